//! What the hooks share with the machine: the bus, the system control space, and what the
//! firmware did wrong.

use super::bus::Bus;
use super::clock::Clock;
use super::engine::{self, Registers};
use super::nvic::SYS_TICK;
use super::scs::{SystemControl, scr};
use crate::board::Memory;
use crate::violation::Violation;
use std::cell::RefCell;
use unicorn_engine::{RegisterARM, Unicorn};

/// The private peripheral bus, without the debug unit that belongs to the microcontroller.
pub(super) const PRIVATE: u32 = 0xE000_0000;
const DEBUG_UNIT: u32 = 0xE004_2000;

/// Everything outside of the core.
#[derive(Debug)]
pub(super) struct System<B> {
    pub bus: B,
    pub control: SystemControl,
    /// Set by the first mistake; ends the run.
    pub violation: Option<Violation>,
    /// Stores into flash, to be done between two blocks: the engine runs from there.
    pub flash_writes: Vec<(u32, Vec<u8>)>,
    /// The machine wants to look up then, whatever happens.
    pub horizon: u64,
}

impl<B: Bus> System<B> {
    pub fn new(bus: B, debugger_attached: bool) -> Self {
        Self {
            bus,
            control: SystemControl::new(debugger_attached),
            violation: None,
            flash_writes: Vec::new(),
            horizon: 0,
        }
    }

    /// Lets everything happen that is due.
    pub fn advance(&mut self, core: &mut Unicorn<'_, ()>, clock: &Clock) {
        let now = clock.now.get();
        if now >= self.bus.next_event() {
            let mut memory = CoreMemory {
                core,
                flash_writes: &mut self.flash_writes,
            };
            if let Err(violation) = self.bus.advance(now, &mut memory) {
                self.violation.get_or_insert(violation);
            }
        }
        self.settle(clock);
    }

    /// Something may have changed: request lines, the clock, what is due next.
    pub fn settle(&mut self, clock: &Clock) {
        clock.set_ticks_per_cycle(self.bus.ticks_per_cycle());
        if self.control.systick.advance(clock.free_running()) {
            self.control.exceptions.pend(SYS_TICK);
        }
        self.control.exceptions.set_lines(self.bus.interrupts());
        if std::mem::take(&mut self.control.exceptions.newly_pending)
            && self.control.scr & scr::SEV_ON_PEND != 0
        {
            clock.event.set(true);
        }
        let systick = clock.when(self.control.systick.next());
        clock
            .due
            .set(self.bus.next_event().min(systick).min(self.horizon));
        if self.control.exceptions.changed
            || self.control.reset_requested
            || self.violation.is_some()
            || !self.flash_writes.is_empty()
            || self.bus.stalled_until() > clock.now.get()
        {
            clock.attention.set(true);
        }
    }

    /// The processor reads a register.
    pub fn read(&mut self, core: &mut Unicorn<'_, ()>, clock: &Clock, address: u32, size: u32) -> u32 {
        let result = if is_private(address) {
            let active = core.get(RegisterARM::IPSR) as usize;
            self.control.read(address, size, active, clock)
        } else {
            let mut memory = CoreMemory {
                core,
                flash_writes: &mut self.flash_writes,
            };
            self.bus.read(clock.now.get(), address, size, &mut memory)
        };
        let value = result.unwrap_or_else(|violation| {
            self.violation.get_or_insert(violation);
            0
        });
        self.settle(clock);
        value
    }

    /// The processor writes a register.
    pub fn write(&mut self, core: &mut Unicorn<'_, ()>, clock: &Clock, address: u32, size: u32, value: u32) {
        let result = if is_private(address) {
            self.control.write(address, size, value, clock)
        } else {
            let mut memory = CoreMemory {
                core,
                flash_writes: &mut self.flash_writes,
            };
            self.bus.write(clock.now.get(), address, size, value, &mut memory)
        };
        if let Err(violation) = result {
            self.violation.get_or_insert(violation);
        }
        self.settle(clock);
    }

    /// The processor stores into flash; false if it must not.
    pub fn program(
        &mut self,
        core: &mut Unicorn<'_, ()>,
        clock: &Clock,
        address: u32,
        size: u32,
        value: u32,
    ) -> bool {
        let mut memory = CoreMemory {
            core,
            flash_writes: &mut self.flash_writes,
        };
        match self
            .bus
            .store_to_flash(clock.now.get(), address, size, value, &mut memory)
        {
            Ok(value) => {
                self.flash_writes
                    .push((address, value.to_le_bytes()[..size as usize].to_vec()));
                self.settle(clock);
                true
            }
            Err(violation) => {
                self.violation.get_or_insert(violation);
                clock.attention.set(true);
                false
            }
        }
    }
}

fn is_private(address: u32) -> bool {
    address >= PRIVATE && !(DEBUG_UNIT..DEBUG_UNIT + 0x400).contains(&address)
}

/// Memory as the DMA controllers and the flash controller reach it.
pub(super) struct CoreMemory<'a, 'c> {
    pub core: &'a mut Unicorn<'c, ()>,
    pub flash_writes: &'a mut Vec<(u32, Vec<u8>)>,
}

impl Memory for CoreMemory<'_, '_> {
    fn read(&mut self, address: u32, bytes: &mut [u8]) {
        if !engine::load(self.core, address, bytes) {
            bytes.fill(0);
        }
    }

    fn write(&mut self, address: u32, bytes: &[u8]) {
        if engine::is_flash(address, bytes.len() as u32) {
            self.flash_writes.push((address, bytes.to_vec()));
        } else {
            engine::store(self.core, address, bytes);
        }
    }
}

/// For hooks: the system is never borrowed while the engine runs.
pub(super) type Shared<B> = std::rc::Rc<RefCell<System<B>>>;
