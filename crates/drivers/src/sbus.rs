//! Frames of Futaba SBUS, as receivers send them at 100,000 baud, 8 bits, even parity, 2 stop bits,
//! inverted.
//!
//! A frame is a header (0x0F), sixteen channels of 11 bits, a byte of flags and a footer. Nothing
//! in it is a checksum, and sticks can look like header and footer. What tells a frame is the
//! pause of 4 ms or more before it, and what tells an error is the parity of each byte. So both
//! are the owner's to say: [`Parser::restart`] where the line paused, [`Parser::discard`] where
//! the port found a byte wrong or lost. [`Parser`] reads frames only from a pause on, one behind
//! the other, until something is wrong.

use crate::rc_channels::{CHANNELS, PACKED_BYTES, pulses};

/// Baud rate of a receiver.
pub const BAUD: u32 = 100_000;

/// Bytes of a frame: 3 ms on the line.
pub const BYTES: usize = PACKED_BYTES + 3;

/// A silence this long is a pause, in µs. Between two bytes of a frame there is none; between
/// frames there are at least 4 ms, of which a reader that looks every ms sees 3.
pub const PAUSE_US: u64 = 2_500;

const HEADER: u8 = 0x0F;

/// SBUS2, which has others, is not read.
const FOOTER: u8 = 0x00;

/// In the flags: channels 17 and 18, which are on or off.
const CHANNEL_17: u8 = 1 << 0;
const CHANNEL_18: u8 = 1 << 1;

/// In the flags: the frame was lost on the air.
const FRAME_LOST: u8 = 1 << 2;

/// In the flags: the link is down.
const FAILSAFE: u8 = 1 << 3;

/// In the flags: bits that are 0.
const RESERVED: u8 = 0xF0;

/// A frame that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Frame {
    /// Pulses in µs, channel 1 first: 880 to 2159. `None` in failsafe: then they are made up.
    pub channels: Option<[u16; CHANNELS]>,
    /// Channels 17 and 18, which are on or off. `None` in failsafe.
    pub switches: Option<[bool; 2]>,
    /// The receiver heard nothing for this frame: the channels are those of an earlier one.
    pub lost: bool,
}

/// What came in since the start. Counts stay at their ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Bytes.
    pub bytes: u32,
    /// Frames, whatever they say.
    pub frames: u32,
    /// Frames that say they were lost on the air.
    pub lost: u32,
    /// Frames that say the link is down.
    pub failsafe: u32,
    /// What was no frame, or was broken off: a wrong header, flags or footer, a pause or an error
    /// within.
    pub refused: u32,
}

impl Counts {
    /// Bytes outside of frames: noise, broken frames, and what is not yet a frame.
    pub fn skipped(&self) -> u32 {
        self.bytes
            .saturating_sub(self.frames.saturating_mul(BYTES as u32))
    }
}

/// Finds frames in a stream of bytes. Waits for a pause at first.
#[derive(Clone, Debug, Default)]
pub struct Parser {
    frame: [u8; BYTES],
    /// Bytes of the frame under way; `None` while only a pause helps.
    length: Option<usize>,
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

    /// The line paused: the next byte begins a frame.
    pub fn restart(&mut self) {
        self.break_off();
        self.length = Some(0);
    }

    /// A byte was wrong or lost: what comes until the next pause is not read.
    pub fn discard(&mut self) {
        self.break_off();
        self.length = None;
    }

    /// What came in since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    fn break_off(&mut self) {
        if self.length.is_some_and(|length| length > 0) {
            self.counts.refused = self.counts.refused.saturating_add(1);
        }
    }

    fn push(&mut self, byte: u8) -> Option<Frame> {
        self.counts.bytes = self.counts.bytes.saturating_add(1);
        let length = self.length?;
        *self.frame.get_mut(length)? = byte;
        self.length = Some(length + 1);
        if byte != HEADER && length == 0 {
            self.discard();
        }
        if length + 1 < BYTES {
            return None;
        }
        let [_, channels @ .., flags, footer] = &self.frame;
        if flags & RESERVED != 0 || *footer != FOOTER {
            self.discard();
            return None;
        }
        let frame = Frame::read(channels, *flags);
        self.length = Some(0);
        self.counts.note(&frame);
        Some(frame)
    }
}

impl Frame {
    fn read(channels: &[u8; PACKED_BYTES], flags: u8) -> Self {
        let is_up = flags & FAILSAFE == 0;
        Self {
            channels: is_up.then(|| pulses(channels)),
            switches: is_up.then_some([flags & CHANNEL_17 != 0, flags & CHANNEL_18 != 0]),
            lost: flags & FRAME_LOST != 0,
        }
    }
}

impl Counts {
    fn note(&mut self, frame: &Frame) {
        self.frames = self.frames.saturating_add(1);
        self.lost = self.lost.saturating_add(frame.lost.into());
        self.failsafe = self.failsafe.saturating_add(frame.channels.is_none().into());
    }
}
