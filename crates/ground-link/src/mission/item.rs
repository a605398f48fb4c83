//! Items between the wire and the form in which they are kept.

use mavlink::MessageData;
use mavlink::dialects::common::{MISSION_ITEM_INT_DATA, MavFrame};
use windhover_autopilot::mission::MissionItem;

use super::PlanKind;
use crate::frame::Address;
use crate::scale::{E7, integer};
use crate::wire::{Message, Payload};

/// Where `MISSION_ITEM_INT` and `MISSION_ITEM` have what is not a parameter.
const INDEX: usize = 28;
const COMMAND: usize = 30;
pub(super) const TARGET: usize = 32;
const FRAME: usize = 34;
const AUTOCONTINUE: usize = 36;
const KIND: usize = 37;

/// `MAV_FRAME_MISSION`: parameters 5 and 6 are no position.
const NO_POSITION: u8 = MavFrame::MAV_FRAME_MISSION as u8;

/// An item as it came, with what belongs to the transfer only.
#[derive(Clone, Copy, Debug)]
pub(super) struct Received {
    pub index: u16,
    /// The kind of plan, or a number that is none.
    pub kind: Result<PlanKind, u8>,
    pub item: MissionItem,
}

/// `MISSION_ITEM_INT`, or `MISSION_ITEM` of clients that do not know integers: there places are in
/// degrees, and become 1e-7 degrees.
pub(super) fn read(payload: Payload<'_>, is_float: bool) -> Received {
    let frame = payload.byte(FRAME);
    let factor = if frame == NO_POSITION { 1 } else { E7 };
    let [x, y] = [16, 20].map(|at| match is_float {
        true => integer(payload.float(at), factor),
        false => payload.integer(at),
    });
    let code = payload.byte(KIND);
    Received {
        index: payload.word(INDEX),
        kind: PlanKind::from_code(code).ok_or(code),
        item: MissionItem {
            command: payload.word(COMMAND),
            frame,
            autocontinue: payload.byte(AUTOCONTINUE) != 0,
            params: payload.floats(0),
            x,
            y,
            z: payload.float(24),
        },
    }
}

/// `MISSION_ITEM_INT` for a client, as it came from one.
pub(crate) fn item_message(
    to: Address,
    kind: PlanKind,
    index: u16,
    current: bool,
    item: &MissionItem,
    m: &mut Message,
) {
    m.start(MISSION_ITEM_INT_DATA::ID)
        .floats(&item.params)
        .integer(item.x)
        .integer(item.y)
        .floats(&[item.z])
        .word(index)
        .word(item.command)
        .target(to)
        .byte(item.frame)
        .byte(u8::from(current))
        .byte(u8::from(item.autocontinue))
        .byte(kind.code());
}

#[cfg(test)]
mod tests {
    use mavlink::MavlinkVersion;
    use mavlink::dialects::common::MISSION_ITEM_DATA;

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
        let mut message = Message::empty();
        item_message(to, PlanKind::Fence, 77, true, &item, &mut message);
        let payload = Payload(message.payload());
        let read = read(payload, false);
        assert_eq!((read.index, read.kind), (77, Ok(PlanKind::Fence)));
        assert!(payload.is_for(to, TARGET));
        let bits = |item: &MissionItem| (item.params.map(f32::to_bits), item.z.to_bits());
        assert_eq!(bits(&read.item), bits(&item));
        let rest = |item: &MissionItem| (item.command, item.frame, item.x, item.y, item.autocontinue);
        assert_eq!(rest(&read.item), rest(&item));
    }

    #[test]
    fn an_item_in_degrees_becomes_integers() {
        let mut payload = [0; 38];
        let data = MISSION_ITEM_DATA {
            x: 47.5,
            y: -8.25,
            ..MISSION_ITEM_DATA::DEFAULT
        };
        data.ser(MavlinkVersion::V2, &mut payload);
        let read = read(Payload(&payload), true);
        assert_eq!((read.item.x, read.item.y), (475_000_000, -82_500_000));
    }
}
