//! What people look at: topics under PX4's names and in PX4's units where PX4 has such a topic, so
//! that PlotJuggler and Flight Review show a flight, and ours beside them.
//!
//! Nothing here is needed for replay; the group for the desktop holds what only a model knows.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::{Blocker, MotorState, OuterResult, Phase, Refused, Snapshot, Stop, Urgent};
use windhover_math::{Quaternion, Vector3};

use crate::inputs::FlatCommand;
use crate::record;
use crate::record::{Description, Record, Topic};
use crate::wire::Decoder;

/// Declares views: struct, number and name of the topic, fields.
macro_rules! views {
    ($(
        $(#[$meta:meta])*
        $View:ident = $id:literal, $name:literal { $($(#[$field_meta:meta])* $field:ident: $Value:ty,)* }
    )*) => {
        $(
            $(#[$meta])*
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct $View {
                $($(#[$field_meta])* pub $field: $Value,)*
            }

            record!($View { $($field: $Value),* });

            impl Topic for $View {
                const TOPIC: Description = Description {
                    id: $id,
                    name: $name,
                    ticked: false,
                    fields: <$View as Record>::FIELDS,
                };
            }
        )*

        /// All views.
        pub const TOPICS: &[Description] = &[$(<$View as Topic>::TOPIC,)*];

        /// A record of any view.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum View {
            $(
                #[doc = concat!("Topic `", $name, "`.")]
                $View($View),
            )*
        }

        impl View {
            /// Reads the fields of the topic with that number; `None` when they are not such.
            pub fn get(id: u16, from: &mut Decoder<'_>) -> Option<Self> {
                match id {
                    $($id => Record::get(from).map(Self::$View),)*
                    _ => None,
                }
            }

            /// The topic, and the record as bytes, written into `buffer`.
            pub fn put<'a>(&self, buffer: &'a mut [u8]) -> (Description, &'a [u8]) {
                let mut out = crate::wire::Encoder::new(buffer);
                let topic = match self {
                    $(Self::$View(view) => {
                        view.put(&mut out);
                        <$View as Topic>::TOPIC
                    })*
                };
                let length = out.finish().unwrap_or(0);
                (topic, buffer.get(..length).unwrap_or_default())
            }
        }
    };
}

views! {
    /// Attitude as estimated.
    VehicleAttitude = 32, "vehicle_attitude" {
        /// Body (FRD) to world (NED).
        q: Quaternion,
    }
    /// Attitude and thrust that position control demands.
    VehicleAttitudeSetpoint = 33, "vehicle_attitude_setpoint" {
        /// Body (FRD) to world (NED).
        q_d: Quaternion,
        /// Thrust in body axes as a share of the largest, −1 to 1.
        thrust_body: Vector3,
    }
    /// Position and velocity as estimated, NED, m and m/s from home.
    VehicleLocalPosition = 34, "vehicle_local_position" {
        /// North, m.
        x: f32,
        /// East, m.
        y: f32,
        /// Down, m.
        z: f32,
        /// North, m/s.
        vx: f32,
        /// East, m/s.
        vy: f32,
        /// Down, m/s.
        vz: f32,
        /// Heading, rad.
        heading: f32,
        /// Whether x and y are known.
        xy_valid: bool,
        /// Whether z is known.
        z_valid: bool,
        /// Whether vx and vy are known.
        v_xy_valid: bool,
        /// Whether vz is known.
        v_z_valid: bool,
    }
    /// The point of the path that position control follows.
    VehicleLocalPositionSetpoint = 35, "vehicle_local_position_setpoint" {
        /// North, m.
        x: f32,
        /// East, m.
        y: f32,
        /// Down, m.
        z: f32,
        /// North, m/s.
        vx: f32,
        /// East, m/s.
        vy: f32,
        /// Down, m/s.
        vz: f32,
        /// NED, m/s².
        acceleration: Vector3,
        /// Heading, rad.
        yaw: f32,
        /// Its rate, rad/s.
        yawspeed: f32,
    }
    /// Motor commands.
    ActuatorMotors = 36, "actuator_motors" {
        /// Rotor speed as a share of the largest, in the core's rotor order.
        control: [f32; 4],
    }
    /// A sample of the inertial sensors in SI units, body axes (FRD), calibrated.
    SensorCombined = 37, "sensor_combined" {
        /// Body rate, rad/s.
        gyro_rad: Vector3,
        /// Specific force, m/s².
        accelerometer_m_s2: Vector3,
    }
    /// The state in PX4's numbers.
    VehicleStatus = 38, "vehicle_status" {
        /// 1 disarmed, 2 armed.
        arming_state: u8,
        /// 3 mission, 4 loiter (here: not flying), 14 offboard.
        nav_state: u8,
        /// 1: rotary wing.
        vehicle_type: u8,
        /// Whether the motors were stopped for a reason of the inner step's.
        failsafe: bool,
    }
    /// Whether the vehicle is on the ground.
    VehicleLandDetected = 39, "vehicle_land_detected" {
        /// Whether it is.
        landed: bool,
    }
    /// The state in our numbers; on change and once a second.
    FlightPhase = 40, "phase" {
        /// 0 disarmed, 1 armed, 2 mission, 3 offboard.
        phase: u8,
        /// 0 disarmed, 1 idle, 2 run.
        motors: u8,
        /// Why the inner step keeps the motors stopped: 0 it does not, 1 kill, 2 disarm, 3 no samples.
        stop: u8,
    }
    /// Something that happened in the mission.
    Mission = 41, "mission_event" {
        /// 1 reached, 2 missed, 3 photo, 4 landed, 5 finished.
        kind: u8,
        /// Index of the item, for the first three.
        item: u16,
        /// Photo: whether position and speed had settled.
        settled: bool,
        /// Photo: whether the vehicle stopped for it.
        has_target: bool,
        /// Photo: where it was to be taken, NED, m.
        target: Vector3,
    }
    /// The leg that is being flown; on change.
    Leg = 42, "leg" {
        /// Where it leads, NED, m.
        destination: Vector3,
    }
    /// Something that was asked for and not done.
    Refusal = 43, "refusal" {
        /// 0 a command, 1 a parameter.
        kind: u8,
        /// Command: as in `input_command`.
        command: u8,
        /// Command: 1 no estimate, 2 not armed, 3 in flight, 4 no mission, 5 no setpoint, 6 stopped.
        /// Parameter: 1 unknown, 2 out of range, 3 inconsistent.
        reason: u8,
        /// Parameter: its index.
        index: u16,
        /// Parameter: the value.
        value: f32,
    }
    /// Acceleration by wind and payload as observed.
    Disturbance = 44, "disturbance" {
        /// NED, m/s².
        acceleration: Vector3,
    }
    /// Sums since the start of the log; once a second.
    TickCounts = 45, "tick_counts" {
        /// Ticks.
        ticks: u32,
        /// Ticks without a sample.
        missing: u32,
        /// Ticks at which a rotor limit changed the demand.
        saturated: u32,
        /// Messages for people that found no room.
        dropped_outputs: u32,
    }
    /// Inputs are missing from the tick `from` to before `until`.
    Gap = 6, "gap" {
        /// The first tick that is missing.
        from: u32,
        /// The first tick that is there again.
        until: u32,
    }
    /// What the model knows; desktop only.
    Truth = 64, "truth" {
        /// NED, m.
        position: [f64; 3],
        /// NED, m/s.
        velocity: [f64; 3],
        /// Body to world.
        q: [f64; 4],
        /// FRD, rad/s.
        body_rate: [f32; 3],
        /// rad/s, in the core's rotor order.
        rotor_speed: [f32; 4],
        /// Velocity of the air, NED, m/s.
        wind: [f32; 3],
        /// Electrical power, W.
        power: f32,
        /// Electrical energy since the start, J.
        energy: f64,
    }
}

/// 0 disarmed, 1 armed, 2 mission, 3 offboard.
pub const fn phase_code(phase: Phase) -> u8 {
    match phase {
        Phase::Disarmed => 0,
        Phase::Armed => 1,
        Phase::Mission => 2,
        Phase::Offboard => 3,
    }
}

/// 0 disarmed, 1 idle, 2 run.
pub const fn motor_state_code(state: MotorState) -> u8 {
    match state {
        MotorState::Disarmed => 0,
        MotorState::Idle => 1,
        MotorState::Run => 2,
    }
}

/// As in [`Refusal::reason`].
pub const fn blocker_code(blocker: Blocker) -> u8 {
    match blocker {
        Blocker::NoEstimate => 1,
        Blocker::NotArmed => 2,
        Blocker::InFlight => 3,
        Blocker::NoMission => 4,
        Blocker::NoSetpoint => 5,
        Blocker::Stopped => 6,
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
        let known = estimate.age.is_some();
        Self {
            x: estimate.position.x,
            y: estimate.position.y,
            z: estimate.position.z,
            vx: estimate.velocity.x,
            vy: estimate.velocity.y,
            vz: estimate.velocity.z,
            heading: estimate.attitude.heading(),
            xy_valid: known,
            z_valid: known,
            v_xy_valid: known,
            v_z_valid: known,
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
    pub fn new(snapshot: &Snapshot, result: &OuterResult) -> Self {
        Self {
            arming_state: if result.motors == MotorState::Disarmed {
                1
            } else {
                2
            },
            nav_state: match result.report.phase {
                Phase::Mission => 3,
                Phase::Disarmed | Phase::Armed => 4,
                Phase::Offboard => 14,
            },
            vehicle_type: 1,
            failsafe: snapshot.stopped == Some(Stop::ImuMissing),
        }
    }
}

impl FlightPhase {
    /// From an outer step.
    pub fn new(snapshot: &Snapshot, result: &OuterResult) -> Self {
        Self {
            phase: phase_code(result.report.phase),
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
            Refused::Command(command, blocker) => Self {
                kind: 0,
                command: FlatCommand::from(*command).command,
                reason: blocker_code(*blocker),
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
