//! The ground: flat at down = 0, level, and firm.
//!
//! A vehicle on the ground rests level and keeps its heading until the vertical force lifts it;
//! its legs hold every torque. On touchdown the legs bring it to rest within a quarter of a
//! second by a motion of their own, whatever the rotors do: a damped spring downwards, friction
//! sideways, and a rotation to level. So an accelerometer and a gyroscope see the landing as
//! finite and consistent. A touchdown beyond the limits below is a crash.

use thiserror::Error;
use windhover_math::{Quaternion, Vector3};

use crate::kinematics::Kinematics;
use crate::length::Length;

/// Fastest touchdown that is not a crash in m/s, down or sideways.
pub const TOUCHDOWN_SPEED_MAX: f64 = 2.0;

/// Largest tilt at a touchdown that is not a crash, in rad: 60°.
pub const TOUCHDOWN_TILT_MAX: f64 = core::f64::consts::FRAC_PI_3;

/// Time constant of the legs in s.
const LEG_TIME: f64 = 0.02;

/// Where the vehicle is in relation to the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// At rest on the ground.
    Resting,
    /// Touched down; the legs bring it to rest.
    Settling,
    /// In the air.
    Flying,
}

/// A touchdown that ended the flight.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "crash at {time:.3} s: {descent:.2} m/s down, {sideways:.2} m/s sideways, tilt {:.0}°, at north {north:.1} m, east {east:.1} m",
    .tilt.to_degrees()
)]
pub struct Crash {
    /// When, in s.
    pub time: f64,
    /// Speed downwards in m/s.
    pub descent: f64,
    /// Horizontal speed in m/s.
    pub sideways: f64,
    /// Angle from level in rad.
    pub tilt: f64,
    /// Where, north of the start in m.
    pub north: f64,
    /// Where, east of the start in m.
    pub east: f64,
}

/// Whether a vehicle in flight has met the ground.
#[inline(always)]
pub(crate) fn is_touchdown(state: &Kinematics) -> bool {
    state.position.z >= 0.0 && state.velocity.z > 0.0
}

/// The crash that a touchdown is, if it is one.
pub(crate) fn crash(state: &Kinematics, time: f64) -> Option<Crash> {
    let crash = Crash {
        time,
        descent: state.velocity.z,
        sideways: libm::hypot(state.velocity.x, state.velocity.y),
        tilt: state.tilt(),
        north: state.position.x,
        east: state.position.y,
    };
    let hard = crash.descent > TOUCHDOWN_SPEED_MAX || crash.sideways > TOUCHDOWN_SPEED_MAX;
    (hard || crash.tilt > TOUCHDOWN_TILT_MAX).then_some(crash)
}

/// A state on the ground, `dt` seconds later, and whether it has come to rest.
pub(crate) fn settle(state: &Kinematics, dt: f64) -> (Kinematics, Contact) {
    if is_still(state) {
        return (at_rest(state), Contact::Resting);
    }
    let decay = libm::exp(-dt / LEG_TIME);
    let mut next = *state;
    // Down: a critically damped spring in closed form. Sideways: friction.
    let (depth, speed) = (state.position.z, state.velocity.z);
    let pull = speed + depth / LEG_TIME;
    next.position.z = (depth + pull * dt) * decay;
    next.velocity.z = (speed - pull * (dt / LEG_TIME)) * decay;
    next.position.x += state.velocity.x * LEG_TIME * (1.0 - decay);
    next.position.y += state.velocity.y * LEG_TIME * (1.0 - decay);
    next.velocity.x *= decay;
    next.velocity.y *= decay;
    // Rotation about a level axis of the body, by a part of the tilt.
    let down = state.attitude.inverse_rotate(Vector3::new(0.0, 0.0, 1.0));
    let sine = libm::hypot(down.x, down.y);
    let mut turn = Vector3::zeros();
    if sine > 0.0 {
        turn = Vector3::new(-down.y, down.x, 0.0) * (state.tilt() / sine * (1.0 - decay));
    }
    next.attitude = (state.attitude * Quaternion::from_rotation_vector(turn)).normalized();
    next.body_rate = turn / dt;
    (next, Contact::Settling)
}

/// The state at rest nearest to a state: on the ground, level, heading kept.
fn at_rest(state: &Kinematics) -> Kinematics {
    Kinematics {
        position: Vector3::new(state.position.x, state.position.y, 0.0),
        attitude: Quaternion::from_heading(state.attitude.heading()),
        ..Kinematics::default()
    }
}

/// Within 0.1 mm, 1 mm/s and 0.1 mrad of rest on the ground.
fn is_still(state: &Kinematics) -> bool {
    state.position.z.abs() < 1e-4 && state.velocity.length_squared() < 1e-6 && state.tilt() < 1e-4
}

#[cfg(test)]
mod tests {
    use super::*;
    use windhover_math::Euler;

    fn landing(descent: f64, sideways: f64, roll: f64) -> Kinematics {
        Kinematics {
            velocity: Vector3::new(0.0, sideways, descent),
            attitude: Quaternion::from_euler(Euler {
                roll,
                pitch: 0.0,
                yaw: 1.0,
            }),
            ..Kinematics::default()
        }
    }

    #[test]
    fn a_touchdown_beyond_the_limits_is_a_crash_with_its_figures() {
        assert_eq!(crash(&landing(1.99, 1.99, 1.04), 1.0), None);
        let hard = crash(&landing(2.01, 0.5, 0.1), 12.0).unwrap();
        let text = "crash at 12.000 s: 2.01 m/s down, 0.50 m/s sideways, tilt 6°, at north 0.0 m, east 0.0 m";
        assert_eq!(hard.to_string(), text);
        assert!(crash(&landing(0.1, 2.01, 0.0), 1.0).is_some());
        assert!(crash(&landing(0.1, 0.0, 1.05), 1.0).is_some());
    }

    #[test]
    fn settling_ends_level_at_rest_with_its_heading() {
        for dt in [0.25e-3, 1e-3, 20e-3] {
            let mut state = landing(1.5, 1.0, 0.2);
            let (mut time, mut deepest, mut hardest) = (0.0, 0.0_f64, 0.0_f64);
            let contact = loop {
                let (next, contact) = settle(&state, dt);
                hardest = windhover_math::max(hardest, (next.velocity - state.velocity).length() / dt);
                deepest = windhover_math::max(deepest, next.position.z);
                state = next;
                time += dt;
                if contact == Contact::Resting || time > 1.0 {
                    break contact;
                }
            };
            assert_eq!(contact, Contact::Resting);
            assert!(time < 0.3, "{time}");
            assert!(deepest < 0.02 && hardest < 16.0 * 9.81, "{deepest} {hardest}");
            assert_eq!(state.position.z, 0.0);
            assert_eq!(
                (state.velocity, state.body_rate),
                (Vector3::zeros(), Vector3::zeros())
            );
            assert!(state.tilt() < 1e-9 && (state.attitude.heading() - 1.0).abs() < 0.01);
            assert!((state.position.y - LEG_TIME).abs() < 1e-4);
        }
    }

    #[test]
    fn rates_while_settling_are_those_of_the_attitude() {
        let state = landing(0.5, 0.0, 0.3);
        let (next, _) = settle(&state, 1e-3);
        let turned = state.attitude * Quaternion::from_rotation_vector(next.body_rate * 1e-3);
        assert!((turned.dot(next.attitude) - 1.0).abs() < 1e-12);
        assert!(next.body_rate.x < -1.0, "rolls back to level");
    }
}
