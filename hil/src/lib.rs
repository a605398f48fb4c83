//! The flight board in the loop: the shipped firmware, unmodified, on an emulated STM32F405.
//!
//! - [`time`]: virtual time, in which everything here is measured.
//! - [`board`]: the microcontroller's peripherals and what hangs on its pins.
//! - [`rig`]: what hangs on the pins in a flight: sensors, motors and the vehicle's world.
//! - [`violation`]: what the firmware must not do; the run stops there and says so.

pub mod board;
pub mod rig;
pub mod time;
pub mod violation;
