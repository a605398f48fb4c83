//! What the filter claims of itself.

use windhover_math::sqrt;

use crate::covariance::{Covariance, Group};

/// Standard deviations (1 σ) of the state, by the covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// Horizontal position, of both axes together, m.
    pub horizontal: f32,
    /// Height, m.
    pub vertical: f32,
    /// Velocity, of the three axes together, m/s.
    pub velocity: f32,
    /// Roll and pitch together, rad.
    pub tilt: f32,
    /// Heading, rad.
    pub heading: f32,
}

impl Accuracy {
    /// From the covariance, and the variance of the height that the barometer is referred to, m².
    pub(crate) fn of(covariance: &Covariance, datum_variance: f32) -> Self {
        let p = covariance.variances(Group::Position);
        let v = covariance.variances(Group::Velocity);
        let a = covariance.variances(Group::Attitude);
        Self {
            horizontal: sqrt(p[0] + p[1]),
            vertical: sqrt(p[2] + datum_variance),
            velocity: sqrt(v[0] + v[1] + v[2]),
            tilt: sqrt(a[0] + a[1]),
            heading: sqrt(a[2]),
        }
    }
}
