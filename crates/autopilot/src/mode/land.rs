//! Land: brakes, then straight down until the ground is there.

use windhover_math::{Vector3, max, min};

use super::{Around, Demand, Motion, Step};
use crate::trajectory::{Glide, GlideLimits, HeadingSlew};

/// The path has to be so far below a vehicle that stands still for it to be held by the ground, m.
pub(super) const CONTACT_DEPTH: f32 = 0.1;

/// Slower than this it stands still, m/s.
const STILL: f32 = 0.1;

/// The same where the accelerometer shows nothing and velocities are known badly: with the path so far
/// below, m, a vehicle in the air would come down faster than this, m/s.
const SURE_DEPTH: f32 = 1.0;
const SINKING: f32 = 1.2;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Land {
    glide: Glide,
    heading: HeadingSlew,
}

impl Land {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            glide: motion.glide,
            heading: HeadingSlew {
                heading: motion.heading.heading,
                rate: 0.0,
            },
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        if around.landed {
            return Step::of(Demand::Rest);
        }
        let (vx, vy) = (self.glide.velocity.x, self.glide.velocity.y);
        let drifts = vx * vx + vy * vy > 0.25;
        let down = if drifts { 0.0 } else { speed(around) };
        let wanted = Vector3::new(0.0, 0.0, down);
        let limits = GlideLimits::of(&around.parameters.manual);
        let jerk = self.glide.step(wanted, &limits, 1.0, around.seconds);
        let setpoint = self.glide.setpoint(jerk, 1.0, (self.heading.heading, 0.0));
        Step {
            contact: has_contact(setpoint.position.z, around),
            ..Step::of(Demand::Follow(setpoint))
        }
    }
}

/// How fast it comes down: slower as the ground comes near, as far as home tells.
fn speed<S: ?Sized>(around: &Around<'_, S>) -> f32 {
    let (p, manual) = (&around.parameters.mission, &around.parameters.manual);
    let height = around.home.z - around.estimate.position.z;
    let span = max(manual.land_fast_height - manual.land_slow_height, 0.1);
    let share = max(0.0, min(1.0, (height - manual.land_slow_height) / span));
    p.land_speed + max(p.descend_speed - p.land_speed, 0.0) * share
}

/// Whether something holds the vehicle while its setpoint goes on down: the ground, as a rule.
pub(super) fn has_contact<S: ?Sized>(down: f32, around: &Around<'_, S>) -> bool {
    let below = down + around.handover.position.z - around.estimate.position.z;
    let sinking = around.estimate.velocity.z.abs();
    if around.blind {
        return below > SURE_DEPTH && sinking < SINKING;
    }
    below > CONTACT_DEPTH && sinking < STILL
}
