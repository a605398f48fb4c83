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
