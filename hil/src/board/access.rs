//! Accesses of the processor to registers: who is meant, whether it can be reached, and what else
//! a write changes.

use super::chip::{Chip, Outside};
use super::gpio;
use super::identity;
use super::map::{self, Unit};
use super::rcc::Rcc;
use super::refusal::{Answer, misuse};
use super::slots::slot;
use crate::violation::Violation;

/// Registers' offsets in a block, without the byte in the word.
const OFFSET: u32 = 0x3FC;

impl Chip {
    pub(super) fn read(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        outside: &mut Outside,
    ) -> Result<u32, Violation> {
        let unit = self.reach(address, "read")?;
        self.see_conversions(now, unit, outside)?;
        let word = self
            .read_register(now, unit, address & OFFSET)
            .map_err(|refusal| refusal.of(unit.name(), address, "read"))?;
        if matches!(unit, Unit::Spi1 | Unit::I2c1 | Unit::Adc1 | Unit::Usart(_)) {
            // Reading status and data clears flags.
            self.changed |= slot(unit);
            self.settle(now, outside)?;
        }
        Ok(word >> (8 * (address & 3)) & mask(size))
    }

    pub(super) fn write(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        outside: &mut Outside,
    ) -> Result<(), Violation> {
        let unit = self.reach(address, "write")?;
        self.see_conversions(now, unit, outside)?;
        let refused = |refusal: super::refusal::Refusal| refusal.of(unit.name(), address, "write");
        let offset = address & OFFSET;
        let word = self.widen(now, unit, address, size, value).map_err(refused)?;
        if unit == Unit::Rcc {
            return self.write_rcc(now, address, word, outside);
        }
        let enabled_before = self.serial_directions(unit);
        self.write_register(now, unit, offset, word, outside)
            .map_err(refused)?;
        self.changed |= slot(unit);
        match unit {
            Unit::Gpio(port) => self.port_written(now, port, outside.wiring)?,
            Unit::Syscfg => self.note_pins(),
            Unit::Flash | Unit::Pwr => self.check_clocks()?,
            Unit::Timer(timer) => self.show_pwm(now, timer, outside.wiring)?,
            Unit::Usart(port) => self.check_serial_pins(port, enabled_before)?,
            Unit::Spi1 => self.check_spi_pins()?,
            Unit::I2c1 => self.i2c_written(now, outside.wiring)?,
            Unit::Iwdg if self.iwdg.running() => {
                self.rcc.start_lsi(now);
                self.changed |= slot(Unit::Rcc);
            }
            _ => {}
        }
        self.settle(now, outside)
    }

    /// The peripheral at an address, if its clock is on and it is not held in reset.
    fn reach(&self, address: u32, access: &'static str) -> Result<Unit, Violation> {
        let Some(unit) = map::unit(address) else {
            return Err(Violation::UnknownRegister {
                peripheral: map::unmodelled(address),
                address,
                access,
            });
        };
        let peripheral = unit.name();
        match unit.gate() {
            Some(gate) if !self.rcc.enabled(gate) => Err(Violation::ClockOff { peripheral, address }),
            Some(gate) if self.rcc.held_in_reset(gate) => Err(Violation::Misuse {
                peripheral,
                what: format!("it is used at {address:#010x} while RCC holds it in reset"),
            }),
            _ => Ok(unit),
        }
    }

    /// The word that a write of fewer bytes means.
    fn widen(&mut self, now: u64, unit: Unit, address: u32, size: u32, value: u32) -> Answer<u32> {
        if size == 4 {
            return Ok(value);
        }
        let bytes = value & mask(size);
        if unit.on_apb() {
            return Ok(if size == 2 {
                bytes * 0x1_0001
            } else {
                bytes * 0x101_0101
            });
        }
        let shift = 8 * (address & 3);
        let offset = address & OFFSET;
        match unit {
            Unit::Dma(_) | Unit::Crc => misuse("its registers are accessed by words only"),
            Unit::Gpio(_) if offset == gpio::SET_AND_RESET => Ok(bytes << shift),
            _ => {
                let old = self.read_register(now, unit, offset)?;
                Ok(old & !(mask(size) << shift) | bytes << shift)
            }
        }
    }

    fn read_register(&mut self, now: u64, unit: Unit, offset: u32) -> Answer<u32> {
        match unit {
            Unit::Timer(index) => self.timers[index].read(now, offset),
            Unit::Usart(index) => self.usarts[index].read(offset),
            Unit::Spi1 => self.spi.read(offset),
            Unit::I2c1 => self.i2c.read(now, offset),
            Unit::Adc1 => self.adc.read(offset),
            Unit::Gpio(index) => self.ports[index].read(offset),
            Unit::Dma(index) => self.dma[index].read(offset),
            Unit::Rcc => self.rcc.read(offset),
            Unit::Pwr => self.pwr.read(now, offset),
            Unit::Flash => self.flash.read(offset),
            Unit::Syscfg => self.syscfg.read(offset),
            Unit::Exti => self.exti.read(offset),
            Unit::Iwdg => self.iwdg.read(now, offset),
            Unit::Backup => self.backup.read(offset),
            Unit::Crc => self.crc.read(offset),
            Unit::Debug => self.debug.read(offset),
            Unit::Identity => identity::read_signature(offset),
        }
    }

    fn write_register(
        &mut self,
        now: u64,
        unit: Unit,
        offset: u32,
        value: u32,
        outside: &mut Outside,
    ) -> Answer<()> {
        let backup_writable = self.pwr.backup_writable();
        match unit {
            Unit::Timer(index) => self.timers[index].write(now, offset, value),
            Unit::Usart(index) => self.usarts[index].write(now, offset, value),
            Unit::Spi1 => self.spi.write(now, offset, value),
            Unit::I2c1 => self.i2c.write(now, offset, value),
            Unit::Adc1 => self.adc.write(now, offset, value),
            Unit::Gpio(index) => self.ports[index].write(offset, value),
            Unit::Dma(index) => self.dma[index].write(offset, value, outside.memory),
            Unit::Rcc => self.rcc.write(now, offset, value, backup_writable),
            Unit::Pwr => self.pwr.write(now, offset, value),
            Unit::Flash => self.flash.write(now, offset, value),
            Unit::Syscfg => self.syscfg.write(offset, value),
            Unit::Exti => self.exti.write(offset, value),
            Unit::Iwdg => self.iwdg.write(now, offset, value),
            Unit::Backup => self.backup.write(offset, value, backup_writable),
            Unit::Crc => self.crc.write(offset, value),
            Unit::Debug => self.debug.write(offset, value),
            Unit::Identity => misuse("it can only be read"),
        }
    }

    /// RCC changes others: it resets them, and gates and sets their clocks.
    fn write_rcc(
        &mut self,
        now: u64,
        address: u32,
        value: u32,
        outside: &mut Outside,
    ) -> Result<(), Violation> {
        let state = |rcc: &Rcc| (rcc.clocks(), rcc.gates);
        let before = state(&self.rcc);
        self.write_register(now, Unit::Rcc, address & OFFSET, value, outside)
            .map_err(|refusal| refusal.of(Unit::Rcc.name(), address, "write"))?;
        self.changed |= slot(Unit::Rcc);
        if before.1.resets != self.rcc.gates.resets {
            map::gated_units()
                .filter(|unit| unit.gate().is_some_and(|gate| self.rcc.held_in_reset(gate)))
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|unit| self.reset_unit(now, unit));
            self.tell_released(now, outside.wiring);
        }
        if before != state(&self.rcc) {
            self.clocks_changed(now, outside)?;
        }
        self.settle(now, outside)
    }

    /// Clocks, gates or resets are not what they were.
    pub(super) fn clocks_changed(&mut self, now: u64, outside: &mut Outside) -> Result<(), Violation> {
        self.check_clocks()?;
        self.distribute_clocks(now);
        for port in 0..self.ports.len() {
            self.tell_outputs(now, port, outside.wiring);
        }
        self.route_outputs(now, outside.wiring);
        self.note_pins();
        self.note_i2c_lines(now)?;
        for timer in 0..self.timers.len() {
            self.show_pwm(now, timer, outside.wiring)?;
        }
        Ok(())
    }
}

/// The bits of so many bytes.
fn mask(size: u32) -> u32 {
    match size {
        1 => 0xFF,
        2 => 0xFFFF,
        _ => 0xFFFF_FFFF,
    }
}
