//! A serial line: bytes as levels in time, and what a receiver makes of them.
//!
//! A frame is told when its last stop bit is over. A receiver of the same format takes it whole.
//! One of another format hears the levels, a frame late, and samples them by its own clock: at a
//! wrong baud rate it finds other bytes, framing and parity errors, or nothing.

use std::collections::VecDeque;

use crate::time::{NEVER, SECOND};

/// What follows the data bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// Nothing.
    None,
    /// A bit that makes the number of ones even.
    Even,
    /// A bit that makes it odd.
    Odd,
}

/// How a byte lies on the line, between one start bit and its stop bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Length of a bit in ticks.
    pub bit: u64,
    /// Data bits, the parity bit not among them.
    pub data_bits: u32,
    /// What follows them.
    pub parity: Parity,
    /// Stop bits, in halves.
    pub stop_halves: u64,
}

impl Format {
    /// Eight bits, no parity, one stop bit.
    pub const fn plain(baud: u64) -> Self {
        Self {
            bit: SECOND / baud,
            data_bits: 8,
            parity: Parity::None,
            stop_halves: 2,
        }
    }

    /// Eight bits, even parity, two stop bits: SBUS.
    pub const fn even_with_two_stop_bits(baud: u64) -> Self {
        Self {
            parity: Parity::Even,
            stop_halves: 4,
            ..Self::plain(baud)
        }
    }

    /// Data bits and the parity bit, if there is one.
    const fn bits(&self) -> u32 {
        self.data_bits + !matches!(self.parity, Parity::None) as u32
    }

    /// Length of a frame in ticks, from the edge of the start bit to the end of the last stop bit.
    pub const fn frame_time(&self) -> u64 {
        (2 * (1 + self.bits() as u64) + self.stop_halves) * self.bit / 2
    }

    /// Data of so many bits.
    pub const fn mask(&self) -> u16 {
        (1 << self.data_bits) - 1
    }

    /// The data with the parity bit above them.
    fn with_parity(&self, data: u16) -> u16 {
        let data = data & self.mask();
        let odd_ones = data.count_ones() % 2 == 1;
        let parity = match self.parity {
            Parity::None => false,
            Parity::Even => odd_ones,
            Parity::Odd => !odd_ones,
        };
        data | u16::from(parity) << self.data_bits
    }

    /// Whether a receiver of this format reads frames of another without error: the same bits, at
    /// a rate off by at most 2 %, with a stop bit at least.
    fn reads(&self, other: &Self) -> bool {
        (self.data_bits, self.parity) == (other.data_bits, other.parity)
            && other.stop_halves >= 2
            && 50 * self.bit.abs_diff(other.bit) <= self.bit
    }
}

/// A byte on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The data bits, the first one sent lowest.
    pub data: u16,
    /// How they were sent.
    pub format: Format,
}

/// What a receiver read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heard {
    /// Data bits, the first one received lowest, and the parity bit above them.
    pub bits: u16,
    /// The stop bit was low.
    pub framing_error: bool,
    /// The parity bit was wrong.
    pub parity_error: bool,
}

/// A receiver's input.
#[derive(Clone, Debug, Default)]
pub struct Receiver {
    /// Levels from a moment on, in the order of time. The line is high before the first.
    levels: VecDeque<(u64, bool)>,
    /// A start bit is looked for from here on.
    free: u64,
    /// End of the last frame among the levels.
    end: u64,
}

impl Receiver {
    /// A frame is over. What is read at once, where nothing of before is still to be read.
    pub fn hear(&mut self, now: u64, frame: Frame, format: &Format) -> Option<Heard> {
        if self.levels.is_empty() && format.reads(&frame.format) {
            return Some(Heard {
                bits: format.with_parity(frame.data),
                framing_error: false,
                parity_error: false,
            });
        }
        self.add(self.end.max(now), frame);
        None
    }

    /// A frame's levels, beginning now.
    fn add(&mut self, start: u64, frame: Frame) {
        let Frame { data, format } = frame;
        let mut edge = |time, level| {
            let before = self.levels.back().is_none_or(|(_, level)| *level);
            if level != before {
                self.levels.push_back((time, level));
            }
        };
        edge(start, false);
        let bits = format.with_parity(data);
        for bit in 0..format.bits() {
            edge(start + u64::from(1 + bit) * format.bit, bits & (1 << bit) != 0);
        }
        edge(start + u64::from(1 + format.bits()) * format.bit, true);
        self.end = start + format.frame_time();
    }

    /// When a byte that begins among the levels will have been read.
    pub fn next_event(&self, format: &Format) -> u64 {
        self.start()
            .map_or(NEVER, |start| start + Self::reading_time(format))
    }

    /// From the edge of the start bit to the middle of the stop bit.
    fn reading_time(format: &Format) -> u64 {
        u64::from(1 + format.bits()) * format.bit + format.bit / 2
    }

    /// The first falling edge that may be that of a start bit.
    fn start(&self) -> Option<u64> {
        let falls = |(time, level): &&(u64, bool)| *time >= self.free && !level;
        self.levels.iter().find(falls).map(|(time, _)| *time)
    }

    fn level(&self, time: u64) -> bool {
        let before = self.levels.iter().rev().find(|(from, _)| *from <= time);
        before.is_none_or(|(_, level)| *level)
    }

    /// Reads what has come in by now. A start bit that is not low in its middle is none.
    pub fn advance(&mut self, now: u64, format: &Format) -> Option<Heard> {
        while let Some(start) = self.start() {
            if start + Self::reading_time(format) > now {
                return None;
            }
            let middle = |bit: u32| start + u64::from(bit) * format.bit + format.bit / 2;
            if self.level(middle(0)) {
                self.forget(start + 1);
                continue;
            }
            let bits = (0..format.bits()).fold(0, |bits, bit| {
                bits | u16::from(self.level(middle(1 + bit))) << bit
            });
            let stop = middle(1 + format.bits());
            let heard = Heard {
                bits,
                framing_error: !self.level(stop),
                parity_error: format.with_parity(bits) != bits,
            };
            self.forget(stop);
            return Some(heard);
        }
        self.levels.clear();
        None
    }

    /// What was before does not matter any more.
    fn forget(&mut self, before: u64) {
        self.free = before;
        while self.levels.get(1).is_some_and(|(next, _)| *next <= before) {
            self.levels.pop_front();
        }
        if self.start().is_none() && self.level(NEVER) {
            self.levels.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENT: Format = Format::plain(115_200);

    /// What a receiver of one format makes of bytes of another, sent one behind the other.
    fn read(sender: Format, receiver: Format, bytes: &[u8]) -> Vec<Heard> {
        let mut input = Receiver::default();
        let mut heard = vec![];
        let wait = |input: &mut Receiver, until: u64| {
            let mut heard = vec![];
            while input.next_event(&receiver) <= until {
                let now = input.next_event(&receiver);
                heard.extend(input.advance(now, &receiver));
            }
            heard
        };
        let mut now = 0;
        for byte in bytes {
            now += sender.frame_time();
            heard.extend(wait(&mut input, now - 1));
            let frame = Frame {
                data: u16::from(*byte),
                format: sender,
            };
            heard.extend(input.hear(now, frame, &receiver));
        }
        heard.extend(wait(&mut input, now + SECOND));
        heard
    }

    fn bits(heard: &[Heard]) -> Vec<u16> {
        heard.iter().map(|heard| heard.bits).collect()
    }

    fn errors(heard: &[Heard]) -> usize {
        let wrong = |heard: &&Heard| heard.framing_error || heard.parity_error;
        heard.iter().filter(wrong).count()
    }

    #[test]
    fn the_same_format_reads_every_byte() {
        let all: Vec<u8> = (0..=255).collect();
        for format in [SENT, Format::even_with_two_stop_bits(100_000)] {
            let heard = read(format, format, &all);
            assert_eq!(heard.len(), 256);
            assert_eq!(errors(&heard), 0);
            assert!(
                heard
                    .iter()
                    .zip(&all)
                    .all(|(heard, byte)| heard.bits as u8 == *byte)
            );
        }
    }

    /// The sampled path must agree with the direct one wherever both can read.
    #[test]
    fn a_rate_that_is_off_by_three_per_cent_is_read_by_sampling() {
        let all: Vec<u8> = (0..=255).collect();
        for baud in [112_000, 118_700] {
            let heard = read(Format::plain(baud), SENT, &all);
            assert_eq!(errors(&heard), 0);
            assert_eq!(bits(&heard), (0..=255).collect::<Vec<u16>>());
        }
    }

    /// A start bit of another rate covers the whole frame: zeros without a stop bit.
    #[test]
    fn a_receiver_that_is_ten_times_too_fast_reads_breaks() {
        let heard = read(Format::plain(9_600), SENT, b"U");
        assert_eq!((heard[0].bits, heard[0].framing_error), (0, true));
        assert_eq!(heard.len(), 5, "one for each falling edge of 0x55");
    }

    #[test]
    fn a_receiver_that_is_too_slow_reads_few_and_wrong_bytes() {
        let text = b"\xB5\x62\x01\x07\x5C\x00 and so on and so forth";
        let heard = read(SENT, Format::plain(9_600), text);
        assert!(heard.len() < text.len() / 4, "{}", heard.len());
        assert!(!bits(&heard).contains(&0xB5));
    }

    #[test]
    fn a_sender_without_parity_fails_at_a_receiver_with_it() {
        let all: Vec<u8> = (0..=255).collect();
        let mut with_parity = SENT;
        with_parity.parity = Parity::Even;
        // The stop bit stands where parity should be, and is right for every second byte.
        let heard = read(SENT, with_parity, &all[..64]);
        assert!(errors(&heard) >= 16, "{}", errors(&heard));
    }

    #[test]
    fn after_silence_nothing_is_left() {
        let mut input = Receiver::default();
        let fast = Format::plain(420_000);
        let frame = |format| Frame { data: 0x0F, format };
        assert_eq!(input.hear(1000, frame(SENT), &fast), None);
        while input.next_event(&fast) != NEVER {
            input.advance(input.next_event(&fast), &fast);
        }
        let heard = input.hear(SECOND, frame(fast), &fast).unwrap();
        assert_eq!(heard.bits, 0x0F);
    }
}
