//! How much room everything takes at most, and that it is there.
//!
//! `sequential-storage` keeps one sector free to move records into. When a record finds no room, it
//! moves what is still valid out of each of the other two in turn, and gains what was not. If both
//! together hold so much less than their room that one of them must have gained the length of the
//! record, it is written; so [`LIMIT`] is their room less twice the longest record.

use windhover_autopilot::Parameters;
use windhover_autopilot::mission::{PlanKind, PlanMemory};

use crate::record::{CHUNK_ITEMS, KEY, VALUE};

/// Bytes of a sector above the layer of marks, and of its page markers.
const PAGE: usize = 0x4000 - 4 - 2 * 4;

/// Bytes of a record: a header of length and CRC, its key, its value.
const fn record(value: usize) -> usize {
    8 + KEY + value
}

const fn chunks(kind: PlanKind) -> usize {
    (PlanMemory::capacity(kind) as usize).div_ceil(CHUNK_ITEMS)
}

/// So many bytes of valid records always find room.
pub const LIMIT: usize = 2 * PAGE - 2 * record(VALUE);

/// So many bytes are valid at most: all parameters, the ledger, all plans as long as they may be, a
/// new mission beside the old one, and the chunks of the other plans that were given back.
pub const MOST: usize = Parameters::COUNT * record(8)
    + record(VALUE)
    + 3 * record(8)
    + (2 * chunks(PlanKind::Mission) + chunks(PlanKind::Fence) + chunks(PlanKind::Rally)) * record(VALUE)
    + (chunks(PlanKind::Fence) + chunks(PlanKind::Rally)) * record(0);

/// What is left is for parameters of other firmware, which are kept: for as many as there are now.
const _: () = assert!(MOST + Parameters::COUNT * record(8) <= LIMIT);

/// A bit for each chunk of a plan.
const _: () = assert!(chunks(PlanKind::Mission) <= 32 && chunks(PlanKind::Fence) <= 32);
