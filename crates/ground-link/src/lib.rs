//! The MAVLink side of the autopilot: bytes and time in, bytes and requests out.
//!
//! Layered like a network stack, from the wire upwards:
//!
//! - [`frame`] finds frames in a stream of bytes and writes them; [`signing`] says whose they are;
//! - [`parameters`], [`mission`], [`commands`], [`streams`] and [`setpoints`] are services, each a
//!   state machine of its own;
//! - [`Link`] ties them together for one channel: a serial port, a socket.
//!
//! Nothing here knows a clock, a heap, a flight mode or a motor. What a ground station asks for
//! goes out as a [`Request`]; what it is told comes in as [`Telemetry`], a table of parameters and
//! a store of plans. Degrees and scaled integers end here: inside are SI units, radians and NED,
//! and a number that says "unset" is an `Option`.
#![no_std]

pub mod frame;
pub mod signing;
