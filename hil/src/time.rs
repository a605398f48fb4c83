//! Virtual time: ticks of 336 MHz, of which every clock of the board is a whole multiple.

/// Ticks of virtual time in one second.
///
/// One cycle of the internal oscillator (16 MHz) is 21 ticks, of the crystal (8 MHz) 42, of the
/// processor at 168 MHz 2, of the low-speed oscillator (32 kHz) 10,500.
pub const SECOND: u64 = 336_000_000;

/// Ticks in a microsecond.
pub const MICROSECOND: u64 = SECOND / 1_000_000;

/// A moment that does not come.
pub const NEVER: u64 = u64::MAX;
