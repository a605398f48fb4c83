//! Writes to the system control space.

use super::{CYCCNTENA, KEY, SystemControl, first, misuse, numbered, unknown};
use crate::machine::clock::Clock;
use crate::machine::nvic::{FIRST_INTERRUPT, INTERRUPTS, NMI, PEND_SV, SYS_TICK, Set};
use crate::violation::Violation;

impl SystemControl {
    /// Writes a register, or a part of one that may be written so.
    pub fn write(&mut self, address: u32, size: u32, value: u32, clock: &Clock) -> Result<(), Violation> {
        let parts = matches!(address, 0xE000_E400..0xE000_E454 | 0xE000_ED18..0xE000_ED24);
        if parts {
            for (i, byte) in value.to_le_bytes().into_iter().take(size as usize).enumerate() {
                self.exceptions.set_priority(numbered(address + i as u32), byte);
            }
            return Ok(());
        }
        if matches!(address, 0xE000_ED28..0xE000_ED2C) {
            self.cfsr &= !(value << (8 * (address & 3)));
            return Ok(());
        }
        if size != 4 {
            return Err(misuse(format!(
                "write of {size} bytes to the word at {address:#010x}"
            )));
        }
        self.write_word(address, value, clock)
    }

    fn write_word(&mut self, address: u32, value: u32, clock: &Clock) -> Result<(), Violation> {
        match address {
            0xE000_1000 => {
                let count = self.cycle_count(clock);
                self.dwt_control = self.dwt_control & !CYCCNTENA | value & CYCCNTENA;
                self.set_cycle_count(count, clock);
            }
            0xE000_1004 => self.set_cycle_count(value, clock),
            // Its lock on the DWT, which the F405 ignores from software's side
            0xE000_1FB0 => {}
            0xE000_E010 => self.systick.write_control(clock.free_running(), value),
            0xE000_E014 => self.systick.write_reload(value),
            0xE000_E018 => self.systick.write_value(clock.free_running()),
            0xE000_E100..0xE000_E10C => self.exceptions.write(Set::Enabled, first(address), value, true),
            0xE000_E180..0xE000_E18C => self.exceptions.write(Set::Enabled, first(address), value, false),
            0xE000_E200..0xE000_E20C => self.exceptions.write(Set::Pending, first(address), value, true),
            0xE000_E280..0xE000_E28C => self.exceptions.write(Set::Pending, first(address), value, false),
            0xE000_ED04 => self.set_interrupt_state(value),
            0xE000_ED08 => self.vtor = value & !0x7F,
            0xE000_ED0C => return self.set_application_control(value),
            0xE000_ED10 => self.scr = value & 0x16,
            0xE000_ED14 => return self.set_configuration(value),
            0xE000_ED24 => self.handlers = value & 0x0007_0000,
            0xE000_ED2C => self.hfsr &= !value,
            0xE000_ED34 => self.mmfar = value,
            0xE000_ED38 => self.bfar = value,
            0xE000_ED88 => self.cpacr = value & 0x00F0_0000,
            0xE000_EDF0 => {}
            0xE000_EDFC => {
                let count = self.cycle_count(clock);
                self.demcr = value;
                self.set_cycle_count(count, clock);
            }
            0xE000_EF00 if (value as usize) < INTERRUPTS => {
                self.exceptions.pend(FIRST_INTERRUPT + value as usize);
            }
            0xE000_EF34 => self.fpccr = value,
            0xE000_EF38 => self.fpcar = value,
            0xE000_EF3C => self.fpdscr = value & 0x07C0_0000,
            _ => return Err(unknown(address, "write")),
        }
        Ok(())
    }

    fn set_cycle_count(&mut self, count: u32, clock: &Clock) {
        self.cycle_offset = if self.counts_cycles() {
            count.wrapping_sub(clock.cycles.get() as u32)
        } else {
            count
        };
    }

    fn set_interrupt_state(&mut self, value: u32) {
        for (number, set, clear) in [(PEND_SV, 28, 27), (SYS_TICK, 26, 25)] {
            if value >> set & 1 != 0 {
                self.exceptions.pend(number);
            }
            if value >> clear & 1 != 0 {
                self.exceptions.unpend(number);
            }
        }
        if value >> 31 != 0 {
            self.exceptions.pend(NMI);
        }
    }

    fn set_application_control(&mut self, value: u32) -> Result<(), Violation> {
        if value >> 16 != KEY {
            return Err(misuse(format!("AIRCR written without its key: {value:#010x}")));
        }
        self.exceptions.set_group((value >> 8) as u8);
        self.reset_requested |= value & 0b100 != 0;
        Ok(())
    }

    fn set_configuration(&mut self, value: u32) -> Result<(), Violation> {
        // DIV_0_TRP and UNALIGN_TRP: the engine would not trap
        if value & 0x18 != 0 {
            return Err(misuse(format!(
                "CCR = {value:#x} sets a trap that this machine does not have"
            )));
        }
        self.ccr = value & 0x303;
        Ok(())
    }
}
