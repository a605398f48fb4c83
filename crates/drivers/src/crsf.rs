//! Frames of CRSF, as receivers of TBS Crossfire and ExpressLRS send them at 420,000 baud (TBS
//! CRSF protocol specification).
//!
//! A frame is an address (0xC8, a flight controller), the length of what follows, a type, a payload
//! and the CRC-8/DVB-S2 of type and payload. Two types are read, and both have a fixed length. So
//! [`Parser`] asks at each byte whether a frame ends with it, and remembers nothing but the last
//! bytes: a frame is found the moment it is there, whatever came before it.
//!
//! A CRC of 8 bits sees every single error, and lets one in 256 of the worst pass: bytes of two
//! frames with a piece missing in between. So the owner says with [`Parser::restart`] where the
//! line paused or the port noticed an error.

use crate::rc_channels::{CHANNELS, PACKED_BYTES, pulses};

/// Baud rate of a receiver.
pub const BAUD: u32 = 420_000;

/// The address of a flight controller.
const ADDRESS: u8 = 0xC8;

/// Bytes of a frame around its payload: address, length, type and CRC.
const AROUND: usize = 4;

/// RC_CHANNELS_PACKED.
const RC_CHANNELS: u8 = 0x16;

/// Bytes of a frame with channels.
pub const CHANNELS_BYTES: usize = PACKED_BYTES + AROUND;

/// What such a frame says of its length: without address and length.
const CHANNELS_LENGTH: u8 = CHANNELS_BYTES as u8 - 2;

/// LINK_STATISTICS.
const LINK_STATISTICS: u8 = 0x14;

/// Bytes of a frame with statistics.
pub const STATISTICS_BYTES: usize = 10 + AROUND;

/// What such a frame says of its length.
const STATISTICS_LENGTH: u8 = STATISTICS_BYTES as u8 - 2;

/// What the receiver says of its link. Up is from the pilot to the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkStatistics {
    /// Received signal strength of both antennas, in −dBm: 60 is −60 dBm.
    pub uplink_rssi: [u8; 2],
    /// Share of packets that arrive, in per cent.
    pub uplink_quality: u8,
    /// Signal-to-noise ratio, in dB.
    pub uplink_snr: i8,
    /// The antenna in use.
    pub active_antenna: u8,
    /// The packet rate, as the maker of the receiver numbers it.
    pub rf_mode: u8,
    /// The transmitter's power, as the specification numbers it.
    pub uplink_power: u8,
    /// Received signal strength at the transmitter, in −dBm.
    pub downlink_rssi: u8,
    /// Share of packets that arrive at the transmitter, in per cent.
    pub downlink_quality: u8,
    /// Signal-to-noise ratio at the transmitter, in dB.
    pub downlink_snr: i8,
}

/// A frame that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Frame {
    /// Pulses in µs, channel 1 first: 880 to 2159.
    Channels([u16; CHANNELS]),
    /// The state of the link.
    Statistics(LinkStatistics),
}

/// What came in since the start. Counts stay at their ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Bytes.
    pub bytes: u32,
    /// Frames with channels.
    pub channels: u32,
    /// Frames with statistics.
    pub statistics: u32,
    /// What began like a frame of these two and whose checksum was wrong: lost frames, mostly.
    pub refused: u32,
}

impl Counts {
    /// Bytes outside of frames that were read: noise, other types, and what is not yet a frame.
    pub fn skipped(&self) -> u32 {
        let channels = self.channels.saturating_mul(CHANNELS_BYTES as u32);
        let statistics = self.statistics.saturating_mul(STATISTICS_BYTES as u32);
        self.bytes.saturating_sub(channels).saturating_sub(statistics)
    }
}

/// Finds frames in a stream of bytes.
#[derive(Clone, Debug, Default)]
pub struct Parser {
    /// The last bytes, the newest at the end. Zeros begin no frame.
    window: [u8; CHANNELS_BYTES],
    counts: Counts,
}

impl Parser {
    /// Takes bytes in, in pieces of any size, and hands out the frames that they end.
    pub fn feed(&mut self, bytes: &[u8], mut found: impl FnMut(Frame)) {
        for byte in bytes {
            if let Some(frame) = self.push(*byte) {
                found(frame);
            }
        }
    }

    /// Forgets the frame under way: the line paused, was in error or is set anew.
    pub fn restart(&mut self) {
        self.window = [0; CHANNELS_BYTES];
    }

    /// What came in since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    fn push(&mut self, byte: u8) -> Option<Frame> {
        self.window.rotate_left(1);
        self.window[CHANNELS_BYTES - 1] = byte;
        self.counts.bytes = self.counts.bytes.saturating_add(1);
        self.channels().or_else(|| self.statistics())
    }

    fn channels(&mut self) -> Option<Frame> {
        let [ADDRESS, CHANNELS_LENGTH, RC_CHANNELS, payload @ .., _] = &self.window else {
            return None;
        };
        if !checks(&self.window) {
            self.counts.refused = self.counts.refused.saturating_add(1);
            return None;
        }
        self.counts.channels = self.counts.channels.saturating_add(1);
        Some(Frame::Channels(pulses(payload)))
    }

    fn statistics(&mut self) -> Option<Frame> {
        let frame = self.window.last_chunk::<STATISTICS_BYTES>()?;
        let [ADDRESS, STATISTICS_LENGTH, LINK_STATISTICS, payload @ .., _] = frame else {
            return None;
        };
        if !checks(frame) {
            self.counts.refused = self.counts.refused.saturating_add(1);
            return None;
        }
        self.counts.statistics = self.counts.statistics.saturating_add(1);
        Some(Frame::Statistics(LinkStatistics::read(payload)))
    }
}

impl LinkStatistics {
    fn read(payload: &[u8; STATISTICS_BYTES - AROUND]) -> Self {
        let [rssi_1, rssi_2, quality, snr, antenna, mode, power, down @ ..] = *payload;
        Self {
            uplink_rssi: [rssi_1, rssi_2],
            uplink_quality: quality,
            uplink_snr: snr.cast_signed(),
            active_antenna: antenna,
            rf_mode: mode,
            uplink_power: power,
            downlink_rssi: down[0],
            downlink_quality: down[1],
            downlink_snr: down[2].cast_signed(),
        }
    }
}

/// Whether a frame's CRC is right: over type, payload and the CRC itself it is 0.
fn checks(frame: &[u8]) -> bool {
    frame.iter().skip(2).fold(0, |crc, byte| crc8(crc ^ byte)) == 0
}

/// CRC-8/DVB-S2 of one byte: polynomial 0xD5, not reflected.
const fn crc8(byte: u8) -> u8 {
    let (mut crc, mut bit) = (byte, 0);
    while bit < 8 {
        crc = if crc & 0x80 == 0 {
            crc << 1
        } else {
            crc << 1 ^ 0xD5
        };
        bit += 1;
    }
    crc
}
