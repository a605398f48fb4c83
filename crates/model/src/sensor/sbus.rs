//! Frames of Futaba SBUS as a receiver sends them: header, sixteen channels of 11 bits, flags,
//! footer. On the line at 100,000 baud, eight bits, even parity, two stop bits, inverted.

use super::rc::{CHANNELS, pack};

/// Bytes of a frame.
pub const BYTES: usize = 25;

/// In the flags: channel 17, which is on or off.
pub const CHANNEL_17: u8 = 1 << 0;

/// In the flags: channel 18, which is on or off.
pub const CHANNEL_18: u8 = 1 << 1;

/// In the flags: this frame was lost on the air, and the channels are those of an earlier one.
pub const FRAME_LOST: u8 = 1 << 2;

/// In the flags: the link is down, and the channels are made up.
pub const FAILSAFE: u8 = 1 << 3;

/// A frame.
pub fn frame(channels: &[u16; CHANNELS], flags: u8) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    bytes[0] = 0x0F;
    bytes[1..23].copy_from_slice(&pack(channels));
    bytes[23] = flags;
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_and_footer_follow_the_channels() {
        let bytes = frame(&[0x7FF; CHANNELS], FRAME_LOST | FAILSAFE);
        assert_eq!(bytes[0], 0x0F);
        assert!(bytes[1..23].iter().all(|byte| *byte == 0xFF));
        assert_eq!(bytes[23..], [0x0C, 0x00]);
    }
}
