//! The wire of the remote control: every frame of CRSF that a search through the whole stream finds
//! is found however the stream is cut, SBUS is read the same however it is cut, and the receiver
//! that finds out which of them is spoken takes anything at any time.
#![no_main]

use libfuzzer_sys::fuzz_target;
use windhover_drivers::rc_receiver::RcReceiver;
use windhover_drivers::{crsf, sbus};
use windhover_model::sensor::crsf::{ADDRESS, LINK_STATISTICS, RC_CHANNELS, crc8};

fn parse_crsf(bytes: &[u8], cut: usize) -> (Vec<crsf::Frame>, crsf::Counts) {
    let (mut parser, mut found) = (crsf::Parser::default(), Vec::new());
    for piece in bytes.chunks(cut) {
        parser.feed(piece, |frame| found.push(frame));
    }
    (found, parser.counts())
}

fn parse_sbus(bytes: &[u8], cut: usize) -> (Vec<sbus::Frame>, sbus::Counts) {
    let (mut parser, mut found) = (sbus::Parser::default(), Vec::new());
    parser.restart();
    for piece in bytes.chunks(cut) {
        parser.feed(piece, |frame| found.push(frame));
    }
    (found, parser.counts())
}

/// Frames of a type and of a length that lie anywhere in the stream.
fn frames(bytes: &[u8], kind: u8, length: usize) -> usize {
    let is_frame = |frame: &&[u8]| {
        frame[..3] == [ADDRESS, length as u8 - 2, kind] && crc8(&frame[2..length - 1]) == frame[length - 1]
    };
    bytes.windows(length).filter(is_frame).count()
}

/// Byte by byte what happens: a wait, an error, arming, or so many bytes of the stream.
fn play(input: &[u8]) {
    let (mut receiver, mut now, mut armed) = (RcReceiver::default(), 0, false);
    let mut rest = input;
    while let Some((event, behind)) = rest.split_first() {
        rest = behind;
        let size = usize::from(event >> 2);
        match event % 4 {
            0 => now += 1 << (size % 24),
            1 => receiver.line_error(now),
            2 => armed = !armed,
            _ => {
                let (piece, behind) = rest.split_at(size.min(rest.len()));
                rest = behind;
                if let Some(channels) = receiver.bytes(piece, now) {
                    assert!(channels.iter().all(|pulse| (880..=2159).contains(pulse)));
                    assert!(receiver.protocol().is_some());
                }
            }
        }
        let before = receiver.protocol();
        let line = receiver.poll(now, armed);
        assert!(
            line.is_none() || before.is_none() || !armed,
            "a line in use stays while armed"
        );
    }
}

fuzz_target!(|input: &[u8]| {
    let Some((cut, bytes)) = input.split_first() else {
        return;
    };
    let (all, cut) = (bytes.len().max(1), usize::from(*cut).max(1));
    let (found, counts) = parse_crsf(bytes, all);
    assert_eq!((found, counts), parse_crsf(bytes, cut));
    assert_eq!(
        counts.channels as usize,
        frames(bytes, RC_CHANNELS, crsf::CHANNELS_BYTES)
    );
    let statistics = frames(bytes, LINK_STATISTICS, crsf::STATISTICS_BYTES);
    assert!(counts.statistics as usize <= statistics);
    assert_eq!(parse_sbus(bytes, all), parse_sbus(bytes, cut));
    play(bytes);
});
