//! Finds frames in a stream of bytes, whatever else is in it.
//!
//! A first byte of a frame may also be a byte of noise, followed by a length that is noise as
//! well. So nothing is taken off the stream before its checksum is right: where a frame seemed to
//! start and none did, the search goes on at the very next byte. A message that the dialect does
//! not have cannot be checked, and counts as noise: the search goes on behind its header.

use super::{Frame, Look, MAX_FRAME, look, put};

/// What a parser has seen since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames with a right checksum.
    pub frames: u32,
    /// Bytes that belong to no frame.
    pub skipped: u32,
}

/// Bytes that may yet become a frame.
#[derive(Clone, Debug)]
pub struct Parser {
    buffer: [u8; MAX_FRAME],
    length: usize,
    counts: Counts,
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            buffer: [0; MAX_FRAME],
            length: 0,
            counts: Counts::default(),
        }
    }
}

impl Parser {
    /// Takes bytes as they come, and gives the frames that they complete.
    pub fn feed(&mut self, bytes: &[u8], mut sink: impl FnMut(&Frame<'_>)) {
        let mut rest = bytes;
        while !rest.is_empty() {
            let space = self.buffer.get_mut(self.length..).unwrap_or_default();
            let taken = space.len().min(rest.len());
            put(space, rest);
            self.length += taken;
            rest = rest.get(taken..).unwrap_or_default();
            self.scan(0, &mut sink);
        }
    }

    /// Gives up what waits for more bytes: none will come. Frames inside it are still found.
    pub fn give_up(&mut self, mut sink: impl FnMut(&Frame<'_>)) {
        while self.length > 0 {
            self.counts.skipped = self.counts.skipped.saturating_add(1);
            self.scan(1, &mut sink);
        }
    }

    /// Whether the start of a frame waits for its end.
    pub fn waits(&self) -> bool {
        self.length > 0
    }

    /// What was seen since start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Gives all frames from `start` on, and keeps what may yet become one. A frame is never
    /// longer than the buffer, so that there is room again afterwards.
    fn scan(&mut self, mut start: usize, sink: &mut impl FnMut(&Frame<'_>)) {
        while let Some(rest) = self.buffer.get(start..self.length) {
            match look(rest) {
                _ if rest.is_empty() => break,
                Look::Short => break,
                Look::Whole(frame, length) => {
                    self.counts.frames = self.counts.frames.saturating_add(1);
                    sink(&frame);
                    start += length;
                }
                Look::Nothing => {
                    self.counts.skipped = self.counts.skipped.saturating_add(1);
                    start += 1;
                }
            }
        }
        self.discard(start);
    }

    /// Moves what is left to the front.
    fn discard(&mut self, start: usize) {
        if start == 0 {
            return;
        }
        self.length = self.length.saturating_sub(start);
        for to in 0..self.length {
            let byte = self.buffer.get(to + start).copied().unwrap_or_default();
            if let Some(place) = self.buffer.get_mut(to) {
                *place = byte;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use std::vec::Vec;

    use super::super::{Address, SIGNATURE, Writer};
    use super::*;

    /// `PARAM_VALUE`, `COMMAND_ACK`, `MISSION_ACK`: any of `common` will do.
    const IDS: [u32; 3] = [22, 77, 47];

    type Seen = Vec<(u32, Vec<u8>)>;

    fn frame(id: u32, payload: &[u8]) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        let mut writer = Writer::new(Address {
            system: 255,
            component: 190,
        });
        let length = writer.write(&mut buffer, id, payload, None).expect("it fits");
        buffer[..length].to_vec()
    }

    fn parse(parser: &mut Parser, bytes: &[u8]) -> Seen {
        let mut seen = Seen::new();
        parser.feed(bytes, |frame| seen.push((frame.id, frame.payload.to_vec())));
        seen
    }

    #[test]
    fn what_the_crate_writes_is_read_and_the_other_way_round() {
        use mavlink::dialects::common::{COMMAND_ACK_DATA, MavMessage};
        use mavlink::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader};
        let header = MavHeader {
            system_id: 7,
            component_id: 9,
            sequence: 200,
        };
        let message = MavMessage::COMMAND_ACK(COMMAND_ACK_DATA::default());
        let (mut first, mut second) = (MAVLinkV1MessageRaw::new(), MAVLinkV2MessageRaw::new());
        first.serialize_message(header, &message);
        second.serialize_message(header, &message);
        for bytes in [first.raw_bytes(), second.raw_bytes()] {
            let mut parser = Parser::default();
            let mut seen = 0;
            parser.feed(bytes, |frame| {
                seen += 1;
                let source = Address {
                    system: 7,
                    component: 9,
                };
                assert_eq!((frame.source, frame.sequence, frame.id), (source, 200, 77));
            });
            assert_eq!((seen, parser.counts().skipped), (1, 0));
        }
        let mut writer = Writer::new(Address {
            system: 7,
            component: 9,
        });
        writer.sequence = 200;
        let mut buffer = [0; MAX_FRAME];
        let length = writer.write(&mut buffer, 77, second.payload(), None);
        assert_eq!(length.map(|length| &buffer[..length]), Some(second.raw_bytes()));
    }

    #[test]
    fn zeros_at_the_end_are_left_out_and_one_byte_stays() {
        assert_eq!(frame(77, &[1, 2, 0, 0])[1], 2);
        assert_eq!(frame(77, &[0, 0, 0, 0])[1], 1);
        assert_eq!(frame(77, &[0; 255]).len(), 13);
    }

    /// A false start that claims 255 bytes, and true frames right behind it.
    #[test]
    fn a_false_start_swallows_nothing() {
        let truth = frame(77, &[1, 2, 3]);
        for false_start in [
            &[0xfe, 255, 0, 1, 1, 0][..],
            &[0xfd, 255, 0, 0, 0, 1, 1, 77, 0, 0],
            &[0xfd, 255, 1, 0, 0, 1, 1, 77, 0, 0],
            &[0xfd, 255],
            &[0xfd],
            &[0xfe],
        ] {
            let mut bytes = false_start.to_vec();
            bytes.extend(&truth);
            let mut parser = Parser::default();
            let mut seen = parse(&mut parser, &bytes);
            parser.give_up(|frame| seen.push((frame.id, frame.payload.to_vec())));
            assert_eq!(seen, [(77, [1, 2, 3].to_vec())], "{false_start:x?}");
            assert_eq!(parser.counts().skipped as usize, false_start.len());
            assert!(!parser.waits());
            // Without giving up, the frames that follow bring it to an end.
            let mut parser = Parser::default();
            let many: Vec<u8> = false_start
                .iter()
                .copied()
                .chain((0..40).flat_map(|_| truth.clone()))
                .collect();
            assert!(parse(&mut parser, &many).len() >= 20, "{false_start:x?}");
        }
    }

    #[test]
    fn a_message_of_another_dialect_is_passed_over() {
        let mut foreign = frame(77, &[5; 30]);
        foreign[7] = 0xc8;
        foreign[8] = 0x2b;
        let mut bytes = foreign.clone();
        bytes.extend(frame(22, &[9]));
        let mut parser = Parser::default();
        assert_eq!(parse(&mut parser, &bytes), [(22, [9].to_vec())]);
        assert_eq!(parser.counts().skipped as usize, foreign.len());
    }

    #[test]
    fn a_signature_is_given_apart() {
        let mut buffer = [0; MAX_FRAME];
        let mut writer = Writer::new(Address::default());
        let mut sign = |bytes: &[u8]| [bytes.len() as u8; SIGNATURE];
        let length = writer
            .write(&mut buffer, 77, &[1, 2, 3], Some(&mut sign))
            .unwrap();
        let mut parser = Parser::default();
        let mut seen = 0;
        parser.feed(&buffer[..length], |frame| {
            assert_eq!(frame.signature, Some(&[15; SIGNATURE]));
            assert_eq!(frame.covered, &buffer[..15]);
            seen += 1;
        });
        assert_eq!(seen, 1);
    }

    proptest! {
        /// Whatever noise lies between frames and however the stream is cut: every frame is found,
        /// in order, once enough has followed.
        #[test]
        fn frames_in_noise_are_found(
            parts in prop::collection::vec(
                (prop::collection::vec(any::<u8>(), 0..40), 0..3usize, prop::collection::vec(any::<u8>(), 1..60)),
                1..12,
            ),
            cut in 1..50usize,
        ) {
            let mut bytes = Vec::new();
            let mut sent = Seen::new();
            for (noise, kind, payload) in parts {
                bytes.extend(noise);
                bytes.extend(frame(IDS[kind], &payload));
                let used = payload.iter().rposition(|byte| *byte != 0).map_or(1, |last| last + 1);
                sent.push((IDS[kind], payload[..used].to_vec()));
            }
            let mut parser = Parser::default();
            let mut seen = Seen::new();
            for chunk in bytes.chunks(cut) {
                seen.extend(parse(&mut parser, chunk));
            }
            parser.give_up(|frame| seen.push((frame.id, frame.payload.to_vec())));
            prop_assert_eq!(&seen, &sent);
        }

        /// No damaged frame passes (a checksum of 16 bits misses no change within 16 bits).
        #[test]
        fn a_damaged_frame_is_none(payload in prop::collection::vec(1..=255u8, 1..60), place in 0..60usize, flip in 1..=255u8) {
            let mut bytes = frame(77, &payload);
            let place = 10 + place % payload.len();
            bytes[place] ^= flip;
            let mut parser = Parser::default();
            let found = parse(&mut parser, &bytes).len();
            prop_assert_eq!(found, 0);
        }
    }
}
