//! Messages about flight: mode, attitude, mission.

use mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, EXTENDED_SYS_STATE_DATA, HEARTBEAT_DATA, MISSION_CURRENT_DATA,
    MISSION_ITEM_REACHED_DATA, MavAutopilot, MavLandedState, MavModeFlag, MavState, MavType,
    MissionState as Wire, SERVO_OUTPUT_RAW_DATA, SYSTEM_TIME_DATA, VFR_HUD_DATA,
};
use windhover_math::{Vector3, sqrt};

use super::Source;
use crate::commands::Identity;
use crate::scale::{centidegrees, scaled};
use crate::telemetry::{Charge, Landed, MissionState};
use crate::wire::Message;

/// `MISSION_CURRENT`'s word for "not in mission mode", and for "in it".
const SUSPENDED: u8 = 2;
const IN_MISSION: u8 = 1;

pub(super) fn heartbeat(source: &Source<'_>) -> Message {
    let t = source.telemetry;
    let mut base =
        MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED;
    base.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, t.armed);
    base.set(
        MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED,
        t.mode.is_manual(),
    );
    base.set(MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED, t.mode.is_auto());
    base.set(MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED, !t.mode.is_manual());
    let system_status = match (t.failsafe || t.battery.charge == Charge::Critical, t.armed) {
        (true, _) => MavState::MAV_STATE_CRITICAL,
        (false, true) => MavState::MAV_STATE_ACTIVE,
        (false, false) => MavState::MAV_STATE_STANDBY,
    };
    Message::of(&HEARTBEAT_DATA {
        custom_mode: t.mode.custom(),
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: match source.identity {
            Identity::Px4 => MavAutopilot::MAV_AUTOPILOT_PX4,
            Identity::Generic => MavAutopilot::MAV_AUTOPILOT_GENERIC,
        },
        base_mode: base,
        system_status,
        ..HEARTBEAT_DATA::DEFAULT
    })
}

pub(super) fn system_time(source: &Source<'_>) -> Message {
    Message::of(&SYSTEM_TIME_DATA {
        time_unix_usec: source.telemetry.utc.unwrap_or_default(),
        time_boot_ms: source.boot_ms(),
    })
}

pub(super) fn attitude(source: &Source<'_>) -> Option<Message> {
    let angles = source.telemetry.attitude?.to_euler();
    let rate = source.telemetry.rate;
    Some(Message::of(&ATTITUDE_DATA {
        time_boot_ms: source.boot_ms(),
        roll: angles.roll,
        pitch: angles.pitch,
        yaw: angles.yaw,
        rollspeed: rate.x,
        pitchspeed: rate.y,
        yawspeed: rate.z,
    }))
}

pub(super) fn attitude_quaternion(source: &Source<'_>) -> Option<Message> {
    let attitude = source.telemetry.attitude?;
    let rate = source.telemetry.rate;
    Some(Message::of(&ATTITUDE_QUATERNION_DATA {
        time_boot_ms: source.boot_ms(),
        q1: attitude.w,
        q2: attitude.x,
        q3: attitude.y,
        q4: attitude.z,
        rollspeed: rate.x,
        pitchspeed: rate.y,
        yawspeed: rate.z,
        ..ATTITUDE_QUATERNION_DATA::DEFAULT
    }))
}

/// Pulses of 1000 to 2000 µs, as clients expect them.
pub(super) fn servo_output(source: &Source<'_>) -> Message {
    let [one, two, three, four] = source
        .telemetry
        .motors
        .map(|share| 1000 + (u32::from(share) * 1000 / 65_535) as u16);
    Message::of(&SERVO_OUTPUT_RAW_DATA {
        time_usec: source.now as u32,
        servo1_raw: one,
        servo2_raw: two,
        servo3_raw: three,
        servo4_raw: four,
        ..SERVO_OUTPUT_RAW_DATA::DEFAULT
    })
}

pub(super) fn mission_current(source: &Source<'_>) -> Message {
    let t = source.telemetry;
    let [mission, fence, rally] = source.plans;
    let in_mission = t.mode == crate::Mode::Mission;
    Message::of(&MISSION_CURRENT_DATA {
        seq: t.mission.current,
        total: mission.count,
        mission_state: match t.mission.state {
            _ if mission.count == 0 => Wire::MISSION_STATE_NO_MISSION,
            MissionState::NotStarted => Wire::MISSION_STATE_NOT_STARTED,
            MissionState::Active => Wire::MISSION_STATE_ACTIVE,
            MissionState::Paused => Wire::MISSION_STATE_PAUSED,
            MissionState::Complete => Wire::MISSION_STATE_COMPLETE,
        },
        mission_mode: if in_mission { IN_MISSION } else { SUSPENDED },
        mission_id: mission.crc,
        fence_id: fence.crc,
        rally_points_id: rally.crc,
    })
}

/// `MISSION_ITEM_REACHED`.
pub(crate) fn reached(index: u16) -> Message {
    Message::of(&MISSION_ITEM_REACHED_DATA { seq: index })
}

pub(super) fn vfr_hud(source: &Source<'_>) -> Message {
    let t = source.telemetry;
    let velocity = t.velocity.unwrap_or_else(Vector3::zeros);
    let speed = sqrt(velocity.x * velocity.x + velocity.y * velocity.y);
    let heading = centidegrees(t.attitude.map(|attitude| attitude.heading()));
    Message::of(&VFR_HUD_DATA {
        airspeed: speed,
        groundspeed: speed,
        alt: t.global.map_or(0.0, |global| global.altitude as f32 * 1e-3),
        climb: -velocity.z,
        heading: if heading == u16::MAX {
            0
        } else {
            (heading / 100) as i16
        },
        throttle: scaled(t.throttle, 100, 0, (0, 100)),
    })
}

pub(super) fn extended_sys_state(source: &Source<'_>) -> Message {
    Message::of(&EXTENDED_SYS_STATE_DATA {
        landed_state: match source.telemetry.landed {
            Landed::OnGround => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
            Landed::TakingOff => MavLandedState::MAV_LANDED_STATE_TAKEOFF,
            Landed::InAir => MavLandedState::MAV_LANDED_STATE_IN_AIR,
            Landed::Landing => MavLandedState::MAV_LANDED_STATE_LANDING,
        },
        ..EXTENDED_SYS_STATE_DATA::DEFAULT
    })
}
