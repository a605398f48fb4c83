//! Return: up to the height of return, over the nearest rally point or home, then land.

use windhover_math::{Vector3, min, sqrt};

use super::course::Course;
use super::{Around, Demand, Mode, Motion, Step};

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Return {
    course: Course,
    /// How long it has been there, s.
    waited: f32,
}

impl Return {
    /// From the present motion on: up first, unless the place is close by.
    pub fn enter<S: ?Sized>(motion: &Motion, around: &Around<'_, S>) -> Self {
        let p = &around.parameters.mission;
        let from = motion.glide.position;
        let place = around.rally.destination(from, around.home);
        let (north, east) = (place.x - from.x, place.y - from.y);
        let near = sqrt(north * north + east * east) < p.acceptance_radius;
        let height = around.home.z - p.return_altitude;
        let down = if near { from.z } else { min(height, from.z) };
        let above = |x: f32, y: f32| Vector3::new(x, y, down);
        Self {
            course: Course::new(motion, &[above(from.x, from.y), above(place.x, place.y)]),
            waited: 0.0,
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        let setpoint = self.course.step(around);
        if self.course.is_done() {
            self.waited += around.seconds;
        }
        let done = self.waited > around.parameters.manual.land_delay;
        Step {
            next: done.then_some(Mode::Land),
            leg_end: Some(self.course.end()),
            ..Step::of(Demand::Follow(setpoint))
        }
    }
}
