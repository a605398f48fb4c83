//! Telemetry as messages: each function writes the fields of one, in the order of the wire.

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
        crate::scale::divided(self.now, 1000) as u32
    }
}

/// A message of telemetry by its number; `false` when there is no such one, or when nothing is
/// known that it could say.
pub(crate) fn message(number: u16, source: &Source<'_>, m: &mut Message) -> bool {
    m.start(u32::from(number));
    let written = match number {
        0 => Some(flight::heartbeat(source, m)),
        1 => Some(power::sys_status(source, m)),
        2 => Some(flight::system_time(source, m)),
        24 => Some(place::gps_raw_int(source, m)),
        30 => flight::attitude(source, m),
        31 => flight::attitude_quaternion(source, m),
        32 => place::local_position(source, m),
        33 => place::global_position(source, m),
        36 => Some(flight::servo_output(source, m)),
        42 => Some(flight::mission_current(source, m)),
        74 => Some(flight::vfr_hud(source, m)),
        147 => Some(power::battery_status(source, m)),
        242 => place::home_position(source, m),
        245 => Some(flight::extended_sys_state(source, m)),
        _ => None,
    };
    written.is_some()
}

pub(crate) use place::image_captured;
