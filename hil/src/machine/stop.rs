//! Why a run ends before its time.

use crate::board::ResetCause;
use crate::time::SECOND;
use crate::violation::Violation;
use std::fmt;

/// Where the processor was, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Program counter. Where a register was used wrongly: beginning of the block of a few
    /// instructions that did it.
    pub pc: u32,
    /// Function of the program counter, with the offset in it.
    pub function: Option<String>,
    /// Link register.
    pub lr: u32,
    /// Function of the link register, with the offset in it.
    pub caller: Option<String>,
    /// Exception that was being handled, 0 for none.
    pub exception: usize,
    /// Virtual time in ticks.
    pub time: u64,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |name: &Option<String>| name.clone().unwrap_or_else(|| "nowhere known".into());
        write!(
            f,
            "at {:.6} s, pc {:#010x} in {}",
            self.time as f64 / SECOND as f64,
            self.pc,
            name(&self.function)
        )?;
        write!(f, ", lr {:#010x} in {}", self.lr, name(&self.caller))?;
        if self.exception != 0 {
            write!(f, ", handling exception {}", self.exception)?;
        }
        Ok(())
    }
}

/// Why a run ended before its time.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stop {
    /// The firmware did what it must not.
    #[error("{violation} {place}")]
    Violation {
        /// What it did.
        violation: Violation,
        /// Where.
        place: Box<Place>,
    },
    /// A fault in the HardFault or NMI handler, and no watchdog to end it.
    #[error("lockup, for ever: {place}")]
    Lockup {
        /// Where the processor locked up.
        place: Box<Place>,
    },
    /// Asleep or stalled for ever, and nothing will ever happen.
    #[error("asleep for ever: {place}")]
    AsleepForEver {
        /// Behind the instruction that sleeps.
        place: Box<Place>,
    },
    /// Power failed, as was asked for. A power cycle boots it again, on what the flash holds.
    #[error("power fails: {place}")]
    PowerFailure {
        /// Where the processor was.
        place: Box<Place>,
    },
    /// BKPT with a debugger attached.
    #[error("breakpoint: {place}")]
    Breakpoint {
        /// At the instruction.
        place: Box<Place>,
    },
    /// The engine gave up.
    #[error("the engine stops with {error}: {place}")]
    Engine {
        /// What it said.
        error: String,
        /// Where.
        place: Box<Place>,
    },
}

/// A reset during a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reset {
    /// Why.
    pub cause: ResetCause,
    /// Where the processor was.
    pub place: Place,
}

/// A fault in the HardFault or NMI handler: the processor stands still until a reset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lockup {
    /// Where the processor was.
    pub place: Place,
}
