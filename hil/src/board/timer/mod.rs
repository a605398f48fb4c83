//! A timer that counts up (RM0090 chapters 17 to 20), evaluated when somebody looks or when
//! something that matters is due.

mod counter;
pub(super) mod kinds;
mod output;
mod registers;

use crate::time::NEVER;
use counter::Counter;
use kinds::Kind;

const CR1_CEN: u32 = 1 << 0;
const CR1_UDIS: u32 = 1 << 1;
const CR1_URS: u32 = 1 << 2;
const CR1_OPM: u32 = 1 << 3;
const CR1_ARPE: u32 = 1 << 7;

/// Update: UIF in SR, UIE in DIER, UG in EGR.
const UPDATE: u32 = 1 << 0;
/// Compare of the first channel, likewise; the other channels' bits follow.
const COMPARE_1: u32 = 1 << 1;
/// Bits of DIER that ask for DMA lie this far above those that ask for interrupts.
const DMA_SHIFT: u32 = 8;

/// How a timer asks for DMA.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Update,
    /// Compare of the channel with this index.
    Compare(u8),
}

impl Event {
    fn bit(self) -> u32 {
        match self {
            Self::Update => UPDATE,
            Self::Compare(channel) => COMPARE_1 << channel,
        }
    }
}

pub(super) struct Timer {
    kind: &'static Kind,
    control: u32,
    control_2: u32,
    slave_mode: u32,
    /// DIER.
    requests: u32,
    status: u32,
    /// DMA requests that were not served yet, as bits of DIER's lower half.
    dma: u32,
    /// CCMR1 and CCMR2.
    modes: [u32; 2],
    /// CCER.
    enables: u32,
    /// BDTR.
    break_register: u32,
    options: u32,
    counter: Counter,
    /// Preload registers: what the counter will take at the next update.
    prescaler: u32,
    reload: u32,
    compares: [u32; 4],
    /// When a period began of which nobody has taken note.
    began: Option<u64>,
}

impl Timer {
    pub(super) fn new(kind: &'static Kind) -> Self {
        Self {
            kind,
            control: 0,
            control_2: 0,
            slave_mode: 0,
            requests: 0,
            status: 0,
            dma: 0,
            modes: [0; 2],
            enables: 0,
            break_register: 0,
            options: 0,
            counter: Counter::new(kind.top),
            prescaler: 0,
            reload: kind.top,
            compares: [0; 4],
            began: None,
        }
    }

    /// Its clock: ticks in a cycle, or none while it is gated off.
    pub(super) fn set_clock(&mut self, now: u64, cycle: Option<u64>) {
        self.catch_up(now);
        self.counter.set_clock(now, cycle);
    }

    fn running(&self) -> bool {
        self.control & CR1_CEN != 0
    }

    /// Its request lines, a bit for each interrupt.
    pub(super) fn interrupts(&self) -> u128 {
        let raised = self.status & self.requests;
        let mut lines = 0;
        if raised & UPDATE != 0 {
            lines |= 1 << self.kind.update_interrupt;
        }
        if raised & (0xF * COMPARE_1) != 0 {
            lines |= 1 << self.kind.compare_interrupt;
        }
        lines
    }

    pub(super) fn requests_dma(&self, event: Event) -> bool {
        self.dma & event.bit() != 0
    }

    pub(super) fn dma_served(&mut self, event: Event) {
        self.dma &= !event.bit();
    }

    /// When the next thing happens that an interrupt, DMA or an output waits for.
    pub(super) fn next_event(&self) -> u64 {
        if !self.running() {
            return NEVER;
        }
        let mut next = NEVER;
        let wants_dma = self.requests >> DMA_SHIFT;
        let wants = self.requests & !self.status | wants_dma;
        let update = self.counter.next_overflow();
        if wants & UPDATE != 0 || self.has_outputs() || self.control & CR1_OPM != 0 {
            next = update;
        }
        for channel in 0..self.kind.channels {
            if wants & (COMPARE_1 << channel) != 0 {
                // What the update brings is not known before it: look again there.
                next = next.min(self.counter.next_match(channel).min(update));
            }
        }
        next
    }

    /// Lets everything happen up to now.
    pub(super) fn catch_up(&mut self, now: u64) {
        while self.running() && self.counter.next_overflow() <= now {
            self.flag_matches(self.counter.matches_before_overflow());
            let counts = self.counter.overflow();
            if counts {
                self.overflowed(now);
            }
        }
        if self.running() {
            let matches = self.counter.count_to(now);
            self.flag_matches(matches);
        } else {
            self.counter.hold(now);
        }
    }

    /// The counter went from its highest value to zero.
    fn overflowed(&mut self, now: u64) {
        self.flag_matches(self.counter.matches_beyond_period());
        self.began = Some(self.counter.since());
        if self.control & CR1_OPM != 0 {
            self.control &= !CR1_CEN;
        }
        if self.control & CR1_UDIS == 0 {
            self.load();
            self.flag(UPDATE);
        }
        self.flag_matches(self.counter.matches_at_zero());
        // Whole periods that nobody watched are all alike.
        if self.running() && self.counter.skip_periods(now) {
            self.flag_matches(0xF);
        }
    }

    /// Takes what was preloaded.
    fn load(&mut self) {
        self.counter.load(self.prescaler, self.reload, self.compares);
    }

    fn flag(&mut self, bits: u32) {
        self.status |= bits;
        self.dma |= bits & (self.requests >> DMA_SHIFT);
    }

    /// `channels` has a bit for each channel that matched.
    fn flag_matches(&mut self, channels: u32) {
        let existing = channels & ((1 << self.kind.channels) - 1);
        if existing != 0 {
            self.flag(existing * COMPARE_1);
        }
    }
}
