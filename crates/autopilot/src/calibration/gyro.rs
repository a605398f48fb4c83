//! The gyro: its rates while the vehicle stands still are its offsets.
//!
//! Motion starts the rest again. A slow tilting shows in the specific force even where the rate is
//! constant; a steady turn about the vertical shows nowhere, and is taken for an offset.

#[cfg(test)]
mod tests;

use core::fmt;

use windhover_math::Vector3;
use windhover_parameters::Decimal;

use super::rest::{Disturbance, KeepStill, Rest, Resting, Stillness, check_sample};
use super::{Axis, BadSample, Timer};
use crate::sensing::{CalibrationParameters, Inertial};

/// What is asked of a gyro's calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroLimits {
    /// What counts as standing still.
    pub stillness: Stillness,
    /// Largest offset of an axis that is believed, rad/s: 0.2 is 11 °/s, many times what a good part
    /// has.
    pub offset: f32,
    /// Time limit, s.
    pub timeout: f32,
}

impl Default for GyroLimits {
    fn default() -> Self {
        Self {
            stillness: Stillness::default(),
            offset: 0.2,
            timeout: 30.0,
        }
    }
}

/// What the gyro shows at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroCalibration {
    /// Rates that do not exist, body axes, rad/s.
    pub offset: Vector3,
}

impl GyroCalibration {
    /// Puts the offsets into the parameters.
    pub fn write(&self, parameters: &mut CalibrationParameters) {
        parameters.gyro_x = self.offset.x;
        parameters.gyro_y = self.offset.y;
        parameters.gyro_z = self.offset.z;
    }
}

/// Why there is no calibration of the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GyroRefusal {
    /// A sample is none.
    Sample(BadSample),
    /// It never stood still for long enough; so it was last disturbed.
    NeverStill(Option<Disturbance>),
    /// The offset of an axis, rad/s, is larger than any.
    Offset(Axis, f32),
}

impl fmt::Display for GyroRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sample(bad) => bad.fmt(f),
            Self::NeverStill(Some(Disturbance::Turned)) => f.write_str("the vehicle kept turning"),
            Self::NeverStill(Some(Disturbance::Pushed)) => f.write_str("the vehicle kept being pushed"),
            Self::NeverStill(None) => f.write_str("the samples ended before the time needed at rest"),
            Self::Offset(axis, rate) => write!(
                f,
                "the gyro shows {} rad/s about the {axis} at rest: it turns, or the gyro is broken",
                Decimal::rounded(*rate, 3)
            ),
        }
    }
}

/// Where the calibration of the gyro is.
pub type GyroProgress = super::Progress<KeepStill, GyroCalibration, GyroRefusal>;

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroCalibrator {
    limits: GyroLimits,
    timer: Timer,
    rest: Rest,
    disturbed: Option<Disturbance>,
    end: Option<Result<GyroCalibration, GyroRefusal>>,
}

impl GyroCalibrator {
    /// At the beginning.
    pub fn new(limits: GyroLimits) -> Self {
        Self {
            limits,
            timer: Timer::new(limits.timeout),
            rest: Rest::new(limits.stillness),
            disturbed: None,
            end: None,
        }
    }

    /// Takes in an uncalibrated sample that stands for `duration` seconds.
    pub fn step(&mut self, sample: &Inertial, duration: f32) -> GyroProgress {
        if self.end.is_none() {
            self.end = self.take_in(sample, duration).transpose();
        }
        let instruction = KeepStill {
            again: self.disturbed,
        };
        GyroProgress::of(self.end, self.rest.share(), instruction)
    }

    fn take_in(&mut self, sample: &Inertial, duration: f32) -> Result<Option<GyroCalibration>, GyroRefusal> {
        check_sample(sample).map_err(GyroRefusal::Sample)?;
        let late = self.timer.advance(duration).map_err(GyroRefusal::Sample)?;
        match self.rest.take_in(sample, duration) {
            Resting::Still => return self.finish().map(Some),
            Resting::Disturbed(disturbance) => self.disturbed = Some(disturbance),
            Resting::Collecting => {}
        }
        if late {
            return Err(GyroRefusal::NeverStill(self.disturbed));
        }
        Ok(None)
    }

    fn finish(&self) -> Result<GyroCalibration, GyroRefusal> {
        let offset = self.rest.mean().rate;
        match Axis::beyond(offset, self.limits.offset) {
            Some((axis, rate)) => Err(GyroRefusal::Offset(axis, rate)),
            None => Ok(GyroCalibration { offset }),
        }
    }
}

impl Default for GyroCalibrator {
    fn default() -> Self {
        Self::new(GyroLimits::default())
    }
}
