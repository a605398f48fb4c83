//! The parts that a flight board's pins are wired to, byte by byte, after their data sheets. They
//! know nothing of the vehicle: their owner says what they measure, when they ask.
//!
//! - [`i2c`]: the bus and its lines; [`spl06`], [`ist8310`]: barometer and compass on it.
//! - [`ublox`]: a satellite receiver that takes its configuration, with [`nmea`], what it says
//!   before.
//! - [`rc`]: what CRSF and SBUS receivers send.

pub mod i2c;
pub mod ist8310;
pub mod nmea;
pub mod rc;
pub mod spl06;
pub mod ublox;

/// What a driver did against a part's data sheet: when, in ticks, and what.
pub type Misuse = (u64, String);
