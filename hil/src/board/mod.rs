//! The microcontroller's peripherals, as the processor and the pins see them.

pub mod wiring;

use crate::violation::Violation;
pub use wiring::{Inputs, Pin, PwmPulse, Usart, Wiring};

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
