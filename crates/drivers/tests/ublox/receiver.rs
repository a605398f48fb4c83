//! A receiver of either generation on a line, and the port at its other end. Both understand each
//! other at the same rate alone, and bytes take their time.

use std::collections::VecDeque;

use windhover_drivers::ublox::{Action, Message, Parser, Setup};
use windhover_model::sensor::nav_pvt::NavPvt;
use windhover_model::sensor::ubx;

pub const MS: u64 = 1_000;
pub const SECOND: u64 = 1_000_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Generation {
    /// Knows messages, and refuses values.
    M8,
    /// Knows messages, and says nothing to values.
    Mute,
    /// Knows values, and refuses messages.
    M10,
}

/// The receiver's configuration and what it forgets with its power.
#[derive(Clone, Debug)]
pub struct Receiver {
    pub generation: Generation,
    /// Its rate after power-on.
    home: u32,
    pub baud: u32,
    pub sentences: bool,
    pub period: u64,
    pub reports: bool,
    pub dynamics: u8,
    next: u64,
    parser: ubx::Parser,
    /// What it sends, behind each other; when the line is free.
    line: VecDeque<(u64, u8, u32)>,
    free: u64,
    /// Commands of this class and number are refused.
    pub refuses: Option<[u8; 2]>,
}

impl Receiver {
    pub fn new(generation: Generation, home: u32, now: u64) -> Self {
        Self {
            generation,
            home,
            baud: home,
            sentences: true,
            period: SECOND,
            reports: false,
            dynamics: 0,
            next: now + SECOND / 2,
            parser: ubx::Parser::default(),
            line: VecDeque::new(),
            free: now,
            refuses: None,
        }
    }

    pub fn power_cycle(&mut self, now: u64) {
        *self = Self {
            refuses: self.refuses,
            ..Self::new(self.generation, self.home, now)
        };
    }

    /// Eight bits with start and stop.
    fn byte_time(&self) -> u64 {
        10 * SECOND / u64::from(self.baud) + 1
    }

    fn send(&mut self, now: u64, bytes: &[u8]) {
        self.free = self.free.max(now);
        for byte in bytes {
            self.free += self.byte_time();
            self.line.push_back((self.free, *byte, self.baud));
        }
    }

    fn step(&mut self, now: u64) {
        if now < self.next {
            return;
        }
        self.next += self.period;
        if self.sentences {
            self.send(now, &[b'$'; 400]);
        }
        if self.reports {
            let fix = NavPvt {
                fix_type: 3,
                flags: 1,
                satellites: 12,
                ..NavPvt::default()
            };
            self.send(now, &ubx::frame(ubx::NAV_PVT, &ubx::nav_pvt(&fix)));
        }
    }

    fn hear(&mut self, now: u64, byte: u8) {
        let Some(message) = self.parser.take(byte) else {
            return;
        };
        assert_eq!(message.id[0], 6, "only configuration is sent");
        let by_value = message.id[1] == 0x8A;
        let is_known = match self.generation {
            Generation::M10 => by_value,
            Generation::Mute if by_value => return,
            Generation::M8 | Generation::Mute => !by_value,
        };
        let is_done = is_known && self.refuses != Some(message.id) && self.obey(now, &message);
        self.send(now, &ubx::frame([5, u8::from(is_done)], &message.id));
    }

    fn obey(&mut self, now: u64, message: &ubx::Message) -> bool {
        let payload = &message.payload[..];
        match (message.id[1], payload) {
            (0x8A, [0, 1, 0, 0, values @ ..]) => return self.set(values),
            (0x00, [1]) => self.send(now, &ubx::frame([6, 0], &[1; 20])),
            (0x00, [1, _, _, _, 0xD0, 8, 0, 0, a, b, c, d, 1, 0, 1, 0, ..]) if payload.len() == 20 => {
                self.baud = u32::from_le_bytes([*a, *b, *c, *d]);
                self.sentences = false;
            }
            (0x08, [low, high, 1, 0, 1, 0]) => self.set_period([*low, *high]),
            (0x01, [1, 7, rate]) => self.reports = *rate == 1,
            (0x24, [1, 0, dynamics, ..]) if payload.len() == 36 => self.dynamics = *dynamics,
            _ => panic!("{message:?}"),
        }
        true
    }

    fn set(&mut self, mut values: &[u8]) -> bool {
        while let [a, b, c, key, rest @ ..] = values {
            let key = u32::from_le_bytes([*a, *b, *c, *key]);
            let (value, rest) = rest.split_at([0, 1, 1, 2, 4][(key >> 28) as usize]);
            values = rest;
            match (key, value) {
                (0x1073_0001 | 0x1074_0001, [1]) | (0x3021_0002, [1, 0]) => {}
                (0x1074_0002, [on]) => self.sentences = *on == 1,
                (0x4052_0001, [a, b, c, d]) => self.baud = u32::from_le_bytes([*a, *b, *c, *d]),
                (0x3021_0001, [low, high]) => self.set_period([*low, *high]),
                (0x2091_0007, [rate]) => self.reports = *rate == 1,
                (0x2011_0021, [dynamics]) => self.dynamics = *dynamics,
                _ => panic!("{key:#x}"),
            }
        }
        assert_eq!(values, []);
        true
    }

    fn set_period(&mut self, period: [u8; 2]) {
        self.period = u64::from(u16::from_le_bytes(period)) * MS;
    }
}

/// Port, parser, setup and perhaps a receiver.
pub struct Bench {
    pub receiver: Option<Receiver>,
    pub setup: Setup,
    parser: Parser,
    baud: u32,
    /// What is sent to the receiver.
    line: VecDeque<(u64, u8, u32)>,
    pub now: u64,
    /// Times of reports.
    pub reports: Vec<u64>,
}

impl Bench {
    pub fn new(receiver: Option<Receiver>) -> Self {
        Self {
            receiver,
            setup: Setup::new(),
            parser: Parser::new(),
            baud: 0,
            line: VecDeque::new(),
            now: 0,
            reports: vec![],
        }
    }

    /// Lets time pass in steps of a ms.
    pub fn run(&mut self, us: u64) {
        let end = self.now + us;
        while self.now < end {
            self.now += MS;
            self.carry_out();
            self.carry_in();
            match self.setup.poll(self.now) {
                None => {}
                Some(Action::SetBaud(baud)) => {
                    assert!(self.line.is_empty(), "it is still sending");
                    self.baud = baud;
                }
                Some(Action::Send(bytes)) => self.send(bytes),
            }
        }
    }

    fn send(&mut self, bytes: &[u8]) {
        assert!(bytes.len() <= 44);
        let time = 10 * SECOND / u64::from(self.baud) + 1;
        let before = self.line.back().map_or(self.now, |(at, _, _)| *at);
        for (n, byte) in (1..).zip(bytes) {
            self.line.push_back((before + n * time, *byte, self.baud));
        }
    }

    fn carry_out(&mut self) {
        while let Some((_, byte, baud)) = self.line.pop_front_if(|(at, _, _)| *at <= self.now) {
            if let Some(receiver) = &mut self.receiver {
                let byte = if baud == receiver.baud {
                    byte
                } else {
                    garbled(byte)
                };
                receiver.hear(self.now, byte);
            }
        }
    }

    fn carry_in(&mut self) {
        let Some(receiver) = &mut self.receiver else {
            return;
        };
        receiver.step(self.now);
        while let Some((_, byte, baud)) = receiver.line.pop_front_if(|(at, _, _)| *at <= self.now) {
            let byte = if baud == self.baud { byte } else { garbled(byte) };
            let (setup, reports, now) = (&mut self.setup, &mut self.reports, self.now);
            self.parser.feed(&[byte], |message| {
                setup.heard(&message, now);
                if let Message::NavPvt(_) = message {
                    reports.push(now);
                }
            });
        }
    }
}

fn garbled(byte: u8) -> u8 {
    byte.rotate_left(3) ^ 0x5A
}
