//! An ideal IMU: the raw counts of an ICM-42688-P without noise, bias or delay.
//!
//! Scales from its data sheet (DS-000347) at ±2000 °/s and ±16 g: 16.4 counts per °/s and 2048
//! counts per g. Axes are the body's (FRD); the part measures the mean over the step.

use windhover_math::Vector3;

use crate::GRAVITY;
use crate::truth::Truth;

/// Gyroscope counts per rad/s.
pub const GYRO_SCALE: f64 = 16.4 * 180.0 / core::f64::consts::PI;

/// Accelerometer counts per m/s².
pub const ACCEL_SCALE: f64 = 2048.0 / GRAVITY;

/// Raw counts as the part's registers hold them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImuCounts {
    /// Specific force along front, right, down.
    pub accel: [i16; 3],
    /// Angular rate about front, right, down.
    pub gyro: [i16; 3],
}

/// The counts for a truth: its specific force and mean rate, so that adding up the counts of
/// every step gives the change of velocity and attitude, but for the rounding.
#[inline]
pub fn ideal_counts(truth: &Truth) -> ImuCounts {
    ImuCounts {
        accel: counts(truth.specific_force, ACCEL_SCALE),
        gyro: counts(truth.mean_rate, GYRO_SCALE),
    }
}

/// To the nearest count, half to even, held at the ends of the range.
#[inline(always)]
fn counts(value: Vector3<f64>, scale: f64) -> [i16; 3] {
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5·2^52: adding and subtracting it rounds
    let count = |x: f64| (((x * scale).clamp(-32_768.0, 32_767.0) + ROUND) - ROUND) as i16;
    [count(value.x), count(value.y), count(value.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_those_of_the_part() {
        let degree = core::f64::consts::PI / 180.0;
        let rate = Vector3::new(1000.0 * degree, -degree, 0.0);
        assert_eq!(counts(rate, GYRO_SCALE), [16_400, -16, 0]);
        let force = Vector3::new(0.0, 0.5 * GRAVITY, -GRAVITY);
        assert_eq!(counts(force, ACCEL_SCALE), [0, 1024, -2048]);
    }

    #[test]
    fn counts_round_to_nearest_and_hold_at_the_ends() {
        assert_eq!(counts(Vector3::new(0.49, 0.51, -0.51), 1.0), [0, 1, -1]);
        assert_eq!(counts(Vector3::new(1.5, 2.5, -2.5), 1.0), [2, 2, -2]);
        assert_eq!(
            counts(Vector3::new(1e9, -1e9, f64::NAN), 1.0),
            [i16::MAX, i16::MIN, 0]
        );
        assert_eq!(
            counts(Vector3::new(32_766.6, -32_767.6, 0.0), 1.0),
            [32_767, -32_768, 0]
        );
    }
}
