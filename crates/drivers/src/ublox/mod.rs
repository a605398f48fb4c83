//! A satellite receiver of u-blox on a serial port: found, configured and read, in the protocol UBX
//! (u-blox M8 and M10, interface descriptions).
//!
//! [`Parser`] finds messages among the bytes that came. [`Setup`] finds the receiver's baud rate
//! and configures it: NAV-PVT ten times a second and nothing else. Neither has a port nor a clock:
//! the owner hands bytes to the one, messages and time to the other, and does what [`Setup`] says.

mod frames;
mod parser;
mod setup;

pub use parser::{Counts, Message, NavPvt, Parser};
pub use setup::{Action, BAUDS, Health, SILENCE_US, Setup, TARGET_BAUD};
