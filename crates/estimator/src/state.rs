//! The nominal state, what moves it, and how errors are put into it.

use windhover_math::scalar::{is_finite, limit_norm};
use windhover_math::{GRAVITY, Quaternion, Vector3};

use crate::covariance::{Column, Transition};

/// What the filter believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Position, NED from the origin, m.
    pub position: Vector3,
    /// Velocity, NED, m/s.
    pub velocity: Vector3,
    /// Attitude, body to world.
    pub attitude: Quaternion,
    /// What the gyro shows at rest, FRD, rad/s.
    pub gyro_bias: Vector3,
    /// What the accelerometer shows beside the specific force, FRD, m/s².
    pub accel_bias: Vector3,
}

/// Up to here a rotation is half its angle, rad; the norm is then right to 1e-4.
const SMALL: f32 = 0.01;

/// The rotation by a vector that should have been small, rad: at most by [`LARGEST_TURN`].
#[cold]
fn turned_by(by: Vector3) -> Quaternion {
    let by = limit_norm(by, LARGEST_TURN);
    if is_finite(by) {
        Quaternion::from_small_rotation(by)
    } else {
        Quaternion::IDENTITY
    }
}

/// Largest turn of the attitude by one scalar, rad: the series of small rotations holds so far.
const LARGEST_TURN: f32 = 1.0;

impl Default for State {
    /// Level, at rest, facing north.
    fn default() -> Self {
        Self {
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            attitude: Quaternion::IDENTITY,
            gyro_bias: Vector3::zeros(),
            accel_bias: Vector3::zeros(),
        }
    }
}

/// What gyro and accelerometer have measured over one interval.
///
/// The inner loop has taken a gyro bias off already, the one that it knew then; the filter turns
/// back the difference to its own. The accelerometer's bias is still in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertialIncrements {
    /// The rotation over the interval: body at its end to body at its start. Coning is in it, as
    /// every sample was turned on from the last.
    pub rotation: Quaternion,
    /// The gyro bias that was taken off every sample of `rotation`, FRD, rad/s. If it changed
    /// within the interval, the one of most samples: the error is the change times a fraction of
    /// the interval.
    pub gyro_bias: Vector3,
    /// Integral of the measured specific force, in the body axes of the interval's start, m/s.
    /// Sculling is in it, as every sample was turned into these axes.
    pub velocity: Vector3,
    /// Length of the interval, s.
    pub duration: f32,
}

/// What an interval did to the nominal state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Propagation {
    /// For the errors.
    pub(crate) transition: Transition,
    /// Velocity gained, NED, m/s.
    pub(crate) gained: Vector3,
    /// The rotation without bias, body at the end to body at the start.
    pub(crate) rotation: Quaternion,
}

impl State {
    /// Carries the state over an interval: v ← v + R(Δv − b_a dt) + g dt, p ← p + v̄ dt with the
    /// mean of both velocities, q ← q ΔR exp((b_taken − b_g) dt). The caller renormalises q now and
    /// then: one product takes 1e-7 off its norm.
    #[inline(always)]
    pub(crate) fn propagate(&mut self, increments: &InertialIncrements) -> Propagation {
        let dt = increments.duration;
        let r = self.attitude.to_matrix();
        let own = increments.velocity - self.accel_bias * dt;
        let force = Vector3::new(
            r.m11 * own.x + r.m12 * own.y + r.m13 * own.z,
            r.m21 * own.x + r.m22 * own.y + r.m23 * own.z,
            r.m31 * own.x + r.m32 * own.y + r.m33 * own.z,
        );
        let gained = Vector3::new(force.x, force.y, force.z + GRAVITY * dt);
        self.position += (self.velocity + gained * 0.5) * dt;
        self.velocity += gained;
        // Half the angle that the inner loop's bias was wrong by: some 1e-4 rad.
        let half = (increments.gyro_bias - self.gyro_bias) * (0.5 * dt);
        let rotation = if half.dot(&half) < SMALL * SMALL {
            increments.rotation * Quaternion::new(1.0, half.x, half.y, half.z)
        } else {
            increments.rotation * turned_by(half * 2.0)
        };
        self.attitude = self.attitude * rotation;
        let n = -dt;
        Propagation {
            transition: Transition {
                force: [force.x, force.y, force.z],
                turn: [
                    [r.m11 * n, r.m12 * n, r.m13 * n],
                    [r.m21 * n, r.m22 * n, r.m23 * n],
                    [r.m31 * n, r.m32 * n, r.m33 * n],
                ],
                duration: dt,
            },
            gained,
            rotation,
        }
    }

    /// x ← x ⊕ s c: sums but for the attitude, q ← exp(s θ) q.
    #[inline(always)]
    pub(crate) fn inject(&mut self, c: &Column, s: f32) {
        self.position += Vector3::from(c.p) * s;
        self.velocity += Vector3::from(c.v) * s;
        self.turn(Vector3::from(c.a) * s);
        self.gyro_bias += Vector3::from(c.g) * s;
        self.accel_bias += Vector3::from(c.b) * s;
    }

    /// Turns the attitude by a rotation vector in the world, at most by [`LARGEST_TURN`].
    #[inline(always)]
    pub(crate) fn turn(&mut self, by: Vector3) {
        let turn = if by.dot(&by) <= LARGEST_TURN * LARGEST_TURN {
            Quaternion::from_small_rotation(by)
        } else {
            turned_by(by)
        };
        self.attitude = (turn * self.attitude).renormalized();
    }

    /// Whether every component is finite.
    pub fn is_finite(&self) -> bool {
        let finite = windhover_math::scalar::is_finite;
        finite(self.position)
            && finite(self.velocity)
            && self.attitude.is_finite()
            && finite(self.gyro_bias)
            && finite(self.accel_bias)
    }
}

impl InertialIncrements {
    /// Mean rate that the gyro showed, bias included, FRD, rad/s; for small rotations.
    #[inline]
    pub fn mean_rate(&self) -> Vector3 {
        let turned = self.rotation.shortest();
        Vector3::new(turned.x, turned.y, turned.z) * (2.0 / self.duration) + self.gyro_bias
    }
}
