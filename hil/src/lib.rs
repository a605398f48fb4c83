//! The flight board in the loop: the shipped firmware, unmodified, on an emulated STM32F405.
//!
//! - [`time`]: virtual time, in which everything here is measured.
//! - [`board`]: the microcontroller's peripherals and what hangs on its pins.
//! - [`violation`]: what the firmware must not do; the run stops there and says so.

pub mod board;
pub mod time;
pub mod violation;
