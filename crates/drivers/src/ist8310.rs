//! The compass iSentek IST8310 on I2C (its data sheet).
//!
//! The part measures when it is told to. [`Ist8310::poll`] takes it through identity, reset and
//! configuration, and then starts a measurement of 16 samples each [`PERIOD_US`] and reads it when
//! it is over. The scale is that of the reset: 14 bits, 3.3 counts per µT. A part that loses its
//! configuration is set up anew.

use embedded_hal::i2c::I2c;

pub use crate::health::Health;
use crate::i2c_part::{Trouble, Watch, read, write};

/// The part's address, as it leaves the factory.
pub const ADDRESS: u8 = 0x0E;

/// From one measurement to the next, in µs.
pub const PERIOD_US: u64 = 20_000;

const WAI: u8 = 0x00;
const STAT1: u8 = 0x02;
const CNTL1: u8 = 0x0A;
const CNTL2: u8 = 0x0B;
const AVGCNTL: u8 = 0x41;
const PDCNTL: u8 = 0x42;

/// What WAI holds.
const IDENTITY: u8 = 0x10;

/// In STAT1: a result is there.
const DRDY: u8 = 1 << 0;

/// For CNTL1: one measurement.
const SINGLE: u8 = 1;

/// For CNTL2: a reset.
const SRST: u8 = 1 << 0;

/// Registers and what they are to hold.
const SETTINGS: [(u8, u8); 2] = [
    // 16 samples for all axes
    (AVGCNTL, 4 << 3 | 4),
    // the pulse that the data sheet asks for
    (PDCNTL, 3 << 6),
];

/// Measurements between two looks at the configuration.
const LOOKED_OVER: u8 = 25;

/// No access for so long after a reset, in µs.
const RESET_US: u64 = 20_000;

/// A measurement of 16 samples takes so long, in µs.
const MEASURE_US: u64 = 6_000;

/// From one look whether a result is there to the next, in µs.
const LOOK_US: u64 = 1_000;

/// The longest that a measurement may take, in µs.
const PATIENCE_US: u64 = 50_000;

/// A result as the part's registers hold it, in its own left-handed axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CompassReading {
    /// The middle of the measurement, in µs.
    pub time: u64,
    /// Raw counts.
    pub counts: [i16; 3],
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
enum Step {
    Identify,
    /// A setting is written and read back.
    Configure {
        index: usize,
    },
    /// A measurement is started, after so many since the configuration was looked at.
    Start {
        count: u8,
    },
    /// One that was started at `since`, in µs, is read.
    Fetch {
        since: u64,
        count: u8,
    },
    /// A setting is looked at, after a measurement that was started at `since`.
    Verify {
        since: u64,
        index: usize,
    },
}

/// The part.
#[derive(Clone, Debug)]
pub struct Ist8310 {
    step: Step,
    watch: Watch,
}

impl Default for Ist8310 {
    fn default() -> Self {
        Self::new()
    }
}

impl Ist8310 {
    /// A part of which nothing is known.
    pub const fn new() -> Self {
        Self {
            step: Step::Identify,
            watch: Watch::new(),
        }
    }

    /// How the part is.
    pub fn health(&self) -> Health {
        self.watch.health
    }

    /// Does what is due at `now`, in µs since start: two transfers of at most 9 bytes, or less. To
    /// be called every few ms. Returns a result that is new.
    pub fn poll(&mut self, bus: &mut impl I2c, now: u64) -> Option<CompassReading> {
        if now < self.watch.due {
            return None;
        }
        match self.advance(bus, now) {
            Ok(reading) => {
                self.watch.succeeded();
                reading
            }
            Err(trouble) => {
                if self.watch.failed(trouble, now) {
                    self.step = Step::Identify;
                }
                None
            }
        }
    }

    fn advance(&mut self, bus: &mut impl I2c, now: u64) -> Result<Option<CompassReading>, Trouble> {
        match self.step {
            Step::Identify => {
                let [identity] = read(bus, ADDRESS, WAI)?;
                if identity != IDENTITY {
                    return Err(Trouble::WrongPart(identity));
                }
                self.watch.identified();
                write(bus, ADDRESS, CNTL2, SRST)?;
                self.watch.due = now + RESET_US;
                self.step = Step::Configure { index: 0 };
            }
            Step::Configure { index } => {
                self.step = match SETTINGS.get(index) {
                    Some(&(register, value)) => {
                        write(bus, ADDRESS, register, value)?;
                        holds(bus, register, value)?;
                        Step::Configure { index: index + 1 }
                    }
                    None => Step::Start { count: 0 },
                };
            }
            Step::Start { count } => {
                write(bus, ADDRESS, CNTL1, SINGLE)?;
                self.watch.due = now + MEASURE_US;
                self.step = Step::Fetch { since: now, count };
            }
            Step::Fetch { since, count } => return self.fetch(bus, now, since, count),
            Step::Verify { since, index } => match SETTINGS.get(index) {
                Some(&(register, value)) => {
                    holds(bus, register, value)?;
                    let index = index + 1;
                    self.step = Step::Verify { since, index };
                }
                None => {
                    self.watch.due = since + PERIOD_US;
                    self.step = Step::Start { count: 0 };
                }
            },
        }
        Ok(None)
    }

    /// Looks for the result of the measurement that was started at `since`.
    fn fetch(
        &mut self,
        bus: &mut impl I2c,
        now: u64,
        since: u64,
        count: u8,
    ) -> Result<Option<CompassReading>, Trouble> {
        let [status, data @ ..] = read::<7>(bus, ADDRESS, STAT1)?;
        if status & DRDY == 0 {
            self.watch.due = now + LOOK_US;
            if now.saturating_sub(since) > PATIENCE_US {
                return Err(Trouble::Stuck);
            }
            return Ok(None);
        }
        self.watch.health = Health::Working;
        if count < LOOKED_OVER {
            self.watch.due = since + PERIOD_US;
            self.step = Step::Start { count: count + 1 };
        } else {
            self.step = Step::Verify { since, index: 0 };
        }
        let [a, b, c, d, e, f] = data;
        Ok(Some(CompassReading {
            time: since + MEASURE_US / 2,
            counts: [[a, b], [c, d], [e, f]].map(i16::from_le_bytes),
        }))
    }
}

/// Reads a setting back.
fn holds(bus: &mut impl I2c, register: u8, value: u8) -> Result<(), Trouble> {
    let [held] = read(bus, ADDRESS, register)?;
    if held == value {
        Ok(())
    } else {
        Err(Trouble::Stuck)
    }
}
