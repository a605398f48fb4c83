//! What a barometer SPL06-001 reads: the air's pressure with a real part's errors.
//!
//! The air is the standard atmosphere (ISO 2533). Around the vehicle it moves: the pressure at
//! the part is the atmosphere's plus a coefficient times the dynamic pressure ½ρv² of the
//! airspeed. The coefficient is positive where the air is dammed up, so that the part reads too
//! low a height, and negative where it is sucked off.

use windhover_math::Vector3;

use super::spl06::Formula;
use super::stream;
use crate::GRAVITY;
use crate::random::Random;
use crate::truth::Truth;

/// Specific gas constant of dry air in J/(kg·K) (ISO 2533).
const GAS: f64 = 287.052_87;

/// Fall of the temperature with height in K/m (ISO 2533).
const LAPSE: f64 = 0.0065;

/// Temperature and pressure at mean sea level in K and Pa (ISO 2533).
const SEA_LEVEL: (f64, f64) = (288.15, 101_325.0);

/// 0 °C in K.
const ICE: f64 = 273.15;

/// Temperature in K, pressure in Pa and density in kg/m³ of the standard atmosphere at a height in
/// m above mean sea level, up to 11 km.
pub fn atmosphere(height: f64) -> (f64, f64, f64) {
    let temperature = SEA_LEVEL.0 - LAPSE * height;
    let pressure = SEA_LEVEL.1 * libm::pow(temperature / SEA_LEVEL.0, GRAVITY / (GAS * LAPSE));
    (temperature, pressure, pressure / (GAS * temperature))
}

/// Errors of the barometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarometerErrors {
    /// White noise of a result, in m of height: standard deviation.
    pub noise: f64,
    /// Drift by weather and part, in m of height: a random walk with this standard deviation after
    /// an hour.
    pub drift_per_hour: f64,
    /// Pressure at the part over dynamic pressure; the sign is said above.
    pub pressure_coefficient: f64,
    /// How much warmer than the air the part is, in K.
    pub warmth: f64,
}

impl BarometerErrors {
    /// No errors.
    pub const fn ideal() -> Self {
        Self {
            noise: 0.0,
            drift_per_hour: 0.0,
            pressure_coefficient: 0.0,
            warmth: 0.0,
        }
    }
}

impl Default for BarometerErrors {
    /// The reference conditions of design §5. That the drift is a random walk is our reading, and
    /// the part's warmth on a board is ours.
    fn default() -> Self {
        Self {
            noise: 0.1,
            drift_per_hour: 0.3,
            pressure_coefficient: 0.10,
            warmth: 15.0,
        }
    }
}

/// A result as the part's registers hold it: 24 bits each, with their sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BarometerCounts {
    /// PSR_B2 to PSR_B0.
    pub pressure: i32,
    /// TMP_B2 to TMP_B0.
    pub temperature: i32,
}

/// One barometer.
#[derive(Clone, Debug)]
pub struct Barometer {
    errors: BarometerErrors,
    formula: Formula,
    /// Height of the truth's origin above mean sea level, in m.
    home: f64,
    random: Random,
    drift: f64,
    drift_step: f64,
}

impl Barometer {
    /// The part that `seed` draws, measuring every `period_us` µs, for a truth whose origin is
    /// `home` m above mean sea level.
    pub fn new(errors: &BarometerErrors, formula: Formula, home: f64, period_us: u64, seed: u64) -> Self {
        let hours = period_us as f64 * 1e-6 / 3600.0;
        Self {
            errors: *errors,
            formula,
            home,
            random: Random::new(seed, stream::BAROMETER),
            drift: 0.0,
            drift_step: errors.drift_per_hour * hours.sqrt(),
        }
    }

    /// What a driver has to know of the part.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// Counts of pressure for a metre of height more, at the origin.
    pub fn counts_per_metre(&self) -> f64 {
        let (temperature, pressure, density) = atmosphere(self.home);
        let temperature = self
            .formula
            .raw_temperature(temperature - ICE + self.errors.warmth);
        let raw = self.formula.raw_pressure(pressure, temperature);
        -density * GRAVITY / self.formula.pascal_per_count(raw, temperature)
    }

    /// Measures: once a period.
    pub fn measure(&mut self, truth: &Truth) -> BarometerCounts {
        let noise = self.random.gaussian() * self.errors.noise;
        let (temperature, pressure, density) = atmosphere(self.home - truth.position.z);
        let airspeed: Vector3<f64> = truth.velocity - truth.wind;
        let dynamic = 0.5 * density * airspeed.dot(&airspeed);
        // A metre of height is ρg of pressure less.
        let error = -(noise + self.drift) * density * GRAVITY;
        self.drift += self.random.gaussian() * self.drift_step;
        let temperature = self
            .formula
            .raw_temperature(temperature - ICE + self.errors.warmth);
        let pressure = pressure + self.errors.pressure_coefficient * dynamic + error;
        BarometerCounts {
            pressure: self.formula.raw_pressure(pressure, temperature),
            temperature,
        }
    }
}
