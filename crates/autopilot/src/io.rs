//! What goes into the inner step and what comes out of it: plain data, all of it logged.

use windhover_math::{Quaternion, Vector3};

/// One sample of the inertial measurement unit as its registers hold it, in the part's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImuCounts {
    /// Accelerometer, raw counts.
    pub accel: [i16; 3],
    /// Gyroscope, raw counts.
    pub gyro: [i16; 3],
}

/// What a tick brings: a sample, or the lack of one. Times in µs since start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Imu {
    /// The sensor had data.
    Sample {
        /// The data.
        counts: ImuCounts,
        /// When the data became ready.
        time: u64,
    },
    /// The time-out came first: 1.5 nominal periods since the last tick.
    Missing {
        /// When the time-out came.
        time: u64,
    },
}

impl Imu {
    /// Time of the tick in µs since start.
    pub fn time(&self) -> u64 {
        match *self {
            Self::Sample { time, .. } | Self::Missing { time } => time,
        }
    }
}

/// The commands that act in the inner step's own tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgent {
    /// Stop the motors now, whatever the phase of flight.
    Kill,
    /// Stop the motors now, as the operator of a landed vehicle does.
    Disarm,
}

/// Everything that one inner step consumes, but for the outer loop's result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InnerInput {
    /// The tick.
    pub imu: Imu,
    /// What the latch of urgent commands held.
    pub urgent: Option<Urgent>,
}

/// What the motors are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotorCommand {
    /// No pulses that could turn a motor.
    #[default]
    Disarmed,
    /// Armed on the ground: every rotor at this command.
    Idle(u16),
    /// In flight: 65535·ω/ω_max for each rotor, in the core's rotor order.
    Run([u16; 4]),
}

impl MotorCommand {
    /// The rotor commands, `None` when disarmed.
    pub fn rotors(&self) -> Option<[u16; 4]> {
        match *self {
            Self::Disarmed => None,
            Self::Idle(idle) => Some([idle; 4]),
            Self::Run(rotors) => Some(rotors),
        }
    }
}

/// What the inertial sensors measured between two snapshots, and what the motors did meanwhile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Increments {
    /// The rotation since the last snapshot: body now to body then. Gyro bias taken off.
    pub rotation: Quaternion,
    /// The gyro bias that was taken off, but for the last tick if a new one came with it, rad/s.
    pub gyro_bias: Vector3,
    /// Integral of the specific force, in the body axes of the last snapshot, m/s.
    pub velocity: Vector3,
    /// Length of the interval, s.
    pub duration: f32,
    /// Integral of the thrust that the rotors should have made, N·s, their lag included.
    pub thrust: f32,
    /// Integral of what the mixer added to the demanded thrust, N·s.
    pub thrust_shortfall: f32,
    /// Ticks in the interval.
    pub ticks: u16,
    /// Ticks of these that had no sample.
    pub missing: u16,
    /// Ticks of these at which the accelerometer showed nothing that can be true: instead of it the
    /// thrust counts that the rotors should have made.
    pub blind: u16,
    /// Ticks of these at whose end a sensor showed an end of its range; only the last one is looked
    /// at, and stands for all.
    pub clipped: u16,
    /// Ticks of these at which a rotor limit changed the demand.
    pub saturated: u16,
}

/// What a boundary of the schedule did. Replay is driven by these records alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScheduleRecord {
    /// The tick of the boundary.
    pub tick: u32,
    /// Whether an outer result was adopted.
    pub adopted: bool,
    /// Whether a snapshot was taken; if not, the outer step missed this boundary.
    pub snapshot_taken: bool,
}
