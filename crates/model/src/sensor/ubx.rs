//! The protocol UBX on the line: frames, and the message NAV-PVT (u-blox M10, interface
//! description: UBX protocol, UBX-NAV-PVT).

use super::nav_pvt::NavPvt;

/// What a frame begins with.
const SYNC: [u8; 2] = [0xB5, 0x62];

/// Payloads of at most so many bytes are taken in.
const LONGEST: usize = 512;

/// From GPS time to UTC, in ms: 18 leap seconds since 2017.
const LEAP_MS: u32 = 18_000;

/// The Sunday on which the week begins that is flown in, a day of January 2026.
const SUNDAY: u32 = 4;

/// A message: its class and number, and what it carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Class and number.
    pub id: [u8; 2],
    /// What it carries.
    pub payload: Vec<u8>,
}

/// The sums over class, number, length and payload.
fn sums(bytes: &[u8]) -> [u8; 2] {
    bytes.iter().fold([0u8; 2], |[a, b], byte| {
        let a = a.wrapping_add(*byte);
        [a, b.wrapping_add(a)]
    })
}

/// A message as a frame.
pub fn frame(id: [u8; 2], payload: &[u8]) -> Vec<u8> {
    let length = payload.len() as u16;
    let body = [&id[..], &length.to_le_bytes(), payload].concat();
    [&SYNC[..], &body, &sums(&body)].concat()
}

/// Finds frames among bytes.
#[derive(Clone, Debug, Default)]
pub struct Parser {
    bytes: Vec<u8>,
}

impl Parser {
    /// Takes a byte: the message that is complete with it, if its sums are right.
    pub fn take(&mut self, byte: u8) -> Option<Message> {
        self.bytes.push(byte);
        loop {
            match self.length() {
                Some(length) if self.bytes.len() < length => return None,
                Some(length) => {
                    let body = &self.bytes[2..length - 2];
                    if sums(body) == self.bytes[length - 2..length] {
                        let message = Message {
                            id: [body[0], body[1]],
                            payload: body[4..].to_vec(),
                        };
                        self.bytes.clear();
                        return Some(message);
                    }
                }
                None => {}
            }
            // No frame begins here: perhaps at the next byte.
            if self.bytes.is_empty() {
                return None;
            }
            self.bytes.remove(0);
        }
    }

    /// The length of the frame that may begin with the bytes so far; none if none does.
    fn length(&self) -> Option<usize> {
        let begins = self.bytes.iter().zip(SYNC).all(|(byte, sync)| *byte == sync);
        match self.bytes[..] {
            [] => None,
            _ if !begins => None,
            [_, _, _, _, low, high, ..] => {
                let payload = usize::from(u16::from_le_bytes([low, high]));
                (payload <= LONGEST).then_some(8 + payload)
            }
            _ => Some(8),
        }
    }
}

/// NAV-PVT's class and number.
pub const NAV_PVT: [u8; 2] = [0x01, 0x07];

/// NAV-PVT as it is carried, with the date of a week in January 2026.
pub fn nav_pvt(message: &NavPvt) -> [u8; 92] {
    /// Date and time are known, to the second.
    const VALID: u8 = 7;
    const TIME_ACCURACY_NS: u32 = 20;
    let utc = message.time_of_week.saturating_sub(LEAP_MS);
    let seconds = utc / 1000;
    let mut bytes = [0; 92];
    let mut put = |place: usize, value: &[u8]| bytes[place..place + value.len()].copy_from_slice(value);
    put(0, &message.time_of_week.to_le_bytes());
    put(4, &2026u16.to_le_bytes());
    let day = SUNDAY + seconds / 86_400;
    let clock = [seconds / 3600 % 24, seconds / 60 % 60, seconds % 60];
    put(
        6,
        &[
            1,
            day as u8,
            clock[0] as u8,
            clock[1] as u8,
            clock[2] as u8,
            VALID,
        ],
    );
    put(12, &TIME_ACCURACY_NS.to_le_bytes());
    put(16, &(utc % 1000 * 1_000_000).to_le_bytes());
    put(20, &[message.fix_type, message.flags, 0, message.satellites]);
    for (n, value) in [
        message.longitude,
        message.latitude,
        message.height,
        message.height_msl,
    ]
    .iter()
    .enumerate()
    {
        put(24 + 4 * n, &value.to_le_bytes());
    }
    put(40, &message.horizontal_accuracy.to_le_bytes());
    put(44, &message.vertical_accuracy.to_le_bytes());
    let [north, east, down] = message.velocity;
    for (n, value) in [north, east, down, message.ground_speed, message.heading_of_motion]
        .iter()
        .enumerate()
    {
        put(48 + 4 * n, &value.to_le_bytes());
    }
    put(68, &message.speed_accuracy.to_le_bytes());
    put(72, &message.heading_accuracy.to_le_bytes());
    put(76, &message.position_dop.to_le_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The poll of MON-VER, as u-blox's own documents print it.
    const POLL: [u8; 8] = [0xB5, 0x62, 0x0A, 0x04, 0x00, 0x00, 0x0E, 0x34];

    #[test]
    fn a_frame_is_as_documents_print_it() {
        assert_eq!(frame([0x0A, 0x04], &[]), POLL);
    }

    #[test]
    fn frames_are_found_among_other_bytes() {
        let long = frame([6, 0x8A], &[7; 300]);
        let noise = [0xB5, 0xB5, 0x62, 0xB5, 0x00];
        let mut damaged = frame([1, 2], &[1, 2, 3]);
        damaged[7] ^= 1;
        let stream = [&noise[..], &POLL, &damaged, &long, &noise, &POLL].concat();
        let mut parser = Parser::default();
        let found: Vec<Message> = stream.iter().filter_map(|byte| parser.take(*byte)).collect();
        let ids: Vec<_> = found
            .iter()
            .map(|message| (message.id, message.payload.len()))
            .collect();
        assert_eq!(ids, [([10, 4], 0), ([6, 0x8A], 300), ([10, 4], 0)]);
    }

    #[test]
    fn a_length_that_none_has_does_not_hide_what_follows() {
        let stream = [&[0xB5, 0x62, 1, 7, 0xFF, 0xFF][..], &POLL].concat();
        let mut parser = Parser::default();
        assert_eq!(stream.iter().filter_map(|byte| parser.take(*byte)).count(), 1);
    }

    /// Places of fields as the interface description lists them.
    #[test]
    fn fields_of_nav_pvt_lie_at_their_places() {
        let bytes = nav_pvt(&NavPvt {
            time_of_week: 302_400_200 + LEAP_MS,
            latitude: 473_977_419,
            longitude: -85_455_938,
            height_msl: 488_000,
            velocity: [1000, -2000, 30],
            fix_type: 3,
            flags: 1,
            satellites: 16,
            position_dop: 130,
            ..NavPvt::default()
        });
        let signed = |place: usize| i32::from_le_bytes(bytes[place..place + 4].try_into().unwrap());
        assert_eq!(
            (signed(24), signed(28), signed(36)),
            (-85_455_938, 473_977_419, 488_000)
        );
        assert_eq!([signed(48), signed(52), signed(56)], [1000, -2000, 30]);
        assert_eq!(
            bytes[4..12],
            [0xEA, 0x07, 1, 7, 12, 0, 0, 7],
            "2026-01-07 12:00:00"
        );
        assert_eq!(signed(16), 200_000_000);
        assert_eq!([bytes[20], bytes[21], bytes[23], bytes[76]], [3, 1, 16, 130]);
    }
}
