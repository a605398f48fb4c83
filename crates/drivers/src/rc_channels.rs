//! Channels as CRSF and SBUS both send them: sixteen of 11 bits, the first in the lowest bits.

/// Channels of a frame.
pub const CHANNELS: usize = 16;

/// Bytes of sixteen channels of 11 bits.
pub const PACKED_BYTES: usize = CHANNELS * 11 / 8;

/// Pulses in µs, channel 1 first.
pub fn pulses(packed: &[u8; PACKED_BYTES]) -> [u16; CHANNELS] {
    let mut channels = [0; CHANNELS];
    let (mut bits, mut held) = (0u32, 0);
    let mut bytes = packed.iter();
    for channel in &mut channels {
        while held < 11 {
            bits |= bytes.next().map_or(0, |byte| u32::from(*byte)) << held;
            held += 8;
        }
        *channel = pulse(bits as u16 & 0x7FF);
        bits >>= 11;
        held -= 11;
    }
    channels
}

/// The pulse of a channel in µs, to the nearest, half up: 172, 992 and 1811 are 988, 1500 and
/// 2012 µs (CRSF: 1500 + 5/8·(count − 992)); 11 bits give 880 to 2159.
const fn pulse(count: u16) -> u16 {
    (5 * count + 8 * 880 + 4) / 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_are_those_of_the_specification() {
        assert_eq!([172, 992, 1811].map(pulse), [988, 1500, 2012]);
        assert_eq!([0, 2047].map(pulse), [880, 2159]);
    }

    #[test]
    fn every_count_has_the_nearest_pulse() {
        for count in 0..2048u16 {
            let exact = 1500.0 + 0.625 * (f64::from(count) - 992.0);
            assert_eq!(f64::from(pulse(count)), (exact + 0.5).floor(), "{count}");
        }
    }
}
