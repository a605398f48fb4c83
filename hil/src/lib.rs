//! The flight board in the loop: the shipped firmware, unmodified, on an emulated STM32F405.
//!
//! - [`time`]: virtual time, in which everything here is measured.
//! - [`board`]: the microcontroller's peripherals and what hangs on its pins.
//! - [`machine`]: the processor, which runs the program.
//! - [`parts`]: what is wired to the pins, after the data sheets.
//! - [`rig`]: sensors, motors and the world, at the other end of the pins.
//! - [`flight`]: a flight from power-on to disarmed.
//! - [`pilot`]: what its pilot sends.
//! - [`serve`]: a process that ground stations fly.
//! - [`figures`]: what is measured of it.
//! - [`count`]: what the code costs in instructions.
//! - [`elf`]: the program, and the names in it.
//! - [`rtt`], [`log`]: what the program says by defmt.
//! - [`trouble`]: what goes wrong inside the processor, on purpose.
//! - [`violation`]: what the firmware must not do; the run stops there and says so.

pub mod board;
pub mod count;
pub mod elf;
pub mod figures;
pub mod flight;
pub mod log;
pub mod machine;
pub mod parts;
pub mod pilot;
pub mod rig;
pub mod rtt;
pub mod serve;
pub mod time;
pub mod trouble;
pub mod violation;
