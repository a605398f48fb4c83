//! Payloads: the crate `mavlink`'s types, read and written.
//!
//! The crate refuses a message whose enumerations hold a number that it does not know. Here such a
//! number must be answered, not ignored: it is read beside the message, and the message is read
//! with a number in its place that the crate knows.

use mavlink::dialects::common::{MavCmd, MavFrame};
use mavlink::{MavlinkVersion, MessageData};

use crate::frame::{MAX_PAYLOAD, put};

/// A number that the crate knows as a command: a waypoint.
const SOME_COMMAND: [u8; 2] = (MavCmd::MAV_CMD_NAV_WAYPOINT as u16).to_le_bytes();

/// A number that the crate knows as a frame: global.
const SOME_FRAME: u8 = MavFrame::MAV_FRAME_GLOBAL as u8;

/// A payload as it came.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Payload<'a>(pub &'a [u8]);

impl Payload<'_> {
    /// The message, if all its numbers are known.
    pub fn read<M: MessageData>(self) -> Option<M> {
        M::deser(MavlinkVersion::V2, self.0).ok()
    }

    /// The message with other bytes in some places.
    pub fn read_with<M: MessageData>(self, bytes: &[(usize, u8)]) -> Option<M> {
        M::deser(MavlinkVersion::V2, &self.patched(bytes)).ok()
    }

    /// A copy with other bytes in some places.
    #[inline(never)]
    fn patched(self, bytes: &[(usize, u8)]) -> [u8; MAX_PAYLOAD] {
        let mut copy = [0; MAX_PAYLOAD];
        put(&mut copy, self.0);
        for (at, byte) in bytes {
            if let Some(place) = copy.get_mut(*at) {
                *place = *byte;
            }
        }
        copy
    }

    /// The message, read with a known command in this place, and perhaps a known frame in that.
    pub fn read_command<M: MessageData>(self, command: usize, frame: Option<usize>) -> Option<M> {
        let [low, high] = SOME_COMMAND;
        let frame = (frame.unwrap_or(MAX_PAYLOAD), SOME_FRAME);
        self.read_with(&[(command, low), (command + 1, high), frame])
    }

    /// The byte in a place: 0 where zeros were left out.
    pub fn byte(self, at: usize) -> u8 {
        self.0.get(at).copied().unwrap_or_default()
    }

    /// The two bytes from a place on, lowest first.
    pub fn word(self, at: usize) -> u16 {
        u16::from_le_bytes([self.byte(at), self.byte(at + 1)])
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
    use mavlink::dialects::common::{COMMAND_LONG_DATA, MISSION_COUNT_DATA, MavMissionType};

    use super::*;

    /// Extension fields are really there, both ways.
    #[test]
    fn the_type_of_a_mission_is_written_and_read() {
        let sent = MISSION_COUNT_DATA {
            count: 3,
            mission_type: MavMissionType::MAV_MISSION_TYPE_RALLY,
            ..MISSION_COUNT_DATA::DEFAULT
        };
        let message = Message::of(&sent);
        assert_eq!(message.payload(), &[3, 0, 0, 0, 2, 0, 0, 0, 0]);
        let payload = Payload(message.payload());
        assert_eq!(payload.read::<MISSION_COUNT_DATA>(), Some(sent));
        assert_eq!(payload.byte(4), 2);
    }

    #[test]
    fn a_command_that_the_crate_does_not_know_is_read_all_the_same() {
        let message = Message::of(&COMMAND_LONG_DATA {
            param1: 2.5,
            ..COMMAND_LONG_DATA::DEFAULT
        });
        let message = message.with_word(28, 60_123);
        let payload = Payload(message.payload());
        assert_eq!(payload.read::<COMMAND_LONG_DATA>(), None);
        let read = payload.read_command::<COMMAND_LONG_DATA>(28, None);
        assert_eq!(read.map(|read| read.param1), Some(2.5));
        assert_eq!(payload.word(28), 60_123);
        assert_eq!((payload.byte(200), payload.word(32)), (0, 0));
    }
}
