//! Sticks to a tilt and a heading that go over into each other without a jump.

use windhover_control::pid::low_pass_share;
use windhover_math::{Euler, Quaternion, max, min, wrap_pi};

use super::{Around, Motion};
use crate::rc::Sticks;

/// Time constant with which the tilt follows the stick, s.
const FOLLOWS: f32 = 0.12;

/// Tilt and heading as commanded.
#[derive(Clone, Debug)]
pub struct Tilt {
    roll: f32,
    pitch: f32,
    heading: f32,
    rate: f32,
}

impl Tilt {
    /// From the attitude that is commanded now.
    pub fn new(motion: &Motion) -> Self {
        let Euler { roll, pitch, .. } = motion.attitude.to_euler();
        Self {
            roll,
            pitch,
            heading: motion.heading.heading,
            rate: motion.heading.rate,
        }
    }

    /// The attitude, and the heading's rate in rad/s.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>, sticks: &Sticks) -> (Quaternion, f32) {
        let p = &around.parameters.manual;
        let most = min(p.tilt, around.parameters.position.tilt_max);
        let share = low_pass_share(FOLLOWS, around.seconds);
        // The corner of the sticks is no more tilt than their ends.
        let length = windhover_math::sqrt(sticks.roll * sticks.roll + sticks.pitch * sticks.pitch);
        let scale = most / max(length, 1.0);
        self.roll += (sticks.roll * scale - self.roll) * share;
        self.pitch += (-sticks.pitch * scale - self.pitch) * share;
        self.rate += (sticks.yaw * p.yaw_rate - self.rate) * share;
        self.heading = wrap_pi(self.heading + self.rate * around.seconds);
        let attitude = Quaternion::from_euler(Euler {
            roll: self.roll,
            pitch: self.pitch,
            yaw: self.heading,
        });
        (attitude, self.rate)
    }
}
