//! A mission item as ground stations send, store and read it back.

/// The most items that one mission holds.
pub const MAX_ITEMS: usize = 256;

/// One item of a mission, with MAVLink's meaning and scaling (`MISSION_ITEM_INT`): the form in
/// which missions are uploaded, stored and given back, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionItem {
    /// `MAV_CMD`.
    pub command: u16,
    /// `MAV_FRAME`.
    pub frame: u8,
    /// Whether the mission goes on by itself after this item.
    pub autocontinue: bool,
    /// Parameters 1 to 4; NaN says unset.
    pub params: [f32; 4],
    /// Latitude in 1e-7 degree where the command has a position, else parameter 5.
    pub x: i32,
    /// Longitude in 1e-7 degree where the command has a position, else parameter 6.
    pub y: i32,
    /// Altitude in m in the item's frame where the command has a position, else parameter 7.
    pub z: f32,
}

/// What an item belongs to; numbers as in MAVLink's `MAV_MISSION_TYPE`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlanKind {
    /// The mission.
    #[default]
    Mission,
    /// The fence.
    Fence,
    /// Rally points.
    Rally,
}

impl PlanKind {
    /// All of them.
    pub const EACH: [Self; 3] = [Self::Mission, Self::Fence, Self::Rally];

    /// Its number.
    pub const fn code(self) -> u8 {
        match self {
            Self::Mission => 0,
            Self::Fence => 1,
            Self::Rally => 2,
        }
    }

    /// The kind with that number.
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::Mission),
            1 => Some(Self::Fence),
            2 => Some(Self::Rally),
            _ => None,
        }
    }

    /// For a human.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mission => "mission",
            Self::Fence => "fence",
            Self::Rally => "rally points",
        }
    }
}
