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
//! and for the plan that were being written, the old or the new one, whole; everything else is as
//! it was. What cannot be true is refused and reported as [`Damage`], and the defaults stand in its
//! place; blank flash is no damage. How that is done is told in [`sectors`] for erasures, and in
//! [`keeper`] for groups of parameters and for plans.
#![no_std]

mod journal;
pub mod keeper;
mod ledger;
mod record;
pub mod sectors;
mod space;
mod sum;

pub use journal::{Damage, Journal, Loaded, PlanSink, StoreError};
pub use keeper::{Keeper, View};
pub use record::{Entry, Task};
pub use space::{LIMIT, MOST};
