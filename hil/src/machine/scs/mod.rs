//! The System Control Space: registers of the NVIC, the system control block, SysTick and the
//! debug unit, as the Armv7-M Architecture Reference Manual (DDI 0403) lists them.

mod write;

use crate::machine::clock::Clock;
use crate::machine::nvic::{
    BUS_FAULT, Exceptions, FIRST_INTERRUPT, INTERRUPTS, MEM_MANAGE, NMI, PEND_SV, SV_CALL, SYS_TICK, Set,
    USAGE_FAULT,
};
use crate::machine::systick::SysTick;
use crate::violation::Violation;

const NAME: &str = "system control space";
const KEY: u32 = 0x05FA;
/// Cortex-M4 r0p1, as on the F405.
const CPUID: u32 = 0x410F_C241;
const ASPEN_LSPEN: u32 = 0xC000_0000;
const STKALIGN: u32 = 1 << 9;
/// Of the DWT's control register.
const CYCCNTENA: u32 = 1;
/// Of DEMCR.
const TRCENA: u32 = 1 << 24;

/// Bits of the system control register.
pub(super) mod scr {
    pub const SLEEP_ON_EXIT: u32 = 1 << 1;
    pub const SLEEP_DEEP: u32 = 1 << 2;
    pub const SEV_ON_PEND: u32 = 1 << 4;
}

/// Its registers.
#[derive(Clone, Debug)]
pub(super) struct SystemControl {
    pub exceptions: Exceptions,
    pub systick: SysTick,
    pub vtor: u32,
    pub scr: u32,
    pub ccr: u32,
    /// Enable bits of SHCSR.
    pub handlers: u32,
    pub cfsr: u32,
    pub hfsr: u32,
    pub mmfar: u32,
    pub bfar: u32,
    pub fpcar: u32,
    pub fpdscr: u32,
    pub reset_requested: bool,
    pub debugger_attached: bool,
    cpacr: u32,
    fpccr: u32,
    demcr: u32,
    dwt_control: u32,
    cycle_offset: u32,
}

impl SystemControl {
    pub fn new(debugger_attached: bool) -> Self {
        Self {
            exceptions: Exceptions::new(),
            systick: SysTick::default(),
            vtor: 0,
            scr: 0,
            ccr: STKALIGN,
            handlers: 0,
            cfsr: 0,
            hfsr: 0,
            mmfar: 0,
            bfar: 0,
            fpcar: 0,
            fpdscr: 0,
            reset_requested: false,
            debugger_attached,
            cpacr: 0,
            fpccr: ASPEN_LSPEN,
            demcr: 0,
            dwt_control: 0x4000_0000,
            cycle_offset: 0,
        }
    }

    /// Reads a register or a part of one.
    pub fn read(&mut self, address: u32, size: u32, active: usize, clock: &Clock) -> Result<u32, Violation> {
        let word = self
            .read_word(address & !3, active, clock)
            .ok_or_else(|| unknown(address, "read"))?;
        let part = word >> (8 * (address & 3));
        Ok(if size < 4 {
            part & ((1 << (8 * size)) - 1)
        } else {
            part
        })
    }

    fn read_word(&mut self, address: u32, active: usize, clock: &Clock) -> Option<u32> {
        Some(match address {
            0xE000_1000 => self.dwt_control,
            0xE000_1004 => self.cycle_count(clock),
            0xE000_E004 => INTERRUPTS.div_ceil(32) as u32 - 1,
            0xE000_E010 => self.systick.read_control(),
            0xE000_E014 => self.systick.read_reload(),
            0xE000_E018 => self.systick.read_value(clock.free_running()),
            // SYST_CALIB: a millisecond of 10.5 MHz
            0xE000_E01C => 0x4000_2904,
            0xE000_E100..0xE000_E10C | 0xE000_E180..0xE000_E18C => {
                self.exceptions.read(Set::Enabled, first(address))
            }
            0xE000_E200..0xE000_E20C | 0xE000_E280..0xE000_E28C => {
                self.exceptions.read(Set::Pending, first(address))
            }
            0xE000_E300..0xE000_E30C => self.exceptions.read(Set::Active, first(address)),
            0xE000_E400..0xE000_E454 | 0xE000_ED18..0xE000_ED24 => self.read_priorities(address),
            0xE000_ED00 => CPUID,
            0xE000_ED04 => self.interrupt_state(active),
            0xE000_ED08 => self.vtor,
            0xE000_ED0C => 0xFA05_0000 | u32::from(self.exceptions.group()) << 8,
            0xE000_ED10 => self.scr,
            0xE000_ED14 => self.ccr,
            0xE000_ED24 => self.handlers | self.handler_state(),
            0xE000_ED28 => self.cfsr,
            0xE000_ED2C => self.hfsr,
            0xE000_ED34 => self.mmfar,
            0xE000_ED38 => self.bfar,
            // MPU_TYPE: this machine has none
            0xE000_ED90 | 0xE000_ED94 => 0,
            0xE000_ED88 => self.cpacr,
            0xE000_EDF0 => u32::from(self.debugger_attached),
            0xE000_EDFC => self.demcr,
            0xE000_EF34 => self.fpccr,
            0xE000_EF38 => self.fpcar,
            0xE000_EF3C => self.fpdscr,
            0xE000_EF40 => 0x1011_0021,
            0xE000_EF44 => 0x1100_0011,
            _ => return None,
        })
    }

    fn read_priorities(&self, address: u32) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|i| {
            self.exceptions.priority(numbered(address + i as u32))
        }))
    }

    fn interrupt_state(&self, active: usize) -> u32 {
        let pending = |number| u32::from(self.exceptions.is_pending(number));
        active as u32
            | u32::from(self.exceptions.depth() <= 1) << 11
            | (self.exceptions.first_pending().unwrap_or(0) as u32) << 12
            | u32::from(self.exceptions.interrupt_pending()) << 22
            | pending(SYS_TICK) << 26
            | pending(PEND_SV) << 28
            | pending(NMI) << 31
    }

    fn handler_state(&self) -> u32 {
        let active = [
            (MEM_MANAGE, 0),
            (BUS_FAULT, 1),
            (USAGE_FAULT, 3),
            (SV_CALL, 7),
            (PEND_SV, 10),
            (SYS_TICK, 11),
        ];
        let pending = [
            (USAGE_FAULT, 12),
            (MEM_MANAGE, 13),
            (BUS_FAULT, 14),
            (SV_CALL, 15),
        ];
        active
            .iter()
            .map(|&(number, bit)| u32::from(self.exceptions.is_active(number)) << bit)
            .sum::<u32>()
            | pending
                .iter()
                .map(|&(number, bit)| u32::from(self.exceptions.is_pending(number)) << bit)
                .sum::<u32>()
    }

    fn counts_cycles(&self) -> bool {
        self.dwt_control & CYCCNTENA != 0 && self.demcr & TRCENA != 0
    }

    /// CYCCNT counts while the processor's clock runs, which in sleep it does not.
    fn cycle_count(&self, clock: &Clock) -> u32 {
        if self.counts_cycles() {
            (clock.cycles.get() as u32).wrapping_add(self.cycle_offset)
        } else {
            self.cycle_offset
        }
    }

    /// Whether a configurable fault has its own handler enabled.
    pub fn handler_enabled(&self, number: usize) -> bool {
        match number {
            MEM_MANAGE => self.handlers >> 16 & 1 != 0,
            BUS_FAULT => self.handlers >> 17 & 1 != 0,
            USAGE_FAULT => self.handlers >> 18 & 1 != 0,
            _ => true,
        }
    }
}

/// First interrupt of a set register.
fn first(address: u32) -> usize {
    (address as usize & 0x7F) * 8
}

/// Number of the exception with its priority in this byte.
fn numbered(address: u32) -> usize {
    match address {
        0xE000_ED18..0xE000_ED24 => (address - 0xE000_ED18) as usize + 4,
        _ => (address - 0xE000_E400) as usize + FIRST_INTERRUPT,
    }
}

fn unknown(address: u32, access: &'static str) -> Violation {
    Violation::UnknownRegister {
        peripheral: NAME,
        address,
        access,
    }
}

fn misuse(what: String) -> Violation {
    Violation::Misuse {
        peripheral: NAME,
        what,
    }
}

#[cfg(test)]
mod tests;
