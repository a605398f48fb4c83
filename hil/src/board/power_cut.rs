//! Power that fails in the middle of an operation of the flash, and what the flash then holds.
//!
//! An operation that does not end leaves bits anywhere between old and new: of a word that is
//! programmed some of the bits to clear, of a sector that is erased some of the bits to set, from
//! none to all. Which ones follows from the operation's number.

use std::ops::Range;

use super::Memory;
use crate::time::NEVER;
use windhover_model::random::Random;

/// The stream of random numbers.
const STREAM: u64 = 0xF1A5;

/// When power fails, by the flash's operations.
pub(super) struct PowerCut {
    /// Operations begun so far.
    operations: u64,
    /// The one in which power will fail.
    at: Option<u64>,
    /// When it will, in the middle of that one.
    due: u64,
    failed: bool,
}

impl PowerCut {
    pub(super) fn new() -> Self {
        Self {
            operations: 0,
            at: None,
            due: NEVER,
            failed: false,
        }
    }

    pub(super) fn operations(&self) -> u64 {
        self.operations
    }

    pub(super) fn set(&mut self, operation: u64) {
        self.at = Some(operation);
    }

    /// An operation begins: whether it will not end.
    pub(super) fn begin(&mut self, start: u64, time: u64) -> bool {
        let operation = self.operations;
        self.operations += 1;
        let fails = self.at == Some(operation);
        if fails {
            self.at = None;
            self.due = start + time / 2;
        }
        fails
    }

    pub(super) fn next_event(&self) -> u64 {
        self.due
    }

    /// Power fails, if it is due.
    pub(super) fn advance(&mut self, now: u64) {
        if self.due <= now {
            self.due = NEVER;
            self.failed = true;
        }
    }

    /// Whether power has failed; asked once.
    pub(super) fn take_failed(&mut self) -> bool {
        std::mem::take(&mut self.failed)
    }

    /// What a place holds that was being programmed.
    pub(super) fn half_programmed(&self, old: u32, value: u32) -> u32 {
        let (any, odds) = self.chance();
        old & (value | mix(any, odds))
    }

    /// What a sector holds that was being erased.
    pub(super) fn erase_partly(&self, sector: Range<u32>, memory: &mut dyn Memory) {
        let (mut any, odds) = self.chance();
        let mut random = Random::new(any, STREAM);
        let mut bytes = vec![0; sector.len()];
        memory.read(sector.start, &mut bytes);
        for word in bytes.chunks_exact_mut(4) {
            any = random.bits();
            for (byte, set) in word.iter_mut().zip(mix(any, odds).to_le_bytes()) {
                *byte |= set;
            }
        }
        memory.write(sector.start, &bytes);
    }

    /// Random bits, and how many of four bits are set.
    fn chance(&self) -> (u64, u64) {
        let mut random = Random::new(self.operations, STREAM);
        (random.bits(), random.bits() % 5)
    }
}

/// Bits of which so many of four are set, on average.
fn mix(any: u64, odds: u64) -> u32 {
    let (one, other) = (any as u32, (any >> 32) as u32);
    match odds {
        0 => 0,
        1 => one & other,
        2 => one,
        3 => one | other,
        _ => !0,
    }
}
