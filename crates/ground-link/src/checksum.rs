//! CRC-32 (IEEE 802.3): over the items of a plan as the flight log names it, and over parameters.

use windhover_autopilot::mission::MissionItem;

/// The polynomial, lowest bit first.
const POLYNOMIAL: u32 = 0xedb8_8320;

/// Takes the bare register on by further bytes, without inverting it at start and end.
pub(crate) fn update(crc: u32, bytes: &[u8]) -> u32 {
    bytes.iter().fold(crc, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            let carry = 0u32.wrapping_sub(crc & 1);
            crc >> 1 ^ POLYNOMIAL & carry
        })
    })
}

/// Takes the CRC of a plan on by one item; an empty plan has 0.
pub(crate) fn plan_crc(crc: u32, item: &MissionItem) -> u32 {
    let crc = update(!crc, &item.command.to_le_bytes());
    let crc = update(crc, &[item.frame, u8::from(item.autocontinue)]);
    let crc = item
        .params
        .iter()
        .fold(crc, |crc, param| update(crc, &param.to_le_bytes()));
    let crc = update(crc, &item.x.to_le_bytes());
    let crc = update(crc, &item.y.to_le_bytes());
    !update(crc, &item.z.to_le_bytes())
}

#[cfg(test)]
mod tests {
    use windhover_flight_log::crc::mission_crc;

    use super::*;

    #[test]
    fn check_value() {
        assert_eq!(!update(!0, b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn a_plan_has_the_crc_that_the_log_names() {
        let item = MissionItem {
            command: 16,
            frame: 6,
            autocontinue: true,
            params: [0.0, 1.0, f32::NAN, -2.0],
            x: 473_977_418,
            y: -85_455_938,
            z: 30.5,
        };
        let items = [
            item,
            MissionItem {
                z: 31.0,
                autocontinue: false,
                ..item
            },
        ];
        assert_eq!(items.iter().fold(0, plan_crc), mission_crc(items));
        assert_eq!(mission_crc([]), 0);
    }
}
