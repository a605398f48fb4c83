//! The sensing border: raw counts become SI units here, once, for inner and outer loop alike.
//!
//! In this order: counts × scale → board rotation → calibration (offset, scale) → level. Drivers
//! and models do none of it.

use windhover_math::{Euler, GRAVITY, Quaternion, Vector3};
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
        gyro_id: "CAL_GYRO0_ID", "", 0.0..=16777215.0, 0.0, "Identity of the gyro that the calibration is of; 0: not calibrated, and the vehicle does not arm";
        accel_id: "CAL_ACC0_ID", "", 0.0..=16777215.0, 0.0, "Identity of the accelerometer that the calibration is of; 0: not calibrated, and the vehicle does not arm";
        compass_id: "CAL_MAG0_ID", "", 0.0..=16777215.0, 0.0, "Identity of the compass that the calibration is of; 0: not calibrated, and the vehicle does not arm to fly by position";
        gyro_x: "CAL_GYRO0_XOFF", "rad/s", -1.0..=1.0, 0.0, "Gyro offset, front axis";
        gyro_y: "CAL_GYRO0_YOFF", "rad/s", -1.0..=1.0, 0.0, "Gyro offset, right axis";
        gyro_z: "CAL_GYRO0_ZOFF", "rad/s", -1.0..=1.0, 0.0, "Gyro offset, down axis";
        accel_x: "CAL_ACC0_XOFF", "m/s^2", -5.0..=5.0, 0.0, "Accelerometer offset, front axis";
        accel_y: "CAL_ACC0_YOFF", "m/s^2", -5.0..=5.0, 0.0, "Accelerometer offset, right axis";
        accel_z: "CAL_ACC0_ZOFF", "m/s^2", -5.0..=5.0, 0.0, "Accelerometer offset, down axis";
        accel_scale_x: "CAL_ACC0_XSCALE", "", 0.9..=1.1, 1.0, "Accelerometer scale, front axis";
        accel_scale_y: "CAL_ACC0_YSCALE", "", 0.9..=1.1, 1.0, "Accelerometer scale, right axis";
        accel_scale_z: "CAL_ACC0_ZSCALE", "", 0.9..=1.1, 1.0, "Accelerometer scale, down axis";
        compass_x: "CAL_MAG0_XOFF_UT", "uT", -500.0..=500.0, 0.0, "Compass offset (hard iron), front axis; PX4 has the same in gauss";
        compass_y: "CAL_MAG0_YOFF_UT", "uT", -500.0..=500.0, 0.0, "Compass offset (hard iron), right axis; PX4 has the same in gauss";
        compass_z: "CAL_MAG0_ZOFF_UT", "uT", -500.0..=500.0, 0.0, "Compass offset (hard iron), down axis; PX4 has the same in gauss";
        compass_scale_x: "CAL_MAG0_XSCALE", "", 0.5..=2.0, 1.0, "Compass scale (soft iron), front axis";
        compass_scale_y: "CAL_MAG0_YSCALE", "", 0.5..=2.0, 1.0, "Compass scale (soft iron), right axis";
        compass_scale_z: "CAL_MAG0_ZSCALE", "", 0.5..=2.0, 1.0, "Compass scale (soft iron), down axis";
        compass_cross_xy: "CAL_MAG0_XODIAG", "", -0.5..=0.5, 0.0, "Compass soft iron off the diagonal, front to right";
        compass_cross_xz: "CAL_MAG0_YODIAG", "", -0.5..=0.5, 0.0, "Compass soft iron off the diagonal, front to down";
        compass_cross_yz: "CAL_MAG0_ZODIAG", "", -0.5..=0.5, 0.0, "Compass soft iron off the diagonal, right to down";
        level_roll: "CAL_LEVEL_ROLL", "rad", -0.3..=0.3, 0.0, "Roll that the board shows while the vehicle stands level";
        level_pitch: "CAL_LEVEL_PITCH", "rad", -0.3..=0.3, 0.0, "Pitch that the board shows while the vehicle stands level";
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

/// One sample in SI units, body axes (FRD).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertial {
    /// Specific force, m/s²: (0, 0, −g) at rest.
    pub specific_force: Vector3,
    /// Body rate, rad/s, bias included.
    pub rate: Vector3,
}

impl Inertial {
    /// Whether an axis shows an end of its range, or nearly: what is really there may be more.
    pub fn is_clipped(&self) -> bool {
        const RATE: f32 = 32_000.0 * GYRO_SCALE;
        const FORCE: f32 = 32_000.0 * ACCEL_SCALE;
        let beyond = |v: &Vector3, most: f32| v.iter().any(|axis| axis.abs() > most);
        beyond(&self.rate, RATE) || beyond(&self.specific_force, FORCE)
    }
}

/// The conversion of one sensor with everything that is constant multiplied out:
/// value = level·scale·(rotation·k·counts − offset) = matrix·counts − shift.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Affine {
    rows: [[f32; 3]; 3],
    shift: [f32; 3],
}

impl Affine {
    fn new(
        rotation: &BoardRotation,
        per_count: f32,
        offset: [f32; 3],
        scale: [f32; 3],
        level: Quaternion,
    ) -> Self {
        let mut affine = Self {
            rows: [[0.0; 3]; 3],
            shift: [0.0; 3],
        };
        let axes = rotation.0.iter().zip(offset.iter().zip(&scale));
        for ((row, shift), (turned, (offset, scale))) in
            affine.rows.iter_mut().zip(&mut affine.shift).zip(axes)
        {
            *row = turned.map(|entry| f32::from(entry) * per_count * scale);
            *shift = offset * scale;
        }
        affine.turned(level)
    }

    /// The same in axes that are turned by `level`. A board that is level keeps its bits.
    fn turned(self, level: Quaternion) -> Self {
        if level == Quaternion::IDENTITY {
            return self;
        }
        let columns = [0, 1, 2].map(|n| level.rotate(Vector3::from(self.rows.map(|row| row[n]))));
        let [a, b, c] = columns;
        let shift = level.rotate(Vector3::from(self.shift));
        Self {
            rows: [[a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]],
            shift: [shift.x, shift.y, shift.z],
        }
    }

    #[inline(always)]
    fn apply(&self, counts: [i16; 3]) -> Vector3 {
        let [x, y, z] = counts.map(f32::from);
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rows;
        let [p, q, r] = self.shift;
        Vector3::new(
            a * x + b * y + c * z - p,
            d * x + e * y + f * z - q,
            g * x + h * y + i * z - r,
        )
    }
}

/// The border: made once for a rotation and a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensingBorder {
    accel: Affine,
    gyro: Affine,
}

impl SensingBorder {
    /// For a sensor that sits like this, calibrated like that.
    pub fn new(rotation: &BoardRotation, calibration: &CalibrationParameters) -> Self {
        let c = calibration;
        let level = Quaternion::from_euler(Euler {
            roll: c.level_roll,
            pitch: c.level_pitch,
            yaw: 0.0,
        });
        Self {
            accel: Affine::new(
                rotation,
                ACCEL_SCALE,
                [c.accel_x, c.accel_y, c.accel_z],
                [c.accel_scale_x, c.accel_scale_y, c.accel_scale_z],
                level,
            ),
            gyro: Affine::new(
                rotation,
                GYRO_SCALE,
                [c.gyro_x, c.gyro_y, c.gyro_z],
                [1.0; 3],
                level,
            ),
        }
    }

    /// One sample in SI units and body axes.
    #[inline(always)]
    pub fn convert(&self, counts: &ImuCounts) -> Inertial {
        Inertial {
            specific_force: self.accel.apply(counts.accel),
            rate: self.gyro.apply(counts.gyro),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_at_rest_are_minus_one_g_down() {
        let counts = ImuCounts {
            accel: [0, 0, -2048],
            gyro: [164, 0, 0],
        };
        let inertial =
            SensingBorder::new(&BoardRotation::default(), &CalibrationParameters::default()).convert(&counts);
        assert!((inertial.specific_force.z + GRAVITY).abs() < 1e-5);
        assert!((inertial.rate.x - 10.0f32.to_radians()).abs() < 1e-5);
    }

    /// A board that lies rolled and pitched in a level vehicle shows gravity straight down once its
    /// trim is set, and a yaw of the vehicle about the vehicle's own axis.
    #[test]
    fn the_level_is_taken_out() {
        let calibration = CalibrationParameters {
            level_roll: 0.1,
            level_pitch: -0.05,
            ..Default::default()
        };
        let trim = Quaternion::from_euler(Euler {
            roll: 0.1,
            pitch: -0.05,
            yaw: 0.0,
        });
        // what the board sees: gravity's reaction and a yaw rate, in its own axes
        let seen = |v: Vector3, per_count: f32| {
            let board = trim.inverse_rotate(v) / per_count;
            [board.x, board.y, board.z].map(|x| (x + if x < 0.0 { -0.5 } else { 0.5 }) as i16)
        };
        let counts = ImuCounts {
            accel: seen(Vector3::new(0.0, 0.0, -GRAVITY), ACCEL_SCALE),
            gyro: seen(Vector3::new(0.0, 0.0, 2.0), GYRO_SCALE),
        };
        let inertial = SensingBorder::new(&BoardRotation::default(), &calibration).convert(&counts);
        assert!((inertial.specific_force - Vector3::new(0.0, 0.0, -GRAVITY)).amax() < 5e-3);
        assert!((inertial.rate - Vector3::new(0.0, 0.0, 2.0)).amax() < 1e-3);
    }

    #[test]
    fn rotation_comes_before_the_offset() {
        // The sensor lies turned by 90° about down: its x is the body's right.
        let rotation = BoardRotation([[0, -1, 0], [1, 0, 0], [0, 0, 1]]);
        let calibration = CalibrationParameters {
            accel_y: 0.5,
            ..Default::default()
        };
        let counts = ImuCounts {
            accel: [2048, 0, 0],
            gyro: [0; 3],
        };
        let force = SensingBorder::new(&rotation, &calibration)
            .convert(&counts)
            .specific_force;
        assert!(
            (force.y - (GRAVITY - 0.5)).abs() < 1e-5 && force.x == 0.0,
            "{force}"
        );
    }
}
