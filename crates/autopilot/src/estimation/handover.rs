//! Steps of the estimate, kept away from the controllers.
//!
//! When a receiver comes back after a loss, or a sensor is given in to, the estimate jumps; the
//! vehicle has not moved. The setpoint jumps along, by an offset that then shrinks slowly: control
//! leads the vehicle back onto its path without a start.

use windhover_control::TrajectorySetpoint;
use windhover_estimator::Reset;
use windhover_math::{Vector3, saturate, scalar, wrap_pi};

/// The position's offset shrinks so fast, m/s.
const POSITION_SLEW: f32 = 0.2;
/// The velocity's, m/s².
const VELOCITY_SLEW: f32 = 0.2;
/// The heading's, rad/s.
const HEADING_SLEW: f32 = 0.1;

/// How far the setpoint is shifted.
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
    /// The estimate has made this step.
    pub(super) fn shift(&mut self, step: &Reset) {
        self.position += step.position;
        self.velocity += step.velocity;
        self.heading = wrap_pi(self.heading + step.attitude.heading());
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
            velocity: wanted.velocity + self.velocity,
            heading: wrap_pi(wanted.heading + self.heading),
            ..*wanted
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windhover_math::Quaternion;

    fn step() -> Reset {
        Reset {
            position: Vector3::new(3.0, -4.0, 0.5),
            velocity: Vector3::new(0.3, 0.0, -0.1),
            attitude: Quaternion::from_heading(0.2),
        }
    }

    #[test]
    fn control_feels_no_jump_when_the_estimate_steps() {
        let wanted = TrajectorySetpoint::at_rest(Vector3::new(10.0, 20.0, -30.0), 3.1);
        let mut handover = Handover::default();
        assert_eq!(handover.shifted(&wanted), wanted);
        handover.shift(&step());
        let shifted = handover.shifted(&wanted);
        assert!((shifted.position - wanted.position - step().position).amax() < 1e-6);
        assert!((shifted.velocity - step().velocity).amax() < 1e-6);
        assert!((shifted.heading - wrap_pi(3.3)).abs() < 1e-6);
    }

    #[test]
    fn the_offset_goes_slowly_and_wholly() {
        let mut handover = Handover::default();
        handover.shift(&step());
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
