//! The battery: what its two ADC channels read, how much charge is left, and for how long.
//!
//! Raw counts become volts and amperes here, once. Two things say what is left: the open-circuit
//! voltage V + R·I against the curve of a cell, and the charge at the start less what was drawn
//! since. The smaller one counts. The voltage alone is good to a tenth in the flat middle of the
//! curve; the count alone does not know a battery that was not full or has aged.

mod cell;
mod parameters;
#[cfg(test)]
mod tests;

pub use self::parameters::BatteryParameters;

use windhover_math::{max, min};

/// The ADC's largest count, 12 bits; it may stand for anything beyond.
const ADC_MOST: u16 = 4095;
/// Volts at the ADC's pin for a count: 3.3 V over all of them.
const ADC_SCALE: f32 = 3.3 / 4095.0;
/// What a cell can show, V. Less is a wire that came off, more another number of cells.
const CELL_RANGE: core::ops::RangeInclusive<f32> = 1.0..=5.0;

/// Time constant of voltage and current for display, s.
const DISPLAY_TIME: f32 = 0.5;
/// Time constant of the open-circuit voltage, s.
const OPEN_CIRCUIT_TIME: f32 = 2.0;
/// Time constant of the mean current, s: with it the mean is 15 s old, as that over the last 30 s is.
const MEAN_TIME: f32 = 15.0;
/// From this much of the beginning the charge at the start is taken, s.
const START_TIME: f32 = 1.0;
/// A worse level must last so long, s, that no load step makes one where the resistance is not
/// quite right.
const DWELL: f32 = 4.0;
/// A level is left for a better one only with so much more charge.
const HYSTERESIS: f32 = 0.05;
/// A sensor that is silent for longer is gone, µs.
const SILENCE: u32 = 2_000_000;
/// Less current than this, A, says nothing about how long the battery lasts.
const LEAST_CURRENT: f32 = 0.1;

/// What the two ADC channels read: 12 bits of 3.3 V.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BatterySample {
    /// When it was measured, µs since start.
    pub time: u64,
    /// Counts behind the divider of the voltage.
    pub voltage: u16,
    /// Counts of the current sensor.
    pub current: u16,
}

impl BatterySample {
    /// Volts and amperes; `None` for what cannot be.
    fn convert(&self, parameters: &BatteryParameters) -> Option<(f32, f32)> {
        if max(self.voltage, self.current) >= ADC_MOST {
            return None;
        }
        let voltage = f32::from(self.voltage) * ADC_SCALE * parameters.divider;
        let current = f32::from(self.current) * ADC_SCALE * parameters.per_volt;
        CELL_RANGE
            .contains(&(voltage / parameters.cell_count()))
            .then_some((voltage, current))
    }
}

/// How much charge there is. In this order, later is worse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Charge {
    /// Nobody knows: no sensor, none any more, or only since a second.
    #[default]
    Unknown,
    /// Enough.
    Enough,
    /// Below `BAT_LOW_THR`.
    Low,
    /// Below `BAT_CRIT_THR`.
    Critical,
    /// Below `BAT_EMERGEN_THR`.
    Emergency,
}

impl Charge {
    fn of(remaining: f32, parameters: &BatteryParameters) -> Self {
        if remaining < parameters.emergency {
            Self::Emergency
        } else if remaining < parameters.critical {
            Self::Critical
        } else if remaining < parameters.low {
            Self::Low
        } else {
            Self::Enough
        }
    }
}

/// Filtered values since the first sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Measured {
    /// When the last sample was measured, µs.
    time: u64,
    /// How long this goes on, s.
    elapsed: f32,
    voltage: f32,
    current: f32,
    open_circuit: f32,
    mean_current: f32,
    /// Charge drawn, nC. Whole numbers: a sum of floats would lose what is small.
    drawn: u64,
    /// Share of the charge at the start.
    start: Option<f32>,
}

impl Measured {
    fn new(time: u64, voltage: f32, current: f32, open_circuit: f32) -> Self {
        Self {
            time,
            voltage,
            current,
            open_circuit,
            mean_current: current,
            ..Self::default()
        }
    }

    /// Goes on to a sample `dt_us` µs later.
    fn take(&mut self, dt_us: u64, voltage: f32, current: f32, open_circuit: f32) {
        let dt = dt_us as f32 * 1e-6;
        self.time = self.time.saturating_add(dt_us);
        self.elapsed += dt;
        let elapsed = self.elapsed;
        // a plain mean at first, a low-pass once it is as old as its time constant
        let follow = |value: &mut f32, sample: f32, constant: f32| {
            *value += (sample - *value) * min(dt / min(elapsed, constant), 1.0);
        };
        follow(&mut self.voltage, voltage, DISPLAY_TIME);
        follow(&mut self.current, current, DISPLAY_TIME);
        follow(&mut self.open_circuit, open_circuit, OPEN_CIRCUIT_TIME);
        follow(&mut self.mean_current, current, MEAN_TIME);
        // mA·µs
        let milliamperes = (current * 1e3 + 0.5) as u64;
        self.drawn = self.drawn.saturating_add(milliamperes.saturating_mul(dt_us));
    }

    fn drawn(&self) -> f32 {
        self.drawn as f32 * 1e-9
    }

    /// Share of the charge that is left, once the start is over.
    fn remaining(&mut self, parameters: &BatteryParameters) -> Option<f32> {
        if self.elapsed < START_TIME {
            return None;
        }
        let by_voltage = parameters.share_at(self.open_circuit);
        let start = *self.start.get_or_insert(by_voltage);
        Some(match parameters.full_charge() {
            Some(full) => min(by_voltage, max(start - self.drawn() / full, 0.0)),
            None => by_voltage,
        })
    }
}

/// The battery with its memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery {
    measured: Option<Measured>,
    remaining: Option<f32>,
    /// The charge of the full battery, C, if it is known.
    full: Option<f32>,
    charge: Charge,
    /// How long the charge has been worse than its level, s, and the best that it was meanwhile.
    worse: Option<(f32, Charge)>,
    /// µs since the last good sample.
    silent: u32,
    refused: u32,
}

impl Battery {
    /// Goes on by `dt_us` µs, and takes in the samples that came, in order of time.
    pub fn step(&mut self, samples: &[BatterySample], parameters: &BatteryParameters, dt_us: u32) {
        if samples.is_empty() && self.measured.is_none() {
            // Nothing is known, and nothing comes.
            return;
        }
        if !parameters.is_watched() {
            *self = Self::default();
            return;
        }
        self.full = parameters.full_charge();
        self.silent = self.silent.saturating_add(dt_us);
        for sample in samples {
            if self.take(sample, parameters).is_some() {
                self.silent = 0;
            } else {
                self.refused = self.refused.wrapping_add(1);
            }
        }
        if !samples.is_empty() {
            self.remaining = self.measured.as_mut().and_then(|m| m.remaining(parameters));
        }
        self.judge(parameters, dt_us as f32 * 1e-6);
    }

    /// Voltage as measured, filtered, V.
    pub fn voltage(&self) -> Option<f32> {
        self.known().map(|measured| measured.voltage)
    }

    /// Current, filtered, A.
    pub fn current(&self) -> Option<f32> {
        self.known().map(|measured| measured.current)
    }

    /// Voltage with the drop by the load taken off, filtered, V.
    pub fn open_circuit(&self) -> Option<f32> {
        self.known().map(|measured| measured.open_circuit)
    }

    /// Charge drawn since the start, C; it stays when the sensor is gone.
    pub fn drawn(&self) -> f32 {
        self.measured.map_or(0.0, |measured| measured.drawn())
    }

    /// Share of the charge that is left, 0 to 1.
    pub fn remaining(&self) -> Option<f32> {
        self.known().and(self.remaining)
    }

    /// How much charge there is.
    pub fn charge(&self) -> Charge {
        self.charge
    }

    /// Whether there was a battery since the start: then `Charge::Unknown` is a loss.
    pub fn was_seen(&self) -> bool {
        self.measured.is_some()
    }

    /// How many samples were refused since the start: impossible, or not later than the one before.
    pub fn refused(&self) -> u32 {
        self.refused
    }

    /// Whether a cell shows less than is asked for to arm; what is not known is not too low.
    pub fn is_too_low_to_arm(&self, parameters: &BatteryParameters) -> bool {
        self.voltage()
            .is_some_and(|voltage| voltage < parameters.arming_voltage())
    }

    /// After how many seconds, drawn as in the last half minute, only the share `reserve` of the charge
    /// is left. `None` while charge or capacity is not known, or hardly anything is drawn.
    pub fn seconds_left(&self, reserve: f32) -> Option<f32> {
        let current = self.known()?.mean_current;
        let share = max(self.remaining()? - reserve, 0.0);
        (current >= LEAST_CURRENT).then_some(share * self.full? / current)
    }

    /// What is measured, while the sensor speaks.
    fn known(&self) -> Option<&Measured> {
        self.measured.as_ref().filter(|_| self.silent <= SILENCE)
    }

    /// The border. `None` for a sample that is refused.
    fn take(&mut self, sample: &BatterySample, parameters: &BatteryParameters) -> Option<()> {
        let (voltage, current) = sample.convert(parameters)?;
        let open_circuit = voltage + parameters.pack_resistance() * current;
        match &mut self.measured {
            None => self.measured = Some(Measured::new(sample.time, voltage, current, open_circuit)),
            Some(measured) => {
                // what was drawn during a silence is counted with the current after it
                let dt_us = sample.time.checked_sub(measured.time).filter(|dt| *dt > 0)?;
                measured.take(dt_us, voltage, current, open_circuit);
            }
        }
        Some(())
    }

    /// A worse level comes when it lasts, a better one when it is clearly better.
    fn judge(&mut self, parameters: &BatteryParameters, dt: f32) {
        let before = self.worse.take();
        let Some(remaining) = self.remaining() else {
            self.charge = Charge::Unknown;
            return;
        };
        let now = Charge::of(remaining, parameters);
        let better = Charge::of(remaining - HYSTERESIS, parameters);
        if self.charge == Charge::Unknown {
            self.charge = now;
        } else if now > self.charge {
            let (time, best) = before.map_or((dt, now), |(time, best)| (time + dt, min(best, now)));
            if time >= DWELL {
                self.charge = best;
            } else {
                self.worse = Some((time, best));
            }
        } else if better < self.charge {
            self.charge = better;
        }
    }
}
