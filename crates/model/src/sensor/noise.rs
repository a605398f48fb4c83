//! What sensors have in common: random walks, correlated noise, a low-pass filter.

use windhover_math::Vector3;

use crate::random::Random;

/// Three independent Gaussian numbers with the standard deviation `deviation`.
pub fn gaussian3(random: &mut Random, deviation: f64) -> Vector3<f64> {
    let x = random.gaussian();
    let y = random.gaussian();
    let z = random.gaussian();
    Vector3::new(x, y, z) * deviation
}

/// A direction, uniform on the sphere: height and azimuth are uniform (Archimedes).
pub fn direction(random: &mut Random) -> Vector3<f64> {
    let z = 2.0 * random.uniform() - 1.0;
    let (s, c) = libm::sincos(core::f64::consts::TAU * random.uniform());
    let radius = (1.0 - z * z).sqrt();
    Vector3::new(radius * c, radius * s, z)
}

/// First-order Gauss–Markov noise: its autocovariance is σ² e^(−t/τ). It starts at its full
/// variance.
#[derive(Clone, Debug)]
pub struct GaussMarkov {
    value: Vector3<f64>,
    deviation: Vector3<f64>,
    decay: f64,
    kick: f64,
}

impl GaussMarkov {
    /// Noise of the standard deviations `deviation` on three axes and the time constant `tau` in
    /// s, in steps of `period` s.
    pub fn new(deviation: Vector3<f64>, tau: f64, period: f64, random: &mut Random) -> Self {
        let decay = libm::exp(-period / tau);
        Self {
            value: gaussian3(random, 1.0).component_mul(&deviation),
            deviation,
            decay,
            kick: (1.0 - decay * decay).sqrt(),
        }
    }

    /// The value of now; moves on by a step.
    pub fn next(&mut self, random: &mut Random) -> Vector3<f64> {
        let now = self.value;
        self.value = now * self.decay + gaussian3(random, self.kick).component_mul(&self.deviation);
        now
    }
}

/// A Butterworth low-pass of second order: the bilinear transform, with the 3 dB frequency kept.
#[derive(Clone, Debug)]
pub struct LowPass {
    b: f64,
    a1: f64,
    a2: f64,
    memory: Option<[f64; 2]>,
}

impl LowPass {
    /// The most of the sampling rate that the 3 dB frequency may be.
    pub const HIGHEST: f64 = 0.49;

    /// A filter with 3 dB at `hz` for samples at `rate` Hz; a frequency too high for the rate is
    /// brought down to [`Self::HIGHEST`] of it.
    pub fn new(hz: f64, rate: f64) -> Self {
        let k = libm::tan(core::f64::consts::PI * windhover_math::min(hz / rate, Self::HIGHEST));
        let (root, square) = (core::f64::consts::SQRT_2 * k, k * k);
        let norm = 1.0 / (1.0 + root + square);
        Self {
            b: square * norm,
            a1: 2.0 * (square - 1.0) * norm,
            a2: (1.0 - root + square) * norm,
            memory: None,
        }
    }

    /// One sample; at the first the filter has settled on it.
    pub fn next(&mut self, x: f64) -> f64 {
        let [first, second] = self.memory.unwrap_or_else(|| {
            let second = (self.b - self.a2) * x;
            [(2.0 * self.b - self.a1) * x + second, second]
        });
        let y = self.b * x + first;
        self.memory = Some([2.0 * self.b * x - self.a1 * y + second, self.b * x - self.a2 * y]);
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_markov_has_its_variance_and_its_time_constant() {
        let (mut variance, mut later) = (0.0, 0.0);
        let n = 20_000;
        for seed in 0..n {
            let mut random = Random::new(seed, 1);
            let mut noise = GaussMarkov::new(Vector3::new(2.0, 0.0, 1.0), 100.0, 1.0, &mut random);
            let start = noise.next(&mut random);
            let end = (0..100)
                .map(|_| noise.next(&mut random))
                .last()
                .expect("a hundred");
            assert_eq!(start.y, 0.0);
            variance += end.x * end.x / n as f64;
            later += start.x * end.x / n as f64;
        }
        // Standard error of a variance: √(2/n) = 1 %.
        assert!((variance / 4.0 - 1.0).abs() < 0.04, "{variance}");
        assert!((later / 4.0 - libm::exp(-1.0)).abs() < 0.04, "{later}");
    }

    /// Gain at a frequency, from a sine.
    fn gain(filter: &LowPass, hz: f64, rate: f64) -> f64 {
        let mut filter = filter.clone();
        let (mut inphase, mut quadrature) = (0.0, 0.0);
        let n = 20_000;
        for i in 0..2 * n {
            let (s, c) = libm::sincos(core::f64::consts::TAU * hz * f64::from(i) / rate);
            let y = filter.next(s);
            if i >= n {
                inphase += 2.0 * y * s / f64::from(n);
                quadrature += 2.0 * y * c / f64::from(n);
            }
        }
        libm::hypot(inphase, quadrature)
    }

    #[test]
    fn the_low_pass_is_a_butterworth() {
        for (hz, rate) in [(258.0, 1000.0), (997.0, 4000.0), (258.0, 4000.0)] {
            let filter = LowPass::new(hz, rate);
            let root = core::f64::consts::FRAC_1_SQRT_2;
            assert!((gain(&filter, hz, rate) - root).abs() < 1e-3);
            assert!((gain(&filter, 10.0, rate) - 1.0).abs() < 1e-3);
            // Near the folding frequency the bilinear transform falls faster than 12 dB an octave.
            assert!(gain(&filter, 1.8 * hz, rate) < 0.31);
        }
    }

    #[test]
    fn the_low_pass_begins_settled() {
        let mut filter = LowPass::new(258.0, 1000.0);
        for _ in 0..10 {
            assert!((filter.next(-9.8) + 9.8).abs() < 1e-12);
        }
        assert!(LowPass::new(1e9, 1000.0).next(1.0).is_finite());
    }

    #[test]
    fn directions_fill_the_sphere() {
        let mut random = Random::new(4, 0);
        let n = 20_000;
        let mut square = Vector3::zeros();
        for _ in 0..n {
            let d = direction(&mut random);
            square += d.component_mul(&d) / f64::from(n);
        }
        assert!(square.iter().all(|s| (s - 1.0 / 3.0).abs() < 0.01), "{square}");
    }
}
