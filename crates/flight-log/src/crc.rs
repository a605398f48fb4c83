//! CRC-32 as IEEE 802.3 has it, over the items of a mission.

use windhover_autopilot::mission::MissionItem;

use crate::record::Record;
use crate::wire::Encoder;

/// The polynomial, lowest bit first.
const POLYNOMIAL: u32 = 0xedb8_8320;

/// Bytes of an item.
const ITEM: usize = 32;

/// Takes on a CRC by further bytes; the first `crc` is 0.
pub fn crc32(crc: u32, bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!crc, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            let carry = 0u32.wrapping_sub(crc & 1);
            crc >> 1 ^ POLYNOMIAL & carry
        })
    })
}

/// The CRC of a mission: over its items as the log's topic `mission_item` has their own fields.
pub fn mission_crc(items: impl IntoIterator<Item = MissionItem>) -> u32 {
    items.into_iter().fold(0, |crc, item| {
        let mut bytes = [0; ITEM];
        item.put(&mut Encoder::new(&mut bytes));
        crc32(crc, &bytes)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use windhover_autopilot::mission::MissionItem;

    /// The check value that catalogues of CRCs give for CRC-32/ISO-HDLC.
    #[test]
    fn check_value() {
        assert_eq!(crc32(0, b"123456789"), 0xcbf4_3926);
        assert_eq!(crc32(crc32(0, b"1234"), b"56789"), 0xcbf4_3926);
    }

    #[test]
    fn every_field_and_the_order_count() {
        let item = MissionItem {
            command: 16,
            frame: 3,
            autocontinue: true,
            params: [0.0, 1.0, f32::NAN, 2.0],
            x: 1,
            y: 2,
            z: 30.0,
        };
        let size: usize = MissionItem::FIELDS.iter().map(|field| field.size(4)).sum();
        assert_eq!(size, ITEM);
        let crc = mission_crc([item, MissionItem { z: 31.0, ..item }]);
        assert_ne!(crc, mission_crc([MissionItem { z: 31.0, ..item }, item]));
        assert_ne!(crc, mission_crc([item, item]));
        assert_eq!(mission_crc([]), 0);
    }
}
