//! What a pilot sends to the board's port for ground stations.

use mavlink::dialects::common::*;
use mavlink::{MavlinkVersion, MessageData};
use windhover_autopilot::Parameters;
use windhover_ground_link::Address;
use windhover_ground_link::frame::{MAX_FRAME, Writer};
use windhover_math::{Quaternion, min};

/// The vehicle, as a target.
const VEHICLE: (u8, u8) = (1, 1);

/// PX4's number of the mode for setpoints from outside.
const OFFBOARD: f32 = 6.0;

/// What makes a command of disarming also obeyed in the air.
const FORCE: f32 = 21_196.0;

/// Which of `SET_ATTITUDE_TARGET`'s values do not count: none but body rates.
const ATTITUDE_AND_THRUST: AttitudeTargetTypemask = AttitudeTargetTypemask::from_bits_truncate(0b111);

/// A ground station's address and its count of frames.
pub struct Pilot(Writer);

impl Default for Pilot {
    fn default() -> Self {
        Self(Writer::new(Address {
            system: 255,
            component: 190,
        }))
    }
}

impl Pilot {
    /// A message's frame.
    pub fn frame<M: MessageData>(&mut self, message: &M) -> Vec<u8> {
        let mut payload = [0; 255];
        let length = message.ser(MavlinkVersion::V2, &mut payload);
        let mut frame = [0; MAX_FRAME];
        let written = self.0.write(&mut frame, M::ID, &payload[..length], None);
        frame[..written.expect("a frame holds every message")].to_vec()
    }
}

/// A command and its first parameters.
pub fn command(command: MavCmd, params: [f32; 3]) -> COMMAND_LONG_DATA {
    let [param1, param2, param3] = params;
    COMMAND_LONG_DATA {
        param1,
        param2,
        param3,
        command,
        target_system: VEHICLE.0,
        target_component: VEHICLE.1,
        ..COMMAND_LONG_DATA::default()
    }
}

/// Takes setpoints from outside.
pub fn offboard() -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, OFFBOARD, 0.0])
}

/// Arms.
pub fn arm() -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [1.0, 0.0, 0.0])
}

/// Stops the motors, wherever the vehicle is.
pub fn stop() -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [0.0, FORCE, 0.0])
}

/// Starts the firmware anew; what is not stored yet is stored before.
pub fn restart() -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, [1.0, 0.0, 0.0])
}

/// Sets a parameter.
pub fn set(name: &str, value: f32) -> PARAM_SET_DATA {
    PARAM_SET_DATA {
        param_value: value,
        target_system: VEHICLE.0,
        target_component: VEHICLE.1,
        param_id: name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    }
}

/// An attitude to be held, and the thrust in N, of a vehicle at its default parameters.
pub fn attitude(attitude: Quaternion, thrust: f32) -> SET_ATTITUDE_TARGET_DATA {
    let most = 4.0 * Parameters::default().vehicle.rotor_thrust_max();
    SET_ATTITUDE_TARGET_DATA {
        q: [attitude.w, attitude.x, attitude.y, attitude.z],
        thrust: min(thrust / most, 1.0),
        target_system: VEHICLE.0,
        target_component: VEHICLE.1,
        type_mask: ATTITUDE_AND_THRUST,
        ..SET_ATTITUDE_TARGET_DATA::default()
    }
}
