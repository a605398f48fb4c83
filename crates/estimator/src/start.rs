//! Where the filter begins.

use windhover_math::Vector3;

use crate::border::{
    LARGEST_FORCE, LARGEST_POSITION, LARGEST_RATE, LARGEST_VELOCITY, Refusal, deviation, rotation, vector,
};
use crate::covariance::Covariance;
use crate::state::State;

/// A first state and how far it may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The state.
    pub state: State,
    /// Standard deviations, of each axis alike where there is one number.
    pub deviations: Deviations,
}

/// Standard deviations of a first state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// North, east, down, m.
    pub position: Vector3,
    /// m/s.
    pub velocity: f32,
    /// About north and east, rad.
    pub tilt: f32,
    /// About down, rad.
    pub heading: f32,
    /// rad/s.
    pub gyro_bias: f32,
    /// m/s².
    pub accel_bias: f32,
}

impl Default for Deviations {
    /// Nobody knows where; level within some degrees; facing anywhere.
    fn default() -> Self {
        Self {
            position: Vector3::new(1e3, 1e3, 1e3),
            velocity: 1.0,
            tilt: 0.1,
            heading: 3.0,
            gyro_bias: 0.01,
            accel_bias: 0.1,
        }
    }
}

impl Start {
    /// Whether a filter can begin so.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let (state, d) = (&self.state, &self.deviations);
        vector(state.position, LARGEST_POSITION)?;
        vector(state.velocity, LARGEST_VELOCITY)?;
        rotation(state.attitude)?;
        vector(state.gyro_bias, LARGEST_RATE)?;
        vector(state.accel_bias, LARGEST_FORCE)?;
        for value in [d.position.x, d.position.y, d.position.z, d.velocity] {
            deviation(value)?;
        }
        for value in [d.tilt, d.heading, d.gyro_bias, d.accel_bias] {
            // Biases may be known to better than what a measurement may claim.
            deviation(value * 100.0)?;
        }
        Ok(())
    }

    /// Nothing of it is correlated.
    pub(crate) fn covariance(&self) -> Covariance {
        let d = &self.deviations;
        let square = |x: f32| x * x;
        Covariance::diagonal(&[
            [square(d.position.x), square(d.position.y), square(d.position.z)],
            [square(d.velocity); 3],
            [square(d.tilt), square(d.tilt), square(d.heading)],
            [square(d.gyro_bias); 3],
            [square(d.accel_bias); 3],
        ])
    }
}
