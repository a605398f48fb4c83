//! What a test does to the program from outside: a function stalls, control goes elsewhere.

use super::Machine;
use super::blocks::{MARK_ENTRY, MARK_INJECTION, MARK_RETURN};
use super::bus::Bus;
use super::engine::Registers;
use crate::elf::{Elf, ElfError};
use std::fmt;
use unicorn_engine::RegisterARM;

/// A place in the program: a function's name, or an address at which a block begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// A function by its path, see [`Elf::find`].
    Function(String),
    /// An address: of a function, or of an instruction behind a branch.
    Address(u32),
}

impl Target {
    /// Its address.
    pub fn resolve(&self, elf: &Elf) -> Result<u32, ElfError> {
        match self {
            Self::Function(path) => elf.find(path).map(|symbol| symbol.address),
            Self::Address(address) => Ok(address & !1),
        }
    }
}

impl From<&str> for Target {
    fn from(path: &str) -> Self {
        Self::Function(path.into())
    }
}

impl From<u32> for Target {
    fn from(address: u32) -> Self {
        Self::Address(address)
    }
}

enum Action {
    /// Spins for so many ticks, by the number of the arrival.
    Stall(Box<dyn FnMut(u64) -> u64>),
    /// Goes on elsewhere, once.
    Jump(u32),
    /// Sets the stack pointer, once.
    SetSp(u32),
}

struct Injection {
    address: u32,
    arrivals: u64,
    action: Action,
}

/// A context that spins.
#[derive(Clone, Copy, Debug)]
struct Spinning {
    depth: u32,
    remaining: u64,
}

/// What is to be done at which address, and who is stalled.
#[derive(Default)]
pub(super) struct Injections {
    planned: Vec<Injection>,
    spinning: Vec<Spinning>,
}

impl fmt::Debug for Injections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Injections")
            .field("planned", &self.planned.len())
            .field("spinning", &self.spinning)
            .finish()
    }
}

impl Injections {
    /// The contexts are gone; what is planned stays.
    pub fn reset(&mut self) {
        self.spinning.clear();
    }

    /// The innermost context spun for so many ticks.
    pub fn spun(&mut self, ticks: u64) {
        if let Some(spinning) = self.spinning.last_mut()
            && spinning.remaining != u64::MAX
        {
            spinning.remaining -= ticks.min(spinning.remaining);
        }
        self.spinning.pop_if(|spinning| spinning.remaining == 0);
    }
}

impl<B: Bus + 'static> Machine<B> {
    /// When the program next reaches this place, its context spins there for so many ticks of its
    /// own time, `u64::MAX` for ever. More urgent contexts still preempt it.
    pub fn stall(&mut self, place: impl Into<Target>, ticks: u64) -> Result<(), ElfError> {
        self.stall_by(place, move |arrival| if arrival == 0 { ticks } else { 0 })
    }

    /// As [`Machine::stall`], each time: `ticks` says for how long at the n-th arrival from 0 on.
    pub fn stall_by(
        &mut self,
        place: impl Into<Target>,
        ticks: impl FnMut(u64) -> u64 + 'static,
    ) -> Result<(), ElfError> {
        self.plan(place.into(), Action::Stall(Box::new(ticks)))
    }

    /// When the program next reaches a place, it goes on at another one instead.
    pub fn jump(&mut self, place: impl Into<Target>, to: impl Into<Target>) -> Result<(), ElfError> {
        let to = to.into().resolve(&self.elf)?;
        self.plan(place.into(), Action::Jump(to))
    }

    /// When the program next reaches a place, its stack pointer is set.
    pub fn set_sp(&mut self, place: impl Into<Target>, sp: u32) -> Result<(), ElfError> {
        self.plan(place.into(), Action::SetSp(sp))
    }

    fn plan(&mut self, place: Target, action: Action) -> Result<(), ElfError> {
        let address = place.resolve(&self.elf)?;
        self.blocks.mark(address, MARK_INJECTION);
        self.injections.planned.push(Injection {
            address,
            arrivals: 0,
            action,
        });
        Ok(())
    }

    /// The program is about to run a marked block.
    pub(super) fn reach(&mut self, address: u32) {
        self.clock.passed.set(Some(address));
        if self.blocks.marked(address, MARK_RETURN) {
            self.return_to(address);
        }
        if self.blocks.marked(address, MARK_ENTRY) {
            self.enter_function(address);
        }
        if self.blocks.marked(address, MARK_INJECTION) {
            self.inject(address);
        }
    }

    fn inject(&mut self, address: u32) {
        let depth = self.system.borrow().control.exceptions.depth();
        let (core, clock, spinning) = (&mut self.core, &self.clock, &mut self.injections.spinning);
        self.injections.planned.retain_mut(|injection| {
            if injection.address != address {
                return true;
            }
            let arrival = injection.arrivals;
            injection.arrivals += 1;
            match &mut injection.action {
                Action::Stall(ticks) => {
                    let remaining = ticks(arrival);
                    if remaining != 0 {
                        spinning.push(Spinning { depth, remaining });
                    }
                    true
                }
                Action::Jump(to) => {
                    core.set(RegisterARM::PC, *to | 1);
                    clock.passed.set(None);
                    false
                }
                Action::SetSp(sp) => {
                    core.set(RegisterARM::SP, *sp);
                    false
                }
            }
        });
        if self
            .injections
            .planned
            .iter()
            .all(|injection| injection.address != address)
        {
            self.blocks.unmark(address, MARK_INJECTION);
        }
    }

    /// Until when the running context has to spin, if it has to.
    pub(super) fn spin_until(&self) -> Option<u64> {
        let spinning = self.injections.spinning.last()?;
        let depth = self.system.borrow().control.exceptions.depth();
        (spinning.depth == depth).then(|| self.now().saturating_add(spinning.remaining))
    }
}
