//! Items between the wire and the form in which they are kept.

use mavlink::dialects::common::{MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA, MavFrame};
use windhover_autopilot::mission::MissionItem;

use super::PlanKind;
use crate::frame::Address;
use crate::wire::{Message, Payload};

/// Where `MISSION_ITEM_INT` and `MISSION_ITEM` have their command, frame and type of plan.
const COMMAND: usize = 30;
const FRAME: usize = 34;
const KIND: usize = 37;

/// `MAV_FRAME_MISSION`: parameters 5 and 6 are no position.
const NO_POSITION: u8 = MavFrame::MAV_FRAME_MISSION as u8;

/// An item as it came, with what belongs to the transfer only.
#[derive(Clone, Copy, Debug)]
pub(super) struct Received {
    pub target: Address,
    pub index: u16,
    /// The kind of plan, or a number that is none.
    pub kind: Result<PlanKind, u8>,
    pub item: MissionItem,
}

/// `MISSION_ITEM_INT`.
pub(super) fn read(payload: Payload<'_>) -> Option<Received> {
    let data: MISSION_ITEM_INT_DATA = readable(payload)?;
    Some(Received {
        target: Address {
            system: data.target_system,
            component: data.target_component,
        },
        index: data.seq,
        kind: kind(payload),
        item: MissionItem {
            command: payload.word(COMMAND),
            frame: payload.byte(FRAME),
            autocontinue: data.autocontinue != 0,
            params: [data.param1, data.param2, data.param3, data.param4],
            x: data.x,
            y: data.y,
            z: data.z,
        },
    })
}

/// `MISSION_ITEM`, of clients that do not know integers: degrees become 1e-7 degrees.
pub(super) fn read_float(payload: Payload<'_>) -> Option<Received> {
    let data: MISSION_ITEM_DATA = readable(payload)?;
    let scale = if payload.byte(FRAME) == NO_POSITION {
        1.0
    } else {
        1e7
    };
    Some(Received {
        target: Address {
            system: data.target_system,
            component: data.target_component,
        },
        index: data.seq,
        kind: kind(payload),
        item: MissionItem {
            command: payload.word(COMMAND),
            frame: payload.byte(FRAME),
            autocontinue: data.autocontinue != 0,
            params: [data.param1, data.param2, data.param3, data.param4],
            x: crate::scale::integer(f64::from(data.x) * scale),
            y: crate::scale::integer(f64::from(data.y) * scale),
            z: data.z,
        },
    })
}

/// `MISSION_ITEM_INT` for a client, as it came from one.
pub(crate) fn item_message(
    to: Address,
    kind: PlanKind,
    index: u16,
    current: bool,
    item: &MissionItem,
) -> Message {
    let [param1, param2, param3, param4] = item.params;
    Message::of(&MISSION_ITEM_INT_DATA {
        param1,
        param2,
        param3,
        param4,
        x: item.x,
        y: item.y,
        z: item.z,
        seq: index,
        target_system: to.system,
        target_component: to.component,
        current: u8::from(current),
        autocontinue: u8::from(item.autocontinue),
        mission_type: kind.wire(),
        ..MISSION_ITEM_INT_DATA::DEFAULT
    })
    .with_word(COMMAND, item.command)
    .with_byte(FRAME, item.frame)
}

fn readable<M: mavlink::MessageData>(payload: Payload<'_>) -> Option<M> {
    let known = |payload: Payload<'_>| payload.read_command(COMMAND, Some(FRAME));
    // The type of plan as well may be a number that the crate does not know.
    let mut copy = [0; KIND + 1];
    crate::frame::put(&mut copy, payload.0);
    if let Some(kind) = copy.get_mut(KIND) {
        *kind = 0;
    }
    known(Payload(&copy))
}

fn kind(payload: Payload<'_>) -> Result<PlanKind, u8> {
    let code = payload.byte(KIND);
    PlanKind::from_code(code).ok_or(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_item_comes_back_bit_for_bit_whatever_its_numbers() {
        let item = MissionItem {
            command: 54_321,
            frame: 200,
            autocontinue: false,
            params: [
                f32::from_bits(0x7fc1_2345),
                -0.0,
                f32::INFINITY,
                f32::from_bits(0xff80_0001),
            ],
            x: i32::MIN,
            y: i32::MAX,
            z: f32::from_bits(0x7fff_ffff),
        };
        let to = Address {
            system: 1,
            component: 1,
        };
        let message = item_message(to, PlanKind::Fence, 77, true, &item);
        let read = read(Payload(message.payload())).expect("it is one");
        assert_eq!(
            (read.index, read.kind, read.target),
            (77, Ok(PlanKind::Fence), to)
        );
        let bits = |item: &MissionItem| (item.params.map(f32::to_bits), item.z.to_bits());
        assert_eq!(bits(&read.item), bits(&item));
        let rest = |item: &MissionItem| (item.command, item.frame, item.x, item.y, item.autocontinue);
        assert_eq!(rest(&read.item), rest(&item));
    }

    #[test]
    fn an_item_in_degrees_becomes_integers() {
        let data = MISSION_ITEM_DATA {
            x: 47.5,
            y: -8.25,
            ..MISSION_ITEM_DATA::DEFAULT
        };
        let message = Message::of(&data);
        let read = read_float(Payload(message.payload())).expect("it is one");
        assert_eq!((read.item.x, read.item.y), (475_000_000, -82_500_000));
    }
}
