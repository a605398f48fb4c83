//! Hold: brakes and stays where it is, or goes where it is sent and stays there.

use windhover_math::Vector3;

use super::course::Course;
use super::{Around, Demand, Motion, Step, Target};
use crate::trajectory::towards;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Hold {
    course: Course,
}

impl Hold {
    /// From the present motion to a stop, or to a target.
    pub fn enter<S: ?Sized>(motion: &Motion, around: &Around<'_, S>, target: Option<&Target>) -> Self {
        let Some(target) = target else {
            return Self {
                course: Course::new(motion, &[]),
            };
        };
        let from = motion.glide.position;
        let ground = target
            .ground
            .and_then(|(latitude, longitude)| around.ground(latitude, longitude))
            .unwrap_or(from);
        let down = target.altitude.map_or(from.z, |altitude| around.down(altitude));
        let place = Vector3::new(ground.x, ground.y, down);
        Self {
            course: Course::new(motion, &[place]).with(target.heading, target.speed),
        }
    }

    /// One step, with the front towards a place where there is one. On the ground there is nothing to
    /// hold.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>, look_at: Option<Vector3>) -> Step {
        if around.landed {
            self.course = Course::new(&around.at_rest(), &[]);
            return Step::of(Demand::Rest);
        }
        if let Some(heading) = look_at.and_then(|place| towards(place, self.course.position())) {
            self.course.face(heading);
        }
        Step::of(Demand::Follow(self.course.step(around)))
    }
}
