//! Descend: level and down, with no need to know where the vehicle is. Where not even the height is
//! known it keeps the rate of descent for as long as the inertial sensors know that, and then a thrust
//! somewhat below the weight.

use windhover_control::position::AttitudeSetpoint;
use windhover_math::{GRAVITY, Vector3, max, min};

use super::land::has_contact;
use super::tilt::Tilt;
use super::{Around, Demand, Motion, Step};
use crate::rc::Sticks;
use crate::trajectory::{Glide, GlideLimits};

/// Thrust of a descent by thrust alone, as a share of the weight.
pub const THRUST: f32 = 0.95;

/// A velocity that may be wrong by more is not followed, m/s.
const VELOCITY_ERROR: f32 = 1.0;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Descend {
    tilt: Tilt,
    glide: Glide,
    feeler: Feeler,
}

/// Feels for the ground where no height tells of it: takes thrust away as long as the accelerometer
/// does not notice. In the air it does at once, since whatever is not held up falls; on the ground
/// nothing changes, until there is too little thrust for anything but a landing.
#[derive(Clone, Copy, Debug)]
struct Feeler {
    /// Share of the thrust that is left.
    share: f32,
    /// Until the next try, s.
    wait: f32,
}

/// A specific force that is less than gravity's by more than this is that of a fall, m/s².
const FALLING: f32 = 1.2;
/// The share of the thrust goes down and comes back so fast, 1/s.
const FEELING: (f32, f32) = (1.0, 4.0);
/// From one try to the next, s.
const PAUSE: f32 = 2.0;

impl Feeler {
    fn new() -> Self {
        Self {
            share: 1.0,
            wait: PAUSE,
        }
    }

    /// Share of the thrust for a specific force of that size, m/s².
    fn step(&mut self, force: f32, dt: f32) -> f32 {
        if self.wait > 0.0 {
            self.wait -= dt;
            self.share = min(self.share + FEELING.1 * dt, 1.0);
        } else if force > GRAVITY - FALLING {
            self.share = max(self.share - FEELING.0 * dt, 0.1);
        } else {
            self.wait = PAUSE;
        }
        self.share
    }
}

impl Descend {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            tilt: Tilt::new(motion),
            glide: motion.glide,
            feeler: Feeler::new(),
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        if around.landed {
            return Step::of(Demand::Rest);
        }
        let (attitude, heading_rate) = self.tilt.step(around, &Sticks::default());
        let share = if around.estimate.known.height {
            1.0
        } else {
            self.feeler.step(around.force, around.seconds)
        };
        let blind = !around.estimate.known.height && around.estimate.accuracy.velocity > VELOCITY_ERROR;
        if blind {
            self.glide.position = around.estimate.position;
            self.glide.velocity = Vector3::zeros();
            let weight = around.parameters.vehicle.mass * GRAVITY / around.thrust_scale;
            return Step::of(Demand::Attitude(AttitudeSetpoint {
                attitude,
                rate: Vector3::zeros(),
                thrust: THRUST * share * weight,
            }));
        }
        let down = Vector3::new(0.0, 0.0, around.parameters.mission.land_speed);
        let limits = GlideLimits::of(&around.parameters.manual);
        let jerk = self.glide.step(down, &limits, 1.0, around.seconds);
        self.glide.position.x = around.estimate.position.x;
        self.glide.position.y = around.estimate.position.y;
        if !around.estimate.known.height {
            // The climb is known for a while after the height is not.
            self.glide.position.z = around.estimate.position.z;
        }
        let point = self.glide.setpoint(jerk, 1.0, (0.0, 0.0));
        Step {
            contact: has_contact(point.position.z, around),
            thrust_share: share,
            ..Step::of(Demand::Tilt {
                attitude,
                heading_rate,
                point,
            })
        }
    }
}
