//! Payloads: read and written field by field.
//!
//! Fields have their places by `common.xml`: those of a message are ordered by their size, and
//! extensions follow as they are listed. The crate `mavlink`'s types would refuse a message whose
//! enumerations hold a number that they do not know; here such a number must be answered, not
//! ignored. They take much more flash as well. The tests send and read by the crate's types, so
//! that a wrong place shows.

use crate::frame::{Address, MAX_PAYLOAD, put};

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

/// A message to be sent, written field by field in the order of the wire.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Message {
    /// Its number.
    pub id: u32,
    bytes: [u8; MAX_PAYLOAD],
    length: usize,
}

impl Message {
    /// Nothing yet.
    pub const fn empty() -> Self {
        Self {
            id: 0,
            bytes: [0; MAX_PAYLOAD],
            length: 0,
        }
    }

    /// Starts anew, with this number.
    #[inline(never)]
    pub fn start(&mut self, id: u32) -> &mut Self {
        self.id = id;
        self.length = 0;
        self
    }

    /// Puts bytes at the end; what does not fit is left out.
    #[inline(never)]
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        let room = self.bytes.get_mut(self.length..).unwrap_or_default();
        self.length += room.len().min(bytes.len());
        put(room, bytes);
        self
    }

    /// A byte.
    #[inline(never)]
    pub fn byte(&mut self, byte: u8) -> &mut Self {
        self.bytes(&[byte])
    }

    /// Two bytes.
    #[inline(never)]
    pub fn word(&mut self, word: u16) -> &mut Self {
        self.bytes(&word.to_le_bytes())
    }

    /// The same, with a sign.
    pub fn short(&mut self, short: i16) -> &mut Self {
        self.word(short.cast_unsigned())
    }

    /// Four bytes.
    #[inline(never)]
    pub fn long(&mut self, long: u32) -> &mut Self {
        self.bytes(&long.to_le_bytes())
    }

    /// The same, with a sign.
    pub fn integer(&mut self, integer: i32) -> &mut Self {
        self.long(integer.cast_unsigned())
    }

    /// Eight bytes.
    #[inline(never)]
    pub fn huge(&mut self, huge: u64) -> &mut Self {
        self.bytes(&huge.to_le_bytes())
    }

    /// Floats in a row, bit for bit.
    #[inline(never)]
    pub fn floats(&mut self, floats: &[f32]) -> &mut Self {
        for float in floats {
            self.long(float.to_bits());
        }
        self
    }

    /// Fields that are not told: so many bytes of zero.
    #[inline(never)]
    pub fn zeros(&mut self, count: usize) -> &mut Self {
        for _ in 0..count {
            self.byte(0);
        }
        self
    }

    /// An address as a target.
    #[inline(never)]
    pub fn target(&mut self, to: Address) -> &mut Self {
        self.byte(to.system).byte(to.component)
    }

    /// What was written.
    pub fn payload(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_written_in_order_and_no_further_than_there_is_room() {
        let mut message = Message::empty();
        message
            .start(1)
            .word(0x0201)
            .short(-1)
            .integer(-2)
            .floats(&[1.0])
            .zeros(1)
            .byte(9);
        let expected = [1, 2, 0xff, 0xff, 0xfe, 0xff, 0xff, 0xff, 0, 0, 0x80, 0x3f, 0, 9];
        assert_eq!(message.payload(), expected);
        message.start(2).zeros(250).huge(u64::MAX);
        assert_eq!((message.payload().len(), message.payload()[254]), (255, 0xff));
        assert_eq!((message.id, message.start(3).payload().len()), (2, 0));
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
