//! The remote control: from channels to sticks and switches.
//!
//! In this order: pulses → the travel of each channel → sticks and levers within ±1 (`channel`) →
//! dead band and expo ([`RcParameters::shape`]) → a machine with memory that tells what is new from
//! what is old or merely there ([`Remote`]).

mod channel;
mod parameters;
mod remote;
mod switch;
#[cfg(test)]
mod tests;

pub use self::parameters::RcParameters;
pub use self::remote::{Events, Remote};

/// Channels of a frame.
pub const CHANNELS: usize = 16;

/// One frame of a receiver: pulses in µs, channel 1 first; 0 for a channel that is not there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RcFrame {
    /// µs.
    pub channels: [u16; CHANNELS],
}

/// What a pilot's hands want, −1 to 1 each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sticks {
    /// Right is positive.
    pub roll: f32,
    /// Stick forward, nose down, is positive.
    pub pitch: f32,
    /// Clockwise seen from above is positive.
    pub yaw: f32,
    /// Up is positive; the lower end is −1.
    pub throttle: f32,
}

impl Sticks {
    /// Whether they may come in: numbers, none beyond ±1.
    pub fn is_valid(&self) -> bool {
        let Self {
            roll,
            pitch,
            yaw,
            throttle,
        } = *self;
        // what is not a number compares as false
        [roll, pitch, yaw, throttle]
            .iter()
            .all(|stick| stick.abs() <= 1.0)
    }

    /// Whether roll, pitch and yaw all lie within ±`limit`: the throttle does not spring back, so that
    /// its place says nothing about hands.
    pub(crate) fn rests_within(&self, limit: f32) -> bool {
        [self.roll, self.pitch, self.yaw]
            .iter()
            .all(|stick| stick.abs() <= limit)
    }
}
