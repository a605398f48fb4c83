//! What RC receivers send: frames of CRSF and of SBUS, each with the same sixteen channels of
//! 11 bits.

use windhover_model::sensor::rc::{CHANNELS, MIDDLE};
use windhover_model::sensor::sbus::{FAILSAFE, FRAME_LOST};
use windhover_model::sensor::{crsf, sbus};

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
            channels: [MIDDLE; CHANNELS],
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
                let mut bytes = crsf::channels(&self.channels);
                if self.frames % 10 == 1 {
                    bytes.extend(crsf::frame(crsf::LINK_STATISTICS, &crsf::GOOD_LINK));
                }
                bytes
            }
            Protocol::Sbus => {
                let lost = if self.lost > 0 { FRAME_LOST } else { 0 };
                let down = if self.lost >= DOWN { FAILSAFE } else { 0 };
                sbus::frame(&self.channels, lost | down).into()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crsf_sends_frames_and_falls_silent() {
        let mut receiver = Receiver::new(Protocol::Crsf);
        let first = receiver.frame(Some([992; CHANNELS]));
        assert_eq!(first.len(), 26 + 14, "channels and statistics");
        assert_eq!(first[..3], [0xC8, 24, 0x16]);
        assert_eq!(first[26..29], [0xC8, 12, 0x14]);
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
