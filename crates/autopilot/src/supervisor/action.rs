//! What a failsafe does, in the order of how much it takes out of the pilot's hands.

use crate::fence::FenceAction;
use crate::mode::Mode;

/// What is done about something that has gone wrong. Later ones are more severe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Action {
    /// Nothing: the row is switched off.
    #[default]
    None,
    /// Tell the pilot.
    Warn,
    /// Stay here; level at height and heading where the position is not known.
    Hold,
    /// Return and land.
    Return,
    /// Land here.
    Land,
    /// Level and down, without a position.
    Descend,
    /// Motors off.
    Terminate,
}

impl Action {
    /// All of them, in their order.
    pub const ALL: [Self; 7] = [
        Self::None,
        Self::Warn,
        Self::Hold,
        Self::Return,
        Self::Land,
        Self::Descend,
        Self::Terminate,
    ];

    /// The mode that carries it out; `None` for what is no mode.
    pub const fn mode(self) -> Option<Mode> {
        match self {
            Self::None | Self::Warn | Self::Terminate => None,
            Self::Hold => Some(Mode::Hold),
            Self::Return => Some(Mode::Return),
            Self::Land => Some(Mode::Land),
            Self::Descend => Some(Mode::Descend),
        }
    }

    /// What a mode does already: a failsafe that asks for less does not interrupt it.
    pub const fn of(mode: Mode) -> Self {
        match mode {
            Mode::Return => Self::Return,
            Mode::Land => Self::Land,
            Mode::Descend => Self::Descend,
            _ => Self::None,
        }
    }

    /// Its name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Warn => "warn",
            Self::Hold => "hold",
            Self::Return => "return",
            Self::Land => "land",
            Self::Descend => "descend",
            Self::Terminate => "terminate",
        }
    }

    /// As the parameters number it that say what is done about a lost link (PX4's `NAV_RCL_ACT`).
    pub(super) fn of_link(code: f32) -> Self {
        match code as u8 {
            0 => Self::Warn,
            1 => Self::Hold,
            2 => Self::Return,
            3 => Self::Land,
            _ => Self::Terminate,
        }
    }

    /// What a fence does that is reached.
    pub(super) fn of_fence(action: FenceAction) -> Self {
        match action {
            FenceAction::Nothing => Self::None,
            FenceAction::Warn => Self::Warn,
            FenceAction::Hold => Self::Hold,
            FenceAction::Return => Self::Return,
            FenceAction::Terminate => Self::Terminate,
            FenceAction::Land => Self::Land,
        }
    }
}
