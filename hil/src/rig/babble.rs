//! A line on which random bytes come one behind the other, as fast as they can.

use windhover_model::random::Random;

use crate::board::{Format, Frame, Usart};
use crate::time::NEVER;

/// The first of the streams of random numbers, one a port.
const STREAM: u64 = 0xBABB;

/// The ports on which something babbles.
#[derive(Clone, Debug)]
pub(super) struct Babble {
    seed: u64,
    lines: Vec<Babbler>,
}

#[derive(Clone, Debug)]
struct Babbler {
    port: Usart,
    format: Format,
    random: Random,
    next: u64,
}

impl Babble {
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            lines: Vec::new(),
        }
    }

    /// It begins on a port, in this format.
    pub fn begin(&mut self, now: u64, port: Usart, format: Format) {
        self.end(port);
        self.lines.push(Babbler {
            port,
            format,
            random: Random::new(self.seed, STREAM + u64::from(port.0)),
            next: now + format.frame_time(),
        });
    }

    /// It ends on a port.
    pub fn end(&mut self, port: Usart) {
        self.lines.retain(|line| line.port != port);
    }

    /// Whether something babbles on a port: nobody else is heard there.
    pub fn covers(&self, port: Usart) -> bool {
        self.lines.iter().any(|line| line.port == port)
    }

    pub fn next_event(&self) -> u64 {
        self.lines.iter().map(|line| line.next).min().unwrap_or(NEVER)
    }

    /// Bytes that have come by now, one a port.
    pub fn advance(&mut self, now: u64) -> impl Iterator<Item = (Usart, Frame)> {
        let due = self.lines.iter_mut().filter(move |line| line.next <= now);
        due.map(|line| {
            line.next += line.format.frame_time();
            let frame = Frame {
                data: line.random.bits() as u16 & line.format.mask(),
                format: line.format,
            };
            (line.port, frame)
        })
    }
}
