//! Payloads: read field by field, written by the crate `mavlink`'s types.
//!
//! What comes is read by the places of its fields (`common.xml`; fields of a message are ordered
//! by their size, extensions follow). The crate's types would refuse a message whose enumerations
//! hold a number that they do not know; here such a number must be answered, not ignored. It takes
//! much less flash as well. The tests send by the crate's types: a wrong place would show.

use mavlink::{MavlinkVersion, MessageData};

use crate::frame::{Address, MAX_PAYLOAD};

/// A payload as it came.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Payload<'a>(pub &'a [u8]);

impl Payload<'_> {
    /// The byte in a place: 0 where zeros were left out.
    #[inline(never)]
    pub fn byte(self, at: usize) -> u8 {
        self.0.get(at).copied().unwrap_or_default()
    }

    /// So many bytes from a place on.
    pub fn bytes<const N: usize>(self, at: usize) -> [u8; N] {
        core::array::from_fn(|offset| self.byte(at + offset))
    }

    /// The two bytes from a place on, lowest first.
    #[inline(never)]
    pub fn word(self, at: usize) -> u16 {
        u16::from_le_bytes(self.bytes(at))
    }

    /// The same, with a sign.
    pub fn short(self, at: usize) -> i16 {
        self.word(at).cast_signed()
    }

    /// The four bytes from a place on.
    #[inline(never)]
    pub fn long(self, at: usize) -> u32 {
        u32::from_le_bytes(self.bytes(at))
    }

    /// The same, with a sign.
    pub fn integer(self, at: usize) -> i32 {
        self.long(at).cast_signed()
    }

    /// The eight bytes from a place on.
    #[inline(never)]
    pub fn huge(self, at: usize) -> u64 {
        u64::from(self.long(at)) | u64::from(self.long(at + 4)) << 32
    }

    /// The float in a place, bit for bit.
    pub fn float(self, at: usize) -> f32 {
        f32::from_bits(self.long(at))
    }

    /// Floats in a row.
    #[inline(never)]
    pub fn floats<const N: usize>(self, at: usize) -> [f32; N] {
        core::array::from_fn(|number| self.float(at + 4 * number))
    }

    /// Whether the target, a system and a component from a place on, is this address.
    #[inline(never)]
    pub fn is_for(self, own: Address, at: usize) -> bool {
        own.is_meant(self.byte(at), self.byte(at + 1))
    }
}

/// A text of a message: up to its first zero; empty when it is not UTF-8.
pub(crate) fn text(bytes: &[u8]) -> &str {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    let used = bytes.get(..end).unwrap_or_default();
    core::str::from_utf8(used).unwrap_or_default()
}

/// A message to be sent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Message {
    /// Its number.
    pub id: u32,
    bytes: [u8; MAX_PAYLOAD],
    length: usize,
}

impl Message {
    /// The message as the crate writes it.
    pub fn of<M: MessageData>(message: &M) -> Self {
        let mut bytes = [0; MAX_PAYLOAD];
        // The length that comes back leaves out zeros; a byte may still be set there.
        message.ser(MavlinkVersion::V2, &mut bytes);
        Self {
            id: M::ID,
            bytes,
            length: M::ENCODED_LEN,
        }
    }

    /// The same with another byte in a place.
    #[inline(never)]
    pub fn with_byte(mut self, at: usize, byte: u8) -> Self {
        if let Some(place) = self.bytes.get_mut(at) {
            *place = byte;
        }
        self
    }

    /// The same with two other bytes from a place on.
    pub fn with_word(self, at: usize, word: u16) -> Self {
        let [low, high] = word.to_le_bytes();
        self.with_byte(at, low).with_byte(at + 1, high)
    }

    /// Its bytes, zeros at the end included.
    pub fn payload(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::common::{MISSION_COUNT_DATA, MavMissionType};

    use super::*;

    /// Extension fields are really written.
    #[test]
    fn the_type_of_a_mission_is_written() {
        let message = Message::of(&MISSION_COUNT_DATA {
            count: 3,
            mission_type: MavMissionType::MAV_MISSION_TYPE_RALLY,
            ..MISSION_COUNT_DATA::DEFAULT
        });
        assert_eq!(message.payload(), &[3, 0, 0, 0, 2, 0, 0, 0, 0]);
    }

    #[test]
    fn fields_are_read_lowest_byte_first_and_zeros_beyond_the_end() {
        let payload = Payload(&[1, 2, 3, 0x80, 0xff, 0xff, 0, 0, 0x80, 0x3f]);
        assert_eq!((payload.byte(1), payload.word(1)), (2, 0x0302));
        assert_eq!(
            (payload.short(4), payload.integer(0)),
            (-1, 0x8003_0201_u32.cast_signed())
        );
        assert_eq!(payload.huge(2), 0x3f80_0000_ffff_8003);
        assert_eq!(payload.floats::<2>(6), [1.0, 0.0]);
        assert_eq!(
            (payload.byte(200), payload.word(9), payload.long(usize::MAX - 8)),
            (0, 0x3f, 0)
        );
    }
}
