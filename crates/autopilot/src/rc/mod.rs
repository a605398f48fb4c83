//! The remote control: from channels to sticks and switches.

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
