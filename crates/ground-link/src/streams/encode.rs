//! Telemetry as messages: each function writes the fields of one, in the order of the wire.

mod flight;
mod place;
mod power;

use mavlink::MessageData;
use mavlink::dialects::common as wire;
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
    let number = u32::from(number);
    m.start(number);
    match number {
        wire::HEARTBEAT_DATA::ID => flight::heartbeat(source, m),
        wire::SYS_STATUS_DATA::ID => power::sys_status(source, m),
        wire::SYSTEM_TIME_DATA::ID => flight::system_time(source, m),
        wire::GPS_RAW_INT_DATA::ID => place::gps_raw_int(source, m),
        wire::ATTITUDE_DATA::ID => return flight::attitude(source, m).is_some(),
        wire::ATTITUDE_QUATERNION_DATA::ID => return flight::attitude_quaternion(source, m).is_some(),
        wire::LOCAL_POSITION_NED_DATA::ID => return place::local_position(source, m).is_some(),
        wire::GLOBAL_POSITION_INT_DATA::ID => return place::global_position(source, m).is_some(),
        wire::SERVO_OUTPUT_RAW_DATA::ID => flight::servo_output(source, m),
        wire::MISSION_CURRENT_DATA::ID => flight::mission_current(source, m),
        wire::VFR_HUD_DATA::ID => flight::vfr_hud(source, m),
        wire::BATTERY_STATUS_DATA::ID => power::battery_status(source, m),
        wire::HOME_POSITION_DATA::ID => return place::home_position(source, m).is_some(),
        wire::EXTENDED_SYS_STATE_DATA::ID => flight::extended_sys_state(source, m),
        _ => return false,
    }
    true
}

pub(crate) use place::image_captured;
