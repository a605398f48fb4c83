//! The microcontroller's peripherals, as the processor and the pins see them.
//!
//! A [`Board`] is an STM32F405 without its processor: registers on one side, pins on the other,
//! and virtual time. What the reference manual (RM0090) forbids or leaves open is refused as a
//! [`Violation`], and so is what is not modelled: a firmware that runs here uses nothing else.

mod access;
mod adc;
mod alternate;
mod backup;
mod chip;
mod crc;
mod dma;
mod events;
mod exti;
mod flash;
mod flash_options;
mod gpio;
mod i2c;
mod identity;
mod iwdg;
pub mod line;
mod map;
mod pins;
mod power_cut;
mod pwr;
mod rcc;
mod refusal;
mod slots;
mod spi;
mod syscfg;
mod timer;
mod usart;
pub mod wiring;

use crate::machine::Bus;
use crate::violation::Violation;
use chip::{Chip, Outside};
pub use line::{Format, Frame};
pub use wiring::{I2cCondition, Inputs, Pin, PwmPulse, Usart, Wiring};

/// The processor's memory, as the DMA controllers reach it.
pub trait Memory {
    /// Reads bytes from flash or SRAM.
    fn read(&mut self, address: u32, bytes: &mut [u8]);
    /// Writes bytes to SRAM, or to flash where the flash controller itself erases or programs.
    fn write(&mut self, address: u32, bytes: &[u8]);
}

/// Why the microcontroller starts, as `RCC_CSR` will say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// Power came on.
    PowerOn,
    /// The reset pin.
    Pin,
    /// The firmware asked for it (`AIRCR.SYSRESETREQ`).
    Software,
    /// The independent watchdog was not fed.
    IndependentWatchdog,
}

/// The board: the microcontroller's peripherals and what is wired to its pins.
///
/// Time never goes back: each call's `now` is at least that of the calls before it. A reset lets pins
/// float, so PWM stops; the flags in `RCC_CSR`, the backup domain and option bytes stay, except that
/// power-on clears the first two.
pub struct Board<W: Wiring> {
    /// What is on the other side of the pins.
    pub wiring: W,
    chip: Chip,
}

impl<W: Wiring> Board<W> {
    /// A board as after power-on.
    pub fn new(wiring: W) -> Self {
        let chip = Chip::new();
        Self { wiring, chip }
    }

    /// The brown-out level in force, as in `FLASH_OPTCR.BOR_LEV`: 0 is level 3, the highest; 3 is
    /// off.
    pub fn brown_out_level(&self) -> u32 {
        self.chip.brown_out_level()
    }

    /// Operations of the flash that have begun so far: programmed units and erasures.
    pub fn flash_operations(&self) -> u64 {
        self.chip.flash.power.operations()
    }

    /// Power fails in the middle of this operation of the flash, of those that
    /// [`Self::flash_operations`] counts: 0 is the first. The run stops there. What was going on is
    /// left half done, once the board is reset with the cause that power came on.
    pub fn cut_power_at(&mut self, operation: u64) {
        self.chip.flash.power.set(operation);
    }

    fn split<'a>(&'a mut self, memory: &'a mut dyn Memory) -> (&'a mut Chip, Outside<'a>) {
        let wiring = &mut self.wiring;
        (&mut self.chip, Outside { wiring, memory })
    }
}

impl<W: Wiring> Bus for Board<W> {
    fn reset(&mut self, now: u64, cause: ResetCause) {
        self.chip.reset(now, cause, &mut self.wiring);
    }

    fn read(&mut self, now: u64, address: u32, size: u32, memory: &mut dyn Memory) -> Result<u32, Violation> {
        self.advance(now, memory)?;
        let (chip, mut outside) = self.split(memory);
        chip.read(now, address, size, &mut outside)
    }

    fn write(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<(), Violation> {
        self.advance(now, memory)?;
        let (chip, mut outside) = self.split(memory);
        chip.write(now, address, size, value, &mut outside)
    }

    fn advance(&mut self, now: u64, memory: &mut dyn Memory) -> Result<(), Violation> {
        loop {
            let next = self.next_event();
            if next > now {
                return Ok(());
            }
            let (chip, mut outside) = self.split(memory);
            chip.advance(next, &mut outside)?;
        }
    }

    fn next_event(&self) -> u64 {
        self.chip.next_event().min(self.wiring.next_event())
    }

    fn interrupts(&self) -> u128 {
        self.chip.interrupts()
    }

    fn ticks_per_cycle(&self) -> u64 {
        self.chip.ticks_per_cycle()
    }

    fn take_reset(&mut self) -> Option<ResetCause> {
        self.chip.take_reset()
    }

    fn take_power_failure(&mut self) -> bool {
        self.chip.flash.power.take_failed()
    }

    fn store_to_flash(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<u32, Violation> {
        self.advance(now, memory)?;
        self.chip.store_to_flash(now, address, size, value, memory)
    }

    fn stalled_until(&self) -> u64 {
        self.chip.stalled_until()
    }
}
