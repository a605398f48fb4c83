//! SBUS.

use proptest::collection::vec;
use proptest::prelude::*;
use windhover_drivers::sbus::{Frame, Parser};
use windhover_model::sensor::sbus;

use super::{arb_channels, pulses};

fn feed(parser: &mut Parser, bytes: &[u8]) -> Vec<Frame> {
    let mut found = Vec::new();
    parser.feed(bytes, |frame| found.push(frame));
    found
}

/// A parser behind a pause.
fn ready() -> Parser {
    let mut parser = Parser::default();
    parser.restart();
    parser
}

fn heard(channels: &[u16; 16]) -> Frame {
    Frame {
        channels: Some(pulses(channels)),
        switches: Some([false; 2]),
        lost: false,
    }
}

/// Every byte of flags, read as the protocol has it: made-up sticks never come out.
#[test]
fn flags_say_what_channels_are_worth() {
    let channels = [172; 16];
    for flags in 0..=255 {
        let found = feed(&mut ready(), &sbus::frame(&channels, flags));
        let is_up = flags & sbus::FAILSAFE == 0;
        let switches = [flags & sbus::CHANNEL_17 != 0, flags & sbus::CHANNEL_18 != 0];
        let wanted = Frame {
            channels: is_up.then_some([988; 16]),
            switches: is_up.then_some(switches),
            lost: flags & sbus::FRAME_LOST != 0,
        };
        let wanted: &[Frame] = if flags < 16 { &[wanted] } else { &[] };
        assert_eq!(found, wanted, "flags {flags:#x}");
    }
}

/// Without a pause nobody knows where a frame begins.
#[test]
fn nothing_is_read_before_a_pause() {
    let mut parser = Parser::default();
    let frame = sbus::frame(&[992; 16], 0);
    assert_eq!(feed(&mut parser, &frame), []);
    parser.restart();
    assert_eq!(feed(&mut parser, &frame).len(), 1);
    assert_eq!((parser.counts().frames, parser.counts().skipped()), (1, 25));
}

proptest! {
    /// No way to cut the stream loses a frame, and a frame is there with its last byte.
    #[test]
    fn frames_are_found_however_they_are_cut(
        frames in vec(arb_channels(), 1..4),
        cuts in vec(1usize..40, 1..40),
    ) {
        let bytes: Vec<u8> = frames.iter().flat_map(|frame| sbus::frame(frame, 0)).collect();
        let wanted: Vec<Frame> = frames.iter().map(heard).collect();
        let (mut parser, mut found, mut rest) = (ready(), Vec::new(), &bytes[..]);
        for cut in cuts.iter().cycle() {
            let (piece, behind) = rest.split_at((*cut).min(rest.len()));
            found.extend(feed(&mut parser, piece));
            rest = behind;
            prop_assert_eq!(found.len(), (bytes.len() - rest.len()) / 25);
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(found, wanted);
        prop_assert_eq!((parser.counts().skipped(), parser.counts().refused), (0, 0));
    }

    /// Whatever came before, a frame behind a pause is read: a part of a frame, noise, an error.
    #[test]
    fn garbage_hides_no_frame(
        garbage in vec(any::<u8>(), 0..70),
        begun in 0usize..25,
        channels in arb_channels(),
        error in any::<bool>(),
    ) {
        let frame = sbus::frame(&channels, 0);
        let mut parser = ready();
        feed(&mut parser, &garbage);
        parser.restart();
        prop_assert_eq!(feed(&mut parser, &frame[..begun]), []);
        if error {
            parser.discard();
        }
        parser.restart();
        prop_assert_eq!(feed(&mut parser, &frame), [heard(&channels)]);
    }

    /// A wrong bit fails the parity of its byte, and the port says so before the next byte: no
    /// part of that frame is read, and none of the next before a pause.
    #[test]
    fn no_frame_with_an_error_is_accepted(channels in arb_channels(), wrong in 0usize..25) {
        let frame = sbus::frame(&channels, 0);
        let mut parser = ready();
        prop_assert_eq!(feed(&mut parser, &frame[..wrong]), []);
        parser.discard();
        prop_assert_eq!(feed(&mut parser, &frame[wrong + 1..]), []);
        prop_assert_eq!(feed(&mut parser, &frame), []);
        prop_assert_eq!(parser.counts().refused, u32::from(wrong > 0));
        parser.restart();
        prop_assert_eq!(feed(&mut parser, &frame), [heard(&channels)]);
    }

    /// Where the frame has fixed bits, even an error without parity is seen.
    #[test]
    fn no_flipped_bit_outside_of_the_channels_is_accepted(channels in arb_channels()) {
        let fixed = (0..8).chain(8 * 23 + 4..8 * 25);
        for bit in fixed {
            let mut frame = sbus::frame(&channels, 0);
            frame[bit / 8] ^= 1 << (bit % 8);
            let mut parser = ready();
            prop_assert_eq!(feed(&mut parser, &frame), [], "bit {}", bit);
            prop_assert_eq!(parser.counts().refused, 1);
        }
    }

    /// A lost byte costs the frame that it was in, though channels can look like a footer.
    #[test]
    fn a_lost_byte_costs_one_frame(channels in arb_channels(), lost in 0usize..25) {
        let frame = sbus::frame(&channels, 0);
        let mut parser = ready();
        prop_assert_eq!(feed(&mut parser, &frame[..lost]), []);
        prop_assert_eq!(feed(&mut parser, &frame[lost + 1..]), []);
        parser.restart();
        prop_assert_eq!(feed(&mut parser, &frame), [heard(&channels)]);
        prop_assert_eq!(parser.counts().refused, 1);
    }
}
