//! Hold: brakes and stays where it is, or goes where it is sent and stays there.

use windhover_math::Vector3;

use super::course::Course;
use super::{Around, Demand, Motion, Step, Target};

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

    /// One step. On the ground there is nothing to hold.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        if around.landed {
            self.course = Course::new(&around.at_rest(), &[]);
            return Step::of(Demand::Rest);
        }
        Step::of(Demand::Follow(self.course.step(around)))
    }
}
