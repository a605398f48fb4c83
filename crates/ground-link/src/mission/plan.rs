//! What is uploaded and downloaded, and where it is kept.

use mavlink::dialects::common::MavMissionResult;
use windhover_autopilot::MissionCommit;
use windhover_autopilot::mission::{MissionItem, PlanKind};

use crate::text::Line;

macro_rules! results {
    ($($(#[$meta:meta])* $name:ident: $wire:ident;)*) => {
        /// How something about plans went (`MAV_MISSION_RESULT`).
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum MissionResult {
            $($(#[$meta])* $name,)*
        }

        impl MissionResult {
            pub(crate) const fn wire(self) -> u8 {
                match self { $(Self::$name => MavMissionResult::$wire as u8,)* }
            }
        }
    };
}

results! {
    /// Done.
    Accepted: MAV_MISSION_ACCEPTED;
    /// Not done, and none of the others says why.
    Error: MAV_MISSION_ERROR;
    /// An item's frame is not one that is flown.
    UnsupportedFrame: MAV_MISSION_UNSUPPORTED_FRAME;
    /// An item's command is not one that is flown.
    Unsupported: MAV_MISSION_UNSUPPORTED;
    /// Too many items.
    NoSpace: MAV_MISSION_NO_SPACE;
    /// A value that is none.
    Invalid: MAV_MISSION_INVALID;
    /// Parameter 1 has a value that is none.
    InvalidParam1: MAV_MISSION_INVALID_PARAM1;
    /// Parameter 2 has a value that is none.
    InvalidParam2: MAV_MISSION_INVALID_PARAM2;
    /// Parameter 3 has a value that is none.
    InvalidParam3: MAV_MISSION_INVALID_PARAM3;
    /// Parameter 4 has a value that is none.
    InvalidParam4: MAV_MISSION_INVALID_PARAM4;
    /// Parameter 5, the latitude, has a value that is none.
    InvalidParam5: MAV_MISSION_INVALID_PARAM5_X;
    /// Parameter 6, the longitude, has a value that is none.
    InvalidParam6: MAV_MISSION_INVALID_PARAM6_Y;
    /// Parameter 7, the altitude, has a value that is none.
    InvalidParam7: MAV_MISSION_INVALID_PARAM7;
    /// Another item was asked for.
    InvalidSequence: MAV_MISSION_INVALID_SEQUENCE;
    /// Not from this one, not now.
    Denied: MAV_MISSION_DENIED;
    /// Given up.
    Cancelled: MAV_MISSION_OPERATION_CANCELLED;
}

/// Why a plan, or an item of it, is not taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanRefusal {
    /// For the client.
    pub result: MissionResult,
    /// For a human: the item and what is wrong with it.
    pub reason: Line,
}

impl PlanRefusal {
    /// With this reason.
    pub fn new(result: MissionResult, reason: core::fmt::Arguments<'_>) -> Self {
        Self {
            result,
            reason: Line::new(reason),
        }
    }
}

/// Where plans are kept: for each kind a slot that is in use, and one for the next upload.
///
/// Several links may share a store: between [`PlanStore::begin`] and [`PlanStore::commit`] or
/// [`PlanStore::abort`] a kind belongs to one of them, and `begin` refuses the others.
pub trait PlanStore {
    /// The plan that is in use.
    fn committed(&self, kind: PlanKind) -> MissionCommit;

    /// One item of the plan in a slot; `None` beyond its end. It comes back as it was written, bit
    /// for bit.
    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem>;

    /// How many items there is room for.
    fn capacity(&self, kind: PlanKind) -> u16;

    /// Whether an item can be flown.
    fn check(&self, kind: PlanKind, index: u16, item: &MissionItem) -> Result<(), PlanRefusal>;

    /// Whether a plan that was committed is still on its way to the core: soon [`PlanStore::begin`] will
    /// be possible, and now it is not.
    fn is_settling(&self, kind: PlanKind) -> bool;

    /// An upload of so many items begins: the slot that it goes into. The slot in use stays as it
    /// is.
    fn begin(&mut self, kind: PlanKind, count: u16) -> Result<u8, PlanRefusal>;

    /// Keeps an item in the slot that [`PlanStore::begin`] gave; items come in order.
    fn write(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> Result<(), PlanRefusal>;

    /// From now on this is the plan in use; what is refused changes nothing.
    fn commit(&mut self, kind: PlanKind, commit: MissionCommit) -> Result<(), PlanRefusal>;

    /// The upload has come to nothing.
    fn abort(&mut self, kind: PlanKind);
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::common::MavMissionType;

    use super::*;

    /// The core's numbers go onto the wire as they are.
    #[test]
    fn kinds_have_the_numbers_of_the_wire() {
        let wire = [
            MavMissionType::MAV_MISSION_TYPE_MISSION,
            MavMissionType::MAV_MISSION_TYPE_FENCE,
            MavMissionType::MAV_MISSION_TYPE_RALLY,
        ];
        let kinds = [PlanKind::Mission, PlanKind::Fence, PlanKind::Rally];
        for (kind, wire) in kinds.into_iter().zip(wire) {
            assert_eq!(kind.code(), wire as u8);
            assert_eq!(PlanKind::from_code(wire as u8), Some(kind));
        }
        assert_eq!(PlanKind::EACH, kinds);
        assert_eq!((3..=u8::MAX).find_map(PlanKind::from_code), None);
    }
}
