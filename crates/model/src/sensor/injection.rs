//! Faults at work: a wrapper around a sensor's raw outputs.
//!
//! It stands behind the sensor and has its own random numbers, so that the sensor never notices:
//! outside the window of a fault every output is the sensor's, bit for bit.

use super::barometer::BarometerCounts;
use super::battery::BatteryCounts;
use super::fault::{FaultKind, FaultSensor, SensorFault};
use super::icm42688p::Measurement;
use super::nav_pvt::NavPvt;
use super::rc::{CHANNELS, HIGH, LOW};
use super::{count, count_i16, stream};
use crate::random::Random;

/// From spike to spike, in µs.
const SPIKE_US: u64 = 1_000_000;

/// A sensor's raw output as numbers that a fault can change.
pub trait Raw: Copy {
    /// Its numbers, in counts.
    fn values(&self) -> Vec<f64>;

    /// The same output with other numbers, held within what the part can hold.
    fn with(self, values: &[f64]) -> Self;

    /// What a frozen sensor that held `self` gives instead of `_fresh`.
    fn frozen(self, _fresh: Self) -> Self {
        self
    }
}

impl Raw for [i16; 3] {
    fn values(&self) -> Vec<f64> {
        self.map(f64::from).to_vec()
    }

    fn with(self, values: &[f64]) -> Self {
        core::array::from_fn(|axis| count_i16(values[axis]))
    }
}

impl Raw for Measurement {
    /// The unit as a whole only drops out or freezes.
    fn values(&self) -> Vec<f64> {
        Vec::new()
    }

    fn with(self, _values: &[f64]) -> Self {
        self
    }
}

impl Raw for BarometerCounts {
    fn values(&self) -> Vec<f64> {
        vec![f64::from(self.pressure)]
    }

    fn with(self, values: &[f64]) -> Self {
        Self {
            pressure: count(values[0], -(1 << 23), (1 << 23) - 1),
            ..self
        }
    }
}

impl Raw for BatteryCounts {
    fn values(&self) -> Vec<f64> {
        vec![f64::from(self.voltage), f64::from(self.current)]
    }

    fn with(self, values: &[f64]) -> Self {
        let adc = |value: f64| count(value, 0, 4095) as u16;
        Self {
            voltage: adc(values[0]),
            current: adc(values[1]),
        }
    }
}

impl Raw for [u16; CHANNELS] {
    fn values(&self) -> Vec<f64> {
        self.map(f64::from).to_vec()
    }

    fn with(self, values: &[f64]) -> Self {
        core::array::from_fn(|channel| count(values[channel], LOW.into(), HIGH.into()) as u16)
    }
}

impl Raw for NavPvt {
    fn values(&self) -> Vec<f64> {
        let [north, east, down] = self.velocity;
        [self.latitude, self.longitude, self.height_msl, north, east, down]
            .map(f64::from)
            .to_vec()
    }

    fn with(self, values: &[f64]) -> Self {
        let whole = |i: usize| count(values[i], i32::MIN, i32::MAX);
        let geoid = self.height.saturating_sub(self.height_msl);
        Self {
            latitude: whole(0),
            longitude: whole(1),
            height: whole(2).saturating_add(geoid),
            height_msl: whole(2),
            velocity: [whole(3), whole(4), whole(5)],
            ground_speed: count(libm::hypot(values[3], values[4]), 0, i32::MAX),
            ..self
        }
    }

    /// The receiver's clock goes on.
    fn frozen(self, fresh: Self) -> Self {
        Self {
            time_of_week: fresh.time_of_week,
            ..self
        }
    }
}

/// What one unit of a magnitude is for one of a sensor's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Counts of a unit.
    pub counts: f64,
    /// Whether a wrong scale counts from the first output in the window instead of from `zero`.
    pub from_first: bool,
    /// The count that stands for nothing.
    pub zero: f64,
}

impl Unit {
    /// A unit of so many counts; a wrong scale counts from 0.
    pub const fn of(counts: f64) -> Self {
        Self {
            counts,
            from_first: false,
            zero: 0.0,
        }
    }

    /// A unit of so many counts; a wrong scale counts from the first output in the window.
    pub const fn from_first(counts: f64) -> Self {
        Self {
            from_first: true,
            ..Self::of(counts)
        }
    }
}

/// One fault with what it has to remember.
#[derive(Clone, Debug)]
struct Active<R> {
    kind: FaultKind,
    magnitude: f64,
    window: (u64, u64),
    random: Random,
    /// What came last before the window, or first within.
    held: Option<R>,
    first: Option<Vec<f64>>,
    next_spike: u64,
    sign: f64,
}

impl<R: Raw> Active<R> {
    fn apply(&mut self, time: u64, output: R, units: &[Unit]) -> Option<R> {
        if time < self.window.0 {
            self.held = Some(output);
            return Some(output);
        }
        if time >= self.window.1 {
            return Some(output);
        }
        match self.kind {
            FaultKind::Dropout => None,
            FaultKind::Freeze => Some(self.held.get_or_insert(output).frozen(output)),
            _ => Some(self.change(time, output, units)),
        }
    }

    fn change(&mut self, time: u64, output: R, units: &[Unit]) -> R {
        let mut values = output.values();
        let spike = self.kind == FaultKind::Spike && time >= self.next_spike;
        let first = self.first.get_or_insert_with(|| values.clone());
        for ((value, unit), first) in values.iter_mut().zip(units).zip(first) {
            match self.kind {
                FaultKind::BiasStep => *value += self.magnitude * unit.counts,
                FaultKind::Noise => *value += self.magnitude * unit.counts * self.random.gaussian(),
                FaultKind::Spike if spike => *value += self.sign * self.magnitude * unit.counts,
                FaultKind::WrongScale => {
                    let zero = if unit.from_first { *first } else { unit.zero };
                    *value = zero + (*value - zero) * self.magnitude;
                }
                FaultKind::Spike | FaultKind::Dropout | FaultKind::Freeze => {}
            }
        }
        if spike {
            self.sign = -self.sign;
            self.next_spike = time.saturating_add(SPIKE_US);
        }
        output.with(&values)
    }
}

/// The faults of one sensor.
#[derive(Clone, Debug)]
pub struct Injector<R> {
    units: Vec<Unit>,
    faults: Vec<Active<R>>,
}

impl<R: Raw> Injector<R> {
    /// Those of `faults` that are `sensor`'s, with one unit for each of its numbers.
    pub fn new(sensor: FaultSensor, units: Vec<Unit>, faults: &[SensorFault], seed: u64) -> Self {
        let active = |(index, fault): (usize, &SensorFault)| Active {
            kind: fault.kind,
            magnitude: fault.magnitude,
            window: fault.window(),
            random: Random::new(seed, stream::FAULT + index as u64),
            held: None,
            first: None,
            next_spike: 0,
            sign: 1.0,
        };
        let own = faults.iter().enumerate().filter(|(_, f)| f.sensor == sensor);
        Self {
            units,
            faults: own.map(active).collect(),
        }
    }

    /// What comes out at `time` µs instead of `output`.
    pub fn apply(&mut self, time: u64, output: R) -> Option<R> {
        let mut result = Some(output);
        for fault in &mut self.faults {
            result = result.and_then(|output| fault.apply(time, output, &self.units));
        }
        result
    }
}
