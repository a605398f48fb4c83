//! The flight log: a ULog file that holds every input and every output of the core.
//!
//! With it a flight is evidence: the inputs, fed to the core again, must give the same outputs
//! bit for bit. The writer runs on board: no heap, no clock, bounded memory, and it never keeps its
//! caller waiting. The reader (feature `reader`) runs on the desktop and needs std.
//!
//! - [`wire`], [`value`], [`mod@record`]: bytes, scalars, and records declared one line each.
//! - [`inputs`]: what the core takes from its queues; a new kind of input is one line there.
//! - [`batch`], [`motors`]: inertial samples and motor commands, one message a period each.
//! - [`views`]: what people look at, under PX4's names where PX4 has one.
//! - [`hash`]: what the 32-bit hash of a period's outputs is.
//! - [`header`]: everything before the first tick, in bounded chunks.
//! - [`logger`]: a byte ring with room reserved for inputs, drained by whoever owns the storage.
//! - `reader`: records, and the periods that replay feeds to the core.
//!
//! ULog, as PX4 documents it ("ULog file format", docs.px4.io): 16 bytes of header, then messages
//! `{size: u16, kind: u8, body}`, little endian throughout. Every topic carries `timestamp` (µs
//! since start) first.
#![no_std]

#[cfg(any(test, feature = "reader"))]
extern crate std;

pub mod batch;
pub mod crc;
pub mod hash;
pub mod header;
pub mod inputs;
pub mod logger;
pub mod motors;
pub mod plan;
#[cfg(feature = "reader")]
pub mod reader;
pub mod record;
mod ring;
pub mod topics;
pub mod value;
pub mod version;
pub mod views;
pub mod wire;

pub use batch::{ImuBatch, ImuTimes, MAX_K};
pub use crc::{crc32, mission_crc};
pub use hash::{period_hash, result_hash};
pub use header::{Header, HeaderWriter, InfoValue};
pub use inputs::Input;
pub use logger::{Latest, Logger, LoggerConfig, Reporter};
pub use motors::MotorBatch;
pub use plan::{Plan, PlanItem, PlanKind};
pub use record::{Record, Topic};
pub use views::View;
