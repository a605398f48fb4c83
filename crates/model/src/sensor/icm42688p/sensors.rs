//! Accelerometer, gyroscope and thermometer: modes, start-up, and the data registers.

use super::clock::{Clock, Grid, millihertz};
use super::registers::{
    ACCEL_CONFIG0, GYRO_CONFIG0, GYRO_DATA_Z0, INTF_CONFIG0, PWR_MGMT0, Registers, TEMP_DATA1,
};
use super::{Measurement, Misuse, NEVER};

/// From off to valid data (data sheet, tables 1 and 2), in µs.
const GYRO_START_US: u64 = 30_000;
const ACCEL_START_US: u64 = 10_000;

/// The gyroscope has to stay on for at least that long, in µs (PWR_MGMT0).
const GYRO_MINIMUM_US: u64 = 45_000;

/// GYRO_MODE and ACCEL_MODE.
const LOW_NOISE: u8 = 3;
const LOW_POWER: u8 = 2;

/// In INTF_CONFIG0.
const HOLD_LAST_DATA: u8 = 1 << 7;
const BIG_ENDIAN: u8 = 1 << 4;

/// In PWR_MGMT0.
const TEMPERATURE_OFF: u8 = 1 << 5;

/// What marks a register that holds no sample.
const INVALID: i16 = i16::MIN;

/// Bytes of the data registers.
pub(super) const DATA_BYTES: usize = (GYRO_DATA_Z0 - TEMP_DATA1 + 1) as usize;

/// The sensors.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    gyro_on: bool,
    accel_on: bool,
    /// When the gyroscope was turned on, and from when on its data are valid.
    gyro_since: u64,
    gyro_valid: u64,
    accel_valid: u64,
    grid: Option<Grid>,
    data: Measurement,
}

impl Sensors {
    /// As after a reset.
    pub fn new() -> Self {
        Self {
            gyro_on: false,
            accel_on: false,
            gyro_since: 0,
            gyro_valid: NEVER,
            accel_valid: NEVER,
            grid: None,
            data: Measurement {
                accel: [INVALID; 3],
                gyro: [INVALID; 3],
                temperature: INVALID,
            },
        }
    }

    /// Whether one of them runs.
    pub fn running(&self) -> bool {
        self.gyro_on || self.accel_on
    }

    /// Takes over the modes of PWR_MGMT0; whether a sensor is turned on that was off.
    pub fn set_modes(
        &mut self,
        now: u64,
        clock: &Clock,
        registers: &Registers,
        misuse: &mut Vec<Misuse>,
    ) -> bool {
        let power = registers.get(PWR_MGMT0);
        let (gyro_mode, accel_mode) = (power >> 2 & 3, power & 3);
        let (gyro, accel) = (gyro_mode == LOW_NOISE, accel_mode == LOW_NOISE);
        if accel_mode == LOW_POWER {
            misuse.push(Misuse::NotModelled("low-power mode of the accelerometer"));
        }
        if self.gyro_on && !gyro && now < self.gyro_since + clock.microseconds(GYRO_MINIMUM_US) {
            misuse.push(Misuse::GyroscopeTooShort);
        }
        let gyro_starts = gyro && !self.gyro_on;
        let accel_starts = accel && !self.accel_on;
        if gyro_starts {
            self.gyro_since = now;
            self.gyro_valid = now + clock.microseconds(GYRO_START_US);
        }
        if accel_starts {
            self.accel_valid = now + clock.microseconds(ACCEL_START_US);
        }
        let ran = self.running();
        (self.gyro_on, self.accel_on) = (gyro, accel);
        if ran != self.running() {
            self.restart(now, clock, registers, misuse);
        }
        gyro_starts || accel_starts
    }

    /// Begins a new grid of samples, at the rate that the registers say: the gyroscope's where
    /// it runs.
    pub fn restart(&mut self, now: u64, clock: &Clock, registers: &Registers, misuse: &mut Vec<Misuse>) {
        self.grid = None;
        if !self.running() {
            return;
        }
        let gyro = registers.get(GYRO_CONFIG0);
        let accel = registers.get(ACCEL_CONFIG0);
        let valid = |on: bool, time: u64| if on { time } else { NEVER };
        let first = valid(self.gyro_on, self.gyro_valid).min(valid(self.accel_on, self.accel_valid));
        match millihertz(if self.gyro_on { gyro } else { accel }) {
            Some(rate) => self.grid = Some(Grid::new(clock, first.max(now), rate)),
            None => misuse.push(Misuse::ReservedRate),
        }
        if self.gyro_on && self.accel_on && (gyro ^ accel) & 0x0F != 0 {
            misuse.push(Misuse::NotModelled(
                "gyroscope and accelerometer at different rates",
            ));
        }
    }

    /// When the next sample is taken.
    pub fn next(&self) -> u64 {
        self.grid.map_or(NEVER, |grid| grid.time())
    }

    /// Takes the time of the next sample.
    pub fn tick(&mut self, clock: &Clock) -> u64 {
        let time = self.next();
        if let Some(grid) = &mut self.grid {
            grid.advance(clock);
        }
        time
    }

    /// A sample is in. Sensors that still start keep what they have.
    pub fn put(&mut self, time: u64, measured: &Measurement, registers: &Registers) {
        let hold = registers.get(INTF_CONFIG0) & HOLD_LAST_DATA != 0;
        let scaled = |counts: [i16; 3], shift: u8| {
            counts.map(|count| {
                // −32768 marks an invalid sample, so that a valid one is never below −32767.
                let low = if hold { i16::MIN } else { i16::MIN + 1 };
                let scaled = i32::from(count) << shift;
                scaled.clamp(i32::from(low), i32::from(i16::MAX)) as i16
            })
        };
        if self.accel_on && time >= self.accel_valid {
            self.data.accel = scaled(measured.accel, registers.get(ACCEL_CONFIG0) >> 5 & 3);
        }
        if self.gyro_on && time >= self.gyro_valid {
            self.data.gyro = scaled(measured.gyro, registers.get(GYRO_CONFIG0) >> 5);
        }
        if registers.get(PWR_MGMT0) & TEMPERATURE_OFF == 0 {
            self.data.temperature = measured.temperature;
        }
    }

    /// The data registers from TEMP_DATA1 on, in the byte order of INTF_CONFIG0.
    pub fn bytes(&self, registers: &Registers) -> [u8; DATA_BYTES] {
        let big = registers.get(INTF_CONFIG0) & BIG_ENDIAN != 0;
        let [ax, ay, az] = self.data.accel;
        let [gx, gy, gz] = self.data.gyro;
        let words = [self.data.temperature, ax, ay, az, gx, gy, gz];
        let mut bytes = [0; DATA_BYTES];
        for (pair, word) in bytes.chunks_exact_mut(2).zip(words) {
            pair.copy_from_slice(&if big {
                word.to_be_bytes()
            } else {
                word.to_le_bytes()
            });
        }
        bytes
    }
}
