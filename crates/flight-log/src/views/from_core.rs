//! Views from what the core gave.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::{Known, Mode, MotorState, OuterResult, Refused, Snapshot, Stop, Urgent, Why};
use windhover_math::Vector3;

use super::{
    BatteryStatus, Disturbance, EstimatorStatus, FlightPhase, Leg, Mission, Refusal, VehicleAttitude,
    VehicleAttitudeSetpoint, VehicleLandDetected, VehicleLocalPosition, VehicleLocalPositionSetpoint,
    VehicleStatus, View,
};
use crate::inputs::FlatCommand;

/// 0 disarmed, 1 idle, 2 run, 3 one motor for a test.
pub const fn motor_state_code(state: MotorState) -> u8 {
    match state {
        MotorState::Disarmed => 0,
        MotorState::Idle => 1,
        MotorState::Run => 2,
        MotorState::Test { .. } => 3,
    }
}

/// As in [`EstimatorStatus::known`].
pub const fn known_code(known: Known) -> u8 {
    known.attitude as u8
        | (known.heading as u8) << 1
        | (known.height as u8) << 2
        | (known.position as u8) << 3
}

/// As in [`Refusal::reason`].
pub const fn why_code(why: &Why) -> u8 {
    match why {
        Why::Blocked(_) => 1,
        Why::InFlight => 2,
        Why::OnGround => 3,
        Why::Failsafe(_) => 4,
        Why::Mission(..) => 5,
        Why::Fence(..) => 6,
        Why::NotANumber => 7,
        Why::Place(_) => 8,
        Why::Armed => 9,
    }
}

/// PX4's `nav_state`.
const fn nav_state(mode: Mode) -> u8 {
    match mode {
        Mode::Stabilize => 15,
        Mode::Altitude => 1,
        Mode::Position => 2,
        Mode::Takeoff => 17,
        Mode::Hold => 4,
        Mode::Mission => 3,
        Mode::Return => 5,
        Mode::Land => 18,
        Mode::Offboard => 14,
        Mode::Descend => 12,
    }
}

/// As in [`Refusal::reason`].
pub const fn refusal_code(refusal: windhover_parameters::Refusal) -> u8 {
    match refusal {
        windhover_parameters::Refusal::Unknown => 1,
        windhover_parameters::Refusal::OutOfRange { .. } => 2,
        windhover_parameters::Refusal::Inconsistent => 3,
    }
}

impl View {
    /// The same view of another outer step: for replay, to hold it against the logged one whose
    /// time is the snapshot's. `None` for views that are not of an outer step alone, and for what
    /// this step has not.
    pub fn again(&self, snapshot: &Snapshot, result: &OuterResult, thrust_max: f32) -> Option<Self> {
        let report = &result.report;
        Some(match self {
            Self::VehicleAttitude(_) => Self::VehicleAttitude(VehicleAttitude::new(result)),
            Self::VehicleAttitudeSetpoint(_) => {
                Self::VehicleAttitudeSetpoint(VehicleAttitudeSetpoint::new(result, thrust_max))
            }
            Self::VehicleLocalPosition(_) => Self::VehicleLocalPosition(VehicleLocalPosition::new(result)),
            Self::VehicleLocalPositionSetpoint(_) => {
                Self::VehicleLocalPositionSetpoint(VehicleLocalPositionSetpoint::new(result)?)
            }
            Self::VehicleStatus(_) => Self::VehicleStatus(VehicleStatus::new(result)),
            Self::VehicleLandDetected(_) => Self::VehicleLandDetected(VehicleLandDetected::new(result)),
            Self::FlightPhase(_) => Self::FlightPhase(FlightPhase::new(snapshot, result)),
            Self::Leg(_) => Self::Leg(Leg {
                destination: report.leg_end?,
            }),
            Self::Disturbance(_) => Self::Disturbance(Disturbance::new(result)),
            Self::EstimatorStatus(_) => Self::EstimatorStatus(EstimatorStatus::new(result)),
            Self::BatteryStatus(_) => Self::BatteryStatus(BatteryStatus::new(result)),
            _ => return None,
        })
    }
}

impl VehicleAttitude {
    /// From an outer result.
    pub fn new(result: &OuterResult) -> Self {
        Self {
            q: result.report.estimate.attitude,
        }
    }
}

impl VehicleLandDetected {
    /// From an outer result.
    pub fn new(result: &OuterResult) -> Self {
        Self {
            landed: result.landed,
        }
    }
}

impl Disturbance {
    /// From an outer result.
    pub fn new(result: &OuterResult) -> Self {
        Self {
            acceleration: result.report.disturbance,
            thrust_scale: result.report.thrust_scale,
        }
    }
}

impl BatteryStatus {
    /// From an outer result.
    pub fn new(result: &OuterResult) -> Self {
        let battery = &result.report.battery;
        Self {
            voltage_v: battery.voltage.unwrap_or_default(),
            current_a: battery.current.unwrap_or_default(),
            remaining: battery.remaining.unwrap_or(-1.0),
            discharged_mah: battery.drawn / 3.6,
            charge: battery.charge as u8,
        }
    }
}

impl EstimatorStatus {
    /// From an outer result.
    pub fn new(result: &OuterResult) -> Self {
        let (estimate, sensors) = (&result.report.estimate, &result.report.sensors);
        let accuracy = &estimate.accuracy;
        Self {
            known: known_code(estimate.known),
            horizontal: accuracy.horizontal,
            vertical: accuracy.vertical,
            velocity: accuracy.velocity,
            tilt: accuracy.tilt,
            heading: accuracy.heading,
            gyro_bias: estimate.gyro_bias,
            accel_bias: estimate.accel_bias,
            sensors: sensors.health,
            rejected: sensors.rejected,
            refused: sensors.refused,
            resets: sensors.resets,
            doubts: sensors.doubts,
            handover: result.report.handover.position,
        }
    }
}

impl VehicleAttitudeSetpoint {
    /// From an outer result; `thrust_max` in N.
    pub fn new(result: &OuterResult, thrust_max: f32) -> Self {
        Self {
            q_d: result.setpoint.attitude,
            thrust_body: Vector3::new(0.0, 0.0, -result.setpoint.thrust / thrust_max),
        }
    }
}

impl VehicleLocalPosition {
    /// From an outer result.
    pub fn new(result: &OuterResult) -> Self {
        let estimate = &result.report.estimate;
        let known = &estimate.known;
        Self {
            x: estimate.position.x,
            y: estimate.position.y,
            z: estimate.position.z,
            vx: estimate.velocity.x,
            vy: estimate.velocity.y,
            vz: estimate.velocity.z,
            heading: estimate.attitude.heading(),
            xy_valid: known.position,
            z_valid: known.height,
            v_xy_valid: known.position,
            v_z_valid: known.height,
        }
    }
}

impl VehicleLocalPositionSetpoint {
    /// From an outer result; `None` when control followed no path.
    pub fn new(result: &OuterResult) -> Option<Self> {
        let point = result.report.trajectory?;
        Some(Self {
            x: point.position.x,
            y: point.position.y,
            z: point.position.z,
            vx: point.velocity.x,
            vy: point.velocity.y,
            vz: point.velocity.z,
            acceleration: point.acceleration,
            yaw: point.heading,
            yawspeed: point.heading_rate,
        })
    }
}

impl VehicleStatus {
    /// From an outer step.
    pub fn new(result: &OuterResult) -> Self {
        Self {
            arming_state: match result.motors {
                MotorState::Disarmed | MotorState::Test { .. } => 1,
                MotorState::Idle | MotorState::Run => 2,
            },
            nav_state: nav_state(result.report.mode),
            vehicle_type: 1,
            failsafe: result.report.failsafe.is_some(),
        }
    }
}

impl FlightPhase {
    /// From an outer step.
    pub fn new(snapshot: &Snapshot, result: &OuterResult) -> Self {
        Self {
            phase: result.report.phase as u8,
            mode: result.report.mode as u8,
            failsafe: result.report.failsafe.map_or(0, |row| row as u8 + 1),
            active: result.report.active.0,
            blockers: result.report.blockers.0,
            motors: motor_state_code(result.motors),
            stop: match snapshot.stopped {
                None => 0,
                Some(Stop::Commanded(Urgent::Kill)) => 1,
                Some(Stop::Commanded(Urgent::Disarm)) => 2,
                Some(Stop::ImuMissing) => 3,
            },
        }
    }
}

impl From<&MissionEvent> for Mission {
    fn from(event: &MissionEvent) -> Self {
        let plain = |kind, item| Self {
            kind,
            item,
            ..Self::default()
        };
        match *event {
            MissionEvent::Reached(item) => plain(1, item),
            MissionEvent::Missed(item) => plain(2, item),
            MissionEvent::Photo {
                item,
                target,
                settled,
            } => Self {
                settled,
                has_target: target.is_some(),
                target: target.unwrap_or_default(),
                ..plain(3, item)
            },
            MissionEvent::Landed => plain(4, 0),
            MissionEvent::Finished => plain(5, 0),
        }
    }
}

impl Mission {
    /// The event, where the numbers name one.
    pub fn event(&self) -> Option<MissionEvent> {
        Some(match self.kind {
            1 => MissionEvent::Reached(self.item),
            2 => MissionEvent::Missed(self.item),
            3 => MissionEvent::Photo {
                item: self.item,
                target: self.has_target.then_some(self.target),
                settled: self.settled,
            },
            4 => MissionEvent::Landed,
            5 => MissionEvent::Finished,
            _ => return None,
        })
    }
}

impl From<&Refused> for Refusal {
    fn from(refused: &Refused) -> Self {
        match refused {
            Refused::Command(command, why) => Self {
                kind: 0,
                command: FlatCommand::from(*command).command,
                reason: why_code(why),
                index: match why {
                    Why::Mission(item, _) | Why::Fence(item, _) => *item,
                    Why::Failsafe(row) => *row as u16,
                    _ => 0,
                },
                blockers: match why {
                    Why::Blocked(blockers) => blockers.0,
                    _ => 0,
                },
                ..Self::default()
            },
            Refused::Parameter(write, refusal) => Self {
                kind: 1,
                reason: refusal_code(*refusal),
                index: write.index,
                value: write.value,
                ..Self::default()
            },
        }
    }
}
