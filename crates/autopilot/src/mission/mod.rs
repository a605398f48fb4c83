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
pub mod nav;
pub mod parameters;
pub mod route;

pub use action::{Action, Reason, Refusal};
pub use check::check;
pub use executor::{MissionEvent, MissionEvents, MissionExecutor};
pub use item::{MAX_ITEMS, MissionItem, PlanKind};
pub use parameters::MissionParameters;

/// Where missions are stored: two slots, one of them valid, the other one for the next upload.
pub trait MissionSource {
    /// One item of the mission in a slot; `None` beyond its end.
    fn item(&self, slot: u8, index: u16) -> Option<MissionItem>;
}

/// A mission in memory, whatever the slot.
impl MissionSource for [MissionItem] {
    fn item(&self, _slot: u8, index: u16) -> Option<MissionItem> {
        self.get(usize::from(index)).copied()
    }
}
