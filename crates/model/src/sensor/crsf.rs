//! Frames of CRSF as a receiver sends them (TBS CRSF protocol specification): address, length,
//! type, payload, and the CRC-8/DVB-S2 of type and payload.

use super::rc::{CHANNELS, pack};

/// The address of a flight controller: the first byte of what a receiver sends it.
pub const ADDRESS: u8 = 0xC8;

/// Type of a frame with the channels: RC_CHANNELS_PACKED.
pub const RC_CHANNELS: u8 = 0x16;

/// Type of a frame on the state of the link: LINK_STATISTICS.
pub const LINK_STATISTICS: u8 = 0x14;

/// LINK_STATISTICS of a good link: RSSI of two antennas in −dBm, quality in per cent, SNR in dB,
/// antenna, mode, power; and the downlink's RSSI, quality and SNR.
pub const GOOD_LINK: [u8; 10] = [60, 62, 100, 10, 0, 4, 3, 65, 100, 8];

/// The longest payload.
pub const MAX_PAYLOAD: usize = 60;

/// The frame with sixteen channels of 11 bits.
pub fn channels(channels: &[u16; CHANNELS]) -> Vec<u8> {
    frame(RC_CHANNELS, &pack(channels))
}

/// Any frame.
///
/// # Panics
///
/// If the payload is longer than [`MAX_PAYLOAD`].
pub fn frame(kind: u8, payload: &[u8]) -> Vec<u8> {
    assert!(payload.len() <= MAX_PAYLOAD, "{} bytes", payload.len());
    let body = [&[kind], payload].concat();
    [&[ADDRESS, body.len() as u8 + 1], &body[..], &[crc8(&body)]].concat()
}

/// CRC-8/DVB-S2: polynomial 0xD5, from 0, not reflected.
pub fn crc8(bytes: &[u8]) -> u8 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::rc::MIDDLE;

    #[test]
    fn the_crc_is_that_of_its_catalogue() {
        assert_eq!(crc8(b"123456789"), 0xBC);
    }

    #[test]
    fn a_frame_says_its_length_and_checks() {
        let bytes = channels(&[MIDDLE; CHANNELS]);
        assert_eq!(bytes.len(), 26);
        assert_eq!(bytes[..3], [0xC8, 24, 0x16]);
        assert_eq!(crc8(&bytes[2..25]), bytes[25]);
        let bytes = frame(LINK_STATISTICS, &GOOD_LINK);
        assert_eq!(bytes.len(), 14);
        assert_eq!(bytes[..3], [0xC8, 12, 0x14]);
    }
}
