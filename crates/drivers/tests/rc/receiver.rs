//! A receiver that is found out, on a line that carries bytes only as long as both ends agree.

use proptest::collection::vec;
use proptest::prelude::*;
use windhover_drivers::rc_receiver::{Line, Parity, Protocol, RcReceiver, SILENCE_US, StopBits, TRIAL_US};
use windhover_model::sensor::{crsf, sbus};

use super::{arb_channels, pulses};

/// Between frames, in µs.
const PERIOD_US: u64 = 10_000;

const MIDDLE: [u16; 16] = [992; 16];

const CRSF: Line = Line {
    baud: 420_000,
    parity: Parity::None,
    stop_bits: StopBits::One,
    inverted: false,
};

const SBUS: Line = Line {
    baud: 100_000,
    parity: Parity::Even,
    stop_bits: StopBits::Two,
    inverted: true,
};

/// The port, its owner and what is plugged in.
struct Bench {
    receiver: RcReceiver,
    line: Option<Line>,
    now: u64,
    armed: bool,
}

impl Bench {
    fn new() -> Self {
        Self {
            receiver: RcReceiver::default(),
            line: None,
            now: 0,
            armed: false,
        }
    }

    /// A period goes by, at whose end `bytes` come over a line of this format: as they are if the
    /// port is set so, else as noise with an error.
    fn step(&mut self, format: Line, bytes: &[u8]) -> Option<[u16; 16]> {
        self.now += PERIOD_US;
        self.line = self.receiver.poll(self.now, self.armed).or(self.line);
        self.now += 5_000;
        if self.line == Some(format) {
            return self.receiver.bytes(bytes, self.now);
        }
        let noise: Vec<u8> = bytes.iter().map(|byte| byte.rotate_left(3) ^ 0x5A).collect();
        let found = self.receiver.bytes(&noise, self.now);
        self.receiver.line_error(self.now);
        assert_eq!(found, None, "noise moves no stick");
        None
    }

    fn crsf(&mut self, channels: &[u16; 16]) -> Option<[u16; 16]> {
        self.step(CRSF, &crsf::channels(channels))
    }

    fn sbus(&mut self, channels: &[u16; 16], flags: u8) -> Option<[u16; 16]> {
        self.step(SBUS, &sbus::frame(channels, flags))
    }

    /// Nothing comes for so long. Gives the lines that were set, and when.
    fn silence(&mut self, length: u64) -> Vec<(u64, Line)> {
        let (begin, mut set) = (self.now, Vec::new());
        while self.now < begin + length {
            self.now += 1_000;
            if let Some(line) = self.receiver.poll(self.now, self.armed) {
                self.line = Some(line);
                set.push((self.now, line));
            }
        }
        set
    }
}

/// A protocol that is never tried is never found.
#[test]
fn both_are_tried_in_turn_for_half_a_second() {
    let mut bench = Bench::new();
    let set = bench.silence(4 * TRIAL_US);
    let lines: Vec<Line> = set.iter().map(|(_, line)| *line).collect();
    assert_eq!(lines, [CRSF, SBUS, CRSF, SBUS]);
    assert!(set.windows(2).all(|pair| pair[1].0 - pair[0].0 == TRIAL_US));
    assert_eq!(bench.receiver.protocol(), None);
}

#[test]
fn nothing_is_read_before_the_line_is_set() {
    let mut receiver = RcReceiver::default();
    assert_eq!(receiver.bytes(&crsf::channels(&MIDDLE), 5_000), None);
    assert_eq!(receiver.counts().crsf.bytes, 0);
}

/// Whenever the receiver is plugged in, its sticks arrive within one round of trials.
#[test]
fn each_is_found_whenever_it_begins() {
    for begin in (0..2 * TRIAL_US).step_by(37_000) {
        for protocol in [Protocol::Crsf, Protocol::Sbus] {
            let mut bench = Bench::new();
            bench.silence(begin);
            let from = bench.now;
            let found = loop {
                let found = match protocol {
                    Protocol::Crsf => bench.crsf(&MIDDLE),
                    Protocol::Sbus => bench.sbus(&MIDDLE, 0),
                };
                assert!(bench.now - from < 2 * TRIAL_US + 100_000, "{protocol:?} {begin}");
                if let Some(found) = found {
                    break found;
                }
            };
            assert_eq!(found, [1500; 16]);
            assert_eq!(bench.receiver.protocol(), Some(protocol));
            assert_eq!(bench.line, Some(protocol.line()));
        }
    }
}

/// A single frame of SBUS could be noise: only the second gives sticks.
#[test]
fn sbus_is_proven_by_two_frames() {
    let mut bench = Bench::new();
    bench.silence(TRIAL_US + 10_000);
    assert_eq!(bench.line, Some(SBUS));
    assert_eq!(bench.sbus(&MIDDLE, 0), None);
    assert_eq!(bench.receiver.protocol(), None);
    assert_eq!(bench.sbus(&MIDDLE, 0), Some([1500; 16]));
}

/// A receiver whose transmitter is off is recognised, and gives no sticks.
#[test]
fn failsafe_and_lost_frames_give_no_channels() {
    let mut bench = Bench::new();
    bench.silence(TRIAL_US + 10_000);
    for _ in 0..10 {
        assert_eq!(bench.sbus(&MIDDLE, sbus::FAILSAFE | sbus::FRAME_LOST), None);
    }
    assert_eq!(bench.receiver.protocol(), Some(Protocol::Sbus));
    assert_eq!(bench.sbus(&MIDDLE, 0), Some([1500; 16]));
    assert_eq!(
        bench.sbus(&MIDDLE, sbus::FRAME_LOST),
        None,
        "old sticks are no news"
    );
    assert_eq!(bench.sbus(&MIDDLE, sbus::FAILSAFE), None);
    let late = [sbus::frame(&MIDDLE, 0), sbus::frame(&MIDDLE, sbus::FAILSAFE)].concat();
    assert_eq!(bench.step(SBUS, &late), None, "the last word counts");
    let counts = bench.receiver.counts();
    assert_eq!((counts.sbus.failsafe, counts.sbus.lost), (12, 11));
    assert_eq!(counts.superseded, 1);
}

/// In flight a link that comes back has to be heard at once; on the ground another receiver may
/// have been plugged in.
#[test]
fn the_line_stays_while_armed_and_is_looked_for_again_on_the_ground() {
    for protocol in [Protocol::Crsf, Protocol::Sbus] {
        let mut bench = Bench::new();
        let speak = |bench: &mut Bench| match protocol {
            Protocol::Crsf => bench.crsf(&MIDDLE),
            Protocol::Sbus => bench.sbus(&MIDDLE, 0),
        };
        while speak(&mut bench).is_none() {}
        bench.armed = true;
        assert_eq!(bench.silence(10 * SILENCE_US), []);
        assert_eq!(speak(&mut bench), Some([1500; 16]), "{protocol:?} at once");
        bench.armed = false;
        assert_eq!(bench.silence(SILENCE_US - 1_000), []);
        assert_eq!(bench.receiver.protocol(), Some(protocol));
        let set = bench.silence(1_000);
        assert_eq!(set, [(bench.now, CRSF)]);
        assert_eq!(bench.receiver.protocol(), None);
    }
}

/// Statistics are no sticks, but show that the receiver lives, and which it is.
#[test]
fn statistics_keep_the_line() {
    let bytes = crsf::frame(crsf::LINK_STATISTICS, &crsf::GOOD_LINK);
    let mut bench = Bench::new();
    for _ in 0..2 * SILENCE_US / PERIOD_US {
        assert_eq!(bench.step(CRSF, &bytes), None);
    }
    assert_eq!(bench.receiver.protocol(), Some(Protocol::Crsf));
    let quality = bench.receiver.statistics().map(|link| link.uplink_quality);
    assert_eq!(quality, Some(100));
    bench.silence(SILENCE_US);
    assert_eq!(bench.receiver.statistics(), None, "of a receiver that is gone");
}

/// Sticks that were held up are not played back one by one.
#[test]
fn the_newest_of_a_piece_is_handed_out() {
    let mut bench = Bench::new();
    let bytes: Vec<u8> = [172, 992, 1811]
        .iter()
        .flat_map(|channel| crsf::channels(&[*channel; 16]))
        .collect();
    assert_eq!(bench.step(CRSF, &bytes), Some([2012; 16]));
    assert_eq!(bench.receiver.counts().superseded, 2);
}

proptest! {
    /// A byte that goes lost costs the frame that it was in and no other, and moves no stick: the
    /// pause behind a frame ends it.
    #[test]
    fn a_lost_byte_costs_one_frame(channels in arb_channels(), lost in 0usize..25) {
        for (format, frame) in [
            (CRSF, crsf::channels(&channels)),
            (SBUS, sbus::frame(&channels, 0).to_vec()),
        ] {
            let mut bench = Bench::new();
            while bench.step(format, &frame).is_none() {}
            let mut broken = frame.clone();
            broken.remove(lost);
            prop_assert_eq!(bench.step(format, &broken), None);
            prop_assert_eq!(bench.step(format, &frame), Some(pulses(&channels)));
        }
    }

    /// Pieces of a frame with a pause in between are not put together, with less they are.
    #[test]
    fn a_pause_ends_a_frame(channels in arb_channels(), cut in 1usize..25, wait in 0u64..20_000) {
        for (format, frame) in [
            (CRSF, crsf::channels(&channels)),
            (SBUS, sbus::frame(&channels, 0).to_vec()),
        ] {
            let mut bench = Bench::new();
            while bench.step(format, &frame).is_none() {}
            prop_assert_eq!(bench.step(format, &frame[..cut]), None);
            let found = bench.receiver.bytes(&frame[cut..], bench.now + wait);
            prop_assert_eq!(found, (wait < 2_500).then(|| pulses(&channels)));
        }
    }

    /// Whatever comes whenever, clocks that jump included, nothing panics and a receiver that
    /// then speaks is heard.
    #[test]
    fn nothing_stops_it(
        events in vec((any::<u32>(), vec(any::<u8>(), 0..60), any::<bool>(), any::<bool>()), 0..60),
        channels in arb_channels(),
    ) {
        let mut bench = Bench::new();
        for (time, bytes, armed, error) in events {
            bench.now = time.into();
            bench.line = bench.receiver.poll(bench.now, armed).or(bench.line);
            bench.receiver.bytes(&bytes, bench.now);
            if error {
                bench.receiver.line_error(bench.now);
            }
        }
        bench.now = 2 * u64::from(u32::MAX);
        bench.silence(SILENCE_US + TRIAL_US);
        let heard = (0..200).find_map(|_| bench.crsf(&channels));
        prop_assert_eq!(heard, Some(pulses(&channels)));
    }
}
