//! What the caller tells about the vehicle: one plain struct, in SI units, radians and NED.

use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

use crate::mode::Mode;

/// The state of the vehicle as far as ground stations are told; `None` is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Telemetry {
    /// Time since start by the vehicle's own clock, µs, where that is not the link's: in a simulation
    /// that runs faster. Streams and times in messages follow it; the protocols' waits do not.
    pub time: Option<u64>,
    /// Attitude, body to world.
    pub attitude: Option<Quaternion>,
    /// Body rates, FRD, rad/s.
    pub rate: Vector3,
    /// Position, NED, m from home.
    pub position: Option<Vector3>,
    /// Velocity, NED, m/s.
    pub velocity: Option<Vector3>,
    /// Position on the Earth.
    pub global: Option<GlobalPosition>,
    /// Home.
    pub home: Option<GlobalPosition>,
    /// What the GNSS receiver says.
    pub gnss: Option<Gnss>,
    /// The battery.
    pub battery: Battery,
    /// Mode of flight.
    pub mode: Mode,
    /// Whether the motors may turn.
    pub armed: bool,
    /// Whether something has gone wrong that needs the pilot.
    pub failsafe: bool,
    /// Whether it stands on the ground.
    pub landed: Landed,
    /// How far the mission has come.
    pub mission: Progress,
    /// What works.
    pub health: Health,
    /// Share of the processor's time that is used, 0 to 1.
    pub load: f32,
    /// Share of the largest thrust that is asked for, 0 to 1.
    pub throttle: f32,
    /// Motor commands, share of the largest speed: 65535 is all; in the order of MAVLink's outputs.
    pub motors: [u16; 4],
    /// UTC, µs since 1970.
    pub utc: Option<u64>,
}

/// What a GNSS receiver says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gnss {
    /// How good its position is.
    pub fix: Fix,
    /// Satellites in use.
    pub satellites: u8,
    /// Its position.
    pub position: GlobalPosition,
    /// Ground speed, m/s.
    pub speed: f32,
    /// Course over ground, rad; `None` at rest.
    pub course: Option<f32>,
    /// Dilution of precision, horizontal and vertical.
    pub dilution: [Option<f32>; 2],
    /// Accuracy, one standard deviation, horizontal and vertical, m.
    pub accuracy: [f32; 2],
    /// Accuracy of the speed, one standard deviation, m/s.
    pub speed_accuracy: f32,
}

/// How good a position by satellites is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fix {
    /// There is none.
    #[default]
    None,
    /// Without altitude.
    Flat,
    /// With altitude.
    Full,
    /// With corrections.
    Differential,
    /// Carrier phase, not yet whole numbers.
    RtkFloat,
    /// Carrier phase.
    RtkFixed,
}

/// The battery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery {
    /// V.
    pub voltage: Option<f32>,
    /// A.
    pub current: Option<f32>,
    /// Charge taken out, C (A·s).
    pub consumed: Option<f32>,
    /// Share that is left, 0 to 1.
    pub remaining: Option<f32>,
    /// Whether it is low, or worse.
    pub charge: Charge,
}

/// How much the battery has left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Charge {
    /// Enough.
    #[default]
    Enough,
    /// Low: time to come back.
    Low,
    /// Critical: time to land.
    Critical,
}

/// Whether the vehicle stands on the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Landed {
    /// It does.
    #[default]
    OnGround,
    /// It leaves it.
    TakingOff,
    /// It flies.
    InAir,
    /// It comes down.
    Landing,
}

/// How far the mission has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Index of the item that is being flown.
    pub current: u16,
    /// What the mission is doing.
    pub state: MissionState,
}

/// What the mission is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissionState {
    /// It was not started.
    #[default]
    NotStarted,
    /// It is being flown.
    Active,
    /// It was interrupted.
    Paused,
    /// It was flown to its end.
    Complete,
}

/// One part of the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// Not fitted.
    #[default]
    Absent,
    /// Fitted and not to be relied on.
    Bad,
    /// Working.
    Good,
}

/// What works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Gyro.
    pub gyro: Part,
    /// Accelerometer.
    pub accelerometer: Part,
    /// Compass.
    pub compass: Part,
    /// Barometer.
    pub barometer: Part,
    /// GNSS receiver.
    pub gnss: Part,
    /// Remote control.
    pub radio: Part,
    /// Battery.
    pub battery: Part,
    /// Attitude and position are known well enough.
    pub estimate: Part,
    /// Log.
    pub log: Part,
    /// Motors.
    pub motors: Part,
    /// Geofence.
    pub fence: Part,
    /// Nothing speaks against arming.
    pub can_arm: bool,
}
