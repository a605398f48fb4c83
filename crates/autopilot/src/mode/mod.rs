//! Modes of flight.

/// A mode of flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// Sticks to tilt, yaw rate and thrust.
    Stabilize,
    /// Sticks to tilt, yaw rate and climb; hands off, it stays level at its height and heading.
    Altitude,
    /// Sticks to velocity; hands off, it stays where it is.
    Position,
    /// Straight up to a height.
    Takeoff,
    /// Stays where it is, or goes where it is sent and stays there.
    #[default]
    Hold,
    /// Flies the stored mission.
    Mission,
    /// Back to the nearest rally point, or home, and lands there.
    Return,
    /// Straight down to the ground.
    Land,
    /// Follows setpoints from outside.
    Offboard,
    /// Level and down, with no need to know where it is: what is left when little is known.
    Descend,
}

impl Mode {
    /// All of them, in their order.
    pub const ALL: [Self; 10] = [
        Self::Stabilize,
        Self::Altitude,
        Self::Position,
        Self::Takeoff,
        Self::Hold,
        Self::Mission,
        Self::Return,
        Self::Land,
        Self::Offboard,
        Self::Descend,
    ];

    /// Whether sticks fly it.
    pub const fn is_manual(self) -> bool {
        matches!(self, Self::Stabilize | Self::Altitude | Self::Position)
    }

    /// Its name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stabilize => "stabilize",
            Self::Altitude => "altitude",
            Self::Position => "position",
            Self::Takeoff => "takeoff",
            Self::Hold => "hold",
            Self::Mission => "mission",
            Self::Return => "return",
            Self::Land => "land",
            Self::Offboard => "offboard",
            Self::Descend => "descend",
        }
    }
}
