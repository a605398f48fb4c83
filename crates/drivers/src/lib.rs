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
//! - [`icm42688p`]: the inertial measurement unit TDK ICM-42688-P on SPI.
//! - [`spl06`], [`ist8310`]: barometer and compass on I2C; [`i2c_part`]: what both have in common;
//!   [`i2c_recovery`]: how their bus is freed.
//! - [`ublox`]: a satellite receiver on a serial port.
//! - [`health`]: how a part is.
//! - [`pulse`]: pulses for electronic speed controllers.
//! - [`rc_receiver`]: a receiver of the remote control, which speaks [`crsf`] or [`sbus`].
#![no_std]

pub mod crsf;
pub mod health;
pub mod i2c_part;
pub mod i2c_recovery;
pub mod icm42688p;
pub mod ist8310;
pub mod pulse;
mod rc_channels;
pub mod rc_receiver;
pub mod sbus;
pub mod spl06;
pub mod ublox;
