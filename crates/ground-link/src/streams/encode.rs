//! Telemetry as messages.

mod flight;
mod place;
mod power;

use windhover_autopilot::MissionCommit;

use crate::commands::Identity;
use crate::telemetry::Telemetry;
use crate::wire::Message;

/// What messages are made from.
pub(crate) struct Source<'a> {
    pub telemetry: &'a Telemetry,
    pub identity: Identity,
    /// The plans in use: mission, fence, rally points.
    pub plans: [MissionCommit; 3],
    /// Share of frames that did not arrive here.
    pub loss: f32,
    /// Time since start, µs.
    pub now: u64,
}

impl Source<'_> {
    /// ms since start, which start anew after 49 days.
    fn boot_ms(&self) -> u32 {
        (self.now / 1000) as u32
    }
}

/// A message of telemetry by its number; `None` when there is no such one, or when nothing is
/// known that it could say.
pub(crate) fn message(number: u16, source: &Source<'_>) -> Option<Message> {
    match number {
        0 => Some(flight::heartbeat(source)),
        1 => Some(power::sys_status(source)),
        2 => Some(flight::system_time(source)),
        24 => Some(place::gps_raw_int(source)),
        30 => flight::attitude(source),
        31 => flight::attitude_quaternion(source),
        32 => place::local_position(source),
        33 => place::global_position(source),
        36 => Some(flight::servo_output(source)),
        42 => Some(flight::mission_current(source)),
        74 => Some(flight::vfr_hud(source)),
        147 => Some(power::battery_status(source)),
        242 => place::home_position(source),
        245 => Some(flight::extended_sys_state(source)),
        _ => None,
    }
}

pub(crate) use flight::reached;
pub(crate) use place::image_captured;
