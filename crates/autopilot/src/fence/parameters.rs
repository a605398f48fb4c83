//! What the fence is besides its shapes, in numbers.

use windhover_parameters::parameters;

parameters! {
    /// How far the vehicle may go, and what happens when it goes, or would go, further.
    pub struct FenceParameters {
        action: "GF_ACTION", "", 0.0..=5.0, 2.0, "When the fence is reached: 0 nothing, 1 warn, 2 hold, 3 return, 4 stop the motors, 5 land";
        distance_max: "GF_MAX_HOR_DIST", "m", 0.0..=10000.0, 0.0, "The vehicle stays within this distance of home; 0 sets no limit";
        altitude_max: "GF_MAX_VER_DIST", "m", 0.0..=10000.0, 0.0, "The vehicle stays below this height above home; 0 sets no limit";
        predict: "GF_PREDICT", "", 0.0..=1.0, 1.0, "1 acts while the vehicle can still stop inside, 0 once it is outside";
        margin: "GF_MARGIN", "m", 0.0..=50.0, 2.0, "How far before the fence the vehicle comes to rest, when that is foreseen";
    }
}

/// What is done when the fence is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FenceAction {
    /// Nothing.
    Nothing,
    /// Say so.
    Warn,
    /// Stay there.
    Hold,
    /// Return, and land.
    Return,
    /// Stop the motors.
    Terminate,
    /// Land there.
    Land,
}

impl FenceParameters {
    /// The action that the parameter's number stands for.
    pub fn action(&self) -> FenceAction {
        match self.action as u8 {
            0 => FenceAction::Nothing,
            1 => FenceAction::Warn,
            3 => FenceAction::Return,
            4 => FenceAction::Terminate,
            5 => FenceAction::Land,
            _ => FenceAction::Hold,
        }
    }

    /// Whether the stopping point counts, not the position alone.
    pub fn predicts(&self) -> bool {
        self.predict >= 0.5
    }
}
