//! Takeoff: straight up to a height, then hold.

use windhover_math::{Vector3, min};

use super::course::Course;
use super::{Around, Demand, Mode, Motion, Step};
use crate::mission::action::Altitude;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Takeoff {
    course: Course,
}

impl Takeoff {
    /// From where the vehicle stands to an altitude, or the parameter's; never downwards.
    pub fn enter<S: ?Sized>(
        motion: &Motion,
        around: &Around<'_, S>,
        altitude: Option<Altitude>,
        heading: Option<f32>,
    ) -> Self {
        let from = motion.glide.position;
        let height = around.parameters.manual.takeoff_altitude;
        let down = match altitude {
            Some(altitude) => around.down(altitude),
            None => around.home.z - height,
        };
        let target = Vector3::new(from.x, from.y, min(down, from.z));
        Self {
            course: Course::new(motion, &[target]).with(heading, None),
        }
    }

    /// One step. Done when the vehicle is there, too.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        let setpoint = self.course.step(around);
        let left = self.course.end().z + around.handover.position.z - around.estimate.position.z;
        let done = self.course.is_done() && left.abs() < around.parameters.mission.acceptance_radius;
        Step {
            next: done.then_some(Mode::Hold),
            ..Step::of(Demand::Follow(setpoint))
        }
    }
}
