//! A serial port's other end: what came, and what is to be sent.

use std::collections::VecDeque;

use crate::board::line::{Format, Frame, Receiver};
use crate::time::NEVER;

/// The other end of a port.
#[derive(Clone, Debug)]
pub struct Port {
    format: Format,
    received: Vec<(u64, u8)>,
    receiver: Receiver,
    queue: VecDeque<(u64, Frame)>,
    /// When the line is free again.
    free: u64,
}

impl Port {
    /// An end that speaks and hears bytes of this format.
    pub fn new(format: Format) -> Self {
        Self {
            format,
            received: Vec::new(),
            receiver: Receiver::default(),
            queue: VecDeque::new(),
            free: 0,
        }
    }

    /// How it speaks and hears.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Speaks and hears otherwise from now on; what is on its way stays as it is.
    pub fn set_format(&mut self, format: Format) {
        self.format = format;
    }

    /// A byte came from the board.
    pub fn receive(&mut self, now: u64, frame: Frame) {
        let heard = self.receiver.hear(now, frame, &self.format);
        self.received.extend(heard.map(|heard| (now, heard.bits as u8)));
    }

    /// What came and was not taken, with the time of each byte's end in ticks.
    pub fn received(&self) -> &[(u64, u8)] {
        &self.received
    }

    /// Takes what came.
    pub fn take_received(&mut self) -> Vec<(u64, u8)> {
        std::mem::take(&mut self.received)
    }

    /// Sends bytes to the board, one behind the other, behind what is on its way.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        self.free = self.free.max(now);
        for byte in bytes {
            self.free += self.format.frame_time();
            let frame = Frame {
                data: u16::from(*byte),
                format: self.format,
            };
            self.queue.push_back((self.free, frame));
        }
    }

    /// Bytes on their way to the board.
    pub fn queued(&self) -> usize {
        self.queue.len()
    }

    /// When the next byte will have arrived at the board, or been heard from it.
    pub fn next_event(&self) -> u64 {
        let arrives = self.queue.front().map_or(NEVER, |(time, _)| *time);
        arrives.min(self.receiver.next_event(&self.format))
    }

    /// The next byte that has arrived at the board by now.
    pub fn advance(&mut self, now: u64) -> Option<Frame> {
        let heard = self.receiver.advance(now, &self.format);
        self.received.extend(heard.map(|heard| (now, heard.bits as u8)));
        let (_, frame) = self.queue.pop_front_if(|(time, _)| *time <= now)?;
        Some(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::SECOND;

    #[test]
    fn bytes_take_their_time() {
        let mut port = Port::new(Format::plain(2_000_000));
        let take = |port: &mut Port, now| port.advance(now).map(|frame| frame.data as u8);
        port.send(1000, b"ab");
        let byte = SECOND / 200_000;
        assert_eq!(port.next_event(), 1000 + byte);
        assert_eq!(take(&mut port, 1000 + byte - 1), None);
        assert_eq!(take(&mut port, 1000 + byte), Some(b'a'));
        port.send(1000 + byte, b"c");
        assert_eq!(take(&mut port, 1000 + 2 * byte), Some(b'b'));
        assert_eq!(take(&mut port, 1000 + 2 * byte), None);
        assert_eq!(take(&mut port, 1000 + 3 * byte), Some(b'c'));
        assert_eq!(port.next_event(), NEVER);
    }

    #[test]
    fn bytes_at_another_rate_are_heard_wrong_or_not_at_all() {
        let mut port = Port::new(Format::plain(115_200));
        let frame = |data, baud| Frame {
            data,
            format: Format::plain(baud),
        };
        port.receive(SECOND, frame(b'x'.into(), 115_200));
        assert_eq!(port.received(), [(SECOND, b'x')]);
        port.receive(2 * SECOND, frame(b'x'.into(), 38_400));
        while port.next_event() != NEVER {
            port.advance(port.next_event());
        }
        assert!(port.received()[1..].iter().all(|(_, byte)| *byte != b'x'));
    }
}
