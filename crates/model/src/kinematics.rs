//! Where the vehicle is and how it moves: common to all models.

use windhover_math::{Quaternion, Vector3};

use crate::integrate::State;

/// Position, velocity, attitude and rate of a rigid body; also the state of the model `rigid`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    /// North, east, down from the start, in m.
    pub position: Vector3<f64>,
    /// Velocity in NED, in m/s.
    pub velocity: Vector3<f64>,
    /// From body (FRD) to world (NED).
    pub attitude: Quaternion<f64>,
    /// Angular velocity in FRD, in rad/s.
    pub body_rate: Vector3<f64>,
}

impl Default for Kinematics {
    /// At rest at the origin, level, facing north.
    fn default() -> Self {
        Self {
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            attitude: Quaternion::IDENTITY,
            body_rate: Vector3::zeros(),
        }
    }
}

impl Kinematics {
    /// Angle between the body's down axis and the world's, in rad, 0 to π.
    pub fn tilt(&self) -> f64 {
        let q = self.attitude;
        2.0 * libm::atan2(libm::hypot(q.x, q.y), libm::hypot(q.w, q.z))
    }
}

/// Rate of change of a quaternion, ½ q ⊗ (0, rate), with the rate in body coordinates.
#[inline(always)]
pub(crate) fn attitude_rate(q: Quaternion<f64>, rate: Vector3<f64>) -> Quaternion<f64> {
    q * Quaternion::new(0.0, 0.5 * rate.x, 0.5 * rate.y, 0.5 * rate.z)
}

impl State for Kinematics {
    #[inline(always)]
    fn plus(self, rate: &Self, dt: f64) -> Self {
        let (q, dq) = (self.attitude, rate.attitude);
        Self {
            position: self.position + rate.position * dt,
            velocity: self.velocity + rate.velocity * dt,
            attitude: Quaternion::new(q.w + dq.w * dt, q.x + dq.x * dt, q.y + dq.y * dt, q.z + dq.z * dt),
            body_rate: self.body_rate + rate.body_rate * dt,
        }
    }

    #[inline(always)]
    fn kick(self, rate: &Self, dt: f64) -> Self {
        Self {
            velocity: self.velocity + rate.velocity * dt,
            body_rate: self.body_rate + rate.body_rate * dt,
            ..self
        }
    }

    /// The rotation over the step is exact for a constant rate, so the body rate is the mean
    /// rate of the step.
    #[inline(always)]
    fn drift(self, dt: f64) -> Self {
        Self {
            position: self.position + self.velocity * dt,
            attitude: self.attitude * Quaternion::from_small_rotation(self.body_rate * dt),
            ..self
        }
    }

    #[inline(always)]
    fn constrained(self) -> Self {
        Self {
            attitude: self.attitude.renormalized(),
            ..self
        }
    }
}
