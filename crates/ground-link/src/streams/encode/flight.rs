//! Messages about flight: mode, attitude, mission.

use mavlink::dialects::common::{
    MavAutopilot, MavLandedState, MavModeFlag as Flag, MavState, MavType, MissionState as Wire,
};
use windhover_math::{Quaternion, Vector3, sqrt};

use super::Source;
use crate::commands::Identity;
use crate::scale::{centidegrees, scaled};
use crate::telemetry::{Charge, Landed, MissionState};
use crate::wire::Message;

/// `MISSION_CURRENT`'s word for "not in mission mode", and for "in it".
const SUSPENDED: u8 = 2;
const IN_MISSION: u8 = 1;

/// The version of the protocol that `HEARTBEAT` names.
const PROTOCOL: u8 = 3;

/// Motors have four of the eight channels of `SERVO_OUTPUT_RAW`.
const OTHER_OUTPUTS: usize = 4 * 2;

pub(super) fn heartbeat(source: &Source<'_>, m: &mut Message) {
    let t = source.telemetry;
    let mut base = Flag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | Flag::MAV_MODE_FLAG_STABILIZE_ENABLED;
    base.set(Flag::MAV_MODE_FLAG_SAFETY_ARMED, t.armed);
    base.set(Flag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED, t.mode.is_manual());
    base.set(Flag::MAV_MODE_FLAG_AUTO_ENABLED, t.mode.is_auto());
    base.set(Flag::MAV_MODE_FLAG_GUIDED_ENABLED, !t.mode.is_manual());
    let status = match (t.failsafe || t.battery.charge == Charge::Critical, t.armed) {
        (true, _) => MavState::MAV_STATE_CRITICAL,
        (false, true) => MavState::MAV_STATE_ACTIVE,
        (false, false) => MavState::MAV_STATE_STANDBY,
    };
    let autopilot = match source.identity {
        Identity::Px4 => MavAutopilot::MAV_AUTOPILOT_PX4,
        Identity::Generic => MavAutopilot::MAV_AUTOPILOT_GENERIC,
    };
    m.long(t.mode.custom())
        .byte(MavType::MAV_TYPE_QUADROTOR as u8)
        .byte(autopilot as u8)
        .byte(base.bits())
        .byte(status as u8)
        .byte(PROTOCOL);
}

pub(super) fn system_time(source: &Source<'_>, m: &mut Message) {
    m.huge(source.telemetry.utc.unwrap_or_default())
        .long(source.boot_ms());
}

pub(super) fn attitude(source: &Source<'_>, m: &mut Message) -> Option<()> {
    let angles = source.telemetry.attitude?.to_euler();
    m.long(source.boot_ms())
        .floats(&[angles.roll, angles.pitch, angles.yaw])
        .vector(source.telemetry.rate);
    Some(())
}

pub(super) fn attitude_quaternion(source: &Source<'_>, m: &mut Message) -> Option<()> {
    let attitude = source.telemetry.attitude?;
    m.long(source.boot_ms())
        .rotation(attitude)
        .vector(source.telemetry.rate);
    Some(())
}

impl Message {
    /// Three floats.
    pub(super) fn vector(&mut self, v: Vector3) -> &mut Self {
        self.floats(&[v.x, v.y, v.z])
    }

    /// Four floats, the real part first.
    pub(super) fn rotation(&mut self, q: Quaternion) -> &mut Self {
        self.floats(&[q.w, q.x, q.y, q.z])
    }
}

/// Pulses of 1000 to 2000 µs, as clients expect them.
pub(super) fn servo_output(source: &Source<'_>, m: &mut Message) {
    m.long(source.now as u32);
    for share in source.telemetry.motors {
        m.word(1000 + (u32::from(share) * 1000 / 65_535) as u16);
    }
    m.zeros(OTHER_OUTPUTS + 1);
}

/// `MISSION_CURRENT` has this total where there is none: 0 says that totals are not told.
const NO_MISSION: u16 = u16::MAX;

pub(super) fn mission_current(source: &Source<'_>, m: &mut Message) {
    let t = source.telemetry;
    let [mission, fence, rally] = source.plans;
    let state = match t.mission.state {
        _ if mission.count == 0 => Wire::MISSION_STATE_NO_MISSION,
        MissionState::NotStarted => Wire::MISSION_STATE_NOT_STARTED,
        MissionState::Active => Wire::MISSION_STATE_ACTIVE,
        MissionState::Paused => Wire::MISSION_STATE_PAUSED,
        MissionState::Complete => Wire::MISSION_STATE_COMPLETE,
    };
    let is_flown = t.mode == crate::Mode::Mission;
    m.word(t.mission.current)
        .word(if mission.count == 0 {
            NO_MISSION
        } else {
            mission.count
        })
        .byte(state as u8)
        .byte(if is_flown { IN_MISSION } else { SUSPENDED })
        .long(mission.crc)
        .long(fence.crc)
        .long(rally.crc);
}

pub(super) fn vfr_hud(source: &Source<'_>, m: &mut Message) {
    let t = source.telemetry;
    let velocity = t.velocity.unwrap_or_else(Vector3::zeros);
    let speed = sqrt(velocity.x * velocity.x + velocity.y * velocity.y);
    let altitude = t.global.map_or(0.0, |global| global.altitude as f32 * 1e-3);
    let heading = match centidegrees(t.attitude.map(|attitude| attitude.heading())) {
        u16::MAX => 0,
        heading => heading / 100,
    };
    // To a multicopter air speed is the same as ground speed.
    m.floats(&[speed, speed, altitude, -velocity.z])
        .word(heading)
        .word(scaled(t.throttle, 100, 0, (0, 100)) as u16);
}

pub(super) fn extended_sys_state(source: &Source<'_>, m: &mut Message) {
    let landed = match source.telemetry.landed {
        Landed::OnGround => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        Landed::TakingOff => MavLandedState::MAV_LANDED_STATE_TAKEOFF,
        Landed::InAir => MavLandedState::MAV_LANDED_STATE_IN_AIR,
        Landed::Landing => MavLandedState::MAV_LANDED_STATE_LANDING,
    };
    m.byte(0).byte(landed as u8);
}
