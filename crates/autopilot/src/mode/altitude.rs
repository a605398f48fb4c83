//! Altitude: sticks to tilt, yaw rate and climb. Hands off, it stays level at its height and heading:
//! what a vehicle does that has lost its position.

use super::land::has_contact;
use super::lift::Lift;
use super::tilt::Tilt;
use super::{Around, Demand, Motion, Step};
use crate::rc::Sticks;
use crate::trajectory::{Glide, GlideLimits};
use windhover_math::Vector3;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct AltitudeHold {
    tilt: Tilt,
    glide: Glide,
    lift: Lift,
}

impl AltitudeHold {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            tilt: Tilt::new(motion),
            glide: motion.glide,
            lift: Lift::default(),
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        let sticks = around.sticks.unwrap_or_default();
        let climb = climb(around, &sticks);
        if self.lift.rests(around.landed, climb >= 0.0) {
            *self = Self {
                lift: self.lift,
                ..Self::enter(&around.at_rest())
            };
            return Step::of(Demand::Rest);
        }
        let behind = self.glide.position.z + around.handover.position.z - around.estimate.position.z;
        let rate = around.parameters.mission.rate(behind.abs());
        let limits = GlideLimits::of(&around.parameters.manual);
        let jerk = self
            .glide
            .step(Vector3::new(0.0, 0.0, climb), &limits, rate, around.seconds);
        // Where it is horizontally is not followed.
        self.glide.position.x = around.estimate.position.x;
        self.glide.position.y = around.estimate.position.y;
        let (attitude, heading_rate) = self.tilt.step(around, &sticks);
        let point = self.glide.setpoint(jerk, rate, (0.0, 0.0));
        Step {
            contact: climb > 0.0 && has_contact(point.position.z, around),
            ..Step::of(Demand::Tilt {
                attitude,
                heading_rate,
                point,
            })
        }
    }
}

/// The velocity downwards that the throttle stick asks for, m/s.
pub(super) fn climb<S: ?Sized>(around: &Around<'_, S>, sticks: &Sticks) -> f32 {
    let p = &around.parameters.manual;
    let stick = around.parameters.rc.climb(sticks.throttle);
    if stick > 0.0 {
        -stick * p.climb
    } else {
        -stick * p.descend
    }
}
