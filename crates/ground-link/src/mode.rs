//! Modes of flight and the numbers that ground stations know them by: PX4's.

/// A mode of flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Sticks to tilt, yaw rate and thrust, without a name of its own in the vehicle: Stabilize.
    Manual,
    /// Sticks to tilt, yaw rate and climb.
    Altitude,
    /// Sticks to velocity.
    Position,
    /// Sticks to body rates.
    Acro,
    /// Setpoints from outside.
    Offboard,
    /// Sticks to tilt, yaw rate and thrust.
    Stabilize,
    /// Taking off.
    Takeoff,
    /// Staying where it is.
    #[default]
    Hold,
    /// Flying the mission.
    Mission,
    /// Returning.
    Return,
    /// Landing.
    Land,
}

/// The main number of the modes in which the vehicle finds its own way.
const AUTO: u8 = 4;

impl Mode {
    /// PX4's main and sub mode.
    pub const fn numbers(self) -> (u8, u8) {
        match self {
            Self::Manual => (1, 0),
            Self::Altitude => (2, 0),
            Self::Position => (3, 0),
            Self::Acro => (5, 0),
            Self::Offboard => (6, 0),
            Self::Stabilize => (7, 0),
            Self::Takeoff => (AUTO, 2),
            Self::Hold => (AUTO, 3),
            Self::Mission => (AUTO, 4),
            Self::Return => (AUTO, 5),
            Self::Land => (AUTO, 6),
        }
    }

    /// The mode with PX4's main and sub mode.
    pub const fn from_numbers(main: u8, sub: u8) -> Option<Self> {
        Some(match (main, sub) {
            (1, _) => Self::Manual,
            (2, _) => Self::Altitude,
            (3, _) => Self::Position,
            (5, _) => Self::Acro,
            (6, _) => Self::Offboard,
            (7, _) => Self::Stabilize,
            (AUTO, 2) => Self::Takeoff,
            (AUTO, 3) => Self::Hold,
            (AUTO, 4) => Self::Mission,
            (AUTO, 5) => Self::Return,
            (AUTO, 6) => Self::Land,
            _ => return None,
        })
    }

    /// As `custom_mode` of a heartbeat has it.
    pub const fn custom(self) -> u32 {
        let (main, sub) = self.numbers();
        u32::from_le_bytes([0, 0, main, sub])
    }

    /// The mode that `custom_mode` of a heartbeat names.
    pub const fn from_custom(custom: u32) -> Option<Self> {
        let [_, _, main, sub] = custom.to_le_bytes();
        Self::from_numbers(main, sub)
    }

    /// Whether the vehicle finds its own way.
    pub const fn is_auto(self) -> bool {
        self.numbers().0 == AUTO
    }

    /// Whether it is flown by sticks.
    pub const fn is_manual(self) -> bool {
        !self.is_auto() && !matches!(self, Self::Offboard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_px4_and_come_back() {
        assert_eq!(Mode::Mission.custom(), 4 << 16 | 4 << 24);
        assert_eq!(Mode::Offboard.custom(), 6 << 16);
        for main in 0..=255 {
            for sub in 0..=255 {
                if let Some(mode) = Mode::from_numbers(main, sub) {
                    assert_eq!(Mode::from_custom(mode.custom()), Some(mode));
                }
            }
        }
        assert_eq!(Mode::from_numbers(4, 1), None);
        assert_eq!(Mode::from_custom(0), None);
    }
}
