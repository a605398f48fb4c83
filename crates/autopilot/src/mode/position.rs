//! Position: sticks to velocity. Hands off, it brakes and stays where it is.

use windhover_math::{Vector3, max, min, sin_cos, sqrt, wrap_pi};

use super::altitude::climb;
use super::land::has_contact;
use super::lift::Lift;
use super::{Around, Demand, Motion, Step};
use crate::trajectory::{Glide, GlideLimits, HeadingSlew};

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct PositionHold {
    glide: Glide,
    heading: HeadingSlew,
    lift: Lift,
}

impl PositionHold {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            glide: motion.glide,
            heading: motion.heading,
            lift: Lift::default(),
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        let sticks = around.sticks.unwrap_or_default();
        let down = climb(around, &sticks);
        if self.lift.rests(around.landed, down >= 0.0) {
            *self = Self {
                lift: self.lift,
                ..Self::enter(&around.at_rest())
            };
            return Step::of(Demand::Rest);
        }
        let p = &around.parameters.manual;
        let most = around.parameters.mission.yaw_acceleration * around.seconds;
        let turn = sticks.yaw * p.yaw_rate - self.heading.rate;
        self.heading.rate += max(-most, min(most, turn));
        self.heading.heading = wrap_pi(self.heading.heading + self.heading.rate * around.seconds);
        let (sin, cos) = sin_cos(self.heading.heading);
        let length = max(sqrt(sticks.roll * sticks.roll + sticks.pitch * sticks.pitch), 1.0);
        let (forward, right) = (
            sticks.pitch * p.velocity / length,
            sticks.roll * p.velocity / length,
        );
        // On the ground only upwards: nothing drags the legs.
        let flat = if around.landed { 0.0 } else { 1.0 };
        let wanted = Vector3::new(
            flat * (forward * cos - right * sin),
            flat * (forward * sin + right * cos),
            down,
        );
        let rate = around.rate(self.glide.position);
        let jerk = self.glide.step(wanted, &GlideLimits::of(p), rate, around.seconds);
        let heading = (self.heading.heading, self.heading.rate);
        Step {
            contact: down > 0.0 && has_contact(self.glide.position.z, around),
            ..Step::of(Demand::Follow(self.glide.setpoint(jerk, rate, heading)))
        }
    }
}
