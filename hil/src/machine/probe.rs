//! Counts what the calls of a function cost, without the exceptions that preempt them.

use super::Machine;
use super::blocks::{MARK_ENTRY, MARK_RETURN};
use super::bus::Bus;
use super::engine::Registers;
use super::inject::Target;
use crate::elf::ElfError;
use unicorn_engine::RegisterARM;

/// A function whose calls are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe(usize);

/// Least, mean and most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spread {
    /// Least.
    pub min: u64,
    /// Most.
    pub max: u64,
    /// Of all calls together.
    pub sum: u64,
}

impl Spread {
    fn add(&mut self, value: u64, first: bool) {
        self.min = if first { value } else { self.min.min(value) };
        self.max = self.max.max(value);
        self.sum += value;
    }
}

/// The calls of a function that returned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Calls {
    /// How many.
    pub count: u64,
    /// Instructions of a call, with those of the functions that it calls.
    pub instructions: Spread,
    /// Cycles of a call by the cost model, so an estimate.
    pub cycles: Spread,
}

impl Calls {
    /// Mean instructions of a call, 0 without any.
    pub fn mean_instructions(&self) -> f64 {
        self.instructions.sum as f64 / self.count.max(1) as f64
    }

    /// Mean cycles of a call, 0 without any.
    pub fn mean_cycles(&self) -> f64 {
        self.cycles.sum as f64 / self.count.max(1) as f64
    }

    fn add(&mut self, cost: Cost) {
        self.instructions.add(cost.instructions, self.count == 0);
        self.cycles.add(cost.cycles, self.count == 0);
        self.count += 1;
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    instructions: u64,
    cycles: u64,
}

impl Cost {
    fn since(self, earlier: Self) -> Self {
        Self {
            instructions: self.instructions - earlier.instructions,
            cycles: self.cycles - earlier.cycles,
        }
    }

    fn plus(self, more: Self) -> Self {
        Self {
            instructions: self.instructions + more.instructions,
            cycles: self.cycles + more.cycles,
        }
    }
}

/// A call that has not returned yet.
#[derive(Clone, Copy, Debug)]
struct Call {
    probe: usize,
    level: usize,
    return_address: u32,
    sp: u32,
    start: Cost,
}

/// All probes, and the nesting of exceptions as they see it.
#[derive(Debug, Default)]
pub(super) struct Probes {
    functions: Vec<(u32, Calls)>,
    calls: Vec<Call>,
    /// What is not the running level's own: cost of levels above it, and before it.
    others: Cost,
    /// For each preempted level: its `others`, and the total when it was preempted.
    preempted: Vec<(Cost, Cost)>,
}

impl Probes {
    pub fn reset(&mut self) {
        self.calls.clear();
        self.preempted.clear();
    }
}

impl<B: Bus + 'static> Machine<B> {
    /// Counts the calls of a function from now on.
    pub fn count(&mut self, function: impl Into<Target>) -> Result<Probe, ElfError> {
        let address = function.into().resolve(&self.elf)?;
        self.blocks.mark(address, MARK_ENTRY);
        self.probes.functions.push((address, Calls::default()));
        Ok(Probe(self.probes.functions.len() - 1))
    }

    /// What a probe has counted.
    pub fn calls(&self, probe: Probe) -> Calls {
        self.probes.functions[probe.0].1
    }

    fn total(&self) -> Cost {
        Cost {
            instructions: self.clock.instructions.get(),
            cycles: self.clock.cycles.get(),
        }
    }

    fn own(&self) -> Cost {
        self.total().since(self.probes.others)
    }

    /// A handler begins.
    pub(super) fn begin_level(&mut self) {
        let total = self.total();
        self.probes.preempted.push((self.probes.others, total));
        self.probes.others = Cost::default();
    }

    /// A handler is over.
    pub(super) fn end_level(&mut self) {
        let level = self.probes.preempted.len();
        while let Some(call) = self.probes.calls.pop_if(|call| call.level >= level) {
            self.unmark_return(call.return_address);
            if call.return_address >= 0xFFFF_FFE0 {
                self.finish(call);
            }
        }
        let total = self.total();
        if let Some((others, then)) = self.probes.preempted.pop() {
            self.probes.others = others.plus(total.since(then));
        }
    }

    /// A probed function begins.
    pub(super) fn enter_function(&mut self, address: u32) {
        let return_address = self.core.get(RegisterARM::LR) & !1;
        let (sp, level, start) = (
            self.core.get(RegisterARM::SP),
            self.probes.preempted.len(),
            self.own(),
        );
        for probe in 0..self.probes.functions.len() {
            if self.probes.functions[probe].0 == address {
                self.probes.calls.push(Call {
                    probe,
                    level,
                    return_address,
                    sp,
                    start,
                });
            }
        }
        if return_address < 0xFFFF_FFE0 {
            self.blocks.mark(return_address, MARK_RETURN);
        }
    }

    /// Perhaps a probed function returned to here.
    pub(super) fn return_to(&mut self, address: u32) {
        let (sp, level) = (self.core.get(RegisterARM::SP), self.probes.preempted.len());
        while let Some(call) = self
            .probes
            .calls
            .pop_if(|call| call.return_address == address && call.level == level && sp >= call.sp)
        {
            self.finish(call);
        }
        self.unmark_return(address);
    }

    fn unmark_return(&mut self, address: u32) {
        if self
            .probes
            .calls
            .iter()
            .all(|call| call.return_address != address)
        {
            self.blocks.unmark(address, MARK_RETURN);
        }
    }

    fn finish(&mut self, call: Call) {
        let cost = self.own().since(call.start);
        self.probes.functions[call.probe].1.add(cost);
    }
}
