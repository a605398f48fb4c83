//! Stabilize: sticks to tilt, yaw rate and thrust. Needs no position and no height.

use windhover_control::position::AttitudeSetpoint;
use windhover_math::{GRAVITY, Vector3, max, min};

use super::{Around, Demand, Motion, Step, lift::Lift, tilt::Tilt};
use crate::rc::Sticks;

/// A throttle below this leaves a landed vehicle on the ground.
const LIFT: f32 = -0.8;

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Stabilize {
    tilt: Tilt,
    lift: Lift,
}

impl Stabilize {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            tilt: Tilt::new(motion),
            lift: Lift::default(),
        }
    }

    /// One step.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        let hands_off = Sticks {
            throttle: -1.0,
            ..Sticks::default()
        };
        let sticks = around.sticks.unwrap_or(hands_off);
        if self.lift.rests(around.landed, sticks.throttle < LIFT) {
            self.tilt = Tilt::new(&around.at_rest());
            return Step::of(Demand::Rest);
        }
        let (attitude, rate) = self.tilt.step(around, &sticks);
        let vehicle = &around.parameters.vehicle;
        let full = 4.0 * vehicle.rotor_thrust_max();
        let limits = &around.parameters.position;
        let (least, most) = (limits.thrust_min * full, limits.thrust_max * full);
        let hover = min(vehicle.mass * GRAVITY / around.thrust_scale, most);
        // Half the throttle hovers, whatever the vehicle weighs.
        let throttle = max(-1.0, min(1.0, sticks.throttle));
        let thrust = if throttle < 0.0 {
            hover + (hover - least) * throttle
        } else {
            hover + (most - hover) * throttle
        };
        Step::of(Demand::Attitude(AttitudeSetpoint {
            attitude,
            rate: Vector3::new(0.0, 0.0, rate),
            thrust,
        }))
    }
}
