//! A receiver of the remote control on a serial port: which protocol it speaks is found out.
//!
//! [`RcReceiver`] has no port and no clock. The owner sets the line as [`RcReceiver::poll`] says,
//! hands what came to [`RcReceiver::bytes`] and what the port found wrong to
//! [`RcReceiver::line_error`]. Bytes are to be handed over when the line falls idle, or every ms:
//! pauses of the line are seen by the times of the pieces.
//!
//! It tries [`crsf`] and [`sbus`], each for [`TRIAL_US`], until one is understood, and stays with
//! that. After [`SILENCE_US`] without a frame it begins again, but never while armed: a link that
//! comes back in flight is to be heard at once.

use crate::crsf::{self, LinkStatistics};
use crate::rc_channels::CHANNELS;
use crate::sbus;

/// How long a protocol is tried, in µs.
pub const TRIAL_US: u64 = 500_000;

/// How long a receiver may be silent before its protocol is looked for again, in µs.
pub const SILENCE_US: u64 = 5_000_000;

/// What a receiver speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Protocol {
    /// TBS Crossfire, ExpressLRS.
    Crsf,
    /// Futaba SBUS.
    Sbus,
}

/// The parity bit of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Parity {
    /// There is none.
    None,
    /// It makes the number of ones even.
    Even,
}

/// The stop bits of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StopBits {
    /// One.
    One,
    /// Two.
    Two,
}

/// How bytes of eight bits lie on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Line {
    /// Bits in a second.
    pub baud: u32,
    /// The parity bit.
    pub parity: Parity,
    /// The stop bits.
    pub stop_bits: StopBits,
    /// The line is low at rest: port or board have to invert it.
    pub inverted: bool,
}

impl Protocol {
    /// How it lies on the line.
    pub const fn line(self) -> Line {
        match self {
            Self::Crsf => Line {
                baud: crsf::BAUD,
                parity: Parity::None,
                stop_bits: StopBits::One,
                inverted: false,
            },
            Self::Sbus => Line {
                baud: sbus::BAUD,
                parity: Parity::Even,
                stop_bits: StopBits::Two,
                inverted: true,
            },
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::Crsf => Self::Sbus,
            Self::Sbus => Self::Crsf,
        }
    }

    /// Frames in a trial that prove it. One of SBUS, which has no checksum, may be noise.
    const fn proof(self) -> u32 {
        match self {
            Self::Crsf => 1,
            Self::Sbus => 2,
        }
    }
}

/// What is known of the receiver.
#[derive(Clone, Copy, Debug)]
enum State {
    /// The line was never set.
    Unset,
    /// A protocol is tried since a time in µs, and so many frames have come.
    Trial { since: u64, frames: u32 },
    /// It is understood; the last frame came at this time in µs.
    Understood { heard: u64 },
}

impl State {
    /// A frame came. Returns whether the protocol is proven.
    fn hear(&mut self, protocol: Protocol, now: u64) -> bool {
        let is_proven = match self {
            Self::Unset => false,
            Self::Trial { frames, .. } => {
                *frames += 1;
                *frames >= protocol.proof()
            }
            Self::Understood { .. } => true,
        };
        if is_proven {
            *self = Self::Understood { heard: now };
        }
        is_proven
    }
}

/// The newest channels of a piece.
#[derive(Debug, Default)]
struct Newest {
    channels: Option<[u16; CHANNELS]>,
    superseded: u32,
}

impl Newest {
    /// Failsafe takes channels back that came just before it.
    fn set(&mut self, channels: Option<[u16; CHANNELS]>) {
        if self.channels.is_some() {
            self.superseded = self.superseded.saturating_add(1);
        }
        self.channels = channels;
    }
}

/// What came in since the start. Counts stay at their ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Of CRSF.
    pub crsf: crsf::Counts,
    /// Of SBUS.
    pub sbus: sbus::Counts,
    /// Errors that the port found: parity, framing, noise, overrun.
    pub line_errors: u32,
    /// Channels that were not handed out because newer ones came with them.
    pub superseded: u32,
}

/// The receiver.
#[derive(Clone, Debug)]
pub struct RcReceiver {
    protocol: Protocol,
    state: State,
    crsf: crsf::Parser,
    sbus: sbus::Parser,
    /// When bytes or an error came last, or the line was set, in µs.
    active: u64,
    statistics: Option<LinkStatistics>,
    line_errors: u32,
    superseded: u32,
}

impl Default for RcReceiver {
    fn default() -> Self {
        Self {
            protocol: Protocol::Crsf,
            state: State::Unset,
            crsf: crsf::Parser::default(),
            sbus: sbus::Parser::default(),
            active: 0,
            statistics: None,
            line_errors: 0,
            superseded: 0,
        }
    }
}

impl RcReceiver {
    /// The line, whenever it is to be set anew: at first, and when another protocol is tried.
    /// `now` in µs; to be asked every 100 ms or more often.
    pub fn poll(&mut self, now: u64, armed: bool) -> Option<Line> {
        self.protocol = match self.state {
            State::Unset => Protocol::Crsf,
            State::Trial { since, .. } if now.saturating_sub(since) >= TRIAL_US => self.protocol.other(),
            State::Understood { heard } if !armed && now.saturating_sub(heard) >= SILENCE_US => {
                Protocol::Crsf
            }
            State::Trial { .. } | State::Understood { .. } => return None,
        };
        self.state = State::Trial {
            since: now,
            frames: 0,
        };
        self.statistics = None;
        self.crsf.restart();
        self.sbus.discard();
        self.active = now;
        Some(self.protocol.line())
    }

    /// Takes in what came by `now` in µs. Gives the newest channels: pulses in µs, channel 1
    /// first.
    ///
    /// Channels that the receiver made up (failsafe) or repeats (frame lost) are not handed out,
    /// nor any before the protocol is proven: silence is for the owner to notice.
    pub fn bytes(&mut self, bytes: &[u8], now: u64) -> Option<[u16; CHANNELS]> {
        if bytes.is_empty() || matches!(self.state, State::Unset) {
            return None;
        }
        self.note_pause(now);
        let mut newest = Newest::default();
        match self.protocol {
            Protocol::Crsf => self.crsf.feed(bytes, |frame| {
                let is_proven = self.state.hear(Protocol::Crsf, now);
                match frame {
                    crsf::Frame::Statistics(statistics) => self.statistics = Some(statistics),
                    crsf::Frame::Channels(channels) if is_proven => newest.set(Some(channels)),
                    crsf::Frame::Channels(_) => {}
                }
            }),
            Protocol::Sbus => self.sbus.feed(bytes, |frame| {
                let is_proven = self.state.hear(Protocol::Sbus, now);
                if is_proven && (frame.channels.is_none() || !frame.lost) {
                    newest.set(frame.channels);
                }
            }),
        }
        self.superseded = self.superseded.saturating_add(newest.superseded);
        newest.channels
    }

    /// The port found a byte wrong, or lost one: the frame under way is not read.
    pub fn line_error(&mut self, now: u64) {
        self.line_errors = self.line_errors.saturating_add(1);
        self.active = self.active.max(now);
        self.crsf.restart();
        self.sbus.discard();
    }

    /// What the receiver speaks, once that is known.
    pub fn protocol(&self) -> Option<Protocol> {
        matches!(self.state, State::Understood { .. }).then_some(self.protocol)
    }

    /// What the receiver last said of its link. SBUS says nothing of it.
    pub fn statistics(&self) -> Option<LinkStatistics> {
        self.statistics
    }

    /// What came in since the start.
    pub fn counts(&self) -> Counts {
        Counts {
            crsf: self.crsf.counts(),
            sbus: self.sbus.counts(),
            line_errors: self.line_errors,
            superseded: self.superseded,
        }
    }

    /// No frame goes on behind a pause of the line.
    fn note_pause(&mut self, now: u64) {
        if now.saturating_sub(self.active) >= sbus::PAUSE_US {
            self.crsf.restart();
            self.sbus.restart();
        }
        self.active = self.active.max(now);
    }
}
