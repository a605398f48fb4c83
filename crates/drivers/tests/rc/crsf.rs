//! CRSF.

use proptest::collection::vec;
use proptest::prelude::*;
use windhover_drivers::crsf::{Frame, LinkStatistics, Parser};
use windhover_model::sensor::crsf;

use super::{arb_channels, pulses};

fn feed(parser: &mut Parser, bytes: &[u8]) -> Vec<Frame> {
    let mut found = Vec::new();
    parser.feed(bytes, |frame| found.push(frame));
    found
}

/// Fields in the order of the specification, with signs where it has them.
#[test]
fn statistics_are_read_as_they_are_written() {
    let bytes = crsf::frame(
        crsf::LINK_STATISTICS,
        &[61, 72, 99, (-7i8) as u8, 1, 5, 3, 83, 94, (-2i8) as u8],
    );
    let statistics = LinkStatistics {
        uplink_rssi: [61, 72],
        uplink_quality: 99,
        uplink_snr: -7,
        active_antenna: 1,
        rf_mode: 5,
        uplink_power: 3,
        downlink_rssi: 83,
        downlink_quality: 94,
        downlink_snr: -2,
    };
    let found = feed(&mut Parser::default(), &bytes);
    assert_eq!(found, [Frame::Statistics(statistics)]);
}

/// Types and addresses of others may not pass for a pilot's sticks.
#[test]
fn other_frames_are_passed_over() {
    let mut parser = Parser::default();
    for kind in (0..=255).filter(|kind| ![crsf::RC_CHANNELS, crsf::LINK_STATISTICS].contains(kind)) {
        for length in 0..=crsf::MAX_PAYLOAD {
            assert_eq!(feed(&mut parser, &crsf::frame(kind, &vec![kind; length])), []);
        }
    }
    for length in (0..=crsf::MAX_PAYLOAD).filter(|length| *length != 22) {
        let bytes = crsf::frame(crsf::RC_CHANNELS, &vec![7; length]);
        assert_eq!(feed(&mut parser, &bytes), [], "{length} bytes are no 16 channels");
    }
    let mut bytes = crsf::channels(&[992; 16]);
    for address in (0..=255).filter(|address| *address != crsf::ADDRESS) {
        bytes[0] = address;
        assert_eq!(feed(&mut parser, &bytes), [], "address {address:#x}");
    }
    let counts = parser.counts();
    assert_eq!((counts.channels, counts.statistics, counts.refused), (0, 0, 0));
    assert_eq!(counts.skipped(), counts.bytes);
}

/// A restart is for a line that was set anew: two halves from before and after are no frame.
#[test]
fn a_restart_forgets_what_was_under_way() {
    let bytes = crsf::channels(&[992; 16]);
    for cut in 1..bytes.len() {
        let mut parser = Parser::default();
        feed(&mut parser, &bytes[..cut]);
        parser.restart();
        assert_eq!(feed(&mut parser, &bytes[cut..]), []);
        assert_eq!(feed(&mut parser, &bytes).len(), 1);
    }
}

proptest! {
    /// No way to cut the stream loses a frame, and a frame is there with its last byte.
    #[test]
    fn frames_are_found_however_they_are_cut(
        frames in vec(arb_channels(), 1..4),
        cuts in vec(1usize..40, 1..40),
    ) {
        let bytes: Vec<u8> = frames.iter().flat_map(crsf::channels).collect();
        let wanted: Vec<Frame> = frames.iter().map(|frame| Frame::Channels(pulses(frame))).collect();
        let (mut parser, mut found, mut rest) = (Parser::default(), Vec::new(), &bytes[..]);
        for cut in cuts.iter().cycle() {
            let (piece, behind) = rest.split_at((*cut).min(rest.len()));
            found.extend(feed(&mut parser, piece));
            rest = behind;
            prop_assert_eq!(found.len(), (bytes.len() - rest.len()) / 26);
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(found, wanted);
        prop_assert_eq!(parser.counts().skipped(), 0);
        prop_assert_eq!(parser.counts().refused, 0);
    }

    /// Garbage, even such as begins like a frame, hides no frame behind it: what a search through
    /// the whole stream finds is found, and the rest is counted.
    #[test]
    fn garbage_hides_no_frame(pieces in vec((garbage(), arb_channels()), 1..6)) {
        let (mut parser, mut found, mut stream) = (Parser::default(), Vec::new(), Vec::new());
        for (garbage, channels) in &pieces {
            found.extend(feed(&mut parser, garbage));
            let now = feed(&mut parser, &crsf::channels(channels));
            prop_assert_eq!(now.last(), Some(&Frame::Channels(pulses(channels))));
            found.extend(now);
            stream.extend(garbage);
            stream.extend(crsf::channels(channels));
        }
        prop_assert_eq!(found.len(), stream.windows(26).filter(|bytes| is_frame(bytes)).count());
        if found.len() == pieces.len() {
            prop_assert_eq!(parser.counts().skipped() as usize, stream.len() - 26 * found.len());
        }
    }

    /// The CRC sees any single error, and so do the fixed bytes: no stick moves by noise.
    #[test]
    fn no_frame_with_a_flipped_bit_is_accepted(channels in arb_channels(), link in any::<[u8; 10]>()) {
        for frame in [crsf::channels(&channels), crsf::frame(crsf::LINK_STATISTICS, &link)] {
            for bit in 0..8 * frame.len() {
                let mut flipped = frame.clone();
                flipped[bit / 8] ^= 1 << (bit % 8);
                let mut parser = Parser::default();
                prop_assert_eq!(feed(&mut parser, &flipped), []);
                let counts = parser.counts();
                prop_assert_eq!(counts.refused, u32::from(bit >= 24), "bit {}", bit);
            }
        }
    }
}

/// A frame with channels, as one looks at it whole.
fn is_frame(bytes: &[u8]) -> bool {
    bytes[..3] == [crsf::ADDRESS, 24, crsf::RC_CHANNELS] && crsf::crc8(&bytes[2..25]) == bytes[25]
}

/// Bytes, and beginnings of frames.
fn garbage() -> impl Strategy<Value = Vec<u8>> {
    let begun = (arb_channels(), 0usize..26).prop_map(|(channels, length)| {
        let mut bytes = crsf::channels(&channels);
        bytes.truncate(length);
        bytes
    });
    let piece = prop_oneof![vec(any::<u8>(), 0..70), vec(Just(crsf::ADDRESS), 0..30), begun];
    vec(piece, 0..4).prop_map(|pieces| pieces.concat())
}
