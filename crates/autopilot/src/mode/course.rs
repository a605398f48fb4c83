//! From whatever motion there is to a few places, one after the other: what the modes share that
//! find their own way.

use heapless::Vec;
use windhover_control::TrajectorySetpoint;
use windhover_math::{Vector3, max};

use super::{Around, Motion};
use crate::trajectory::path::Joint;
use crate::trajectory::{Glide, GlideLimits, HeadingSlew, Limits, Path};

/// The most places of a course.
pub const PLACES: usize = 3;

/// However slow it is told to go, m/s: each leg has an end.
const SLOWEST: f32 = 0.1;

/// A course: brakes to a stop, then from place to place, at rest at each.
#[derive(Clone, Debug)]
pub struct Course {
    glide: Glide,
    path: Option<Path>,
    /// Those that are left, the next one last.
    places: Vec<Vector3, PLACES>,
    heading: HeadingSlew,
    heading_target: f32,
    /// Ground speed, m/s; `None` leaves it to a parameter.
    speed: Option<f32>,
}

impl Course {
    /// To these places, in their order; to a stop where there are none.
    pub fn new(motion: &Motion, places: &[Vector3]) -> Self {
        Self {
            glide: motion.glide,
            path: None,
            places: places.iter().rev().take(PLACES).copied().collect(),
            heading: motion.heading,
            heading_target: motion.heading.heading,
            speed: None,
        }
    }

    /// The same with another heading (rad) and ground speed (m/s), where there is one.
    pub fn with(mut self, heading: Option<f32>, speed: Option<f32>) -> Self {
        self.heading_target = heading.unwrap_or(self.heading_target);
        self.speed = speed;
        self
    }

    /// Turns to this heading, rad.
    pub fn face(&mut self, heading: f32) {
        self.heading_target = heading;
    }

    /// Whether the last place is reached by the setpoint, or the stop.
    pub fn is_done(&self) -> bool {
        let arrived = match &self.path {
            Some(path) => path.is_finished(),
            None => self.glide.is_at_rest(),
        };
        arrived && self.places.is_empty()
    }

    /// Where it stands now.
    pub fn position(&self) -> Vector3 {
        self.glide.position
    }

    /// Where it leads.
    pub fn end(&self) -> Vector3 {
        let way = self.path.as_ref().map_or(self.glide.position, Path::end);
        self.places.first().copied().unwrap_or(way)
    }

    /// The next step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> TrajectorySetpoint {
        let p = &around.parameters.mission;
        let rate = around.rate(self.glide.position);
        self.heading.step(
            self.heading_target,
            p.yaw_rate,
            p.yaw_acceleration,
            around.seconds,
        );
        let heading = (self.heading.heading, self.heading.rate);
        if self.path.is_none() && self.glide.is_at_rest() && !self.places.is_empty() {
            self.path = Some(Path::at(self.glide.position));
        }
        let Some(path) = &mut self.path else {
            let limits = GlideLimits::of(&around.parameters.manual);
            let jerk = self.glide.step(Vector3::zeros(), &limits, rate, around.seconds);
            return self.glide.setpoint(jerk, rate, heading);
        };
        if path.is_finished()
            && let Some(place) = self.places.pop()
        {
            let limits = Limits {
                speed: max(self.speed.unwrap_or(p.cruise_speed), SLOWEST),
                climb: if around.landed {
                    p.takeoff_speed
                } else {
                    p.climb_speed
                },
                descend: p.descend_speed,
                acceleration: p.acceleration,
                vertical_acceleration: p.vertical_acceleration,
                jerk: p.jerk,
            };
            path.push(place, &limits, Joint::Stop, Joint::Stop);
        }
        let mut setpoint = path.step(around.dt, rate).setpoint;
        self.glide = Glide {
            position: setpoint.position,
            velocity: setpoint.velocity,
            acceleration: setpoint.acceleration,
        };
        (setpoint.heading, setpoint.heading_rate) = heading;
        setpoint
    }
}
