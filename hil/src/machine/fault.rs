//! Faults: what they leave in the status registers, and which exception they raise.

use super::nvic::{BUS_FAULT, HARD_FAULT, MEM_MANAGE, SV_CALL, USAGE_FAULT};
use super::scs::SystemControl;

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A load from nowhere.
    Load(u32),
    /// A store to nowhere. Silicon often notices later and says "imprecise"; here it is precise.
    Store(u32),
    /// A fetch of what cannot be executed.
    Fetch(u32),
    /// No such instruction.
    Undefined,
    /// Not in Thumb state.
    InvalidState,
    /// An EXC_RETURN that does not fit.
    InvalidReturn,
    /// The frame of an exception could not be pushed.
    Stacking,
    /// The frame of an exception could not be popped.
    Unstacking,
    /// A vector could not be read.
    Vector,
    /// BKPT without a debugger.
    Breakpoint,
    /// SVC where its exception cannot be taken.
    Supervisor,
}

mod cfsr {
    pub const IACCVIOL: u32 = 1;
    pub const IBUSERR: u32 = 1 << 8;
    pub const PRECISERR: u32 = 1 << 9;
    pub const UNSTKERR: u32 = 1 << 11;
    pub const STKERR: u32 = 1 << 12;
    pub const BFARVALID: u32 = 1 << 15;
    pub const UNDEFINSTR: u32 = 1 << 16;
    pub const INVSTATE: u32 = 1 << 17;
    pub const INVPC: u32 = 1 << 18;
}

mod hfsr {
    pub const VECTTBL: u32 = 1 << 1;
    pub const FORCED: u32 = 1 << 30;
    pub const DEBUGEVT: u32 = 1 << 31;
}

impl Fault {
    /// Peripherals, devices and the private peripheral bus can never be executed.
    fn is_execute_never(address: u32) -> bool {
        matches!(address >> 29, 2 | 5..=7)
    }

    fn exception(self) -> usize {
        match self {
            Self::Fetch(address) if Self::is_execute_never(address) => MEM_MANAGE,
            Self::Load(_) | Self::Store(_) | Self::Fetch(_) | Self::Stacking | Self::Unstacking => BUS_FAULT,
            Self::Undefined | Self::InvalidState | Self::InvalidReturn => USAGE_FAULT,
            Self::Vector | Self::Breakpoint => HARD_FAULT,
            Self::Supervisor => SV_CALL,
        }
    }

    fn configurable_status(self) -> u32 {
        match self {
            Self::Load(_) | Self::Store(_) => cfsr::PRECISERR | cfsr::BFARVALID,
            Self::Fetch(address) if Self::is_execute_never(address) => cfsr::IACCVIOL,
            Self::Fetch(_) => cfsr::IBUSERR,
            Self::Undefined => cfsr::UNDEFINSTR,
            Self::InvalidState => cfsr::INVSTATE,
            Self::InvalidReturn => cfsr::INVPC,
            Self::Stacking => cfsr::STKERR,
            Self::Unstacking => cfsr::UNSTKERR,
            Self::Vector | Self::Breakpoint | Self::Supervisor => 0,
        }
    }

    /// Notes the fault in the status registers. The exception that it raises when the processor
    /// executes at this priority; none if that is a lockup.
    pub fn note(self, control: &mut SystemControl, priority: i16) -> Option<usize> {
        control.cfsr |= self.configurable_status();
        if let Self::Load(address) | Self::Store(address) = self {
            control.bfar = address;
        }
        match self {
            Self::Vector => control.hfsr |= hfsr::VECTTBL,
            Self::Breakpoint => control.hfsr |= hfsr::DEBUGEVT,
            _ => {}
        }
        if priority < 0 {
            return None;
        }
        let number = self.exception();
        if number == HARD_FAULT {
            return Some(HARD_FAULT);
        }
        if control.handler_enabled(number) && control.exceptions.preemption_priority(number) < priority {
            return Some(number);
        }
        control.hfsr |= hfsr::FORCED;
        Some(HARD_FAULT)
    }
}
