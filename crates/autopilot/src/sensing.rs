//! The sensing border: raw counts become SI units here, once, for inner and outer loop alike.
//!
//! In this order: counts × scale → board rotation → calibration (offset, scale). Drivers and
//! models do none of it.

use windhover_math::{GRAVITY, Vector3};
use windhover_parameters::parameters;

use crate::io::ImuCounts;

/// Gyro scale of the ICM-42688-P at ±2000 °/s, 16.4 counts per °/s (datasheet, table 1), in
/// rad/s per count.
pub const GYRO_SCALE: f32 = core::f32::consts::PI / (180.0 * 16.4);

/// Accelerometer scale of the ICM-42688-P at ±16 g, 2048 counts per g (datasheet, table 2), in
/// m/s² per count.
pub const ACCEL_SCALE: f32 = GRAVITY / 2048.0;

parameters! {
    /// Calibration of the inertial sensors, in body axes.
    pub struct CalibrationParameters {
        gyro_x: "CAL_GYRO0_XOFF", "rad/s", -1.0..=1.0, 0.0, "Gyro offset, front axis";
        gyro_y: "CAL_GYRO0_YOFF", "rad/s", -1.0..=1.0, 0.0, "Gyro offset, right axis";
        gyro_z: "CAL_GYRO0_ZOFF", "rad/s", -1.0..=1.0, 0.0, "Gyro offset, down axis";
        accel_x: "CAL_ACC0_XOFF", "m/s^2", -5.0..=5.0, 0.0, "Accelerometer offset, front axis";
        accel_y: "CAL_ACC0_YOFF", "m/s^2", -5.0..=5.0, 0.0, "Accelerometer offset, right axis";
        accel_z: "CAL_ACC0_ZOFF", "m/s^2", -5.0..=5.0, 0.0, "Accelerometer offset, down axis";
        accel_scale_x: "CAL_ACC0_XSCALE", "", 0.9..=1.1, 1.0, "Accelerometer scale, front axis";
        accel_scale_y: "CAL_ACC0_YSCALE", "", 0.9..=1.1, 1.0, "Accelerometer scale, right axis";
        accel_scale_z: "CAL_ACC0_ZSCALE", "", 0.9..=1.1, 1.0, "Accelerometer scale, down axis";
    }
}

/// How the sensor sits on the board and the board in the vehicle: body axes are these rows of
/// the sensor's axes, each entry −1, 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardRotation(pub [[i8; 3]; 3]);

impl Default for BoardRotation {
    fn default() -> Self {
        Self([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    }
}

impl BoardRotation {
    #[inline]
    fn apply(&self, counts: [i16; 3], scale: f32) -> Vector3 {
        let [x, y, z] = counts.map(|count| f32::from(count) * scale);
        let [front, right, down] = self.0.map(|[a, b, c]| f32::from(a) * x + f32::from(b) * y + f32::from(c) * z);
        Vector3::new(front, right, down)
    }
}

/// One sample in SI units, body axes (FRD).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertial {
    /// Specific force, m/s²: (0, 0, −g) at rest.
    pub specific_force: Vector3,
    /// Body rate, rad/s, bias included.
    pub rate: Vector3,
}

/// Converts one sample.
#[inline]
pub fn convert(counts: &ImuCounts, rotation: &BoardRotation, calibration: &CalibrationParameters) -> Inertial {
    let c = calibration;
    let accel = rotation.apply(counts.accel, ACCEL_SCALE) - Vector3::new(c.accel_x, c.accel_y, c.accel_z);
    let gyro = rotation.apply(counts.gyro, GYRO_SCALE) - Vector3::new(c.gyro_x, c.gyro_y, c.gyro_z);
    let scale = Vector3::new(c.accel_scale_x, c.accel_scale_y, c.accel_scale_z);
    Inertial {
        specific_force: accel.component_mul(&scale),
        rate: gyro,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_at_rest_are_minus_one_g_down() {
        let counts = ImuCounts { accel: [0, 0, -2048], gyro: [164, 0, 0] };
        let inertial = convert(&counts, &BoardRotation::default(), &CalibrationParameters::default());
        assert!((inertial.specific_force.z + GRAVITY).abs() < 1e-6);
        assert!((inertial.rate.x - 10.0f32.to_radians()).abs() < 1e-6);
    }

    #[test]
    fn rotation_comes_before_the_offset() {
        // The sensor lies turned by 90° about down: its x is the body's right.
        let rotation = BoardRotation([[0, -1, 0], [1, 0, 0], [0, 0, 1]]);
        let calibration = CalibrationParameters { accel_y: 0.5, ..Default::default() };
        let counts = ImuCounts { accel: [2048, 0, 0], gyro: [0; 3] };
        let force = convert(&counts, &rotation, &calibration).specific_force;
        assert!((force.y - (GRAVITY - 0.5)).abs() < 1e-6 && force.x == 0.0, "{force}");
    }
}
