//! Plans and their items as messages.

use mavlink::dialects::common::*;
use mavlink::{MavlinkVersion, MessageData};
use windhover_autopilot::mission::MissionItem;

use super::{NAN, Seen};

/// Any plan: numbers that tell items apart, and NaNs of different kinds.
pub fn plan(count: u16, salt: u32) -> Vec<MissionItem> {
    (0..count)
        .map(|index| {
            let n = u32::from(index) + salt;
            MissionItem {
                command: if index % 3 == 2 { 2000 } else { 16 },
                frame: [0, 3, 6, 2][usize::from(index % 4)],
                autocontinue: index % 7 != 0,
                params: [n as f32, f32::from_bits(0x7fc0_0000 | n), -0.0, NAN],
                x: 473_977_418 + n as i32,
                y: -85_455_938 - n as i32,
                z: if index % 5 == 0 {
                    f32::from_bits(0xffc0_0001 + n)
                } else {
                    n as f32 * 0.1
                },
            }
        })
        .collect()
}

pub fn item_data(item: &MissionItem, index: u16, kind: MavMissionType) -> MISSION_ITEM_INT_DATA {
    use num::{command, frame};
    let [param1, param2, param3, param4] = item.params;
    MISSION_ITEM_INT_DATA {
        param1,
        param2,
        param3,
        param4,
        x: item.x,
        y: item.y,
        z: item.z,
        seq: index,
        command: command(item.command),
        target_system: 1,
        target_component: 1,
        frame: frame(item.frame),
        current: 0,
        autocontinue: u8::from(item.autocontinue),
        mission_type: kind,
    }
}

pub fn item_of(data: &MISSION_ITEM_INT_DATA) -> MissionItem {
    MissionItem {
        command: data.command as u16,
        frame: data.frame as u8,
        autocontinue: data.autocontinue != 0,
        params: [data.param1, data.param2, data.param3, data.param4],
        x: data.x,
        y: data.y,
        z: data.z,
    }
}

/// Numbers to the crate's enumerations, by way of a message.
mod num {
    use super::*;

    fn data(command: u16, frame: u8) -> MISSION_ITEM_INT_DATA {
        let mut payload = [0; 38];
        payload[30..32].copy_from_slice(&command.to_le_bytes());
        payload[34] = frame;
        MISSION_ITEM_INT_DATA::deser(MavlinkVersion::V2, &payload).expect("known numbers")
    }

    pub fn command(number: u16) -> MavCmd {
        data(number, 0).command
    }

    pub fn frame(number: u8) -> MavFrame {
        data(16, number).frame
    }
}

/// How many plans the vehicle says that it has taken.
pub fn accepted_plans(seen: &[Seen]) -> usize {
    let acks = seen.iter().filter(|seen| seen.id == MISSION_ACK_DATA::ID);
    acks.filter(|ack| ack.payload.get(2).is_none_or(|result| *result == 0))
        .count()
}

pub fn count(count: u16, kind: MavMissionType) -> MISSION_COUNT_DATA {
    MISSION_COUNT_DATA {
        count,
        target_system: 1,
        target_component: 1,
        mission_type: kind,
        ..MISSION_COUNT_DATA::DEFAULT
    }
}
