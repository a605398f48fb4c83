//! What the block hook reads and writes for every block of instructions, in cells so that it is
//! fast: virtual time, the counters, and why to stop.

use super::engine::{Masks, Registers};
use crate::time::NEVER;
use std::cell::Cell;

/// Why the engine stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// Nothing said why: a WFI.
    Unsaid,
    /// Between two blocks: something is due or wants attention.
    Boundary,
    /// Before a block with a probe or an injection.
    Mark(u32),
    /// A WFE that found the event register clear.
    WaitForEvent,
    /// A branch to an EXC_RETURN value.
    ExceptionReturn,
    /// SVC.
    Supervisor,
    /// BKPT.
    Breakpoint,
    /// An instruction that does not exist.
    Undefined,
    /// An instruction in a state other than Thumb.
    InvalidState,
    /// A load from nowhere.
    Load(u32),
    /// A store to nowhere.
    Store(u32),
    /// A fetch of what cannot be executed.
    Fetch(u32),
    /// A store into flash that the bus refused.
    Refused,
}

/// Time, counters and reasons to stop, shared by the machine and its hooks.
#[derive(Debug)]
pub(super) struct Clock {
    /// Virtual time at the beginning of the block that runs.
    pub now: Cell<u64>,
    /// When the machine must look up from running instructions.
    pub due: Cell<u64>,
    /// The machine must look up at the next block.
    pub attention: Cell<bool>,
    /// An interrupt waits behind these masks: look up when they change.
    pub watched_masks: Cell<Option<Masks>>,
    /// The event register of WFE.
    pub event: Cell<bool>,
    /// Cycles in which the processor's clock ran, sleep excluded.
    pub cycles: Cell<u64>,
    /// Instructions executed, those skipped in an IT block included.
    pub instructions: Cell<u64>,
    /// Cost of the block that runs, to be added when it is over.
    block_cycles: Cell<u64>,
    block_instructions: Cell<u64>,
    /// First address of the block that runs.
    pub block: Cell<u32>,
    /// Address behind the block that runs.
    pub block_end: Cell<u32>,
    /// A marked block that may now run.
    pub passed: Cell<Option<u32>>,
    /// Why the engine stopped.
    pub cause: Cell<Cause>,
    ticks_per_cycle: Cell<u64>,
    /// A moment at which the free-running clock had counted so many cycles.
    reference: Cell<(u64, u64)>,
}

impl Clock {
    pub fn new(ticks_per_cycle: u64) -> Self {
        Self {
            now: Cell::new(0),
            due: Cell::new(0),
            attention: Cell::new(false),
            watched_masks: Cell::new(None),
            event: Cell::new(false),
            cycles: Cell::new(0),
            instructions: Cell::new(0),
            block_cycles: Cell::new(0),
            block_instructions: Cell::new(0),
            block: Cell::new(0),
            block_end: Cell::new(0),
            passed: Cell::new(None),
            cause: Cell::new(Cause::Unsaid),
            ticks_per_cycle: Cell::new(ticks_per_cycle),
            reference: Cell::new((0, 0)),
        }
    }

    /// The block is over: what it cost becomes time.
    pub fn finish_block(&self) -> u64 {
        self.instructions
            .set(self.instructions.get() + self.block_instructions.replace(0));
        self.spend(self.block_cycles.replace(0))
    }

    /// A block begins.
    pub fn begin_block(&self, address: u32, size: u32, instructions: u64, cycles: u64) {
        self.block.set(address);
        self.block_end.set(address.wrapping_add(size));
        self.block_instructions.set(instructions);
        self.block_cycles.set(cycles);
    }

    /// The processor worked for so many cycles.
    pub fn spend(&self, cycles: u64) -> u64 {
        self.cycles.set(self.cycles.get() + cycles);
        let now = self.now.get() + cycles * self.ticks_per_cycle.get();
        self.now.set(now);
        now
    }

    /// The processor stood still, its clock running, until `then`.
    pub fn stand_until(&self, then: u64) {
        let ticks = then.saturating_sub(self.now.get());
        self.cycles
            .set(self.cycles.get() + ticks / self.ticks_per_cycle.get());
        self.now.set(self.now.get() + ticks);
    }

    /// Whether the block hook has to stop the engine.
    pub fn must_stop(&self, now: u64, registers: &impl Registers) -> bool {
        now >= self.due.get()
            || self.attention.get()
            || self
                .watched_masks
                .get()
                .is_some_and(|masks| masks != registers.masks())
    }

    /// Cycles of the free-running clock, which counts in sleep too.
    pub fn free_running(&self) -> u64 {
        let (now, cycles) = self.reference.get();
        cycles + (self.now.get() - now) / self.ticks_per_cycle.get()
    }

    /// When the free-running clock will have counted so many cycles.
    pub fn when(&self, cycles: u64) -> u64 {
        let (then, counted) = self.reference.get();
        match cycles.checked_sub(counted) {
            Some(more) => more
                .checked_mul(self.ticks_per_cycle.get())
                .map_or(NEVER, |ticks| then + ticks),
            None => then,
        }
    }

    /// The processor's clock may have been switched to another frequency.
    pub fn set_ticks_per_cycle(&self, ticks: u64) {
        if ticks != self.ticks_per_cycle.get() {
            self.reference.set((self.now.get(), self.free_running()));
            self.ticks_per_cycle.set(ticks);
        }
    }
}
