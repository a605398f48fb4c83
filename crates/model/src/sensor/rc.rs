//! What an RC receiver sends: sixteen channels as CRSF's integers of 11 bits.
//!
//! A frame that the link loses is not sent, and while the link is down none is: the receivers we
//! know fall silent instead of sending made-up sticks.

use super::{count, stream};
use crate::random::Random;

/// Channels of a frame (CRSF, RC_CHANNELS_PACKED).
pub const CHANNELS: usize = 16;

/// A channel at −1, 0 and 1: 988, 1500 and 2012 µs (CRSF, RC_CHANNELS_PACKED).
pub const LOW: u16 = 172;
/// In the middle.
pub const MIDDLE: u16 = 992;
/// At the upper end.
pub const HIGH: u16 = 1811;

/// Counts for the way from the middle to an end.
pub const SCALE: f64 = 0.5 * (HIGH - LOW) as f64;

/// Errors of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcErrors {
    /// Share of frames lost, each by itself.
    pub loss: f64,
    /// Noise of the transmitter's sticks, in counts: standard deviation.
    pub noise: f64,
}

impl RcErrors {
    /// No errors.
    pub const fn ideal() -> Self {
        Self {
            loss: 0.0,
            noise: 0.0,
        }
    }
}

impl Default for RcErrors {
    /// One frame of a hundred lost, half a count of noise: a link in good range. Ours.
    fn default() -> Self {
        Self {
            loss: 0.01,
            noise: 0.5,
        }
    }
}

/// One receiver and its transmitter.
#[derive(Clone, Debug)]
pub struct Rc {
    errors: RcErrors,
    random: Random,
    connected: bool,
}

impl Rc {
    /// A link that `seed` disturbs; it is up.
    pub fn new(errors: &RcErrors, seed: u64) -> Self {
        Self {
            errors: *errors,
            random: Random::new(seed, stream::RC),
            connected: true,
        }
    }

    /// Breaks or restores the link.
    pub fn connect(&mut self, connected: bool) {
        self.connected = connected;
    }

    /// The frame for sticks and switches of −1 to 1: once a period. `None` if it is lost.
    pub fn measure(&mut self, sticks: &[f64; CHANNELS]) -> Option<[u16; CHANNELS]> {
        let lost = self.random.uniform() < self.errors.loss;
        let frame = sticks.map(|stick| {
            let counts = f64::from(MIDDLE) + SCALE * stick + self.errors.noise * self.random.gaussian();
            count(counts, LOW.into(), HIGH.into()) as u16
        });
        (self.connected && !lost).then_some(frame)
    }
}

/// Channels of a frame on the wire, 11 bits each, the first in the lowest bits: as CRSF and SBUS
/// have them.
pub fn pack(channels: &[u16; CHANNELS]) -> [u8; 22] {
    let mut bytes = [0; 22];
    for (n, channel) in channels.iter().enumerate() {
        for bit in 0..11 {
            let place = 11 * n + bit;
            bytes[place / 8] |= ((channel >> bit & 1) as u8) << (place % 8);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the first bytes as the specification draws them, written out by hand.
    #[test]
    fn channels_are_packed_from_the_lowest_bit() {
        let mut channels = [0; CHANNELS];
        channels[0] = 0b101_0101_0011;
        channels[1] = 0b110_0000_0001;
        let bytes = pack(&channels);
        assert_eq!(bytes[..3], [0b0101_0011, 0b0000_1101, 0b0011_0000]);
        assert!(bytes[3..].iter().all(|byte| *byte == 0));
        channels = [0; CHANNELS];
        channels[15] = 0b100_0000_0001;
        assert_eq!(pack(&channels)[20..], [0b0010_0000, 0b1000_0000]);
    }
}
