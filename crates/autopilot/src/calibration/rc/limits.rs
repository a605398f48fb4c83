//! What is asked of a calibration of the channels, what it asks of the pilot, and why there is none.

use core::fmt;

use super::Channels;
use crate::calibration::BadSample;

/// What is asked of a calibration of the channels. Times of pulses are in µs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcLimits {
    /// The channels that must travel.
    pub required: Channels,
    /// Those of them that spring back to their middle.
    pub centred: Channels,
    /// The lower end must lie here or below.
    pub low: u16,
    /// The upper end must lie here or above.
    pub high: u16,
    /// Largest difference of a middle from half-way between the ends, as a share of the way between
    /// them.
    pub off_centre: f32,
    /// How far a resting channel may move, and an end may still creep, µs.
    pub steady: u16,
    /// How long the channels must rest at first, and find no new end at last, s.
    pub rest: (f32, f32),
    /// Time limit, s.
    pub timeout: f32,
}

impl Default for RcLimits {
    /// Roll, pitch, throttle and yaw on channels 1 to 4; a throttle that does not spring back.
    fn default() -> Self {
        Self {
            required: Channels(0b1111),
            centred: Channels(0b1011),
            low: 1300,
            high: 1700,
            off_centre: 0.2,
            steady: 20,
            rest: (2.0, 3.0),
            timeout: 120.0,
        }
    }
}

/// What the pilot is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RcInstruction {
    /// Leave the sticks in the middle, throttle as well as it goes.
    Centre,
    /// Move all sticks and switches to their ends; these have not been there.
    Move(Channels),
    /// All have been there: let go.
    LetGo,
}

impl fmt::Display for RcInstruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Centre => f.write_str("leave all sticks in the middle"),
            Self::Move(missing) => write!(
                f,
                "move all sticks and switches to their ends; missing: channels {missing}"
            ),
            Self::LetGo => f.write_str("let go of the sticks"),
        }
    }
}

/// Why there is no calibration of the channels. Channels count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RcRefusal {
    /// The time of a sample is none.
    Sample(BadSample),
    /// This channel showed a pulse, µs, that is none.
    Pulse(u8, u16),
    /// This channel is required and is not there.
    Missing(u8),
    /// The number of channels changed, from and to.
    Changed(u8, u8),
    /// This channel did not rest in the middle.
    Restless(u8),
    /// This channel travelled only between these, µs.
    Travel(u8, u16, u16),
    /// The middle of this channel, µs, lies too far from half-way between its ends.
    OffCentre(u8, u16),
    /// New ends were found until time was up.
    NeverLetGo,
}

impl fmt::Display for RcRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sample(bad) => bad.fmt(f),
            Self::Pulse(channel, pulse) => write!(f, "channel {channel} shows {pulse} µs, which is no pulse"),
            Self::Missing(channel) => write!(f, "the receiver has no channel {channel}"),
            Self::Changed(from, to) => write!(f, "the receiver went from {from} to {to} channels"),
            Self::Restless(channel) => write!(f, "channel {channel} did not rest in the middle"),
            Self::Travel(channel, min, max) => {
                write!(f, "channel {channel} travelled only from {min} to {max} µs")
            }
            Self::OffCentre(channel, trim) => {
                write!(f, "channel {channel} rests at {trim} µs, far from its middle")
            }
            Self::NeverLetGo => f.write_str("the sticks were moved until time was up"),
        }
    }
}
