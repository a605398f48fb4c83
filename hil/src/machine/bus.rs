//! What the processor sees of the rest of the microcontroller.

use crate::board::{Memory, ResetCause};
use crate::violation::Violation;

/// The peripherals behind the processor: registers, request lines, and events in virtual time.
///
/// A mistake of the firmware comes back as a [`Violation`] and ends the run.
pub trait Bus {
    /// Puts the peripherals into their reset state and notes the cause.
    fn reset(&mut self, now: u64, cause: ResetCause);

    /// Reads a register of 0x4000_0000 to 0x5FFF_FFFF, or of the debug unit at 0xE004_2000.
    fn read(&mut self, now: u64, address: u32, size: u32, memory: &mut dyn Memory) -> Result<u32, Violation>;

    /// Writes a register, see [`Bus::read`].
    fn write(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<(), Violation>;

    /// Lets everything happen that is due by `now`.
    fn advance(&mut self, now: u64, memory: &mut dyn Memory) -> Result<(), Violation>;

    /// When something will next happen by itself, [`crate::time::NEVER`] if nothing will.
    fn next_event(&self) -> u64;

    /// The level of each interrupt request line, bit n for interrupt n.
    fn interrupts(&self) -> u128;

    /// Ticks of virtual time in one cycle of the processor's clock.
    fn ticks_per_cycle(&self) -> u64;

    /// A reset that a peripheral demands, such as the watchdog's; asked once.
    fn take_reset(&mut self) -> Option<ResetCause>;

    /// Whether power has failed; asked once.
    fn take_power_failure(&mut self) -> bool {
        false
    }

    /// The processor stores into flash: what these bytes become, or why it must not.
    fn store_to_flash(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<u32, Violation>;

    /// Until when flash is busy and the processor cannot fetch from it.
    fn stalled_until(&self) -> u64;
}
