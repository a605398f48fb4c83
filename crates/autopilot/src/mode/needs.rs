//! What modes rely on: their entry conditions as a table.

use super::Mode;
use crate::set::bit_set;

/// Something that a mode relies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Roll and pitch are known.
    Attitude,
    /// The height is.
    Height,
    /// The position is, and it is measured.
    Position,
    /// A pilot's sticks are heard.
    Sticks,
    /// There is a mission that can be flown.
    Mission,
    /// Setpoints come from outside.
    Setpoint,
}

impl Need {
    /// All of them, in their order.
    pub const ALL: [Self; 6] = [
        Self::Attitude,
        Self::Height,
        Self::Position,
        Self::Sticks,
        Self::Mission,
        Self::Setpoint,
    ];
}

bit_set! {
    /// What a mode relies on, or what there is to rely on.
    Needs(u8) of Need
}

bit_set! {
    /// A set of modes.
    ModeSet(u16) of Mode
}

impl Mode {
    /// What it relies on; offboard, what its setpoints need.
    pub const fn needs(self, setpoint_needs_position: bool) -> Needs {
        const LEVEL: Needs = Needs::of(Need::Attitude);
        const HEIGHT: Needs = LEVEL.with(Need::Height, true);
        const PLACE: Needs = HEIGHT.with(Need::Position, true);
        match self {
            Self::Stabilize => LEVEL.with(Need::Sticks, true),
            Self::Altitude => HEIGHT,
            Self::Position => PLACE.with(Need::Sticks, true),
            Self::Takeoff | Self::Hold | Self::Return | Self::Land => PLACE,
            Self::Mission => PLACE.with(Need::Mission, true),
            Self::Offboard if setpoint_needs_position => PLACE.with(Need::Setpoint, true),
            Self::Offboard => LEVEL.with(Need::Setpoint, true),
            Self::Descend => Needs(0),
        }
    }
}

/// The modes that can rely on what there is.
pub fn available(there_is: Needs, setpoint_needs_position: bool) -> ModeSet {
    Mode::ALL.into_iter().fold(ModeSet::default(), |set, mode| {
        let lacks = mode.needs(setpoint_needs_position).without(there_is);
        set.with(mode, lacks.is_empty())
    })
}
