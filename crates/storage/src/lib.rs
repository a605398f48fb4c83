//! What outlasts power: parameters, calibrations among them, and plans, in a journal in flash.
//!
//! [`Journal`] opens three sectors, loads what they hold, and does one [`Task`] at a time.
//! [`Keeper`] says which one is next: it compares what the core has with what is stored, and asks
//! for nothing while the vehicle is armed. So whoever owns the flash does this, and no more:
//!
//! ```
//! # use embedded_storage_async::nor_flash::NorFlash;
//! # use windhover_autopilot::mission::MissionSource;
//! use windhover_storage::{Journal, Keeper, View};
//!
//! # async fn step<F: NorFlash>(
//! #     journal: &mut Journal<F>, keeper: &mut Keeper, plans: &impl MissionSource, view: View<'_>,
//! # ) {
//! if let Some(task) = keeper.next(&view, plans) {
//!     let outcome = journal.perform(&task).await;
//!     keeper.done(outcome);
//! }
//! # }
//! ```
//!
//! Power may fail at any moment. What is there at the next start is, for the group of parameters
//! and for the plan that were being written, the old or the new one, whole; everything else is as it
//! was. What cannot be true is refused and reported as [`Damage`], and the defaults stand in its
//! place; blank flash is no damage. How that is done is told in [`sectors`] for erasures, and in
//! [`Keeper`] for groups of parameters and for plans.
#![no_std]

mod journal;
pub mod keeper;
mod ledger;
mod record;
pub mod sectors;
mod space;
mod sum;

pub use journal::{Damage, Journal, Loaded, PlanMemory, StoreError};
pub use keeper::{Keeper, View};
pub use record::{Entry, Task};
pub use space::{LIMIT, MOST};

use windhover_autopilot::fence::{MAX_RALLY, MAX_SHAPES, MAX_VERTICES};
use windhover_autopilot::mission::{MAX_ITEMS, PlanKind};

/// How many items of a kind of plan the journal has room for, always. A fence needs one for each
/// vertex and each circle.
pub const fn capacity(kind: PlanKind) -> u16 {
    let items = match kind {
        PlanKind::Mission => MAX_ITEMS,
        PlanKind::Fence => MAX_VERTICES + MAX_SHAPES,
        PlanKind::Rally => MAX_RALLY,
    };
    items as u16
}
