//! What a ground station may ask of the vehicle, in SI units, radians and NED.

use windhover_autopilot::mission::action::{Altitude, Place};

use crate::mode::Mode;
use crate::setpoints::{Channels, Setpoint, Sticks};

/// Something asked for. Each variant says whether an answer is awaited by
/// [`crate::outbox::Order::id`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Set a parameter; the value is within the range of its declaration. The answer is the table
    /// itself, or [`crate::Link::parameter_refused`].
    WriteParameter {
        /// Index in the table.
        index: u16,
        /// In the table's unit.
        value: f32,
    },
    /// Let the motors turn.
    Arm {
        /// Whatever speaks against it.
        force: bool,
    },
    /// Stop the motors of a landed vehicle.
    Disarm,
    /// Stop the motors now, wherever it is.
    Kill,
    /// Take off.
    Takeoff {
        /// To here; `None` leaves it to a parameter.
        altitude: Option<Altitude>,
        /// Heading, rad; `None` keeps it.
        heading: Option<f32>,
    },
    /// Land.
    Land {
        /// There; `None` is here.
        place: Option<Ground>,
    },
    /// Return and land.
    Return,
    /// Stay here; a mission is interrupted.
    Hold,
    /// Go on with the mission that was interrupted.
    Continue,
    /// Fly there and stay.
    Reposition {
        /// Over this point; `None` is the present one.
        place: Option<Ground>,
        /// At this altitude; `None` is the present one.
        altitude: Option<Altitude>,
        /// Heading, rad; `None` leaves it to the vehicle.
        heading: Option<f32>,
        /// Ground speed, m/s; `None` leaves it to a parameter.
        speed: Option<f32>,
    },
    /// Fly at another speed from now on.
    ChangeSpeed {
        /// Which.
        kind: SpeedKind,
        /// m/s; `None` goes back to the parameter.
        speed: Option<f32>,
    },
    /// Change the mode of flight.
    SetMode(Mode),
    /// Fly the stored mission from an item on.
    StartMission {
        /// Index of the first item; it may lie beyond the mission.
        first: u16,
    },
    /// Go on with another item of the mission.
    SetCurrentItem {
        /// Its index; as a command it may lie beyond the mission, and is then to be denied.
        index: u16,
    },
    /// Put home somewhere.
    SetHome(
        /// There; `None` is here.
        Option<Place>,
    ),
    /// Point camera and heading.
    LookAt(
        /// At this; `None` looks ahead again.
        Option<Place>,
    ),
    /// Release the shutter.
    TakePhotos {
        /// Seconds between two.
        interval: f32,
        /// How many; 0 goes on until told to stop.
        count: u32,
    },
    /// A photo every so many metres; 0 stops.
    PhotosByDistance {
        /// Metres between two.
        distance: f32,
        /// The first one now, and not after that distance.
        at_once: bool,
    },
    /// Take no more photos.
    StopPhotos,
    /// Calibrate.
    Calibrate(Calibration),
    /// Run one motor of a disarmed vehicle.
    TestMotor {
        /// Counted from 1, in the order of MAVLink's outputs.
        motor: u8,
        /// Share of full throttle, 0 to 1.
        throttle: f32,
        /// For so long, s.
        duration: f32,
    },
    /// Start the processor anew.
    Reboot,
    /// Store all parameters.
    StoreParameters,
    /// All parameters back to their defaults.
    ResetParameters,
    /// Say what speaks against arming, as lines of text.
    CheckArming,
    /// From now on only those who have this key are heard: [`crate::Signing::set_key`]. To be heeded
    /// on a trusted channel only, such as USB.
    SetSigningKey {
        /// The key.
        secret: [u8; 32],
        /// Time of signing, 10 µs since 2015-01-01.
        time: u64,
    },
    /// Follow this, for as long as it keeps coming.
    Offboard(Setpoint),
    /// The sticks of a game pad.
    Sticks(Sticks),
    /// Channels of a remote control, by radio link.
    Channels(Channels),
}

/// A point on the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ground {
    /// WGS84 latitude in 1e-7 degrees.
    pub latitude: i32,
    /// WGS84 longitude in 1e-7 degrees.
    pub longitude: i32,
}

impl Ground {
    /// Whether there is such a point.
    pub(crate) fn is_on_earth(self) -> bool {
        self.latitude.unsigned_abs() <= 900_000_000 && self.longitude.unsigned_abs() <= 1_800_000_000
    }
}

/// Which speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedKind {
    /// Over ground.
    Ground,
    /// Upwards.
    Climb,
    /// Downwards.
    Descent,
}

/// What is to be calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Calibration {
    /// The gyro's offset, at rest.
    Gyro,
    /// The compass, turned in all directions.
    Compass,
    /// The barometer's pressure at the ground.
    Pressure,
    /// The ends of the remote control's sticks.
    Radio,
    /// The accelerometer, in six positions.
    Accelerometer,
    /// What is level, in the present position.
    Level,
    /// The accelerometer's offset along one axis, in the present position.
    AccelerometerOffset,
    /// End of the calibration that is under way.
    Cancel,
}
