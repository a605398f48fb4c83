//! The border of the filter: what is not a number, or cannot be, goes no further.

use windhover_math::{Quaternion, Vector3};

use crate::history::Unreachable;
use crate::state::InertialIncrements;

/// Why an input was not looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Something in it is not a finite number.
    NotFinite,
    /// Something in it lies beyond what flies.
    OutOfRange,
    /// It was measured before what the filter remembers.
    TooOld,
    /// It claims a time that is still to come.
    Ahead,
    /// It says nothing in this attitude, as a compass in a vertical field.
    Blind,
}

/// Shortest interval between two steps, s.
pub const SHORTEST_INTERVAL: f32 = 1e-5;
/// Longest interval between two steps, s.
pub const LONGEST_INTERVAL: f32 = 0.5;
/// Largest mean specific force over an interval, m/s²: twice an accelerometer's range of 16 g.
pub const LARGEST_FORCE: f32 = 320.0;
/// Largest rate or bias of a gyro, rad/s: its range of 2000 °/s.
pub const LARGEST_RATE: f32 = 35.0;
/// Largest distance from the origin, m.
pub const LARGEST_POSITION: f32 = 1e5;
/// Largest speed, m/s.
pub const LARGEST_VELOCITY: f32 = 300.0;
/// Smallest and largest standard deviation that a measurement may claim, in its own unit.
pub const DEVIATIONS: core::ops::RangeInclusive<f32> = 1e-4..=1e4;

/// A number of at most this magnitude.
#[inline(always)]
pub(crate) fn number(value: f32, limit: f32) -> Result<(), Refusal> {
    // A NaN fails the comparison.
    if value.abs() <= limit {
        Ok(())
    } else if value.is_finite() {
        Err(Refusal::OutOfRange)
    } else {
        Err(Refusal::NotFinite)
    }
}

/// Every component of at most this magnitude.
#[inline(always)]
pub(crate) fn vector(value: Vector3, limit: f32) -> Result<(), Refusal> {
    // One comparison for all three where all is well.
    if value.dot(&value) <= limit * limit {
        return Ok(());
    }
    beyond(value, limit)
}

/// What is wrong with it, if anything is: a corner of the cube lies outside the sphere.
#[cold]
fn beyond(value: Vector3, limit: f32) -> Result<(), Refusal> {
    number(value.x, limit)?;
    number(value.y, limit)?;
    number(value.z, limit)
}

/// A standard deviation.
#[inline(always)]
pub(crate) fn deviation(value: f32) -> Result<(), Refusal> {
    if value >= *DEVIATIONS.start() && value <= *DEVIATIONS.end() {
        Ok(())
    } else if value.is_finite() {
        Err(Refusal::OutOfRange)
    } else {
        Err(Refusal::NotFinite)
    }
}

/// A rotation, of norm 1 but for rounding.
#[inline(always)]
pub(crate) fn rotation(value: Quaternion) -> Result<(), Refusal> {
    let square = value.dot(value);
    if (square - 1.0).abs() < 1e-3 {
        Ok(())
    } else if value.is_finite() {
        Err(Refusal::OutOfRange)
    } else {
        Err(Refusal::NotFinite)
    }
}

impl InertialIncrements {
    /// Whether this can have been measured.
    #[inline(always)]
    pub fn check(&self) -> Result<(), Refusal> {
        if !(SHORTEST_INTERVAL..=LONGEST_INTERVAL).contains(&self.duration) {
            number(self.duration, LONGEST_INTERVAL)?;
            return Err(Refusal::OutOfRange);
        }
        rotation(self.rotation)?;
        vector(self.gyro_bias, LARGEST_RATE)?;
        vector(self.velocity, LARGEST_FORCE * self.duration)
    }
}

impl From<Unreachable> for Refusal {
    fn from(why: Unreachable) -> Self {
        match why {
            Unreachable::Ahead => Self::Ahead,
            Unreachable::Behind => Self::TooOld,
        }
    }
}
