//! A serial port's other end: what came, and what is to be sent.

use std::collections::VecDeque;

use crate::time::{NEVER, SECOND};

/// Bits of a byte on the line: start, eight, stop.
const FRAME_BITS: u64 = 10;

/// The other end of a port.
#[derive(Clone, Debug, Default)]
pub struct Port {
    received: Vec<(u64, u8)>,
    queue: VecDeque<(u64, u8)>,
    /// When the line is free again.
    free: u64,
}

impl Port {
    /// A byte came from the board.
    pub fn receive(&mut self, now: u64, byte: u8) {
        self.received.push((now, byte));
    }

    /// Everything that came, with the time of each byte's end in ticks.
    pub fn received(&self) -> &[(u64, u8)] {
        &self.received
    }

    /// Sends bytes to the board, one behind the other at a baud rate, behind what is on its way.
    pub fn send(&mut self, now: u64, baud: u64, bytes: &[u8]) {
        self.free = self.free.max(now);
        for byte in bytes {
            self.free += FRAME_BITS * SECOND / baud;
            self.queue.push_back((self.free, *byte));
        }
    }

    /// When the next byte will have arrived at the board.
    pub fn next_event(&self) -> u64 {
        self.queue.front().map_or(NEVER, |(time, _)| *time)
    }

    /// The next byte that has arrived by now.
    pub fn take(&mut self, now: u64) -> Option<u8> {
        let (_, byte) = self.queue.pop_front_if(|(time, _)| *time <= now)?;
        Some(byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_take_their_time() {
        let mut port = Port::default();
        port.send(1000, 2_000_000, b"ab");
        let byte = SECOND / 200_000;
        assert_eq!(port.next_event(), 1000 + byte);
        assert_eq!(port.take(1000 + byte - 1), None);
        assert_eq!(port.take(1000 + byte), Some(b'a'));
        port.send(1000 + byte, 2_000_000, b"c");
        assert_eq!(port.take(1000 + 2 * byte), Some(b'b'));
        assert_eq!(port.take(1000 + 2 * byte), None);
        assert_eq!(port.take(1000 + 3 * byte), Some(b'c'));
        assert_eq!(port.next_event(), NEVER);
    }
}
