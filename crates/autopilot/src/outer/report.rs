//! What an outer step gives: to the inner step, and to those who watch.

use heapless::Vec;
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

use crate::battery::Charge;
use crate::blocker::Blockers;
use crate::estimation::handover::Handover;
use crate::estimation::{Estimate, SensorReport};
use crate::fence::FenceRefusal;
use crate::inner::{InnerParameters, MotorState};
use crate::mission::{MissionEvents, Refusal};
use crate::mode::Mode;
use crate::queue::{Command, ParameterWrite};
use crate::supervisor::{Phase, Row, RowSet};

/// What the inner step adopts.
#[derive(Clone, Debug, PartialEq)]
pub struct OuterResult {
    /// Tick of the snapshot that it was made from.
    pub tick: u32,
    /// Attitude at that tick.
    pub attitude: Quaternion,
    /// Gyro bias, rad/s.
    pub gyro_bias: Vector3,
    /// Whether the motors may turn.
    pub motors: MotorState,
    /// Whether the vehicle is on the ground.
    pub landed: bool,
    /// What attitude control is to reach.
    pub setpoint: AttitudeSetpoint,
    /// What motor commands are multiplied by while the battery sags; at least 1.
    pub motor_gain: f32,
    /// New parameters of the inner step, when they have changed.
    pub parameters: Option<InnerParameters>,
    /// What is told to those who watch.
    pub report: OuterReport,
}

impl Default for OuterResult {
    fn default() -> Self {
        Self {
            tick: 0,
            attitude: Quaternion::IDENTITY,
            gyro_bias: Vector3::zeros(),
            motors: MotorState::Disarmed,
            landed: false,
            setpoint: AttitudeSetpoint::default(),
            motor_gain: 1.0,
            parameters: None,
            report: OuterReport::default(),
        }
    }
}

/// What the outer step tells those who watch: log, ground station, desktop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OuterReport {
    /// Where the vehicle is between two flights.
    pub phase: Phase,
    /// The mode that flies, or will when the vehicle is armed.
    pub mode: Mode,
    /// The failsafe that acts, the worst of those that are active.
    pub failsafe: Option<Row>,
    /// All failsafes whose condition has lasted.
    pub active: RowSet,
    /// What speaks against arming.
    pub blockers: Blockers,
    /// The estimate that control worked with.
    pub estimate: Estimate,
    /// Where positions count from, once that is known.
    pub origin: Option<GlobalPosition>,
    /// Home, NED, m from there.
    pub home: Vector3,
    /// How the sensors do.
    pub sensors: SensorReport,
    /// What the setpoint is shifted by since the estimate made a step.
    pub handover: Handover,
    /// The point of the path that control followed; `None` when it followed none.
    pub trajectory: Option<TrajectorySetpoint>,
    /// Where the leg that is being flown leads, NED, m; `None` outside missions and returns.
    pub leg_end: Option<Vector3>,
    /// The mission: how far it has come.
    pub mission: MissionReport,
    /// The battery.
    pub battery: BatteryReport,
    /// The disturbance as observed, NED, m/s².
    pub disturbance: Vector3,
    /// Acceleration that the rotors give over what the parameters say.
    pub thrust_scale: f32,
    /// What happened in the mission.
    pub events: MissionEvents,
    /// Commands and writes that were refused.
    pub refusals: Refusals,
}

/// Refusals of one step: room for every write and command of a snapshot, and for two switches of
/// the remote control.
pub type Refusals = Vec<Refused, 10>;

/// How far the mission has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MissionReport {
    /// How many items the stored one has.
    pub count: u16,
    /// Index of the item that is being flown, or will be.
    pub current: u16,
    /// Whether it was begun and not brought to its end.
    pub begun: bool,
}

/// The battery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BatteryReport {
    /// V; `None` while the sensor is silent.
    pub voltage: Option<f32>,
    /// A.
    pub current: Option<f32>,
    /// Share that is left.
    pub remaining: Option<f32>,
    /// Charge drawn, C.
    pub drawn: f32,
    /// How much that is.
    pub charge: Charge,
    /// Below this voltage it is not armed, V.
    pub arming_voltage: f32,
}

/// Something that was asked for and not done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// A command, and why.
    Command(Command, Why),
    /// A write to the parameter table, and why.
    Parameter(ParameterWrite, windhover_parameters::Refusal),
}

/// Why a command was not done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Why {
    /// These speak against it, all of them.
    Blocked(Blockers),
    /// The vehicle is in flight.
    InFlight,
    /// The vehicle is armed.
    Armed,
    /// The vehicle is on the ground.
    OnGround,
    /// This failsafe acts, and does not yield.
    Failsafe(Row),
    /// This item of the mission is why.
    Mission(u16, Refusal),
    /// This item of fence or rally points is why.
    Fence(u16, FenceRefusal),
    /// A number is none, or the place is not known.
    NotANumber,
    /// The place cannot be gone to.
    Place(Refusal),
}

impl core::fmt::Display for Why {
    #[cold]
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blocked(blockers) => {
                for (index, blocker) in blockers.iter().enumerate() {
                    let comma = if index == 0 { "" } else { "; " };
                    write!(f, "{comma}{}", blocker.text())?;
                }
                Ok(())
            }
            Self::InFlight => f.write_str("the vehicle is in flight"),
            Self::Armed => f.write_str("the vehicle is armed"),
            Self::OnGround => f.write_str("the vehicle is on the ground"),
            Self::Failsafe(row) => write!(f, "failsafe: {}", row.watched().text),
            Self::Mission(index, refusal) => write!(f, "mission item {}, {refusal}", index + 1),
            Self::Fence(index, refusal) => write!(f, "fence item {}, {refusal}", index + 1),
            Self::Place(refusal) => refusal.fmt(f),
            Self::NotANumber => f.write_str("a value is not a number, or the place is not known"),
        }
    }
}
