//! All peripherals together, and what passes between them.

use super::adc::Adc;
use super::backup::Backup;
use super::crc::Crc;
use super::dma::Dma;
use super::exti::Exti;
use super::flash::Flash;
use super::gpio::Port;
use super::i2c::I2c;
use super::identity::Debug;
use super::iwdg::Iwdg;
use super::map::{Bus, Unit};
use super::pins::Output;
use super::pwr::Pwr;
use super::rcc::Rcc;
use super::slots::{SLOTS, slot};
use super::spi::Spi;
use super::syscfg::Syscfg;
use super::timer::Timer;
use super::timer::kinds::TIMERS;
use super::usart::{PORTS, Usart};
use super::{Inputs, Memory, ResetCause, Wiring};
use crate::time::NEVER;
use crate::violation::Violation;

/// What is not on the chip, for as long as one access or event takes.
pub(super) struct Outside<'a> {
    pub wiring: &'a mut dyn Wiring,
    pub memory: &'a mut dyn Memory,
}

pub(super) struct Chip {
    pub rcc: Rcc,
    pub pwr: Pwr,
    pub flash: Flash,
    pub ports: [Port; 9],
    pub syscfg: Syscfg,
    pub exti: Exti,
    pub dma: [Dma; 2],
    pub spi: Spi,
    pub i2c: I2c,
    pub adc: Adc,
    pub usarts: [Usart; 4],
    pub timers: [Timer; 14],
    pub iwdg: Iwdg,
    pub backup: Backup,
    pub crc: Crc,
    pub debug: Debug,
    /// The pins' levels, as they were told to EXTI.
    pub levels: [u16; 9],
    /// Timer outputs that reach a pin.
    pub outputs: Vec<Output>,
    /// SPI's pins were found to be switched to it.
    pub spi_connected: bool,
    /// Kept so that it need not be made anew for each event.
    pub inputs: Inputs,
    pub wanted_reset: Option<ResetCause>,
    /// Peripherals that changed since their next event and interrupts were last noted, as bits.
    pub changed: u32,
    pub next_events: [u64; SLOTS],
    pub lines: [u128; SLOTS],
    pub next: u64,
    pub requested: u128,
}

impl Chip {
    pub(super) fn new() -> Self {
        let mut chip = Self {
            rcc: Rcc::new(),
            pwr: Pwr::new(),
            flash: Flash::new(),
            ports: std::array::from_fn(Port::new),
            syscfg: Syscfg::new(),
            exti: Exti::new(),
            dma: std::array::from_fn(Dma::new),
            spi: Spi::new(),
            i2c: I2c::new(),
            adc: Adc::new(),
            usarts: std::array::from_fn(|_| Usart::new()),
            timers: std::array::from_fn(|index| Timer::new(&TIMERS[index])),
            iwdg: Iwdg::new(),
            backup: Backup::new(),
            crc: Crc::new(),
            debug: Debug::new(),
            levels: [0; 9],
            outputs: Vec::new(),
            spi_connected: false,
            inputs: Inputs::default(),
            wanted_reset: None,
            changed: 0,
            next_events: [NEVER; SLOTS],
            lines: [0; SLOTS],
            next: NEVER,
            requested: 0,
        };
        chip.distribute_clocks(0);
        chip.note_pins();
        chip.note_changes();
        chip
    }

    pub(super) fn reset(&mut self, now: u64, cause: ResetCause, wiring: &mut dyn Wiring) {
        self.stop_all_pwm(now, wiring);
        self.i2c.reset(now);
        self.tell_released(now, wiring);
        let mut fresh = Self::new();
        std::mem::swap(&mut fresh.rcc, &mut self.rcc);
        std::mem::swap(&mut fresh.flash, &mut self.flash);
        std::mem::swap(&mut fresh.ports, &mut self.ports);
        fresh.rcc.reset(cause);
        fresh.flash.reset(now);
        for (index, port) in fresh.ports.iter_mut().enumerate() {
            port.reset(index);
        }
        if cause != ResetCause::PowerOn {
            std::mem::swap(&mut fresh.backup, &mut self.backup);
        }
        *self = fresh;
        self.distribute_clocks(now);
        self.note_pins();
        self.changed = !0;
        self.note_changes();
    }

    pub(super) fn next_event(&self) -> u64 {
        self.next
    }

    pub(super) fn interrupts(&self) -> u128 {
        self.requested
    }

    pub(super) fn ticks_per_cycle(&self) -> u64 {
        self.rcc.clocks().core
    }

    pub(super) fn take_reset(&mut self) -> Option<ResetCause> {
        self.wanted_reset.take()
    }

    pub(super) fn stalled_until(&self) -> u64 {
        self.flash.stalled_until()
    }

    pub(super) fn brown_out_level(&self) -> u32 {
        self.flash.brown_out_level()
    }

    pub(super) fn store_to_flash(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<u32, Violation> {
        let becomes = self
            .flash
            .program(now, address, size, value, memory)
            .map_err(|refusal| refusal.during(Unit::Flash.name()))?;
        self.changed |= slot(Unit::Flash);
        self.note_changes();
        Ok(becomes)
    }

    /// Puts a peripheral back to its reset values, as its bit in RCC does.
    pub(super) fn reset_unit(&mut self, now: u64, unit: Unit) {
        match unit {
            Unit::Timer(index) => self.timers[index] = Timer::new(&TIMERS[index]),
            Unit::Usart(index) => self.usarts[index] = Usart::new(),
            Unit::Spi1 => self.spi = Spi::new(),
            Unit::I2c1 => self.i2c.reset(now),
            Unit::Adc1 => {
                self.adc = Adc::new();
                self.adc.set_cycle(self.rcc.clocks().apb2);
            }
            Unit::Gpio(index) => self.ports[index].reset(index),
            Unit::Dma(index) => self.dma[index] = Dma::new(index),
            Unit::Pwr => self.pwr = Pwr::new(),
            Unit::Syscfg => self.syscfg = Syscfg::new(),
            Unit::Crc => self.crc = Crc::new(),
            _ => {}
        }
        self.changed |= slot(unit);
    }

    /// After a change of clocks or gates: everybody's cycle.
    pub(super) fn distribute_clocks(&mut self, now: u64) {
        let clocks = self.rcc.clocks();
        for (index, timer) in self.timers.iter_mut().enumerate() {
            let cycle = match TIMERS[index].bus {
                Bus::Apb1 => clocks.apb1_timers,
                _ => clocks.apb2_timers,
            };
            let gate = (TIMERS[index].bus, TIMERS[index].gate);
            timer.set_clock(now, self.rcc.enabled(gate).then_some(cycle));
            self.changed |= slot(Unit::Timer(index));
        }
        for (usart, port) in self.usarts.iter_mut().zip(&PORTS) {
            usart.set_cycle(match port.bus {
                Bus::Apb1 => clocks.apb1,
                _ => clocks.apb2,
            });
        }
        self.spi.set_cycle(clocks.apb2);
        self.i2c.set_cycle(clocks.apb1);
        self.adc.set_cycle(clocks.apb2);
    }

    /// Refuses clocks that the flash, the regulator or the buses cannot follow.
    pub(super) fn check_clocks(&self) -> Result<(), Violation> {
        self.rcc
            .clocks()
            .check(self.flash.wait_states(), self.pwr.scale_1())
            .map_err(|refusal| refusal.during(Unit::Rcc.name()))
    }
}
