//! Drivers of the parts on a flight board.
//!
//! A driver turns bus transactions into what the part measured, as the part says it: raw counts
//! in the part's own axes. Scales, rotations and calibration are the sensing border's (crate
//! `windhover-autopilot`). Buses, pins and delays come in as `embedded-hal` traits.
//!
//! Everything here ends: a driver waits only for bounded delays and a bounded number of bus
//! transactions, and never panics. A bus that does not complete is the owner's to notice: wrap
//! the calls in a time-out. Dropping a call half-way is safe.
//!
//! - [`spl06`]: the barometer Goertek SPL06-001 on I2C; [`ist8310`]: the compass iSentek IST8310
//!   there; [`i2c_part`]: what both say of their state; [`i2c_recovery`]: how their bus is freed.
//! - [`icm42688p`]: the inertial measurement unit TDK ICM-42688-P on SPI.
//! - [`pulse`]: pulses for electronic speed controllers.
//! - [`rc_receiver`]: a receiver of the remote control, which speaks [`crsf`] or [`sbus`].
#![no_std]

pub mod crsf;
pub mod i2c_part;
pub mod i2c_recovery;
pub mod icm42688p;
pub mod ist8310;
pub mod pulse;
mod rc_channels;
pub mod rc_receiver;
pub mod sbus;
pub mod spl06;
