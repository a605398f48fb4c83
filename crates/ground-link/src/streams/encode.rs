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
    match number {
        0 => flight::heartbeat(source, m),
        1 => power::sys_status(source, m),
        2 => flight::system_time(source, m),
        24 => place::gps_raw_int(source, m),
        30 => return flight::attitude(source, m).is_some(),
        31 => return flight::attitude_quaternion(source, m).is_some(),
        32 => return place::local_position(source, m).is_some(),
        33 => return place::global_position(source, m).is_some(),
        36 => flight::servo_output(source, m),
        42 => flight::mission_current(source, m),
        74 => flight::vfr_hud(source, m),
        147 => power::battery_status(source, m),
        242 => return place::home_position(source, m).is_some(),
        245 => flight::extended_sys_state(source, m),
        _ => return false,
    }
    true
}

pub(crate) use place::image_captured;
