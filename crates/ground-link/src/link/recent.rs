//! Frames that the network delivers twice.

use heapless::Deque;

use crate::frame::{Address, Frame};

/// Frames that are remembered.
const FRAMES: usize = 8;

/// For so long, µs: the network repeats at once, a client that waits for an answer later.
const MEMORY: u64 = 150_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mark {
    source: Address,
    sequence: u8,
    checksum: u16,
    id: u32,
}

/// The last frames that must not act twice.
#[derive(Clone, Debug, Default)]
pub(super) struct Recent {
    marks: Deque<(Mark, u64), FRAMES>,
}

impl Recent {
    /// Whether this very frame was here just now. If not, it is from now on.
    pub fn has(&mut self, frame: &Frame<'_>, now: u64) -> bool {
        let mark = Mark {
            source: frame.source,
            sequence: frame.sequence,
            checksum: frame.checksum,
            id: frame.id,
        };
        let young = |at: u64| now.saturating_sub(at) < MEMORY;
        if self.marks.iter().any(|(other, at)| *other == mark && young(*at)) {
            return true;
        }
        if self.marks.is_full() {
            self.marks.pop_front();
        }
        let _ = self.marks.push_back((mark, now));
        false
    }
}
