//! The level: how the board lies in a vehicle that stands level.
//!
//! The result is the roll and the pitch of the board's axes as gravity shows them while the *vehicle*
//! stands level, both in radians, in the order yaw, pitch, roll of [`windhover_math::Euler`] with
//! yaw 0. Positive roll: the board's right side is lower than its left; positive pitch: its front is
//! higher than its back. With `t` the quaternion of these angles and `q` the attitude of the board
//! (body to world), the vehicle's attitude is `q · t⁻¹`, and a vector in the board's axes is turned
//! into the vehicle's by `t`.
//!
//! Samples must be calibrated by then: an offset of the accelerometer of 0.1 m/s² is 0.6° of trim.

#[cfg(test)]
mod tests;

use core::fmt;

use windhover_math::scalar::norm;
use windhover_math::{GRAVITY, atan2, sqrt};
use windhover_parameters::Decimal;

use super::rest::{Disturbance, KeepStill, Rest, Resting, Stillness, check_sample};
use super::{BadSample, Timer};
use crate::sensing::{CalibrationParameters, Inertial};

/// What is asked of a calibration of the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelLimits {
    /// What counts as standing still.
    pub stillness: Stillness,
    /// Largest roll and largest pitch, rad.
    pub angle: f32,
    /// Largest difference of the mean force's size from gravity, m/s².
    pub gravity: f32,
    /// Time limit, s.
    pub timeout: f32,
}

impl Default for LevelLimits {
    fn default() -> Self {
        Self {
            stillness: Stillness::default(),
            angle: 0.26,
            gravity: 0.6,
            timeout: 30.0,
        }
    }
}

/// How the board lies: see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelCalibration {
    /// Roll, rad.
    pub roll: f32,
    /// Pitch, rad.
    pub pitch: f32,
}

impl LevelCalibration {
    /// Puts the trim into the parameters.
    pub fn write(&self, parameters: &mut CalibrationParameters) {
        parameters.level_roll = self.roll;
        parameters.level_pitch = self.pitch;
    }
}

/// Why there is no calibration of the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LevelRefusal {
    /// A sample is none.
    Sample(BadSample),
    /// It never stood still for long enough; so it was last disturbed.
    NeverStill(Option<Disturbance>),
    /// The mean force has this size, m/s², which is not gravity's.
    NoGravity(f32),
    /// The board is tilted too far for a trim.
    Tilted {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
    },
}

impl fmt::Display for LevelRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sample(bad) => bad.fmt(f),
            Self::NeverStill(Some(Disturbance::Turned)) => f.write_str("the vehicle kept turning"),
            Self::NeverStill(Some(Disturbance::Pushed)) => f.write_str("the vehicle kept being pushed"),
            Self::NeverStill(None) => f.write_str("the samples ended before the time needed at rest"),
            Self::NoGravity(size) => write!(
                f,
                "the accelerometer shows {} m/s² at rest: calibrate it first",
                Decimal::rounded(*size, 2)
            ),
            Self::Tilted { roll, pitch } => write!(
                f,
                "the board is tilted by {}° roll and {}° pitch: stand the vehicle on a level place",
                Decimal::rounded(roll.to_degrees(), 0),
                Decimal::rounded(pitch.to_degrees(), 0)
            ),
        }
    }
}

/// Where the calibration of the level is.
pub type LevelProgress = super::Progress<KeepStill, LevelCalibration, LevelRefusal>;

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelCalibrator {
    limits: LevelLimits,
    timer: Timer,
    rest: Rest,
    disturbed: Option<Disturbance>,
    end: Option<Result<LevelCalibration, LevelRefusal>>,
}

impl LevelCalibrator {
    /// At the beginning.
    pub fn new(limits: LevelLimits) -> Self {
        Self {
            limits,
            timer: Timer::new(limits.timeout),
            rest: Rest::new(limits.stillness),
            disturbed: None,
            end: None,
        }
    }

    /// Takes in a sample with a calibrated accelerometer that stands for `duration` seconds.
    pub fn step(&mut self, sample: &Inertial, duration: f32) -> LevelProgress {
        if self.end.is_none() {
            self.end = self.take_in(sample, duration).transpose();
        }
        let instruction = KeepStill {
            again: self.disturbed,
        };
        LevelProgress::of(self.end, self.rest.share(), instruction)
    }

    fn take_in(
        &mut self,
        sample: &Inertial,
        duration: f32,
    ) -> Result<Option<LevelCalibration>, LevelRefusal> {
        check_sample(sample).map_err(LevelRefusal::Sample)?;
        let late = self.timer.advance(duration).map_err(LevelRefusal::Sample)?;
        match self.rest.take_in(sample, duration) {
            Resting::Still => return self.finish().map(Some),
            Resting::Disturbed(disturbance) => self.disturbed = Some(disturbance),
            Resting::Collecting => {}
        }
        if late {
            return Err(LevelRefusal::NeverStill(self.disturbed));
        }
        Ok(None)
    }

    fn finish(&self) -> Result<LevelCalibration, LevelRefusal> {
        let down = -self.rest.mean().specific_force;
        let size = norm(down);
        if (size - GRAVITY).abs() > self.limits.gravity {
            return Err(LevelRefusal::NoGravity(size));
        }
        let roll = atan2(down.y, down.z);
        let pitch = atan2(-down.x, sqrt(down.y * down.y + down.z * down.z));
        if roll.abs() <= self.limits.angle && pitch.abs() <= self.limits.angle {
            Ok(LevelCalibration { roll, pitch })
        } else {
            Err(LevelRefusal::Tilted { roll, pitch })
        }
    }
}

impl Default for LevelCalibrator {
    fn default() -> Self {
        Self::new(LevelLimits::default())
    }
}
