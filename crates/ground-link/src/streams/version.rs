//! What the vehicle says about itself when it is asked who it is.

use mavlink::MessageData;
use mavlink::dialects::common::{
    AUTOPILOT_VERSION_DATA, MavProtocolCapability as Capability, PROTOCOL_VERSION_DATA,
};

use crate::wire::Message;

/// 1.4.1, development: from this on QGroundControl finds nothing to complain about. Our own version
/// is in the bytes for a custom one.
const VERSION: u32 = 0x0104_0100;

/// MAVLink 2.0, times a hundred.
const PROTOCOL: u16 = 200;

/// What clients may rely on. Without `MISSION_INT` MAVSDK refuses missions; of the encodings of
/// parameters there must be exactly one, though every parameter is a float.
const CAPABILITIES: Capability = Capability::MAV_PROTOCOL_CAPABILITY_MISSION_INT
    .union(Capability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_MAVLINK2)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_MISSION_FENCE)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_MISSION_RALLY)
    .union(Capability::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE);

/// `AUTOPILOT_VERSION`.
pub(crate) fn autopilot(uid: u64, own_version: [u8; 8], m: &mut Message) {
    m.start(AUTOPILOT_VERSION_DATA::ID)
        .huge(CAPABILITIES.bits())
        .huge(uid)
        .long(VERSION)
        .zeros(16) // versions of middleware, operating system and board; vendor, product
        .bytes(&own_version);
}

/// `PROTOCOL_VERSION`.
pub(crate) fn protocol(m: &mut Message) {
    m.start(PROTOCOL_VERSION_DATA::ID)
        .word(PROTOCOL)
        .word(100)
        .word(PROTOCOL);
}
