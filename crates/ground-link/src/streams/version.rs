//! What the vehicle says about itself when it is asked who it is.

use mavlink::dialects::common::{AUTOPILOT_VERSION_DATA, MavProtocolCapability, PROTOCOL_VERSION_DATA};

use crate::wire::Message;

/// 1.4.1, development: from this on QGroundControl finds nothing to complain about. Our own version
/// is in the bytes for a custom one.
const VERSION: u32 = 0x0104_0100;

/// MAVLink 2.0, times a hundred.
const PROTOCOL: u16 = 200;

/// `AUTOPILOT_VERSION`.
pub(crate) fn autopilot(uid: u64, own_version: [u8; 8]) -> Message {
    let capabilities = MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MAVLINK2
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE;
    Message::of(&AUTOPILOT_VERSION_DATA {
        capabilities,
        uid,
        flight_sw_version: VERSION,
        flight_custom_version: own_version,
        ..AUTOPILOT_VERSION_DATA::DEFAULT
    })
}

/// `PROTOCOL_VERSION`.
pub(crate) fn protocol() -> Message {
    Message::of(&PROTOCOL_VERSION_DATA {
        version: PROTOCOL,
        min_version: 100,
        max_version: PROTOCOL,
        ..PROTOCOL_VERSION_DATA::DEFAULT
    })
}
