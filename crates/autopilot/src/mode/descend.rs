//! Descend: level and down, with no need to know where the vehicle is; where not even the height is
//! known, by a thrust somewhat below the weight.

use windhover_control::position::AttitudeSetpoint;
use windhover_math::{GRAVITY, Vector3};

use super::land::has_contact;
use super::tilt::Tilt;
use super::{Around, Demand, Motion, Step};
use crate::rc::Sticks;
use crate::trajectory::{Glide, GlideLimits};

/// Thrust of a descent by thrust alone, as a share of the weight.
pub const THRUST: f32 = 0.95;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Descend {
    tilt: Tilt,
    glide: Glide,
}

impl Descend {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            tilt: Tilt::new(motion),
            glide: motion.glide,
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        if around.landed {
            return Step::of(Demand::Rest);
        }
        let (attitude, heading_rate) = self.tilt.step(around, &Sticks::default());
        if !around.estimate.known.height {
            self.glide.position = around.estimate.position;
            self.glide.velocity = Vector3::zeros();
            let weight = around.parameters.vehicle.mass * GRAVITY / around.thrust_scale;
            return Step::of(Demand::Attitude(AttitudeSetpoint {
                attitude,
                rate: Vector3::zeros(),
                thrust: THRUST * weight,
            }));
        }
        let down = Vector3::new(0.0, 0.0, around.parameters.mission.land_speed);
        let limits = GlideLimits::of(&around.parameters.manual);
        let jerk = self.glide.step(down, &limits, 1.0, around.seconds);
        self.glide.position.x = around.estimate.position.x;
        self.glide.position.y = around.estimate.position.y;
        let point = self.glide.setpoint(jerk, 1.0, (0.0, 0.0));
        Step {
            contact: has_contact(point.position.z, around),
            ..Step::of(Demand::Tilt {
                attitude,
                heading_rate,
                point,
            })
        }
    }
}
