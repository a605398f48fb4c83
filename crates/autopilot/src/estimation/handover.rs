//! Steps of the estimate, kept away from the controllers.
//!
//! When a receiver comes back after a loss, or a sensor is given in to, the estimate jumps; the
//! vehicle has not moved. The setpoint's position jumps along, by an offset that then shrinks
//! slowly, and a step of the velocity is shown to control bit by bit: it leads the vehicle back onto
//! its path without a start.

use windhover_control::TrajectorySetpoint;
use windhover_estimator::State;
use windhover_math::{Vector3, saturate, scalar, wrap_pi};

/// The position's offset shrinks so fast, m/s.
const POSITION_SLEW: f32 = 0.2;
/// The velocity's, m/s².
const VELOCITY_SLEW: f32 = 0.5;
/// The heading's, rad/s.
const HEADING_SLEW: f32 = 0.1;

/// What control may feel at once: m, m/s, rad.
const STEPS: [f32; 3] = [0.05, 0.05, 0.02];

/// How far the setpoint is shifted, and what of the velocity control does not see yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Handover {
    /// NED, m.
    pub position: Vector3,
    /// NED, m/s.
    pub velocity: Vector3,
    /// rad.
    pub heading: f32,
}

impl Handover {
    /// The estimate was `reckoned` so far, and the sensors have made it `corrected`. What is too
    /// large to be felt by control is taken up; usual corrections are not.
    pub(super) fn take_up(&mut self, reckoned: &State, corrected: &State) {
        let position = corrected.position - reckoned.position;
        let velocity = corrected.velocity - reckoned.velocity;
        let turn = (corrected.attitude * reckoned.attitude.conjugate()).heading();
        if position.dot(&position) > STEPS[0] * STEPS[0]
            || velocity.dot(&velocity) > STEPS[1] * STEPS[1]
            || turn.abs() > STEPS[2]
        {
            self.position += position;
            self.velocity += velocity;
            self.heading = wrap_pi(self.heading + turn);
        }
    }

    /// Shrinks over `dt` seconds.
    pub(super) fn decay(&mut self, dt: f32) {
        self.position -= scalar::limit_norm(self.position, POSITION_SLEW * dt);
        self.velocity -= scalar::limit_norm(self.velocity, VELOCITY_SLEW * dt);
        self.heading -= saturate(self.heading, HEADING_SLEW * dt);
    }

    /// The setpoint that control is to follow for the one that is wanted.
    pub fn shifted(&self, wanted: &TrajectorySetpoint) -> TrajectorySetpoint {
        TrajectorySetpoint {
            position: wanted.position + self.position,
            heading: wrap_pi(wanted.heading + self.heading),
            ..*wanted
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windhover_math::Quaternion;

    fn jumped() -> State {
        State {
            position: Vector3::new(3.0, -4.0, 0.5),
            velocity: Vector3::new(0.3, 0.0, -0.1),
            attitude: Quaternion::from_heading(0.2),
            ..State::default()
        }
    }

    #[test]
    fn usual_corrections_are_not_taken_up() {
        let mut handover = Handover::default();
        let corrected = State {
            position: Vector3::new(0.02, 0.0, 0.02),
            velocity: Vector3::new(0.0, 0.03, 0.0),
            ..State::default()
        };
        handover.take_up(&State::default(), &corrected);
        assert_eq!(handover, Handover::default());
    }

    #[test]
    fn control_feels_no_jump_when_the_estimate_steps() {
        let wanted = TrajectorySetpoint::at_rest(Vector3::new(10.0, 20.0, -30.0), 3.1);
        let mut handover = Handover::default();
        assert_eq!(handover.shifted(&wanted), wanted);
        handover.take_up(&State::default(), &jumped());
        let shifted = handover.shifted(&wanted);
        assert!((shifted.position - wanted.position - jumped().position).amax() < 1e-6);
        assert_eq!(shifted.velocity, wanted.velocity);
        assert_eq!(handover.velocity, jumped().velocity);
        assert!((shifted.heading - wrap_pi(3.3)).abs() < 1e-6);
    }

    #[test]
    fn the_offset_goes_slowly_and_wholly() {
        let mut handover = Handover::default();
        handover.take_up(&State::default(), &jumped());
        let mut seconds = 0.0;
        while handover != Handover::default() {
            let before = handover;
            handover.decay(0.004);
            assert!(scalar::norm(handover.position - before.position) <= POSITION_SLEW * 0.004 * 1.001);
            assert!(scalar::norm(handover.velocity - before.velocity) <= VELOCITY_SLEW * 0.004 * 1.001);
            seconds += 0.004;
            assert!(seconds < 30.0, "{handover:?}");
        }
    }
}
