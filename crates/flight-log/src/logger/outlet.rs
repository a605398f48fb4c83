//! The way out of the logger: a ring, and the account of what found no room in it.

use crate::ring::{Ring, Storage};
use crate::wire::{Encoder, kind, message};

/// Bytes of a dropout message.
const DROPOUT: usize = 5;

/// A ring of which half is reserved for inputs.
#[derive(Clone, Debug)]
pub(super) struct Outlet<S> {
    pub ring: Ring<S>,
    /// Time of the last tick, µs.
    pub time: u64,
    /// First tick of the gap that is open.
    pub gap: Option<u32>,
    pub dropout_since: Option<u64>,
    pub dropped_outputs: u32,
}

impl<S: Storage> Outlet<S> {
    pub fn new(storage: S) -> Self {
        Self {
            ring: Ring::new(storage),
            time: 0,
            gap: None,
            dropout_since: None,
            dropped_outputs: 0,
        }
    }

    /// What outputs leave free.
    #[inline]
    pub fn reserve(&self) -> usize {
        self.ring.capacity() / 2
    }

    /// A whole message for people, as [`Reporter`] makes them. `false` when it found no room.
    pub fn message(&mut self, message: &[u8]) -> bool {
        self.make_room(message.len()) && self.ring.push(message)
    }

    /// Whether there is room for an output of that length; a dropout message goes first where one
    /// is due.
    #[inline]
    pub fn make_room(&mut self, length: usize) -> bool {
        let due = if self.dropout_since.is_some() { DROPOUT } else { 0 };
        if self.ring.free() < length + self.reserve() + due {
            self.dropped_outputs = self.dropped_outputs.saturating_add(1);
            self.dropout_since.get_or_insert(self.time);
            return false;
        }
        if due > 0 && self.gap.is_none() {
            self.end_dropout();
        }
        true
    }

    pub fn end_dropout(&mut self) {
        let Some(since) = self.dropout_since.take() else {
            return;
        };
        let lost = (self.time.saturating_sub(since) / 1000).clamp(1, u64::from(u16::MAX)) as u16;
        let mut buffer = [0; DROPOUT];
        let length = message(&mut buffer, kind::DROPOUT, |out: &mut Encoder<'_>| {
            out.bytes(lost.to_le_bytes());
        });
        if length.is_none() || !self.ring.push(&buffer) {
            self.dropout_since = Some(since);
        }
    }
}
