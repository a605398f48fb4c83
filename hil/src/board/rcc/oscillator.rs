//! The oscillators: when each is ready after it was switched on.

use crate::time::{MICROSECOND, NEVER};

/// Indices, in the order of the interrupt bits in `RCC_CIR`.
pub(in super::super) const LSI: usize = 0;
pub(in super::super) const LSE: usize = 1;
pub(in super::super) const HSI: usize = 2;
pub(in super::super) const HSE: usize = 3;
pub(in super::super) const PLL: usize = 4;
pub(in super::super) const PLLI2S: usize = 5;

/// Their names.
pub(in super::super) const NAMES: [&str; 6] = ["LSI", "LSE", "HSI", "HSE", "the PLL", "PLLI2S"];

/// Typical start-up times (datasheet tables 32 to 38).
const START_UP: [u64; 6] = [
    15 * MICROSECOND,
    2_000_000 * MICROSECOND,
    2 * MICROSECOND,
    2_000 * MICROSECOND,
    200 * MICROSECOND,
    200 * MICROSECOND,
];

#[derive(Clone, Copy)]
struct Oscillator {
    on: bool,
    ready: bool,
    /// When it will be ready; never while it is off, or ready already.
    due: u64,
}

pub(in super::super) struct Oscillators([Oscillator; 6]);

impl Oscillators {
    /// As after reset: only the internal oscillator runs.
    pub(in super::super) fn new() -> Self {
        let off = Oscillator {
            on: false,
            ready: false,
            due: NEVER,
        };
        let mut all = [off; 6];
        all[HSI].on = true;
        all[HSI].ready = true;
        Self(all)
    }

    /// Takes one as it was before a reset.
    pub(in super::super) fn keep(&mut self, which: usize, before: &Self) {
        self.0[which] = before.0[which];
    }

    pub(in super::super) fn on(&self, which: usize) -> bool {
        self.0[which].on
    }

    pub(in super::super) fn ready(&self, which: usize) -> bool {
        self.0[which].ready
    }

    pub(in super::super) fn switch(&mut self, which: usize, on: bool, now: u64) {
        let oscillator = &mut self.0[which];
        if oscillator.on != on {
            *oscillator = Oscillator {
                on,
                ready: false,
                due: if on { now + START_UP[which] } else { NEVER },
            };
        }
    }

    pub(in super::super) fn next_event(&self) -> u64 {
        self.0.iter().fold(NEVER, |soonest, one| soonest.min(one.due))
    }

    /// Makes those ready that are due, and returns them as bits.
    pub(in super::super) fn advance(&mut self, now: u64) -> u32 {
        let mut became_ready = 0;
        for (index, oscillator) in self.0.iter_mut().enumerate() {
            if oscillator.due <= now {
                oscillator.ready = true;
                oscillator.due = NEVER;
                became_ready |= 1 << index;
            }
        }
        became_ready
    }
}
