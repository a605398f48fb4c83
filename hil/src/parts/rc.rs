//! What RC receivers send: frames of CRSF and of SBUS, each with the same sixteen channels of
//! 11 bits.

use windhover_model::sensor::rc::CHANNELS;

use crate::board::Format;

/// Which protocol a receiver speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// TBS Crossfire, ExpressLRS.
    #[default]
    Crsf,
    /// Futaba SBUS, behind the board's inverter.
    Sbus,
}

/// SBUS, in the byte behind the channels.
const FRAME_LOST: u8 = 1 << 2;
const FAILSAFE: u8 = 1 << 3;

/// So many frames lost in a row are a link that is down.
const DOWN: u32 = 25;

/// A receiver.
#[derive(Clone, Debug)]
pub struct Receiver {
    protocol: Protocol,
    channels: [u16; CHANNELS],
    lost: u32,
    frames: u32,
}

impl Receiver {
    /// A receiver that has heard nothing yet.
    pub fn new(protocol: Protocol) -> Self {
        Self {
            protocol,
            channels: [windhover_model::sensor::rc::MIDDLE; CHANNELS],
            lost: DOWN,
            frames: 0,
        }
    }

    /// How its bytes lie on the line.
    pub fn format(&self) -> Format {
        match self.protocol {
            Protocol::Crsf => Format::plain(420_000),
            Protocol::Sbus => Format::even_with_two_stop_bits(100_000),
        }
    }

    /// What it sends for what came over the air, if anything did. CRSF falls silent without; SBUS
    /// says so and goes on. Every tenth frame of CRSF has the link's statistics behind it.
    pub fn frame(&mut self, heard: Option<[u16; CHANNELS]>) -> Vec<u8> {
        self.lost = if heard.is_some() {
            0
        } else {
            self.lost.saturating_add(1)
        };
        self.channels = heard.unwrap_or(self.channels);
        match self.protocol {
            Protocol::Crsf if heard.is_none() => Vec::new(),
            Protocol::Crsf => {
                self.frames += 1;
                let mut bytes = crsf(CRSF_CHANNELS, &pack(&self.channels));
                if self.frames % 10 == 1 {
                    bytes.extend(crsf(CRSF_STATISTICS, &STATISTICS));
                }
                bytes
            }
            Protocol::Sbus => {
                let lost = if self.lost > 0 { FRAME_LOST } else { 0 };
                let down = if self.lost >= DOWN { FAILSAFE } else { 0 };
                sbus(&self.channels, lost | down)
            }
        }
    }
}

/// Channels, 11 bits each, the first in the lowest bits.
fn pack(channels: &[u16; CHANNELS]) -> [u8; 22] {
    let mut bytes = [0; 22];
    for (n, channel) in channels.iter().enumerate() {
        for bit in 0..11 {
            let place = 11 * n + bit;
            bytes[place / 8] |= ((channel >> bit & 1) as u8) << (place % 8);
        }
    }
    bytes
}

const CRSF_ADDRESS: u8 = 0xC8;
const CRSF_CHANNELS: u8 = 0x16;
const CRSF_STATISTICS: u8 = 0x14;

/// A good link: RSSI of two antennas in −dBm, quality in per cent, SNR in dB, antenna, mode, power;
/// and the downlink's RSSI, quality and SNR.
const STATISTICS: [u8; 10] = [60, 62, 100, 10, 0, 4, 3, 65, 100, 8];

/// A frame of CRSF: address, length, type, payload and CRC-8 of type and payload.
fn crsf(kind: u8, payload: &[u8]) -> Vec<u8> {
    let body = [&[kind], payload].concat();
    [&[CRSF_ADDRESS, body.len() as u8 + 1], &body[..], &[crc8(&body)]].concat()
}

/// CRC-8/DVB-S2.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc, _| {
            if crc & 0x80 != 0 {
                crc << 1 ^ 0xD5
            } else {
                crc << 1
            }
        })
    })
}

/// A frame of SBUS: header, channels, flags, footer.
fn sbus(channels: &[u16; CHANNELS], flags: u8) -> Vec<u8> {
    [&[0x0F], &pack(channels)[..], &[flags, 0x00]].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crc_is_that_of_its_catalogue() {
        assert_eq!(crc8(b"123456789"), 0xBC);
    }

    /// Channels as a receiver of frames reads them: byte by byte, eleven bits at a time.
    #[test]
    fn channels_are_packed_from_the_lowest_bit() {
        let channels: [u16; CHANNELS] = core::array::from_fn(|n| 172 + 100 * n as u16);
        let packed = pack(&channels);
        let mut bits = packed
            .iter()
            .flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1));
        for channel in channels {
            let read = (0..11).fold(0, |read, bit| read | u16::from(bits.next().unwrap()) << bit);
            assert_eq!(read, channel);
        }
        assert_eq!(packed[0], 172);
    }

    #[test]
    fn crsf_sends_frames_and_falls_silent() {
        let mut receiver = Receiver::new(Protocol::Crsf);
        let first = receiver.frame(Some([992; CHANNELS]));
        assert_eq!(first.len(), 26 + 14, "channels and statistics");
        assert_eq!(first[..3], [0xC8, 24, 0x16]);
        assert_eq!(first[26..29], [0xC8, 12, 0x14]);
        assert_eq!(crc8(&first[2..25]), first[25]);
        assert_eq!(receiver.frame(Some([992; CHANNELS])).len(), 26);
        assert!(receiver.frame(None).is_empty());
    }

    #[test]
    fn sbus_says_that_frames_are_lost_and_that_the_link_is_down() {
        let mut receiver = Receiver::new(Protocol::Sbus);
        let flags = |frame: Vec<u8>| {
            assert_eq!((frame.len(), frame[0], frame[24]), (25, 0x0F, 0));
            frame[23]
        };
        assert_eq!(
            flags(receiver.frame(None)),
            FRAME_LOST | FAILSAFE,
            "nothing was heard yet"
        );
        let heard = receiver.frame(Some([500; CHANNELS]));
        assert_eq!(flags(heard.clone()), 0);
        let lost = receiver.frame(None);
        assert_eq!(lost[1..23], heard[1..23], "channels stay");
        assert_eq!(flags(lost), FRAME_LOST);
        for _ in 0..24 {
            receiver.frame(None);
        }
        assert_eq!(flags(receiver.frame(None)), FRAME_LOST | FAILSAFE);
    }
}
