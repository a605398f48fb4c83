//! The MAVLink side of the autopilot: bytes and time in, bytes and requests out.
//!
//! Layered like a network stack, from the wire upwards:
//!
//! - [`frame`] finds frames in a stream of bytes and writes them; [`signing`] says whose they are;
//! - [`parameters`], [`mission`], [`commands`], [`streams`] and [`setpoints`] are services, each a
//!   state machine of its own;
//! - [`Link`] ties them together for one channel: a serial port, a socket.
//!
//! Nothing here has a clock or a heap, or decides what is flown and which motor turns. What a
//! ground station asks for goes out as a [`Request`]; what it is told comes in as [`Telemetry`], a
//! table of parameters and a store of plans. Degrees and scaled integers end here, but for
//! latitudes and longitudes, which the core has in 1e-7 degrees too: inside are SI units, radians
//! and NED, and a number that says "unset" is an `Option`.
//!
//! Around a [`Link`] a vehicle does this, every few milliseconds:
//!
//! ```
//! use windhover_autopilot::Parameters;
//! use windhover_ground_link::parameters::{Appended, QGROUNDCONTROL};
//! use windhover_ground_link::{
//!     CommandResult, Config, Context, Link, ParameterTable, PlanStore, Request, Signing, Telemetry,
//! };
//!
//! fn step(link: &mut Link, bytes: &[u8], now: u64, context: &mut Context<'_>, send: &mut dyn FnMut(&[u8])) {
//!     link.receive(bytes, now, context); // of a datagram: receive_packet
//!     while let Some(order) = link.next_request() {
//!         let result = match order.request {
//!             Request::WriteParameter { index, value } => continue, // into the table, or parameter_refused
//!             Request::Arm { .. } => CommandResult::Denied,         // and link.say(…) for each blocker
//!             _ => CommandResult::Accepted,
//!         };
//!         if let Some(id) = order.id {
//!             link.finish(id, result, now); // at once or later
//!         }
//!     }
//!     link.poll(now, context, send);
//! }
//! # let _ = step;
//! ```
//!
//! The [`Context`] is put together anew for each step, from the vehicle's [`Telemetry`], its table
//! of parameters ([`parameters::Appended`] adds constants to it), its [`PlanStore`] and the one
//! [`Signing`] of all channels. What happens on occasion is told by [`Link::say`],
//! [`Link::item_reached`], [`Link::photo_taken`] and [`Link::parameter_changed`].
//!
//! Flash is short on the board: what is called from several places is one function there, marked
//! `inline(never)`.
#![no_std]
// Clients still send what the protocol's authors would have them replace.
#![allow(deprecated)]

mod checksum;
pub mod commands;
pub mod frame;
mod link;
pub mod mission;
mod mode;
pub mod outbox;
pub mod parameters;
mod request;
mod scale;
pub mod setpoints;
mod sha256;
pub mod signing;
pub mod streams;
pub mod telemetry;
pub mod text;
mod wire;

pub use commands::{CommandId, CommandResult, Identity};
pub use frame::Address;
pub use link::{Config, Context, Counters, Link, Photo};
pub use mission::{MissionResult, PlanKind, PlanRefusal, PlanStore};
pub use mode::Mode;
pub use outbox::Order;
pub use parameters::ParameterTable;
pub use request::{Calibration, Ground, Request, SpeedKind};
pub use signing::Signing;
pub use telemetry::Telemetry;
pub use text::Severity;
