//! When a flight leaves the range in which a model means anything.

use core::fmt;

use thiserror::Error;
use windhover_math::Vector3;

use crate::kinematics::Kinematics;

/// Largest coordinate of the position in m.
const POSITION_MAX: f64 = 1e4;

/// Largest coordinate of the velocity in m/s.
const VELOCITY_MAX: f64 = 1e3;

/// Largest body rate about one axis in rad/s.
const BODY_RATE_MAX: f64 = 200.0;

/// What left the range in which a model means anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// More than 10 km from the start in one coordinate, or not finite; m.
    Position,
    /// More than 1000 m/s in one coordinate, or not finite; m/s.
    Velocity,
    /// More than 200 rad/s about one axis, or not finite; rad/s.
    BodyRate,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position in m",
            Self::Velocity => "velocity in m/s",
            Self::BodyRate => "body rate in rad/s",
        })
    }
}

/// The flight went beyond what the model can say; the state of the step before it stays.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("diverged at {time:.3} s: {what} reached {value:e}")]
pub struct Divergence {
    /// What diverged.
    pub what: Quantity,
    /// When, in s.
    pub time: f64,
    /// The value that it reached in its worst coordinate, possibly not finite.
    pub value: f64,
}

/// Whether every part of a state is finite and in range. A NaN fails the comparison. (`&` has no
/// branches, of which nine would cost more than the comparisons.)
#[inline(always)]
pub(crate) fn is_sound(state: &Kinematics) -> bool {
    let within =
        |v: Vector3<f64>, limit: f64| (v.x.abs() <= limit) & (v.y.abs() <= limit) & (v.z.abs() <= limit);
    within(state.position, POSITION_MAX)
        & within(state.velocity, VELOCITY_MAX)
        & within(state.body_rate, BODY_RATE_MAX)
}

/// What is not sound about a state.
#[cold]
pub(crate) fn divergence(state: &Kinematics, time: f64) -> Divergence {
    let worst = |v: Vector3<f64>| {
        let worse = |a: f64, b: f64| {
            if b.is_nan() || b.abs() > a.abs() { b } else { a }
        };
        worse(worse(v.x, v.y), v.z)
    };
    let quantities = [
        (Quantity::Position, state.position, POSITION_MAX),
        (Quantity::Velocity, state.velocity, VELOCITY_MAX),
        (Quantity::BodyRate, state.body_rate, BODY_RATE_MAX),
    ];
    let bad = quantities
        .into_iter()
        .map(|(what, v, limit)| (what, worst(v), limit))
        .find(|(_, value, limit)| value.is_nan() || value.abs() > *limit);
    let (what, value, _) = bad.unwrap_or((Quantity::Position, f64::NAN, 0.0));
    Divergence { what, time, value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_coordinate_is_named() {
        let mut state = Kinematics::default();
        assert!(is_sound(&state));
        state.body_rate.y = -201.0;
        assert!(!is_sound(&state));
        let text = "diverged at 2.500 s: body rate in rad/s reached -2.01e2";
        assert_eq!(divergence(&state, 2.5).to_string(), text);
        state.velocity.z = f64::NAN;
        let found = divergence(&state, 2.5);
        assert!(found.what == Quantity::Velocity && found.value.is_nan());
        state.position.x = f64::NEG_INFINITY;
        assert_eq!(divergence(&state, 2.5).what, Quantity::Position);
    }
}
