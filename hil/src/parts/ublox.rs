//! A u-blox receiver on its serial port 1: it speaks sentences at a rate of its own until it is
//! configured, acknowledges what it understands, and reports NAV-PVT at the rate that was asked for
//! (interface descriptions of u-blox M8 and M10).
//!
//! An M10 takes CFG-VALSET; an M8 does not know it and takes CFG-PRT, CFG-RATE and CFG-MSG. Both
//! say by MON-VER which they are. Configuration is lost with power.

mod configuration;

use windhover_model::sensor::nav_pvt::NavPvt;
use windhover_model::sensor::ubx;

use super::nmea;
use crate::board::line::{Format, Frame};
use crate::rig::serial::Port;
use crate::time::{NEVER, SECOND};
use configuration::Configuration;

/// From power-on until it speaks and listens.
const START_TIME: u64 = SECOND / 2;

/// What does not fit between it and the line is dropped, message by message.
const BUFFER: usize = 2_000;

/// Which one it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Generation {
    /// Protocol 18, 9,600 baud.
    M8,
    /// Protocol 34, 38,400 baud.
    #[default]
    M10,
}

impl Generation {
    fn baud(self) -> u64 {
        match self {
            Self::M8 => 9_600,
            Self::M10 => 38_400,
        }
    }

    /// What MON-VER says: software, hardware, protocol.
    fn version(self) -> [&'static str; 3] {
        match self {
            Self::M8 => ["ROM CORE 3.01 (107888)", "00080000", "PROTVER=18.00"],
            Self::M10 => ["ROM SPG 5.10 (7b202e)", "000A0000", "PROTVER=34.10"],
        }
    }
}

/// One receiver.
#[derive(Clone, Debug)]
pub struct Ublox {
    generation: Generation,
    configuration: Configuration,
    parser: ubx::Parser,
    port: Port,
    /// When it measures next.
    epoch: u64,
    epochs: u64,
    started: u64,
    plugged: bool,
    dropped: u64,
}

impl Ublox {
    /// A receiver whose power comes on now.
    pub fn new(generation: Generation, now: u64) -> Self {
        let baud = generation.baud();
        Self {
            generation,
            configuration: Configuration::new(baud),
            parser: ubx::Parser::default(),
            port: Port::new(Format::plain(baud)),
            epoch: now + START_TIME,
            epochs: 0,
            started: now + START_TIME,
            plugged: true,
            dropped: 0,
        }
    }

    /// Takes it away.
    pub fn unplug(&mut self) {
        self.plugged = false;
    }

    /// Puts it back: its power comes on.
    pub fn plug(&mut self, now: u64) {
        *self = Self::new(self.generation, now);
    }

    /// The rate at which it speaks and listens now.
    pub fn format(&self) -> Format {
        self.port.format()
    }

    /// Messages that were dropped because its line was too slow.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// A byte came from the board.
    pub fn receive(&mut self, now: u64, frame: Frame) {
        if self.plugged && now >= self.started {
            self.port.receive(now, frame);
            self.listen(now);
        }
    }

    /// When something will next happen: a byte has arrived, or it measures.
    pub fn next_event(&self) -> u64 {
        if self.plugged {
            self.port.next_event().min(self.epoch)
        } else {
            NEVER
        }
    }

    /// Whether it measures now; asked once. The report of it comes later.
    pub fn measures(&mut self, now: u64) -> bool {
        let measures = self.plugged && self.epoch <= now;
        if measures {
            self.epoch += self.configuration.period();
            self.epochs += 1;
            self.speak_sentences(now);
        }
        measures
    }

    /// The byte that has arrived at the board by now.
    pub fn advance(&mut self, now: u64) -> Option<Frame> {
        let frame = self.port.advance(now);
        self.listen(now);
        frame
    }

    /// What was measured is reported, where reports were asked for.
    pub fn report(&mut self, now: u64, message: &NavPvt) {
        if self.plugged && self.configuration.reports(self.epochs) {
            self.say(now, ubx::NAV_PVT, &ubx::nav_pvt(message));
        }
    }

    fn speak_sentences(&mut self, now: u64) {
        for (number, sentence) in nmea::SENTENCES {
            if self.configuration.speaks(number) {
                self.send(now, &nmea::line(sentence));
            }
        }
    }

    fn say(&mut self, now: u64, id: [u8; 2], payload: &[u8]) {
        self.send(now, &ubx::frame(id, payload));
    }

    fn send(&mut self, now: u64, bytes: &[u8]) {
        if self.port.queued() + bytes.len() > BUFFER {
            self.dropped += 1;
        } else {
            self.port.send(now, bytes);
        }
    }

    /// Does what it was told.
    fn listen(&mut self, now: u64) {
        for (_, byte) in self.port.take_received() {
            let Some(message) = self.parser.take(byte) else {
                continue;
            };
            self.obey(now, &message);
        }
    }

    fn obey(&mut self, now: u64, message: &ubx::Message) {
        const MON_VER: [u8; 2] = [0x0A, 0x04];
        const ACKNOWLEDGED: [u8; 2] = [0x05, 0x01];
        const REFUSED: [u8; 2] = [0x05, 0x00];
        if message.id == MON_VER && message.payload.is_empty() {
            return self.say(now, MON_VER, &self.version());
        }
        // Only messages of configuration are acknowledged.
        if message.id[0] != 0x06 {
            return;
        }
        let valset = message.id[1] == configuration::VALSET;
        let done = match (self.generation, valset) {
            (Generation::M8, true) => None,
            (Generation::M10, true) => self.configuration.set_values(&message.payload),
            (_, false) => self.configuration.set(message.id[1], &message.payload),
        };
        self.say(
            now,
            if done.is_some() { ACKNOWLEDGED } else { REFUSED },
            &message.id,
        );
        // What is on its way, the acknowledgement too, still goes at the old rate.
        let format = Format::plain(self.configuration.baud());
        if format != self.port.format() {
            self.port.set_format(format);
        }
    }

    fn version(&self) -> Vec<u8> {
        let mut bytes = vec![0; 30 + 10 + 30];
        for (place, text) in [0, 30, 40].into_iter().zip(self.generation.version()) {
            bytes[place..place + text.len()].copy_from_slice(text.as_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests;
