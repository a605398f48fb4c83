//! The parser of the ground link: however a stream of bytes is cut, the same frames are found in it,
//! and every byte belongs to a frame or is counted.
#![no_main]

use libfuzzer_sys::fuzz_target;
use windhover_ground_link::frame::{Counts, Frame, Parser};

#[derive(Default)]
struct Found {
    frames: Vec<(u32, u8, Vec<u8>)>,
    bytes: usize,
}

impl Found {
    fn take(&mut self, frame: &Frame<'_>) {
        self.frames
            .push((frame.id, frame.sequence, frame.payload.to_vec()));
        self.bytes += frame.covered.len() + frame.signature.map_or(0, |signature| signature.len());
    }
}

fn parse(bytes: &[u8], cut: usize) -> (Found, Counts) {
    let (mut parser, mut found) = (Parser::default(), Found::default());
    for piece in bytes.chunks(cut) {
        parser.feed(piece, |frame| found.take(frame));
    }
    parser.give_up(|frame| found.take(frame));
    assert!(!parser.waits());
    (found, parser.counts())
}

fuzz_target!(|input: &[u8]| {
    let Some((cut, bytes)) = input.split_first() else {
        return;
    };
    let (whole, counts) = parse(bytes, bytes.len().max(1));
    let (pieces, same) = parse(bytes, usize::from(*cut).max(1));
    assert_eq!((whole.frames, counts), (pieces.frames, same));
    assert_eq!(whole.bytes + counts.skipped as usize, bytes.len());
});
