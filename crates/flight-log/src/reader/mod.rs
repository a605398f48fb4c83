//! The reader: a log as a byte slice, read message by message.
//!
//! [`Log::open`] reads what stands before the first tick; [`Log::entries`] gives every record
//! after it, and [`Log::periods`] what replay needs: a period of inputs at a time, with the outputs
//! that the flight had. A log that was cut, or is corrupt from some byte on, gives everything
//! complete before; where and why reading stopped is an [`End`].
//!
//! Nothing is copied but what is small and bounded, so that no file, however made, takes much
//! memory.

mod difference;
mod end;
mod entries;
mod log;
mod messages;
mod periods;
mod setup;

pub use difference::{Difference, difference};
pub use end::{End, OpenError, Reason};
pub use entries::{Entries, Entry};
pub use log::{Info, Log};
pub use messages::{Message, Messages};
pub use periods::{Period, Periods, Step};
pub use setup::{CoreSetup, PlanStore, SetupError};
