//! What an ICM-42688-P measures: specific force and angular rate with a real part's errors.
//!
//! In the order of the part: vibration and white noise come in with the motion, the part's
//! filter takes them together, then misalignment, scale and bias, rounding and clipping. The part
//! is sampled once a step of the world, since the truth's forces and rates are means over a step.
//!
//! The filter is the anti-alias filter that the driver sets, taken as a Butterworth of second
//! order; it delays the motion too (0.9 ms at 258 Hz). Vibration is a tone per rotor at its
//! rotation frequency; imbalance makes its amplitude grow with the square of the speed.

use windhover_math::Vector3;

use super::icm42688p::Measurement;
use super::mounting::Mounting;
use super::noise::{LowPass, gaussian3};
use super::{count_i16, stream};
use crate::GRAVITY;
use crate::imu::{ACCEL_SCALE, GYRO_SCALE};
use crate::random::Random;
use crate::truth::Truth;

/// Thermometer counts per kelvin (DS-000347: TEMP_DATA).
pub const TEMPERATURE_SCALE: f64 = 132.48;

/// Temperature in °C at which the thermometer reads 0 (DS-000347: TEMP_DATA), and at which
/// the part was calibrated.
pub const TEMPERATURE_ZERO: f64 = 25.0;

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// Errors of three axes. Units are those of the quantity, m/s² or rad/s, called u here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriadErrors {
    /// Bias that calibration left, in u: standard deviation per axis.
    pub bias: f64,
    /// Random walk of the bias, in u/√s.
    pub walk: f64,
    /// Relative error of the scale: standard deviation per axis.
    pub scale: f64,
    /// Rotation of the sensing axes, in rad: standard deviation about each axis.
    pub misalignment: f64,
    /// Bias per temperature, in u/K: standard deviation per axis.
    pub per_kelvin: f64,
    /// White noise before the filter, in u/√Hz, one-sided, for each of the part's axes.
    pub density: [f64; 3],
    /// Vibration before the filter, in u RMS per axis, all four rotors together at
    /// [`InertialErrors::vibration_speed`].
    pub vibration: f64,
    /// 3 dB frequency of the part's filter in Hz; `None` for no filter.
    pub bandwidth: Option<f64>,
}

impl TriadErrors {
    /// No errors.
    pub const IDEAL: Self = Self {
        bias: 0.0,
        walk: 0.0,
        scale: 0.0,
        misalignment: 0.0,
        per_kelvin: 0.0,
        density: [0.0; 3],
        vibration: 0.0,
        bandwidth: None,
    };
}

/// How the part's temperature moves: from `start` to `start + rise`, as e^(−t/τ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warming {
    /// At power-on, in °C.
    pub start: f64,
    /// How much warmer it gets, in K.
    pub rise: f64,
    /// Time constant in s.
    pub tau: f64,
}

/// Errors of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertialErrors {
    /// Of the accelerometer, in m/s².
    pub accel: TriadErrors,
    /// Of the gyroscope, in rad/s.
    pub gyro: TriadErrors,
    /// The part's temperature.
    pub warming: Warming,
    /// Rotor speed in rad/s at which vibration has the amplitude given: that of hovering.
    pub vibration_speed: f64,
    /// How the part sits.
    pub mounting: Mounting,
}

impl InertialErrors {
    /// No errors: [`Inertial::sample`] equals [`ideal_counts`](crate::ideal_counts).
    pub const fn ideal() -> Self {
        Self {
            accel: TriadErrors::IDEAL,
            gyro: TriadErrors::IDEAL,
            warming: Warming {
                start: TEMPERATURE_ZERO,
                rise: 0.0,
                tau: 1.0,
            },
            vibration_speed: 557.0,
            mounting: Mounting([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        }
    }

    /// The reference conditions at a rate of samples in Hz, with the filters that the driver sets
    /// at that rate. Bias, walk, accelerometer scale and misalignment, and vibration: design §5.
    /// Density and bias per kelvin: DS-000347, tables 1 and 2. Ours: the gyroscope's vibration,
    /// 1 % of the accelerometer's in SI units; warming by 10 K in flight; the mean hover speed of
    /// vehicle x450.
    pub fn reference(rate: f64) -> Self {
        let micro_g = 1e-6 * GRAVITY;
        Self {
            accel: TriadErrors {
                bias: 5e-3 * GRAVITY,
                walk: 2e-4,
                scale: 3e-3,
                misalignment: 0.3 * DEGREE,
                per_kelvin: 0.15e-3 * GRAVITY,
                density: [65.0 * micro_g, 65.0 * micro_g, 70.0 * micro_g],
                vibration: 3.0,
                bandwidth: Some(258.0),
            },
            gyro: TriadErrors {
                bias: 0.1 * DEGREE,
                walk: 2e-5,
                scale: 0.0,
                misalignment: 0.0,
                per_kelvin: 0.005 * DEGREE,
                density: [0.0028 * DEGREE; 3],
                vibration: 0.03,
                bandwidth: Some(if rate < 1500.0 { 258.0 } else { 997.0 }),
            },
            warming: Warming {
                start: TEMPERATURE_ZERO,
                rise: 10.0,
                tau: 300.0,
            },
            ..Self::ideal()
        }
    }
}

impl Default for InertialErrors {
    /// The reference conditions at 1 kHz.
    fn default() -> Self {
        Self::reference(1000.0)
    }
}

/// Sine and cosine of a rotor's angle, times its share of the amplitude.
type Tones = [(f64, f64); 4];

/// Three axes of one quantity.
#[derive(Clone, Debug)]
struct Triad {
    random: Random,
    bias: Vector3<f64>,
    walk: f64,
    scale: Vector3<f64>,
    misalignment: Vector3<f64>,
    per_kelvin: Vector3<f64>,
    noise: Vector3<f64>,
    /// For every axis and rotor: what its sine and cosine count for.
    vibration: [[(f64, f64); 4]; 3],
    filters: Option<[LowPass; 3]>,
}

impl Triad {
    fn new(errors: &TriadErrors, rate: f64, mut random: Random) -> Self {
        let bias = gaussian3(&mut random, errors.bias);
        let scale = gaussian3(&mut random, errors.scale).add_scalar(1.0);
        let misalignment = gaussian3(&mut random, errors.misalignment);
        let per_kelvin = gaussian3(&mut random, errors.per_kelvin);
        // Four tones that add up to the RMS: each has its half, times √2 for the peak.
        let peak = errors.vibration * core::f64::consts::FRAC_1_SQRT_2;
        let vibration = [(); 3].map(|()| {
            [(); 4].map(|()| {
                let (s, c) = libm::sincos(core::f64::consts::TAU * random.uniform());
                (peak * c, peak * s)
            })
        });
        Self {
            bias,
            walk: errors.walk / rate.sqrt(),
            scale,
            misalignment,
            per_kelvin,
            // One-sided density over the band up to half the rate.
            noise: Vector3::from(errors.density) * (0.5 * rate).sqrt(),
            vibration,
            filters: errors
                .bandwidth
                .map(|hz| [(); 3].map(|()| LowPass::new(hz, rate))),
            random,
        }
    }

    /// What the axes read for `value`, `warmth` K above calibration.
    fn measure(&mut self, value: Vector3<f64>, tones: &Tones, warmth: f64) -> Vector3<f64> {
        let shake = self.vibration.map(|axis| {
            let tone = |i: usize| axis[i].0 * tones[i].0 + axis[i].1 * tones[i].1;
            (tone(0) + tone(1)) + (tone(2) + tone(3))
        });
        let noise = gaussian3(&mut self.random, 1.0).component_mul(&self.noise);
        let mut seen = value + Vector3::from(shake) + noise;
        if let Some(filters) = &mut self.filters {
            for (axis, filter) in seen.iter_mut().zip(filters) {
                *axis = filter.next(*axis);
            }
        }
        let turned = seen - self.misalignment.cross(&seen);
        let read = turned.component_mul(&self.scale) + self.bias + self.per_kelvin * warmth;
        self.bias += gaussian3(&mut self.random, self.walk);
        read
    }
}

/// The measuring side of one part.
#[derive(Clone, Debug)]
pub struct Inertial {
    accel: Triad,
    gyro: Triad,
    mounting: Mounting,
    period: f64,
    temperature: f64,
    /// Where the temperature goes, and by which share of the way in a sample.
    warm: f64,
    warming: f64,
    inverse_speed: f64,
    rotor_angle: [f64; 4],
}

impl Inertial {
    /// The part that `seed` draws, sampled `rate` times a second.
    pub fn new(errors: &InertialErrors, rate: f64, seed: u64) -> Self {
        let warming = &errors.warming;
        Self {
            accel: Triad::new(&errors.accel, rate, Random::new(seed, stream::ACCEL)),
            gyro: Triad::new(&errors.gyro, rate, Random::new(seed, stream::GYRO)),
            mounting: errors.mounting,
            period: 1.0 / rate,
            temperature: warming.start,
            warm: warming.start + warming.rise,
            warming: 1.0 - libm::exp(-1.0 / (rate * warming.tau)),
            inverse_speed: 1.0 / errors.vibration_speed,
            rotor_angle: [0.0; 4],
        }
    }

    /// Takes a sample: call it once a period, after the world's step.
    pub fn sample(&mut self, truth: &Truth) -> Measurement {
        let tones = self.turn_rotors(&truth.rotor_speed);
        let warmth = self.temperature - TEMPERATURE_ZERO;
        let force = self.mounting.to_part(truth.specific_force);
        let rate = self.mounting.to_part(truth.mean_rate);
        let force = self.accel.measure(force, &tones, warmth) * ACCEL_SCALE;
        let rate = self.gyro.measure(rate, &tones, warmth) * GYRO_SCALE;
        self.temperature += (self.warm - self.temperature) * self.warming;
        Measurement {
            accel: [force.x, force.y, force.z].map(count_i16),
            gyro: [rate.x, rate.y, rate.z].map(count_i16),
            temperature: count_i16(warmth * TEMPERATURE_SCALE),
        }
    }

    /// The part's temperature in °C.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    fn turn_rotors(&mut self, speed: &[f64; 4]) -> Tones {
        core::array::from_fn(|i| {
            let turns = (self.rotor_angle[i] + speed[i] * self.period) * core::f64::consts::FRAC_1_PI * 0.5;
            self.rotor_angle[i] = (turns - libm::floor(turns)) * core::f64::consts::TAU;
            let (s, c) = libm::sincos(self.rotor_angle[i]);
            let relative = speed[i] * self.inverse_speed;
            (s * relative * relative, c * relative * relative)
        })
    }
}
