//! Missions: what their items mean, whether they can be flown, and how far the vehicle has come.
//!
//! A mission is a list of [`MissionItem`]s, kept as they were uploaded. [`action`] says what an
//! item means or why it is refused; [`check`](mod@check) does so for a whole mission, before it is
//! accepted; [`route`] walks through it, jumps included; [`executor`] flies it.

pub mod action;
pub mod camera;
pub mod check;
pub mod executor;
pub mod item;
pub mod memory;
pub mod nav;
pub mod parameters;
pub mod route;

pub use action::{Action, Reason, Refusal};
pub use check::check;
pub use executor::{MissionEvent, MissionEvents, MissionExecutor};
pub use item::{MAX_ITEMS, MissionItem, PlanKind};
pub use memory::PlanMemory;
pub use parameters::MissionParameters;

/// Where plans are stored: of each kind two slots, one of them valid, the other one for the next
/// upload.
pub trait MissionSource {
    /// One item of the plan of that kind in a slot; `None` beyond its end.
    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem>;
}

/// A mission in memory, whatever the slot; no fence and no rally points.
impl MissionSource for [MissionItem] {
    fn item(&self, kind: PlanKind, _slot: u8, index: u16) -> Option<MissionItem> {
        match kind {
            PlanKind::Mission => self.get(usize::from(index)).copied(),
            PlanKind::Fence | PlanKind::Rally => None,
        }
    }
}

/// Plans of all kinds in memory, whatever the slot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plans<'a> {
    /// The mission.
    pub mission: &'a [MissionItem],
    /// The fence.
    pub fence: &'a [MissionItem],
    /// Rally points.
    pub rally: &'a [MissionItem],
}

impl MissionSource for Plans<'_> {
    fn item(&self, kind: PlanKind, _slot: u8, index: u16) -> Option<MissionItem> {
        let items = match kind {
            PlanKind::Mission => self.mission,
            PlanKind::Fence => self.fence,
            PlanKind::Rally => self.rally,
        };
        items.get(usize::from(index)).copied()
    }
}
