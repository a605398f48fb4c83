//! The serial port of bench tests: frames that put inputs into the core, until the ground link
//! takes its place.
//!
//! A frame is `0xA5, length, topic, record …, crc`: an input's topic and record are those of the
//! flight log, the CRC-8 (polynomial 0x07) covers length, topic and record. What is no frame is
//! skipped; a frame that is damaged is dropped whole and counted.
#![no_std]

use windhover_autopilot::{ParameterWrite, Urgent};
use windhover_flight_log::wire::{Decoder, Encoder};
use windhover_flight_log::{Input, Record, Topic};

/// The first byte of a frame.
const START: u8 = 0xA5;

/// The longest record of a frame.
const RECORD: usize = 96;

/// The longest frame: start, length, topic, record, CRC.
pub const FRAME: usize = RECORD + 4;

/// Topics that the flight log does not know.
const SAVE_PARAMETER: u16 = 200;
const RESTART: u16 = 201;

/// What a frame asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Something for the outer step's queues.
    Input(Input),
    /// Something that acts in the inner step's next tick.
    Urgent(Urgent),
    /// Store a parameter; it acts at the next start.
    SaveParameter(ParameterWrite),
    /// Start anew, as after power-on. Refused while the motors may turn.
    Restart,
}

impl Request {
    /// Writes the frame; its length. `None` when the buffer is shorter than [`FRAME`] and the
    /// frame does not fit.
    pub fn encode(&self, buffer: &mut [u8]) -> Option<usize> {
        let mut record = [0; RECORD];
        let mut out = Encoder::new(&mut record);
        let topic = match self {
            Self::Input(input) => input.put(&mut out),
            Self::Urgent(urgent) => {
                urgent.put(&mut out);
                Urgent::TOPIC.id
            }
            Self::SaveParameter(write) => {
                write.put(&mut out);
                SAVE_PARAMETER
            }
            Self::Restart => RESTART,
        };
        let length = out.finish()?;
        let head = [START, u8::try_from(length).ok()?, u8::try_from(topic).ok()?];
        let mut frame = Encoder::new(buffer);
        frame.bytes(head);
        frame.slice(record.get(..length)?);
        let [_, covered @ ..] = head;
        let crc = crc8(crc8(0, &covered), record.get(..length)?);
        frame.bytes([crc]);
        frame.finish()
    }

    fn decode(topic: u8, record: &[u8]) -> Option<Self> {
        let mut from = Decoder::new(record);
        let request = match u16::from(topic) {
            RESTART => Self::Restart,
            SAVE_PARAMETER => Self::SaveParameter(Record::get(&mut from)?),
            topic if topic == Urgent::TOPIC.id => Self::Urgent(Record::get(&mut from)?),
            topic => Self::Input(Input::get(topic, &mut from)?),
        };
        from.rest().is_empty().then_some(request)
    }
}

fn crc8(crc: u8, bytes: &[u8]) -> u8 {
    bytes.iter().fold(crc, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc, _| {
            if crc & 0x80 == 0 {
                crc << 1
            } else {
                crc << 1 ^ 0x07
            }
        })
    })
}

/// Finds frames in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Parser {
    /// The frame so far.
    frame: [u8; FRAME],
    length: usize,
    damaged: u32,
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            frame: [0; FRAME],
            length: 0,
            damaged: 0,
        }
    }
}

impl Parser {
    /// Takes one byte; the request that it completes.
    pub fn push(&mut self, byte: u8) -> Option<Request> {
        if self.length == 0 && byte != START {
            return None;
        }
        if let Some(place) = self.frame.get_mut(self.length) {
            *place = byte;
        }
        self.length += 1;
        let [_, record, ..] = self.frame;
        let record = usize::from(record);
        if self.length >= 2 && record > RECORD {
            return self.give_up();
        }
        if self.length < 2 || self.length < record + 4 {
            return None;
        }
        match self.whole(record) {
            Some(request) => {
                self.length = 0;
                Some(request)
            }
            None => self.give_up(),
        }
    }

    /// Frames that began and were none.
    pub fn damaged(&self) -> u32 {
        self.damaged
    }

    fn whole(&self, record: usize) -> Option<Request> {
        let (covered, crc) = self.frame.get(1..record + 4)?.split_at_checked(record + 2)?;
        if [crc8(0, covered)] != *crc {
            return None;
        }
        let (head, record) = covered.split_first_chunk::<2>()?;
        let [_, topic] = *head;
        Request::decode(topic, record)
    }

    fn give_up(&mut self) -> Option<Request> {
        self.damaged = self.damaged.saturating_add(1);
        self.length = 0;
        None
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use std::vec::Vec;
    use windhover_autopilot::{Command, Mode};
    use windhover_control::position::AttitudeSetpoint;
    use windhover_math::{Quaternion, Vector3};

    use super::*;

    fn requests() -> Vec<Request> {
        let setpoint = AttitudeSetpoint {
            attitude: Quaternion::from_heading(0.5),
            rate: Vector3::zeros(),
            thrust: 7.5,
        };
        let write = ParameterWrite {
            index: 3,
            value: -0.5,
        };
        let mut all: Vec<Request> = [Command::ForceArm, Command::Fly(Mode::Offboard), Command::Disarm]
            .map(|command| Request::Input(Input::Command(command)))
            .into();
        all.extend([
            Request::Input(Input::Attitude(setpoint)),
            Request::Input(Input::Parameter(write)),
            Request::Urgent(Urgent::Kill),
            Request::Urgent(Urgent::Disarm),
            Request::SaveParameter(write),
            Request::Restart,
        ]);
        all
    }

    fn frame(request: &Request) -> Vec<u8> {
        let mut buffer = [0; FRAME];
        let length = request.encode(&mut buffer).expect("it fits");
        buffer[..length].to_vec()
    }

    #[test]
    fn requests_come_back_from_a_stream() {
        let mut parser = Parser::default();
        let bytes: Vec<u8> = requests().iter().flat_map(frame).collect();
        let back: Vec<Request> = bytes.iter().filter_map(|byte| parser.push(*byte)).collect();
        assert_eq!((back, parser.damaged()), (requests(), 0));
    }

    /// No single damaged byte of a frame gives another request.
    #[test]
    fn a_damaged_frame_asks_for_nothing() {
        for request in requests() {
            let good = frame(&request);
            for place in 1..good.len() {
                for flip in 1..=255u8 {
                    let mut bad = good.clone();
                    bad[place] ^= flip;
                    let mut parser = Parser::default();
                    let found: Vec<_> = bad.iter().filter_map(|byte| parser.push(*byte)).collect();
                    assert!(
                        found.is_empty(),
                        "{request:?}: byte {place} changed by {flip:#x} gives {found:?}"
                    );
                }
            }
        }
    }

    proptest! {
        /// Whatever went before, a frame that comes after enough silence bytes is found.
        #[test]
        fn garbage_ends(garbage in prop::collection::vec(any::<u8>(), 0..300)) {
            let mut parser = Parser::default();
            for byte in garbage {
                let _ = parser.push(byte);
            }
            for _ in 0..FRAME {
                let _ = parser.push(0);
            }
            let found: Vec<_> = frame(&Request::Restart).iter().filter_map(|byte| parser.push(*byte)).collect();
            prop_assert_eq!(found, [Request::Restart]);
        }
    }
}
