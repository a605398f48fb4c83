//! Wind: a mean and Dryden gusts.
//!
//! The gusts follow MIL-F-8785C at low altitude: length scales by height, forming filters of
//! first order along the mean wind and of second order across it and down. The standard's
//! intensities depend on the wind; here the user gives one standard deviation for all three.
//! The filters run at 250 Hz whatever the model's step, so that the same seed gives the same
//! gusts to any integrator; between updates the value is held.

use windhover_math::Vector3;

use crate::length::Length;
use crate::random::Random;

/// Time between updates in ns.
const PERIOD_NS: u64 = 4_000_000;
const PERIOD: f64 = 0.004;

/// Updates between new filter coefficients: height and airspeed change slowly.
const COEFFICIENT_UPDATES: u32 = 25;

/// The least airspeed in m/s at which the gusts' field is passed through: a vehicle that hovers
/// in calm air meets gusts too, because the field itself changes.
const LEAST_AIRSPEED: f64 = 3.0;

const METRES_PER_FOOT: f64 = 0.3048;

/// The wind's velocity in NED, in m/s, from its speed and the direction it comes *from*, in
/// degrees clockwise from north, as in a weather report.
///
/// ```
/// let wind = windhover_model::mean_wind_from(4.47, 206.6);
/// assert!((wind.x - 4.0).abs() < 0.01 && (wind.y - 2.0).abs() < 0.01);
/// ```
pub fn mean_wind_from(speed: f64, from_degrees: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(from_degrees.to_radians());
    Vector3::new(-speed * cos, -speed * sin, 0.0)
}

/// Length scales of the gusts in m at a height in m: horizontal and vertical, MIL-F-8785C
/// between 10 and 1000 feet, and held beyond.
pub fn length_scales(height: f64) -> (f64, f64) {
    let feet = (height / METRES_PER_FOOT).clamp(10.0, 1000.0);
    let horizontal = feet / libm::pow(0.177 + 0.000_823 * feet, 1.2);
    (horizontal * METRES_PER_FOOT, feet * METRES_PER_FOOT)
}

/// σ √(2L/V) / (1 + (L/V) s) for the gusts along the mean wind; variance 1.
#[derive(Clone, Debug, Default)]
struct FirstOrder {
    value: f64,
    decay: f64,
    noise: f64,
}

impl FirstOrder {
    /// Coefficients for a time constant L/V in s, exact for white noise.
    fn tune(&mut self, time: f64) {
        self.decay = libm::exp(-PERIOD / time);
        self.noise = (1.0 - self.decay * self.decay).sqrt();
    }

    #[inline]
    fn update(&mut self, random: &mut Random) -> f64 {
        self.value = self.value * self.decay + random.gaussian() * self.noise;
        self.value
    }
}

/// σ √(L/V) (1 + √3 (L/V) s) / (1 + (L/V) s)² for the gusts across; variance 1.
///
/// Two lags in a row, x₁' = (n − x₁)/T and x₂' = (x₁ − x₂)/T with n such that x₁ has variance 1;
/// then x₂ has variance ½ and so has their covariance, at any T. The output
/// (√3 x₁ + (1 − √3) x₂)/√2 has the transfer function above and variance 1.
#[derive(Clone, Debug, Default)]
struct SecondOrder {
    x1: f64,
    x2: f64,
    decay: f64,
    carry: f64,
    noise: [f64; 3],
}

impl SecondOrder {
    /// Coefficients for T = L/V in s. With Φ = e^(−a)·[1 0; a 1], a = dt/T, the noise must
    /// have the covariance P − Φ P Φᵀ for the stationary P = [1 ½; ½ ½]; its Cholesky factor
    /// is kept.
    fn tune(&mut self, time: f64) {
        let a = PERIOD / time;
        let decay = libm::exp(-a);
        let d2 = decay * decay;
        let q11 = 1.0 - d2;
        let q12 = 0.5 - d2 * (a + 0.5);
        let q22 = 0.5 - d2 * (a * a + a + 0.5);
        let l11 = q11.sqrt();
        let l21 = q12 / l11;
        let l22 = windhover_math::max(q22 - l21 * l21, 0.0).sqrt();
        self.decay = decay;
        self.carry = decay * a;
        self.noise = [l11, l21, l22];
    }

    /// Starts from the stationary distribution.
    fn settle(&mut self, random: &mut Random) {
        self.x1 = random.gaussian();
        self.x2 = 0.5 * (self.x1 + random.gaussian());
    }

    #[inline]
    fn update(&mut self, random: &mut Random) -> f64 {
        let (n1, n2) = (random.gaussian(), random.gaussian());
        let [l11, l21, l22] = self.noise;
        self.x2 = self.decay * self.x2 + self.carry * self.x1 + (l21 * n1 + l22 * n2);
        self.x1 = self.decay * self.x1 + l11 * n1;
        let root3 = 1.732_050_807_568_877_2;
        (root3 * self.x1 + (1.0 - root3) * self.x2) * core::f64::consts::FRAC_1_SQRT_2
    }
}

/// The wind at the vehicle.
#[derive(Clone, Debug)]
pub struct Wind {
    mean: Vector3<f64>,
    /// Horizontal direction of the mean wind: its north and east part.
    along: [f64; 2],
    deviation: f64,
    random: Random,
    u: FirstOrder,
    v: SecondOrder,
    w: SecondOrder,
    updates: u32,
    next_ns: u64,
    velocity: Vector3<f64>,
}

impl Wind {
    /// A wind of velocity `mean` in NED, with gusts of the standard deviation `deviation` in m/s
    /// along the mean wind, across it and down. Without mean wind, "along" is north.
    pub fn new(mean: Vector3<f64>, deviation: f64, random: Random) -> Self {
        let speed = libm::hypot(mean.x, mean.y);
        let along = if speed > 0.0 {
            [mean.x / speed, mean.y / speed]
        } else {
            [1.0, 0.0]
        };
        let mut wind = Self {
            mean,
            along,
            deviation,
            random,
            u: FirstOrder::default(),
            v: SecondOrder::default(),
            w: SecondOrder::default(),
            updates: 0,
            next_ns: 0,
            velocity: mean,
        };
        wind.u.value = wind.random.gaussian();
        wind.v.settle(&mut wind.random);
        wind.w.settle(&mut wind.random);
        wind
    }

    /// Velocity of the air in NED, in m/s, since the last update.
    #[inline(always)]
    pub fn velocity(&self) -> Vector3<f64> {
        self.velocity
    }

    /// Makes the updates due until `time_ns`, for a vehicle at `height` m above ground with the
    /// velocity `vehicle` in NED.
    #[inline(always)]
    pub fn advance(&mut self, time_ns: u64, height: f64, vehicle: Vector3<f64>) {
        while self.deviation > 0.0 && self.next_ns <= time_ns {
            self.next_ns += PERIOD_NS;
            self.update(height, vehicle);
        }
    }

    fn update(&mut self, height: f64, vehicle: Vector3<f64>) {
        if self.updates == 0 {
            let airspeed = (vehicle - self.mean).length();
            let airspeed = windhover_math::max(airspeed, LEAST_AIRSPEED);
            let (horizontal, vertical) = length_scales(height);
            self.u.tune(horizontal / airspeed);
            self.v.tune(horizontal / airspeed);
            self.w.tune(vertical / airspeed);
            self.updates = COEFFICIENT_UPDATES;
        }
        self.updates -= 1;
        let u = self.deviation * self.u.update(&mut self.random);
        let v = self.deviation * self.v.update(&mut self.random);
        let w = self.deviation * self.w.update(&mut self.random);
        let [n, e] = self.along;
        self.velocity = self.mean + Vector3::new(u * n - v * e, u * e + v * n, w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wind_comes_from_where_it_is_said_to() {
        let east = mean_wind_from(3.0, 270.0);
        assert!((east - Vector3::new(0.0, 3.0, 0.0)).length() < 1e-12);
        let north = mean_wind_from(1.0, 180.0);
        assert!((north - Vector3::new(1.0, 0.0, 0.0)).length() < 1e-12);
    }

    #[test]
    fn length_scales_are_those_of_the_standard() {
        // At 100 feet: 100/(0.177 + 0.0823)^1.2 = 505.2 feet, and the height itself.
        let (horizontal, vertical) = length_scales(30.48);
        assert!((horizontal - 505.2 * 0.3048).abs() < 0.1, "{horizontal}");
        assert!((vertical - 30.48).abs() < 1e-9);
        // At 1000 feet both are 1000 feet; on the ground those of 10 feet.
        let (horizontal, vertical) = length_scales(304.8);
        assert!((horizontal - vertical).abs() < 1e-9);
        assert_eq!(length_scales(-1.0), length_scales(3.048));
    }

    /// Mean, variance and autocovariance at `lag` updates of a component along a unit vector,
    /// over many seeds, at 5 m in a mean wind of 20 m/s towards the north-east.
    fn statistics(along: Vector3<f64>, lag: usize) -> (f64, f64, f64) {
        let mean_wind = mean_wind_from(20.0, 225.0);
        let (seeds, length) = (300_u32, 20_000_usize);
        let count = f64::from(seeds) * length as f64;
        let (mut mean, mut variance, mut covariance) = (0.0, 0.0, 0.0);
        for seed in 0..seeds {
            let mut wind = Wind::new(mean_wind, 1.5, Random::new(u64::from(seed), 0));
            let mut gusts = Vec::with_capacity(length + lag);
            for n in 0..(length + lag) as u64 {
                wind.advance(n * PERIOD_NS, 5.0, Vector3::zeros());
                gusts.push((wind.velocity() - mean_wind).dot(&along));
            }
            for n in 0..length {
                mean += gusts[n] / count;
                variance += gusts[n] * gusts[n] / count;
                covariance += gusts[n] * gusts[n + lag] / count;
            }
        }
        (mean, variance, covariance / variance)
    }

    #[test]
    fn gusts_have_the_variance_and_the_correlation_of_dryden() {
        let diagonal = core::f64::consts::FRAC_1_SQRT_2;
        let (horizontal, vertical) = length_scales(5.0);
        let axes = [
            (Vector3::new(diagonal, diagonal, 0.0), horizontal, true),
            (Vector3::new(-diagonal, diagonal, 0.0), horizontal, false),
            (Vector3::new(0.0, 0.0, 1.0), vertical, false),
        ];
        for (axis, scale, longitudinal) in axes {
            // After the time L/V: e⁻¹ along, (1 − ½) e⁻¹ across, which are the transforms of
            // the two spectra.
            let lag = (scale / 20.0 / PERIOD) as usize;
            let (mean, variance, correlation) = statistics(axis, lag);
            let wanted = if longitudinal { 1.0 } else { 0.5 } * libm::exp(-1.0);
            assert!(mean.abs() < 0.06, "{axis:?}: mean {mean}");
            assert!(
                (variance / 2.25 - 1.0).abs() < 0.05,
                "{axis:?}: variance {variance}"
            );
            assert!(
                (correlation - wanted).abs() < 0.04,
                "{axis:?}: {correlation} for {wanted}"
            );
        }
    }

    #[test]
    fn gusts_start_with_their_full_variance() {
        let mut sum = Vector3::zeros();
        for seed in 0..20_000 {
            let mut wind = Wind::new(Vector3::zeros(), 1.0, Random::new(seed, 0));
            wind.advance(0, 1.0, Vector3::zeros());
            sum += wind.velocity().component_mul(&wind.velocity()) / 20_000.0;
        }
        assert!((sum - Vector3::repeat(1.0)).abs().max() < 0.04, "{sum}");
    }

    #[test]
    fn gusts_do_not_depend_on_the_steps() {
        let gust = |step_ns: u64| {
            let mut wind = Wind::new(mean_wind_from(5.0, 10.0), 1.0, Random::new(3, 0));
            for n in 0..=(1_000_000_000 / step_ns) {
                wind.advance(n * step_ns, 30.0, Vector3::zeros());
            }
            wind.velocity()
        };
        assert_eq!(gust(1_000_000), gust(250_000));
        assert_eq!(gust(1_000_000), gust(20_000_000));
    }

    #[test]
    fn without_gusts_the_wind_is_its_mean() {
        let mean = mean_wind_from(4.47, 206.6);
        let mut wind = Wind::new(mean, 0.0, Random::new(1, 0));
        wind.advance(1_000_000_000, 30.0, Vector3::zeros());
        assert_eq!(wind.velocity(), mean);
    }
}
