//! The processor of the emulated STM32F405: a Cortex-M4F that runs an unmodified program.
//!
//! Instructions are executed by the crate `unicorn-engine`; everything that makes them a
//! microcontroller is here: exceptions and their priorities, sleep, faults, resets, and virtual
//! time by a cost in cycles for each block of instructions, which is an estimate. Peripherals are
//! behind the trait [`Bus`].
//!
//! Where this machine differs from silicon:
//! - an exception always pushes the long frame, so that a stack is used at least as much as there;
//! - code runs from flash only, also where silicon would run it from SRAM;
//! - unaligned LDRD, LDM and VLDR do not fault, nor does floating point without CPACR;
//! - there is no MPU, and no unprivileged thread;
//! - STREX fails by value: an exception in between does not clear the exclusive monitor;
//! - registers see the time at which their block of instructions began.

mod blocks;
mod bus;
mod clock;
mod cost;
mod engine;
mod exception;
mod fault;
mod hooks;
mod inject;
mod load;
mod log;
mod nvic;
mod probe;
mod run;
mod scs;
mod stop;
mod system;
mod systick;

pub use bus::Bus;
pub use inject::Target;
pub use load::Load;
pub use log::LogChunk;
pub use nvic::EXCEPTIONS;
pub use probe::{Calls, Probe, Spread};
pub use stop::{Lockup, Place, Reset, Stop};

use crate::board::ResetCause;
use crate::elf::Elf;
use blocks::Blocks;
use clock::Clock;
use engine::{Core, Registers};
use inject::Injections;
use log::LogTap;
use probe::Probes;
use std::cell::{RefCell, RefMut};
use std::rc::Rc;
use std::sync::Arc;
use system::{Shared, System};
use unicorn_engine::RegisterARM;

/// What the processor is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Running,
    /// In WFI.
    AsleepForInterrupt,
    /// In WFE.
    AsleepForEvent,
    /// After a fault in the HardFault or NMI handler.
    Lockup,
}

/// How a machine is set up.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// A debugger is attached: BKPT ends the run instead of faulting.
    pub debugger_attached: bool,
}

/// Why a machine could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MachineError {
    /// The engine refused.
    #[error("the engine says {0}")]
    Engine(String),
    /// The program has bytes outside of flash.
    #[error("the program has {size} bytes at {address:#010x}, which is not in flash")]
    Segment {
        /// Where they should go.
        address: u32,
        /// How many they are.
        size: usize,
    },
}

/// A microcontroller that runs a program in virtual time.
pub struct Machine<B: Bus + 'static> {
    core: Core,
    clock: Rc<Clock>,
    blocks: Rc<Blocks>,
    system: Shared<B>,
    elf: Arc<Elf>,
    options: Options,
    state: State,
    /// The exception that is being handled, 0 for none.
    current: usize,
    load: Load,
    probes: Probes,
    injections: Injections,
    log: LogTap,
    /// End of the run.
    until: u64,
    resets: Vec<Reset>,
    lockups: Vec<Lockup>,
    trace: Trace,
}

impl<B: Bus + 'static> Machine<B> {
    /// A machine with this program in its flash, at power-on.
    pub fn new(bus: B, elf: Arc<Elf>, options: Options) -> Result<Self, MachineError> {
        let failed = |error| MachineError::Engine(format!("{error:?}"));
        let mut core = engine::new().map_err(failed)?;
        let clock = Rc::new(Clock::new(bus.ticks_per_cycle()));
        let blocks = Rc::new(Blocks::new());
        let system = Rc::new(RefCell::new(System::new(bus, options.debugger_attached)));
        hooks::install(&mut core, &system, &clock, &blocks).map_err(failed)?;
        for (address, bytes) in &elf.segments {
            let size = bytes.len();
            if !engine::is_flash(*address, size as u32) {
                return Err(MachineError::Segment {
                    address: *address,
                    size,
                });
            }
            engine::store(&mut core, *address, bytes);
            hooks::watch_send_event(&mut core, &clock, *address, bytes).map_err(failed)?;
        }
        let log = LogTap::new(&elf);
        let mut machine = Self {
            core,
            clock,
            blocks,
            system,
            elf,
            options,
            state: State::Running,
            current: 0,
            load: Load::default(),
            probes: Probes::default(),
            injections: Injections::default(),
            log,
            until: 0,
            resets: Vec::new(),
            lockups: Vec::new(),
            trace: Trace::default(),
        };
        machine.reset_core();
        Ok(machine)
    }

    /// Virtual time in ticks.
    pub fn now(&self) -> u64 {
        self.clock.now.get()
    }

    /// The peripherals. What is changed here takes effect when the machine runs on.
    pub fn bus(&self) -> RefMut<'_, B> {
        RefMut::map(self.system.borrow_mut(), |system| &mut system.bus)
    }

    /// The program.
    pub fn elf(&self) -> &Elf {
        &self.elf
    }

    /// Instructions executed so far.
    pub fn instructions(&self) -> u64 {
        self.clock.instructions.get()
    }

    /// Time spent by priority level, up to now.
    pub fn load(&mut self) -> &Load {
        self.account();
        &self.load
    }

    /// Resets so far, in order.
    pub fn resets(&self) -> &[Reset] {
        &self.resets
    }

    /// Lockups so far, in order.
    pub fn lockups(&self) -> &[Lockup] {
        &self.lockups
    }

    /// A number that is equal for equal runs: of each exception's entry and return, where and when.
    pub fn trace_hash(&self) -> u64 {
        self.trace.0
    }

    /// Reads memory as the processor would, RAM and flash only.
    pub fn read_memory(&self, address: u32, bytes: &mut [u8]) -> bool {
        engine::load(&self.core, address, bytes)
    }

    /// Reads a word of memory.
    pub fn read_word(&self, address: u32) -> Option<u32> {
        engine::load_word(&self.core, address)
    }

    /// Writes memory from outside, without any time passing.
    pub fn write_memory(&mut self, address: u32, bytes: &[u8]) -> bool {
        engine::store(&mut self.core, address, bytes)
    }

    /// Switches the power off and on: RAM is lost.
    pub fn power_cycle(&mut self) {
        self.cut_log();
        engine::scramble(&mut self.core);
        self.reset(ResetCause::PowerOn);
    }

    /// Resets the microcontroller. RAM keeps its content.
    pub fn reset(&mut self, cause: ResetCause) {
        self.account();
        let place = self.place(self.core.get(RegisterARM::PC));
        self.resets.push(Reset { cause, place });
        self.cut_log();
        {
            let mut system = self.system.borrow_mut();
            system.control = scs::SystemControl::new(self.options.debugger_attached);
            system.bus.reset(self.clock.now.get(), cause);
        }
        self.reset_core();
    }

    fn reset_core(&mut self) {
        self.state = State::Running;
        self.current = 0;
        self.clock.event.set(false);
        self.probes.reset();
        self.injections.reset();
        engine::reset(&mut self.core);
        self.system.borrow_mut().settle(&self.clock);
    }

    fn place(&self, pc: u32) -> Place {
        let lr = self.core.get(RegisterARM::LR);
        Place {
            pc,
            function: self.elf.name_of(pc),
            lr,
            caller: self.elf.name_of(lr.wrapping_sub(1)),
            exception: self.current,
            time: self.now(),
        }
    }

    /// Runs `act` with the system and its memory.
    fn with_system<R>(&mut self, act: impl FnOnce(&mut System<B>, &mut Core, &Clock) -> R) -> R {
        act(&mut self.system.borrow_mut(), &mut self.core, &self.clock)
    }

    /// What was stored into flash since the last block becomes true.
    fn program_flash(&mut self) {
        let writes = std::mem::take(&mut self.system.borrow_mut().flash_writes);
        for (address, bytes) in writes {
            engine::store(&mut self.core, address, &bytes);
            self.blocks.forget(address, bytes.len() as u32);
        }
    }
}

/// A hash (FNV-1a) of what happened when.
#[derive(Clone, Copy, Debug)]
struct Trace(u64);

impl Default for Trace {
    fn default() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }
}

impl Trace {
    fn note(&mut self, now: u64, exception: usize, pc: u32) {
        for word in [now, exception as u64, pc.into()] {
            self.0 = (self.0 ^ word).wrapping_mul(0x100_0000_01B3);
        }
    }
}
