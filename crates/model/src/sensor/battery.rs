//! What the battery's two ADC channels read: voltage under load and current.
//!
//! The battery is an open-circuit voltage by its charge behind a resistance. The load draws a
//! power, so that the current follows from V·I = P with V = V₀ − R·I. Charge is counted from the
//! truth's energy, so that it does not depend on how often the ADC is read.

use super::{count, stream};
use crate::random::Random;
use crate::truth::Truth;

/// Volts of a lithium-polymer cell at rest at a charge of 0, 5, …, 100 %: the table that chargers'
/// and model makers' handbooks share, to some 20 mV.
const CELL: [f64; 21] = [
    3.27, 3.61, 3.69, 3.71, 3.73, 3.75, 3.77, 3.79, 3.80, 3.82, 3.84, 3.85, 3.87, 3.91, 3.95, 3.98, 4.02,
    4.08, 4.11, 4.15, 4.20,
];

/// The ADC: 12 bits of 3.3 V (STM32F405 reference manual RM0090).
const ADC: (i32, f64) = (4095, 3.3);

/// Counts of the ADC for a volt at its pin.
const ADC_SCALE: f64 = ADC.0 as f64 / ADC.1;

/// Volts of the battery for a volt at the pin: the SpeedyBee F405 V4's divider.
pub const VOLTAGE_DIVIDER: f64 = 11.0;

/// Amperes for a volt at the pin: the SpeedyBee F405 V4's current sensor.
pub const CURRENT_SENSOR: f64 = 25.0;

/// ADC counts per volt of the battery.
pub const VOLTAGE_SCALE: f64 = ADC_SCALE / VOLTAGE_DIVIDER;

/// ADC counts per ampere.
pub const CURRENT_SCALE: f64 = ADC_SCALE / CURRENT_SENSOR;

/// The battery, and what draws from it besides the rotors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pack {
    /// Cells in series.
    pub cells: u8,
    /// Charge when full, in A·h.
    pub capacity: f64,
    /// Resistance of cells and leads together, in Ω.
    pub resistance: f64,
    /// Charge at the start, 0 to 1.
    pub charge: f64,
    /// Power of everything but the rotors, in W.
    pub avionics: f64,
}

impl Default for Pack {
    /// Four cells of 5 A·h with 5 mΩ each, full; 5 W for the board, receiver and radio. Ours.
    fn default() -> Self {
        Self {
            cells: 4,
            capacity: 5.0,
            resistance: 0.020,
            charge: 1.0,
            avionics: 5.0,
        }
    }
}

impl Pack {
    /// Open-circuit voltage in V at a charge of 0 to 1.
    pub fn open_circuit(&self, charge: f64) -> f64 {
        let place = charge.clamp(0.0, 1.0) * (CELL.len() - 1) as f64;
        let below = Ord::min(place as usize, CELL.len() - 2);
        let share = place - below as f64;
        f64::from(self.cells) * (CELL[below] + share * (CELL[below + 1] - CELL[below]))
    }

    /// Voltage in V and current in A while `power` W are drawn at a charge of 0 to 1. More power
    /// than the battery has gives what it has: half its voltage.
    pub fn under_load(&self, charge: f64, power: f64) -> (f64, f64) {
        let open = self.open_circuit(charge);
        let root = windhover_math::max(open * open - 4.0 * self.resistance * power, 0.0).sqrt();
        let voltage = 0.5 * (open + root);
        // From the power, since a battery without resistance has no drop to divide by it.
        let most = open / (2.0 * self.resistance);
        (voltage, windhover_math::min(power / voltage, most))
    }
}

/// Errors of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatteryErrors {
    /// Relative error of the divider: standard deviation.
    pub voltage_scale: f64,
    /// Relative error of the current sensor: standard deviation.
    pub current_scale: f64,
    /// Offset of the current sensor in A: standard deviation.
    pub current_offset: f64,
    /// Noise of the ADC in counts: standard deviation.
    pub noise: f64,
}

impl BatteryErrors {
    /// No errors.
    pub const fn ideal() -> Self {
        Self {
            voltage_scale: 0.0,
            current_scale: 0.0,
            current_offset: 0.0,
            noise: 0.0,
        }
    }
}

impl Default for BatteryErrors {
    /// A divider of 1 % resistors, a current sensor to 3 % and 0.2 A, and the ADC's typical total
    /// error of 2 counts (STM32F405 data sheet, ADC accuracy). The first three are ours.
    fn default() -> Self {
        Self {
            voltage_scale: 0.01,
            current_scale: 0.03,
            current_offset: 0.2,
            noise: 2.0,
        }
    }
}

/// Counts of the two ADC channels, 0 to 4095.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BatteryCounts {
    /// Behind the divider.
    pub voltage: u16,
    /// Of the current sensor.
    pub current: u16,
}

/// One battery and its sensors.
#[derive(Clone, Debug)]
pub struct Battery {
    pack: Pack,
    noise: f64,
    voltage_scale: f64,
    current_scale: f64,
    current_offset: f64,
    random: Random,
    charge: f64,
    voltage: f64,
    /// Energy and time in s of the last measurement.
    before: Option<(f64, f64)>,
}

impl Battery {
    /// The sensors that `seed` draws at a battery.
    pub fn new(pack: &Pack, errors: &BatteryErrors, seed: u64) -> Self {
        let mut random = Random::new(seed, stream::BATTERY);
        let voltage_scale = 1.0 + errors.voltage_scale * random.gaussian();
        let current_scale = 1.0 + errors.current_scale * random.gaussian();
        let current_offset = errors.current_offset * random.gaussian();
        Self {
            pack: *pack,
            noise: errors.noise,
            voltage_scale: voltage_scale * VOLTAGE_SCALE,
            current_scale: current_scale * CURRENT_SCALE,
            current_offset,
            random,
            charge: pack.charge,
            voltage: pack.open_circuit(pack.charge),
            before: None,
        }
    }

    /// Charge that is left, 0 to 1.
    pub fn charge(&self) -> f64 {
        self.charge
    }

    /// Measures at `time` µs, and takes off the charge drawn since the last time.
    pub fn measure(&mut self, truth: &Truth, time: u64) -> BatteryCounts {
        let seconds = time as f64 * 1e-6;
        let (energy, since) = self.before.unwrap_or((truth.energy, seconds));
        self.before = Some((truth.energy, seconds));
        let drawn = truth.energy - energy + self.pack.avionics * (seconds - since);
        let full = self.pack.capacity * 3600.0;
        self.charge = (self.charge - drawn / self.voltage / full).clamp(0.0, 1.0);
        let (voltage, current) = self
            .pack
            .under_load(self.charge, truth.power + self.pack.avionics);
        self.voltage = voltage;
        let mut read = |counts: f64| count(counts + self.noise * self.random.gaussian(), 0, ADC.0) as u16;
        BatteryCounts {
            voltage: read(voltage * self.voltage_scale),
            current: read((current + self.current_offset) * self.current_scale),
        }
    }
}
