//! The attitude predictor: gyro samples, integrated at the rate at which they come.
//!
//! The outer loop estimates the attitude at the tick of its snapshot, which is some milliseconds
//! old when its result arrives. The predictor keeps the rotation since that tick and puts it on
//! top, so that a late estimate corrects the attitude without throwing the last turns away.

use windhover_math::{Quaternion, Vector3};

/// Attitude, rate and what has been turned since the last snapshot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudePredictor {
    base: Quaternion,
    since: Quaternion,
    bias: Vector3,
    rate: Vector3,
}

impl AttitudePredictor {
    /// Takes in a gyro measurement (body FRD, rad/s), the mean over the last `dt` seconds.
    #[inline]
    pub fn predict(&mut self, gyro: Vector3, dt: f32) {
        self.rate = gyro - self.bias;
        self.since = (self.since * Quaternion::from_small_rotation(self.rate * dt)).renormalized();
    }

    /// A snapshot is taken now: from here the rotation counts anew. Returns the rotation since
    /// the last snapshot.
    #[inline]
    pub fn mark(&mut self) -> Quaternion {
        let turned = self.since;
        self.base = (self.base * turned).renormalized();
        self.since = Quaternion::IDENTITY;
        turned
    }

    /// Adopts the attitude that the vehicle had at the last snapshot, and the gyro bias (rad/s).
    #[inline]
    pub fn adopt(&mut self, attitude: Quaternion, bias: Vector3) {
        self.base = attitude;
        self.bias = bias;
    }

    /// Attitude now, body to world.
    #[inline]
    pub fn attitude(&self) -> Quaternion {
        self.base * self.since
    }

    /// The rotation since the last snapshot, from the body now to the body then.
    #[inline]
    pub fn since_mark(&self) -> Quaternion {
        self.since
    }

    /// The gyro bias that is taken off, FRD, rad/s.
    #[inline]
    pub fn bias(&self) -> Vector3 {
        self.bias
    }

    /// Body rate now, FRD, rad/s, without the bias.
    #[inline]
    pub fn rate(&self) -> Vector3 {
        self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windhover_math::scalar::norm;

    fn angle_between(a: Quaternion, b: Quaternion) -> f32 {
        let d = a.conjugate() * b;
        2.0 * norm(Vector3::new(d.x, d.y, d.z))
    }

    #[test]
    fn a_constant_rate_turns_by_rate_times_time() {
        let mut predictor = AttitudePredictor::default();
        let rate = Vector3::new(0.3, -1.0, 2.0);
        for _ in 0..1000 {
            predictor.predict(rate, 1e-3);
        }
        let exact = Quaternion::from_rotation_vector(rate);
        assert!(angle_between(exact, predictor.attitude()) < 1e-5);
    }

    #[test]
    fn a_late_result_is_put_under_the_rotation_since_its_snapshot() {
        let mut predictor = AttitudePredictor::default();
        let rate = Vector3::new(1.0, 0.5, -0.3);
        predictor.predict(rate, 4e-3);
        let turned = predictor.mark();
        assert_eq!(
            turned,
            Quaternion::from_small_rotation(rate * 4e-3).renormalized()
        );
        for _ in 0..7 {
            predictor.predict(rate, 4e-3);
        }
        // The outer loop finds that the attitude at the snapshot was another one.
        let truth = Quaternion::from_rotation_vector(Vector3::new(0.1, 0.2, 0.3));
        predictor.adopt(truth, Vector3::zeros());
        let exact = truth * Quaternion::from_rotation_vector(rate * 28e-3);
        assert!(angle_between(exact, predictor.attitude()) < 1e-6);
    }

    #[test]
    fn the_bias_is_taken_off() {
        let mut predictor = AttitudePredictor::default();
        predictor.adopt(Quaternion::IDENTITY, Vector3::new(0.01, 0.0, 0.0));
        predictor.predict(Vector3::new(0.01, 0.0, 0.0), 1e-3);
        assert_eq!(predictor.rate(), Vector3::zeros());
        assert_eq!(predictor.attitude(), Quaternion::IDENTITY);
    }
}
