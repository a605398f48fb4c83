//! The magnetic field: the bearing of its horizontal part is the declination.
//!
//! Its size and its dip are not used: both change with currents and iron, and say little of the
//! attitude that gravity does not say better.

use windhover_math::{Quaternion, Vector3};

use super::bearing::Bearing;
use crate::border::{Refusal, deviation, number, vector};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::Sensor;

/// Largest component of a field, in whatever unit.
const LARGEST_FIELD: f32 = 1e6;

/// A measured field, calibrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MagneticField {
    /// When it was measured, µs.
    pub time: u64,
    /// FRD, in any unit.
    pub field: Vector3,
    /// Standard deviation of each component, in the same unit.
    pub deviation: f32,
    /// In how many samples in a row, at least 1, the error is the same: so many times the variance
    /// counts when the field is taken in. The gate judges by the variance alone.
    pub repeats: f32,
    /// Declination of the place: bearing of magnetic north, east positive, rad.
    pub declination: f32,
}

impl MagneticField {
    /// Whether this can have been measured.
    pub fn check(&self) -> Result<(), Refusal> {
        vector(self.field, LARGEST_FIELD)?;
        deviation(self.deviation)?;
        if !(1.0..=1e6).contains(&self.repeats) {
            return Err(Refusal::OutOfRange);
        }
        number(self.declination, core::f32::consts::PI)
    }
}

impl Filter {
    /// Takes in the heading that the field tells.
    #[inline]
    pub fn fuse_compass(&mut self, measured: &MagneticField) -> Result<Report<1>, Refusal> {
        let attitude = self.compass_border(measured);
        let attitude = self.counted(Sensor::Compass, attitude)?;
        let bearing = Bearing {
            direction: measured.field,
            bearing: measured.declination,
            noise: measured.deviation * measured.deviation,
            bearing_noise: 0.0,
            repeats: measured.repeats,
            is_bearing_exact: true,
            attitude,
        };
        self.fuse_bearing(Sensor::Compass, &bearing)
    }

    /// The attitude when it was measured.
    #[inline(always)]
    fn compass_border(&self, measured: &MagneticField) -> Result<Quaternion, Refusal> {
        measured.check()?;
        Ok(self.past(measured.time)?.attitude(&self.state))
    }
}
