//! The barometer Goertek SPL06-001 behind I2C, after its data sheet: registers, ready flags,
//! measurements by command or in the background, each as long as its oversampling takes.
//!
//! Not modelled: FIFO, interrupts, SPI, the inner thermometer.

use windhover_model::sensor::barometer::BarometerCounts;
use windhover_model::sensor::spl06::{Coefficients, Formula, Oversampling};

use super::Misuse;
use super::i2c::Part;
use crate::time::{MICROSECOND, NEVER, SECOND};

/// Its address with SDO low.
pub const ADDRESS: u8 = 0x76;

const PSR_B2: u8 = 0x00;
const TMP_B2: u8 = 0x03;
const PRS_CFG: u8 = 0x06;
const TMP_CFG: u8 = 0x07;
const MEAS_CFG: u8 = 0x08;
const CFG_REG: u8 = 0x09;
const RESET: u8 = 0x0C;
const ID: u8 = 0x0D;
const COEF: u8 = 0x10;
const COEF_END: u8 = 0x21;

/// Product and revision.
const IDENTITY: u8 = 0x10;

const COEF_RDY: u8 = 1 << 7;
const SENSOR_RDY: u8 = 1 << 6;
const TMP_RDY: u8 = 1 << 5;
const PRS_RDY: u8 = 1 << 4;
const CONTINUOUS: u8 = 1 << 2;
const TEMPERATURE: u8 = 1 << 1;
const PRESSURE: u8 = 1 << 0;

const TMP_EXT: u8 = 1 << 7;
const T_SHIFT: u8 = 1 << 3;
const P_SHIFT: u8 = 1 << 2;

/// SOFT_RST, in the lower half of RESET.
const SOFT_RESET: u8 = 0b1001;

/// From power-on until the sensors and the coefficients can be used (data sheet: start-up timing).
const SENSOR_TIME: u64 = 12_000 * MICROSECOND;
const COEF_TIME: u64 = 40_000 * MICROSECOND;

/// Time of a measurement, by its oversampling (data sheet: pressure configuration), in µs.
const TIMES: [u64; 8] = [3_600, 5_200, 8_400, 14_800, 27_600, 53_200, 104_400, 206_800];

const OVERSAMPLING: [Oversampling; 8] = [
    Oversampling::X1,
    Oversampling::X2,
    Oversampling::X4,
    Oversampling::X8,
    Oversampling::X16,
    Oversampling::X32,
    Oversampling::X64,
    Oversampling::X128,
];

/// One part.
#[derive(Clone, Debug)]
pub struct Spl06 {
    formula: Formula,
    powered: u64,
    /// PRS_CFG, TMP_CFG, MEAS_CFG without its flags, CFG_REG.
    configuration: [u8; 4],
    flags: u8,
    /// Pressure and temperature, as registers hold them.
    results: [i32; 2],
    /// What a transfer that has begun reads of them.
    seen: [i32; 2],
    /// When the measurement under way will be done.
    due: [u64; 2],
    misuse: Vec<Misuse>,
}

impl Spl06 {
    /// A part of this formula, whose scale factors are those of the counts that it will be given.
    /// Its power comes on now.
    pub fn new(formula: Formula, now: u64) -> Self {
        Self {
            formula,
            powered: now,
            configuration: [0; 4],
            flags: 0,
            results: [i32::from(i16::MIN) << 8; 2],
            seen: [0; 2],
            due: [NEVER; 2],
            misuse: Vec::new(),
        }
    }

    /// What was done against its data sheet.
    pub fn misuse(&self) -> &[Misuse] {
        &self.misuse
    }

    /// A measurement is over by now, of what was measured; nothing for a sensor that fails.
    pub fn put(&mut self, now: u64, counts: Option<BarometerCounts>) {
        let from = [self.formula.pressure, self.formula.temperature];
        for which in 0..2 {
            if self.due[which] > now {
                continue;
            }
            self.due[which] = self.next_due(which);
            let Some(counts) = counts else {
                continue;
            };
            let count = i64::from([counts.pressure, counts.temperature][which]);
            let scaled = count * i64::from(self.oversampling(which).scale()) / i64::from(from[which].scale());
            self.results[which] = scaled.clamp(-(1 << 23), (1 << 23) - 1) as i32;
            self.flags |= [PRS_RDY, TMP_RDY][which];
        }
        if self.configuration[2] & CONTINUOUS == 0 {
            self.configuration[2] = 0;
        }
    }

    fn oversampling(&self, which: usize) -> Oversampling {
        OVERSAMPLING[usize::from(self.configuration[which] & 7)]
    }

    fn time(&self, which: usize) -> u64 {
        TIMES[usize::from(self.configuration[which] & 7)] * MICROSECOND
    }

    /// From one measurement in the background to the next.
    fn period(&self, which: usize) -> u64 {
        SECOND >> (self.configuration[which] >> 4 & 7)
    }

    fn next_due(&self, which: usize) -> u64 {
        if self.configuration[2] & CONTINUOUS != 0 {
            self.due[which] + self.period(which)
        } else {
            NEVER
        }
    }

    /// Measurements begin: the temperature's first.
    fn measure(&mut self, now: u64, command: u8) {
        self.due = [NEVER; 2];
        self.configuration[2] = command;
        let mut end = now;
        for (which, bit) in [(1, TEMPERATURE), (0, PRESSURE)] {
            if command & bit != 0 {
                end += self.time(which);
                self.due[which] = end;
            }
        }
        if command == 0 {
            return;
        }
        let shifts = [P_SHIFT, T_SHIFT].map(|bit| self.configuration[3] & bit != 0);
        let needs = [0, 1].map(|which| self.configuration[which] & 7 > 3);
        let background = command & CONTINUOUS != 0;
        let load: u64 = [(0, PRESSURE), (1, TEMPERATURE)]
            .iter()
            .filter(|(_, bit)| command & bit != 0)
            .map(|(which, _)| SECOND / self.period(*which) * self.time(*which))
            .sum();
        let wrong = [
            (
                now < self.powered + SENSOR_TIME,
                "it is to measure before SENSOR_RDY",
            ),
            (
                self.configuration[1] & TMP_EXT == 0,
                "the coefficients are of the outer thermometer, TMP_EXT",
            ),
            (
                shifts != needs,
                "P_SHIFT and T_SHIFT must be set from 16 samples on, and only then",
            ),
            (
                background && load > SECOND,
                "more measurements in the background than fit in a second",
            ),
            (
                command & !7 != 0 || command & 3 == 3 && !background,
                "a command that does not exist",
            ),
        ];
        let wrong = wrong.iter().filter(|(is, _)| *is);
        self.misuse
            .extend(wrong.map(|(_, what)| (now, (*what).to_owned())));
    }

    fn object(&mut self, now: u64, what: String) {
        self.misuse.push((now, what));
    }
}

/// The coefficients as they lie in memory, from COEF on (data sheet: calibration coefficients).
fn packed(c: &Coefficients) -> [u8; 18] {
    let twelve = |a: i16, b: i16| (u32::from(a as u16) & 0xFFF) << 12 | u32::from(b as u16) & 0xFFF;
    let twenty = |a: i32, b: i32| (u64::from(a as u32) & 0xF_FFFF) << 20 | u64::from(b as u32) & 0xF_FFFF;
    let mut bytes = [0; 18];
    bytes[..3].copy_from_slice(&twelve(c.c0, c.c1).to_be_bytes()[1..]);
    bytes[3..8].copy_from_slice(&twenty(c.c00, c.c10).to_be_bytes()[3..]);
    for (place, value) in bytes[8..]
        .chunks_exact_mut(2)
        .zip([c.c01, c.c11, c.c20, c.c21, c.c30])
    {
        place.copy_from_slice(&value.to_be_bytes());
    }
    bytes
}

impl Part for Spl06 {
    fn begin(&mut self) {
        self.seen = self.results;
    }

    fn read(&mut self, now: u64, register: u8) -> u8 {
        let result = |which: usize, byte: u8| self.seen[which].to_be_bytes()[1 + usize::from(byte)];
        match register {
            PSR_B2..TMP_B2 => {
                let byte = result(0, register - PSR_B2);
                self.flags &= !PRS_RDY;
                byte
            }
            TMP_B2..PRS_CFG => {
                let byte = result(1, register - TMP_B2);
                self.flags &= !TMP_RDY;
                byte
            }
            PRS_CFG | TMP_CFG | CFG_REG => self.configuration[usize::from(register - PRS_CFG)],
            MEAS_CFG => {
                let ready = |time, flag| if now >= self.powered + time { flag } else { 0 };
                let started = ready(SENSOR_TIME, SENSOR_RDY) | ready(COEF_TIME, COEF_RDY);
                started | self.flags | self.configuration[2]
            }
            ID => IDENTITY,
            COEF..=COEF_END => {
                if now < self.powered + COEF_TIME {
                    self.object(now, "coefficients are read before COEF_RDY".to_owned());
                    return 0;
                }
                packed(&self.formula.coefficients)[usize::from(register - COEF)]
            }
            RESET => 0,
            _ => {
                self.object(
                    now,
                    format!("register {register:#04x} is read, which is not modelled"),
                );
                0
            }
        }
    }

    fn write(&mut self, now: u64, register: u8, value: u8) {
        match register {
            PRS_CFG | TMP_CFG => {
                let reserved = if register == PRS_CFG { 0x88 } else { 0x08 };
                if value & reserved != 0 {
                    self.object(now, format!("{value:#04x} is written to {register:#04x}"));
                }
                if self.configuration[2] != 0 {
                    self.object(now, format!("{register:#04x} is written while it measures"));
                }
                self.configuration[usize::from(register - PRS_CFG)] = value & !reserved;
            }
            MEAS_CFG => self.measure(now, value),
            CFG_REG => {
                if value & !(T_SHIFT | P_SHIFT) != 0 {
                    self.object(now, "interrupts, FIFO and SPI are not modelled".to_owned());
                }
                self.configuration[3] = value & (T_SHIFT | P_SHIFT);
            }
            RESET if value & 0x0F == SOFT_RESET => self.power_on(now),
            _ => self.object(now, format!("{value:#04x} is written to {register:#04x}")),
        }
    }

    fn power_on(&mut self, now: u64) {
        *self = Self {
            misuse: std::mem::take(&mut self.misuse),
            ..Self::new(self.formula, now)
        };
    }

    fn next_event(&self) -> u64 {
        self.due[0].min(self.due[1])
    }
}

#[cfg(test)]
mod tests;
