//! How far the inertial sensors are from their ideal: what the covariance grows by.

use windhover_parameters::parameters;

use crate::covariance::Added;

parameters! {
    /// Noise of the inertial sensors as the filter sees it. Defaults: ICM-42688-P on a vehicle that
    /// vibrates, so some times the part's own noise (6.9e-4 m/s²/√Hz, 4.9e-5 rad/s/√Hz).
    pub struct NoiseParameters {
        accel: "EST_ACC_NOISE", "m/s^2/Hz^0.5", 1e-5..=10.0, 0.005, "Density of the accelerometer's noise";
        gyro: "EST_GYRO_NOISE", "rad/s/Hz^0.5", 1e-6..=1.0, 1e-4, "Density of the gyro's noise";
        accel_walk: "EST_ACC_WALK", "m/s^2/s^0.5", 1e-7..=1.0, 2e-4, "Random walk of the accelerometer's bias";
        gyro_walk: "EST_GYRO_WALK", "rad/s/s^0.5", 1e-8..=0.1, 2e-5, "Random walk of the gyro's bias";
    }
}

impl NoiseParameters {
    /// Variances per second.
    pub(crate) fn densities(&self) -> Added {
        Added {
            velocity: self.accel * self.accel,
            attitude: self.gyro * self.gyro,
            gyro_bias: self.gyro_walk * self.gyro_walk,
            accel_bias: self.accel_walk * self.accel_walk,
        }
    }
}
