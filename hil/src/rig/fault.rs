//! Faults of sensors and wires, by name and time.
//!
//! In text `name`, `name@start` or `name@start+duration`, times in seconds: `imu-absent`,
//! `imu-unplugged@5+0.3`, `data-ready-random@10+50`. Without a start a fault is there from
//! power-on, without a duration it stays.

use std::str::FromStr;

use windhover_model::random::Random;
use windhover_model::sensor::icm42688p::DataLine;

use crate::board::Usart;
use crate::parts::i2c::Line;
use crate::time::{NEVER, SECOND};

/// Where a sensor is plugged in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Socket {
    /// Inertial sensors.
    Imu,
    /// Barometer.
    Barometer,
    /// Compass.
    Compass,
    /// Satellite receiver.
    Gnss,
    /// RC receiver.
    Remote,
    /// The battery's voltage and current.
    Battery,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The part is not there, or has no power: nothing drives its lines.
    Unplugged(Socket),
    /// A line of I2C is held low.
    HeldLow(Line),
    /// Random bytes come in at a serial port, one behind the other, at its other end's rate.
    Babble(Usart),
    /// The inertial part resets: a short loss of power. It has no duration.
    ImuReset,
    /// The line from part to processor is stuck low.
    SpiStuckLow,
    /// The line from part to processor is stuck high.
    SpiStuckHigh,
    /// The part sends the same byte again and again.
    SpiRepeats,
    /// Data-ready does not reach the processor, while samples go on.
    DataReadyLost,
    /// Data-ready is lost again and again: for 5 to 500 ms, with 0.1 to 2 s between.
    DataReadyRandom,
}

impl FaultKind {
    /// Whether it is of what is there only with [`super::Setup::sensors`].
    pub fn is_of_sensors(self) -> bool {
        match self {
            Self::Unplugged(socket) => socket != Socket::Imu,
            Self::HeldLow(_) => true,
            _ => false,
        }
    }
}

/// Names in text.
const NAMES: [(&str, FaultKind); 23] = [
    ("imu-absent", FaultKind::Unplugged(Socket::Imu)),
    ("imu-unplugged", FaultKind::Unplugged(Socket::Imu)),
    ("baro-absent", FaultKind::Unplugged(Socket::Barometer)),
    ("baro-unplugged", FaultKind::Unplugged(Socket::Barometer)),
    ("compass-absent", FaultKind::Unplugged(Socket::Compass)),
    ("compass-unplugged", FaultKind::Unplugged(Socket::Compass)),
    ("gnss-absent", FaultKind::Unplugged(Socket::Gnss)),
    ("gnss-unplugged", FaultKind::Unplugged(Socket::Gnss)),
    ("rc-absent", FaultKind::Unplugged(Socket::Remote)),
    ("rc-unplugged", FaultKind::Unplugged(Socket::Remote)),
    ("battery-absent", FaultKind::Unplugged(Socket::Battery)),
    ("battery-unplugged", FaultKind::Unplugged(Socket::Battery)),
    ("i2c-clock-low", FaultKind::HeldLow(Line::Clock)),
    ("i2c-data-low", FaultKind::HeldLow(Line::Data)),
    ("babble-usart1", FaultKind::Babble(Usart(1))),
    ("babble-usart2", FaultKind::Babble(Usart(2))),
    ("babble-usart6", FaultKind::Babble(Usart(6))),
    ("imu-reset", FaultKind::ImuReset),
    ("spi-stuck-low", FaultKind::SpiStuckLow),
    ("spi-stuck-high", FaultKind::SpiStuckHigh),
    ("spi-repeats", FaultKind::SpiRepeats),
    ("data-ready-lost", FaultKind::DataReadyLost),
    ("data-ready-random", FaultKind::DataReadyRandom),
];

/// Lengths of random losses in ms, and of the time between them.
const LOSS_MS: [u64; 2] = [5, 500];
const BETWEEN_MS: [u64; 2] = [100, 2000];

/// Random losses end after an hour even if nobody says when.
const RANDOM_LIMIT: u64 = 3600 * SECOND;

/// A fault and its time, in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What is wrong.
    pub kind: FaultKind,
    /// From when on.
    pub start: u64,
    /// How long; `NEVER` for good.
    pub duration: u64,
}

/// A text that is no fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// No fault has this name.
    #[error("{0}: no such fault; there are {names}", names = NAMES.map(|(name, _)| name).join(", "))]
    Name(String),
    /// A time is not a number of seconds from 0 on.
    #[error("{0}: not a time in s")]
    Time(String),
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let (name, times) = text.split_once('@').unwrap_or((text, "0"));
        let (start, duration) = match times.split_once('+') {
            Some((start, duration)) => (start, ticks(duration)?),
            None => (times, NEVER),
        };
        let found = NAMES.iter().find(|(known, _)| *known == name);
        let (_, kind) = *found.ok_or(FaultError::Name(name.into()))?;
        Ok(Self {
            kind,
            start: ticks(start)?,
            duration,
        })
    }
}

/// A time in s, in ticks.
fn ticks(text: &str) -> Result<u64, FaultError> {
    let seconds: f64 = text.parse().map_err(|_| FaultError::Time(text.into()))?;
    if (0.0..1e9).contains(&seconds) {
        Ok((seconds * SECOND as f64).round() as u64)
    } else {
        Err(FaultError::Time(text.into()))
    }
}

/// What a fault does to the part and its wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    Plug(Socket, bool),
    Hold(Line, bool),
    Babble(Usart, bool),
    Reset,
    Line(DataLine),
    /// Data-ready reaches the processor, or does not.
    Ready(bool),
}

/// The actions of some faults in the order of their times.
pub(super) fn schedule(faults: &[Fault], seed: u64) -> Vec<(u64, Action)> {
    let mut actions = vec![];
    for (stream, fault) in faults.iter().enumerate() {
        let end = fault.start.saturating_add(fault.duration);
        let mut span = |begin, after| actions.extend([(fault.start, begin), (end, after)]);
        match fault.kind {
            FaultKind::Unplugged(socket) => span(Action::Plug(socket, false), Action::Plug(socket, true)),
            FaultKind::HeldLow(line) => span(Action::Hold(line, true), Action::Hold(line, false)),
            FaultKind::Babble(port) => span(Action::Babble(port, true), Action::Babble(port, false)),
            FaultKind::ImuReset => actions.push((fault.start, Action::Reset)),
            FaultKind::SpiStuckLow => damage(&mut span, DataLine::StuckLow),
            FaultKind::SpiStuckHigh => damage(&mut span, DataLine::StuckHigh),
            FaultKind::SpiRepeats => damage(&mut span, DataLine::Repeats),
            FaultKind::DataReadyLost => span(Action::Ready(false), Action::Ready(true)),
            FaultKind::DataReadyRandom => {
                let end = end.min(fault.start + RANDOM_LIMIT);
                random_losses(&mut actions, fault.start, end, seed, stream as u64);
            }
        }
    }
    actions.retain(|(time, _)| *time != NEVER);
    actions.sort_by_key(|(time, _)| *time);
    actions
}

fn damage(span: &mut impl FnMut(Action, Action), line: DataLine) {
    span(Action::Line(line), Action::Line(DataLine::Connected));
}

/// Losses of data-ready from `start` on that are over by `end`.
fn random_losses(actions: &mut Vec<(u64, Action)>, start: u64, end: u64, seed: u64, stream: u64) {
    let mut random = Random::new(seed, stream);
    let mut between = |[low, high]: [u64; 2]| {
        let span = (high - low) * SECOND / 1000;
        low * SECOND / 1000 + random.bits() % (span + 1)
    };
    let mut time = start;
    loop {
        let lost = time + between(BETWEEN_MS);
        time = lost + between(LOSS_MS);
        if time > end {
            return;
        }
        actions.extend([(lost, Action::Ready(false)), (time, Action::Ready(true))]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read() {
        for (name, kind) in NAMES {
            assert_eq!(fault(name).kind, kind);
        }
        assert!(fault("baro-absent").kind.is_of_sensors() && fault("i2c-data-low").kind.is_of_sensors());
        assert!(!fault("imu-absent").kind.is_of_sensors() && !fault("babble-usart1").kind.is_of_sensors());
    }

    fn fault(text: &str) -> Fault {
        text.parse().unwrap()
    }

    #[test]
    fn faults_are_read_from_text() {
        let expected = Fault {
            kind: FaultKind::SpiStuckLow,
            start: 5 * SECOND,
            duration: SECOND / 4,
        };
        assert_eq!(fault("spi-stuck-low@5+0.25"), expected);
        let absent = fault("imu-absent");
        assert_eq!((absent.start, absent.duration), (0, NEVER));
    }

    #[test]
    fn what_is_no_fault_is_refused() {
        let refused = |text: &str| text.parse::<Fault>().unwrap_err().to_string();
        assert!(refused("imu-lost").starts_with("imu-lost: no such fault; there are imu-absent, "));
        assert_eq!(refused("imu-reset@now"), "now: not a time in s");
        assert_eq!(refused("imu-reset@-1"), "-1: not a time in s");
    }

    #[test]
    fn a_fault_begins_and_ends() {
        let faults = [fault("imu-unplugged@2+1"), fault("spi-repeats@1")];
        let expected = [
            (SECOND, Action::Line(DataLine::Repeats)),
            (2 * SECOND, Action::Plug(Socket::Imu, false)),
            (3 * SECOND, Action::Plug(Socket::Imu, true)),
        ];
        assert_eq!(schedule(&faults, 1), expected);
    }

    #[test]
    fn random_losses_last_5_to_500_ms_and_repeat_by_their_seed() {
        let faults = [fault("data-ready-random@1+60")];
        let actions = schedule(&faults, 7);
        assert!(actions.len() > 60, "{}", actions.len());
        for pair in actions.chunks(2) {
            let [(lost, Action::Ready(false)), (back, Action::Ready(true))] = pair else {
                panic!("{pair:?}");
            };
            assert!((SECOND / 200..=SECOND / 2).contains(&(back - lost)));
            assert!((SECOND..=61 * SECOND).contains(lost) && *back <= 61 * SECOND);
        }
        assert_eq!(actions, schedule(&faults, 7));
        assert_ne!(actions, schedule(&faults, 8));
    }
}
