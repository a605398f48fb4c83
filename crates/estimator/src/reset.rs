//! Steps of the state, for those who hold setpoints against it.

use windhover_math::{Quaternion, Vector3};

use crate::state::State;

/// A step of the state that is no motion: new position = old + `position`, and so on. A controller
/// that shifts its setpoints by it feels no jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reset {
    /// Step of position, NED, m.
    pub position: Vector3,
    /// Step of velocity, NED, m/s.
    pub velocity: Vector3,
    /// Step of attitude in the world: new = `attitude` · old.
    pub attitude: Quaternion,
}

impl Reset {
    /// From one state to the other.
    pub(crate) fn between(old: &State, new: &State) -> Self {
        Self {
            position: new.position - old.position,
            velocity: new.velocity - old.velocity,
            attitude: new.attitude * old.attitude.conjugate(),
        }
    }
}
