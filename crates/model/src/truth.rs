//! The truth: everything there is to know about the vehicle at one moment.

use windhover_math::{Quaternion, Vector3};

/// The world at one moment, as no sensor sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Since the start, in s.
    pub time: f64,
    /// North, east, down from the start, in m.
    pub position: Vector3<f64>,
    /// Velocity over ground in NED, in m/s.
    pub velocity: Vector3<f64>,
    /// From body (FRD) to world (NED).
    pub attitude: Quaternion<f64>,
    /// Angular velocity in FRD, in rad/s, at this moment.
    pub body_rate: Vector3<f64>,
    /// Angular velocity in FRD, in rad/s, as its mean over the last step: what an ideal
    /// gyroscope that integrates over its sample period reads.
    pub mean_rate: Vector3<f64>,
    /// Acceleration less gravity in FRD, in m/s², as its mean over the last step, in the axes
    /// of the step's middle: what an ideal accelerometer reads. (0, 0, −g) at rest.
    pub specific_force: Vector3<f64>,
    /// Rotor speeds in rad/s, in the core's order.
    pub rotor_speed: [f64; 4],
    /// Velocity of the air in NED, in m/s.
    pub wind: Vector3<f64>,
    /// Electrical power in W during the last step.
    pub power: f64,
    /// Electrical energy since the start in J.
    pub energy: f64,
}

/// The rotation vector in rad that turns one attitude into another: the constant body rate
/// times its time. By series: exact to 1e-9 of itself up to 0.2 rad.
#[inline(always)]
pub(crate) fn turn(from: Quaternion<f64>, to: Quaternion<f64>) -> Vector3<f64> {
    let q = (from.conjugate() * to).shortest();
    let s = q.x * q.x + q.y * q.y + q.z * q.z;
    // 2 asin(√s)/√s
    let scale = 2.0 + s * (1.0 / 3.0 + s * (3.0 / 20.0 + s * (5.0 / 56.0 + s * (35.0 / 576.0))));
    Vector3::new(q.x * scale, q.y * scale, q.z * scale)
}

/// The attitude halfway between two that are close; its norm is exact to 3e-6 for 0.2 rad, and
/// to 1e-12 for 5 mrad.
#[inline(always)]
pub(crate) fn halfway(from: Quaternion<f64>, to: Quaternion<f64>) -> Quaternion<f64> {
    let half = if from.dot(to) < 0.0 { -0.5 } else { 0.5 };
    Quaternion::new(
        0.5 * from.w + half * to.w,
        0.5 * from.x + half * to.x,
        0.5 * from.y + half * to.y,
        0.5 * from.z + half * to.z,
    )
    .renormalized()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::length::Length;

    #[test]
    fn a_turn_inverts_a_rotation() {
        let from = Quaternion::new(0.5, -0.5, 0.5, 0.5);
        for angle in [1e-9, 1e-3, 0.05, 0.2] {
            let rate = Vector3::new(0.6, -0.64, 0.48) * (angle / 1e-3);
            let mut to = from * Quaternion::from_rotation_vector(rate * 1e-3);
            for sign in [1.0, -1.0] {
                to = Quaternion::new(sign * to.w, sign * to.x, sign * to.y, sign * to.z);
                let found = turn(from, to) / 1e-3;
                assert!((found - rate).length() < 1e-9 * rate.length() + 1e-12, "{angle}");
                let middle = from * Quaternion::from_rotation_vector(rate * 0.5e-3);
                let bound = 2e-3 * angle * angle * angle * angle + 1e-12;
                assert!((halfway(from, to).dot(middle) - 1.0).abs() < bound, "{angle}");
            }
        }
    }
}
