//! Sets of channels.

use core::fmt;

/// Most channels that are calibrated.
pub const CHANNELS: usize = 16;

/// A set of channels: bit 0 is channel 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Channels(pub u16);

impl Channels {
    /// Whether this channel, 1 to 16, is in it.
    pub fn contains(self, channel: u8) -> bool {
        self.0 & Self::bit(channel) != 0
    }

    /// With this channel, 1 to 16.
    #[must_use]
    pub fn with(self, channel: u8) -> Self {
        Self(self.0 | Self::bit(channel))
    }

    /// How many there are.
    pub fn count(self) -> u8 {
        self.0.count_ones() as u8
    }

    /// Their numbers, from 1.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (1..=CHANNELS as u8).filter(move |channel| self.contains(*channel))
    }

    fn bit(channel: u8) -> u16 {
        1_u16.checked_shl(u32::from(channel.wrapping_sub(1))).unwrap_or(0)
    }
}

impl fmt::Display for Channels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, channel) in self.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{channel}")?;
        }
        Ok(())
    }
}
