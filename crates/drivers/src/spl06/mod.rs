//! The barometer Goertek SPL06-001 on I2C (its data sheet).
//!
//! [`Spl06::poll`] takes the part through identity, reset, coefficients and configuration, step by
//! step, and then looks for results: pressure 32 times a second, 16 samples each, temperature
//! 8 times, 4 samples each. That is 950 of 1000 ms of measuring. A part that loses its
//! configuration is set up anew.

mod compensation;

use compensation::{COEFFICIENT_BYTES, Coefficients, raw};
use embedded_hal::i2c::I2c;

pub use crate::health::Health;
use crate::i2c_part::{Trouble, Watch, read, write};

/// The part's address with SDO low.
pub const ADDRESS: u8 = 0x76;

const PSR_B2: u8 = 0x00;
const PRS_CFG: u8 = 0x06;
const TMP_CFG: u8 = 0x07;
const MEAS_CFG: u8 = 0x08;
const CFG_REG: u8 = 0x09;
const RESET: u8 = 0x0C;
const ID: u8 = 0x0D;
const COEF: u8 = 0x10;

/// Product and revision.
const IDENTITY: u8 = 0x10;

const SOFT_RESET: u8 = 0x09;

/// In MEAS_CFG: coefficients and sensors can be used; a pressure is there.
const READY: u8 = 1 << 7 | 1 << 6;
const PRS_RDY: u8 = 1 << 4;

/// In MEAS_CFG: pressure and temperature in the background, and where that stands.
const BACKGROUND: u8 = 7;

/// Registers in the order in which they are written, what is written, and what of it is read back.
/// Measuring begins with the last.
const SETTINGS: [(u8, u8, u8); 4] = [
    // 32 a second, 16 samples
    (PRS_CFG, 5 << 4 | 4, 0x7F),
    // 8 a second, 4 samples, by the sensor that the coefficients are of (TMP_EXT)
    (TMP_CFG, 1 << 7 | 3 << 4 | 2, 0xF7),
    // P_SHIFT: needed above 8 samples
    (CFG_REG, 1 << 2, 0x0C),
    (MEAS_CFG, BACKGROUND, BACKGROUND),
];

/// No access for so long after a reset, in µs.
const RESET_US: u64 = 10_000;

/// From one look whether the part is ready to the next, in µs.
const LOOK_US: u64 = 2_000;

/// No look for so long after a result, in µs: the next comes after 31 ms.
const REST_US: u64 = 25_000;

/// The longest that the part may take to start (data sheet: 40 ms) or to measure, in µs.
const PATIENCE_US: u64 = 200_000;

/// From the middle of a measurement to its end, in µs: 16 samples take 27.6 ms.
const HALF_US: u64 = 13_800;

/// What result registers hold before there is one.
const NO_RESULT: i32 = -(1 << 23);

/// A result.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BarometerReading {
    /// The middle of the measurement if it was just over when it was read, in µs.
    pub time: u64,
    /// Pressure in Pa, compensated. Finite.
    pub pressure: f32,
}

/// What comes next. `since` is a time in µs from which patience is counted.
#[derive(Clone, Copy, Debug)]
enum Step {
    Identify,
    Start {
        since: u64,
    },
    Coefficients,
    /// They are read again: there is no checksum.
    Confirm {
        packed: [u8; COEFFICIENT_BYTES],
    },
    Configure {
        index: usize,
        coefficients: Coefficients,
    },
    Measure {
        since: u64,
        coefficients: Coefficients,
    },
}

/// The part.
#[derive(Clone, Debug)]
pub struct Spl06 {
    step: Step,
    watch: Watch,
}

impl Default for Spl06 {
    fn default() -> Self {
        Self::new()
    }
}

impl Spl06 {
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

    /// Does what is due at `now`, in µs since start: two transfers of at most 20 bytes, or less. To
    /// be called every few ms. Returns a result that is new.
    pub fn poll(&mut self, bus: &mut impl I2c, now: u64) -> Option<BarometerReading> {
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

    fn advance(&mut self, bus: &mut impl I2c, now: u64) -> Result<Option<BarometerReading>, Trouble> {
        match self.step {
            Step::Identify => {
                let [identity] = read(bus, ADDRESS, ID)?;
                if identity != IDENTITY {
                    return Err(Trouble::WrongPart(identity));
                }
                self.watch.identified();
                write(bus, ADDRESS, RESET, SOFT_RESET)?;
                self.watch.due = now + RESET_US;
                self.step = Step::Start { since: now };
            }
            Step::Start { since } => {
                let [status] = read(bus, ADDRESS, MEAS_CFG)?;
                if status & READY == READY {
                    self.step = Step::Coefficients;
                } else {
                    self.look_again(since, now)?;
                }
            }
            Step::Coefficients => {
                let packed = read(bus, ADDRESS, COEF)?;
                self.step = Step::Confirm { packed };
            }
            Step::Confirm { packed } => {
                if packed != read(bus, ADDRESS, COEF)? {
                    return Err(Trouble::Stuck);
                }
                self.step = Step::Configure {
                    index: 0,
                    coefficients: Coefficients::unpack(&packed),
                };
            }
            Step::Configure { index, coefficients } => {
                self.step = match SETTINGS.get(index) {
                    Some(&(register, value, mask)) => {
                        write(bus, ADDRESS, register, value)?;
                        let [held] = read(bus, ADDRESS, register)?;
                        if held & mask != value {
                            return Err(Trouble::Stuck);
                        }
                        let index = index + 1;
                        Step::Configure { index, coefficients }
                    }
                    None => Step::Measure {
                        since: now,
                        coefficients,
                    },
                };
            }
            Step::Measure { since, coefficients } => return self.measure(bus, now, since, coefficients),
        }
        Ok(None)
    }

    /// Looks for a result, the last of which came at `since`.
    fn measure(
        &mut self,
        bus: &mut impl I2c,
        now: u64,
        since: u64,
        coefficients: Coefficients,
    ) -> Result<Option<BarometerReading>, Trouble> {
        let [status] = read(bus, ADDRESS, MEAS_CFG)?;
        if status & BACKGROUND != BACKGROUND {
            // It was reset: by its supply, most likely.
            return Err(Trouble::Stuck);
        }
        if status & PRS_RDY == 0 {
            self.look_again(since, now)?;
            return Ok(None);
        }
        let [a, b, c, d, e, f] = read(bus, ADDRESS, PSR_B2)?;
        let (pressure, temperature) = (raw([a, b, c]), raw([d, e, f]));
        if pressure == NO_RESULT || temperature == NO_RESULT {
            self.look_again(since, now)?;
            return Ok(None);
        }
        self.watch.health = Health::Working;
        self.watch.due = now + REST_US;
        self.step = Step::Measure {
            since: now,
            coefficients,
        };
        Ok(Some(BarometerReading {
            time: now.saturating_sub(HALF_US),
            pressure: coefficients.pressure(pressure, temperature),
        }))
    }

    /// It is not ready: once more, while there is patience.
    fn look_again(&mut self, since: u64, now: u64) -> Result<(), Trouble> {
        self.watch.due = now + LOOK_US;
        if now.saturating_sub(since) > PATIENCE_US {
            return Err(Trouble::Stuck);
        }
        Ok(())
    }
}
