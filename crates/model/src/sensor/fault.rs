//! Faults of sensors as data, by name: `NAME@T` or `NAME@T,FOR`, as in `gnss-dropout@40,30`.
//!
//! A fault acts from its start (inclusive) to its end (exclusive), in seconds of flight; without
//! `FOR`, to the end of the flight. [`injection`](super::injection) lets it act on raw outputs.

use core::fmt;
use core::str::FromStr;

use thiserror::Error;

/// What fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultSensor {
    /// The inertial measurement unit as a whole.
    Imu,
    /// Its gyroscope.
    Gyro,
    /// Its accelerometer.
    Accel,
    /// The barometer.
    Barometer,
    /// The compass.
    Compass,
    /// The satellite receiver.
    Gnss,
    /// The battery's sensors.
    Battery,
    /// The RC receiver.
    Rc,
}

/// How it fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// Nothing comes. Gyroscope and accelerometer alone: their registers hold −32768, which is
    /// how the part marks an invalid sample.
    Dropout,
    /// What came last, again and again.
    Freeze,
    /// One result a second is off, in turn above and below.
    Spike,
    /// Every result is off by the same.
    BiasStep,
    /// White noise besides the sensor's own.
    Noise,
    /// Results are too large by a factor. Barometer and receiver: their changes since the start
    /// of the fault, and the receiver's velocity.
    WrongScale,
}

use FaultKind::{BiasStep, Dropout, Freeze, Noise, Spike, WrongScale};

const SENSORS: [FaultSensor; 8] = [
    FaultSensor::Imu,
    FaultSensor::Gyro,
    FaultSensor::Accel,
    FaultSensor::Barometer,
    FaultSensor::Compass,
    FaultSensor::Gnss,
    FaultSensor::Battery,
    FaultSensor::Rc,
];

const KINDS: [FaultKind; 6] = [Dropout, Freeze, Spike, BiasStep, Noise, WrongScale];

impl FaultSensor {
    /// As in the names of faults.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Imu => "imu",
            Self::Gyro => "gyro",
            Self::Accel => "accel",
            Self::Barometer => "baro",
            Self::Compass => "compass",
            Self::Gnss => "gnss",
            Self::Battery => "battery",
            Self::Rc => "rc",
        }
    }

    /// The kinds of faults that it can have.
    pub const fn kinds(self) -> &'static [FaultKind] {
        match self {
            Self::Imu => &[Dropout, Freeze],
            _ => &KINDS,
        }
    }

    /// What is off, with its unit in [`SensorFault::magnitude`].
    const fn quantity(self) -> (&'static str, &'static str) {
        match self {
            Self::Imu => ("samples", ""),
            Self::Gyro => ("the angular rate, on each axis,", "rad/s"),
            Self::Accel => ("the specific force, on each axis,", "m/s²"),
            Self::Barometer => ("the height", "m"),
            Self::Compass => ("the field, on each axis,", "µT"),
            Self::Gnss => ("the position, on each axis,", "m"),
            Self::Battery => ("voltage and current", "V and A"),
            Self::Rc => ("each channel", "of half its travel"),
        }
    }

    /// Magnitudes by default: spike, bias step, noise, wrong scale. Large enough to matter in
    /// flight, and small enough to be mistaken for a measurement.
    const fn magnitudes(self) -> [f64; 4] {
        match self {
            Self::Imu => [0.0, 0.0, 0.0, 1.0],
            Self::Gyro => [3.0, 0.035, 0.1, 1.1],
            Self::Accel => [20.0, 0.5, 2.0, 1.1],
            Self::Barometer => [20.0, 5.0, 2.0, 1.5],
            Self::Compass => [100.0, 20.0, 5.0, 1.5],
            Self::Gnss => [50.0, 10.0, 5.0, 1.5],
            Self::Battery => [-3.0, -1.0, 0.5, 0.9],
            Self::Rc => [1.0, 0.2, 0.1, 0.5],
        }
    }
}

impl FaultKind {
    /// As in the names of faults.
    pub const fn name(self) -> &'static str {
        match self {
            Dropout => "dropout",
            Freeze => "freeze",
            Spike => "spike",
            BiasStep => "bias-step",
            Noise => "noise",
            WrongScale => "wrong-scale",
        }
    }
}

/// One fault of one sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorFault {
    /// What fails.
    pub sensor: FaultSensor,
    /// How.
    pub kind: FaultKind,
    /// From when on, in s.
    pub start: f64,
    /// How long, in s; infinite for the rest of the flight.
    pub duration: f64,
    /// How much: rad/s, m/s², m, µT, V and A, or half the travel of a stick; for a wrong scale
    /// the factor. Dropout and freeze have none.
    pub magnitude: f64,
}

/// A name of a fault with one line for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultName {
    /// As in [`SensorFault::from_str`], before the `@`.
    pub name: String,
    /// What happens, with its magnitude.
    pub text: String,
}

impl SensorFault {
    /// A fault with its magnitude by default.
    pub fn new(sensor: FaultSensor, kind: FaultKind, start: f64, duration: f64) -> Self {
        let [spike, bias, noise, scale] = sensor.magnitudes();
        let magnitude = match kind {
            Dropout | Freeze => 0.0,
            Spike => spike,
            BiasStep => bias,
            Noise => noise,
            WrongScale => scale,
        };
        Self {
            sensor,
            kind,
            start,
            duration,
            magnitude,
        }
    }

    /// The name, as in [`SensorFault::all`].
    pub fn name(&self) -> String {
        format!("{}-{}", self.sensor.name(), self.kind.name())
    }

    /// What happens, in one line.
    pub fn text(&self) -> String {
        let (quantity, unit) = self.sensor.quantity();
        let amount = self.magnitude;
        match (self.kind, self.sensor) {
            (Dropout, FaultSensor::Gyro | FaultSensor::Accel) => {
                "its registers hold -32768, the mark of an invalid sample".to_owned()
            }
            (Dropout, _) => "nothing comes".to_owned(),
            (Freeze, _) => "what came last comes again and again".to_owned(),
            (Spike, _) => format!("once a second {quantity} is off by {amount} {unit}, in turn up and down"),
            (BiasStep, _) => format!("{quantity} is off by {amount} {unit}"),
            (Noise, _) => format!("{quantity} has noise of {amount} {unit}"),
            (WrongScale, FaultSensor::Barometer | FaultSensor::Gnss) => {
                format!("changes of {quantity} count {amount} times")
            }
            (WrongScale, _) => format!("{quantity} counts {amount} times"),
        }
    }

    /// When it acts: from the first µs to before the second.
    pub fn window(&self) -> (u64, u64) {
        let us = |seconds: f64| libm::rint(seconds * 1e6) as u64;
        let start = us(self.start);
        (start, start.saturating_add(us(self.duration)))
    }

    /// All faults that can be named, sensor by sensor.
    pub fn all() -> Vec<FaultName> {
        let faults = SENSORS
            .iter()
            .flat_map(|&sensor| sensor.kinds().iter().map(move |&kind| (sensor, kind)));
        faults
            .map(|(sensor, kind)| Self::new(sensor, kind, 0.0, f64::INFINITY))
            .map(|fault| FaultName {
                name: fault.name(),
                text: fault.text(),
            })
            .collect()
    }
}

impl fmt::Display for SensorFault {
    /// As [`FromStr`] reads it; the magnitude is not part of it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.name(), self.start)?;
        if self.duration.is_finite() {
            write!(f, ",{}", self.duration)?;
        }
        Ok(())
    }
}

/// Why a fault is refused, in one line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FaultError {
    /// No `@`.
    #[error("fault {0}: must be NAME@T or NAME@T,FOR with times in s, as in gnss-dropout@40,30")]
    Form(String),
    /// A name that no fault has.
    #[error("no fault is named {0}: `windhover faults` lists them")]
    Name(String),
    /// Not a time.
    #[error("fault {name}: {field} is {value}: must be {allowed}")]
    Time {
        /// The fault's name.
        name: String,
        /// Which of the two times.
        field: &'static str,
        /// What was found.
        value: String,
        /// The values allowed.
        allowed: &'static str,
    },
}

impl FromStr for SensorFault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let Some((name, times)) = text.split_once('@') else {
            return Err(FaultError::Form(text.escape_default().to_string()));
        };
        let known = SENSORS
            .iter()
            .flat_map(|&sensor| sensor.kinds().iter().map(move |&kind| (sensor, kind)))
            .find(|(sensor, kind)| Self::new(*sensor, *kind, 0.0, 0.0).name() == name);
        let Some((sensor, kind)) = known else {
            return Err(FaultError::Name(name.escape_default().to_string()));
        };
        let time = |field, value: &str, least: f64, allowed| {
            let found = value.parse().ok();
            found
                .filter(|time| (least..=1e6).contains(time))
                .ok_or_else(|| FaultError::Time {
                    name: name.to_owned(),
                    field,
                    value: value.escape_default().to_string(),
                    allowed,
                })
        };
        let (start, duration) = match times.split_once(',') {
            None => (times, f64::INFINITY),
            Some((start, duration)) => (start, time("FOR", duration, 1e-6, "above 0, to 1000000 s")?),
        };
        let start = time("T", start, 0.0, "0 to 1000000 s")?;
        Ok(Self::new(sensor, kind, start, duration))
    }
}
