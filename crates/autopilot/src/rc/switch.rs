//! A switch with its memory: two frames alike make a position.

/// A switch whose positions are `T`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch<T> {
    /// The channel that it sits on, as its parameter says.
    channel: f32,
    position: Option<T>,
    /// What the last frame showed.
    last: Option<T>,
}

/// A switch came to another position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change<T> {
    /// `None` when its position was not known since the start or a loss: nobody moved it.
    pub from: Option<T>,
    pub to: T,
}

impl<T> Default for Switch<T> {
    fn default() -> Self {
        Self {
            channel: 0.0,
            position: None,
            last: None,
        }
    }
}

impl<T: Copy + PartialEq> Switch<T> {
    /// Where it is, once two frames have said the same.
    pub fn position(&self) -> Option<T> {
        self.position
    }

    /// Takes in what a frame shows; `None` is a switch that is not there or between two positions.
    /// On another channel it is another switch.
    pub fn step(&mut self, channel: f32, shown: Option<T>) -> Option<Change<T>> {
        if channel != self.channel {
            *self = Self {
                channel,
                ..Self::default()
            };
        }
        let before = core::mem::replace(&mut self.last, shown);
        let to = shown?;
        if before != shown || self.position == shown {
            return None;
        }
        let from = self.position.replace(to);
        Some(Change { from, to })
    }
}

/// Whether a lever from −1 to 1 is on: beyond three quarters of its way, as PX4 has it. Just below,
/// it may be either, so that a jitter does not throw it.
pub fn is_on(lever: f32) -> Option<bool> {
    if lever > 0.5 {
        Some(true)
    } else if lever < 0.3 {
        Some(false)
    } else {
        None
    }
}

/// Where positions 2 to 6 of a mode switch begin. They are sixths of the way, as in PX4; but that
/// the middle of a switch with three positions is clearly position 4, the fourth begins earlier.
const POSITIONS: [f32; 5] = [-2.0 / 3.0, -1.0 / 3.0, -0.1, 1.0 / 3.0, 2.0 / 3.0];

/// Position 1 to 6 of a lever from −1 to 1.
pub fn position(lever: f32) -> u8 {
    POSITIONS
        .iter()
        .fold(1, |position, begin| position + u8::from(lever >= *begin))
}
