//! Random numbers that are the same everywhere: xoshiro256** seeded by SplitMix64.
//!
//! Blackman and Vigna, "Scrambled linear pseudorandom number generators" (2021).

/// A generator of random numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Random {
    state: [u64; 4],
}

/// SplitMix64: advances `state` and mixes it.
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

impl Random {
    /// The generator of a seed and a stream: streams of one seed do not repeat each other, so
    /// that wind and every sensor have their own.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut mix = seed;
        let mut start = split_mix(&mut mix) ^ stream.wrapping_mul(0xD1B5_4A32_D192_ED03);
        Self {
            state: core::array::from_fn(|_| split_mix(&mut start)),
        }
    }

    /// 64 random bits.
    #[inline(always)]
    pub fn bits(&mut self) -> u64 {
        let s = &mut self.state;
        let result = s[1].wrapping_mul(5).rotate_left(7).wrapping_mul(9);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        result
    }

    /// Uniform in [0, 1).
    #[inline(always)]
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Nearly Gaussian, with mean 0 and variance 1: the sum of eight uniform numbers of 16 bits,
    /// so within ±4.9, with a kurtosis of 2.85 instead of 3. Two draws and no logarithm.
    #[inline(always)]
    pub fn gaussian(&mut self) -> f64 {
        const MEAN: f64 = 8.0 * 65_535.0 / 2.0;
        // 1/√(8·(2³²−1)/12)
        const SCALE: f64 = 1.868_812_365_011_853_4e-5;
        let pairs = |bits: u64| (bits & 0x0000_FFFF_0000_FFFF) + ((bits >> 16) & 0x0000_FFFF_0000_FFFF);
        let sums = pairs(self.bits()) + pairs(self.bits());
        let sum = (sums & 0xFFFF_FFFF) + (sums >> 32);
        (sum as f64 - MEAN) * SCALE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generators_are_those_published() {
        // SplitMix64 from seed 0, and xoshiro256** from the state 1, 2, 3, 4.
        let mut mix = 0;
        assert_eq!(split_mix(&mut mix), 0xE220_A839_7B1D_CDAF);
        assert_eq!(split_mix(&mut mix), 0x6E78_9E6A_A1B9_65F4);
        let mut random = Random { state: [1, 2, 3, 4] };
        let drawn = [random.bits(), random.bits(), random.bits(), random.bits()];
        assert_eq!(drawn, [11_520, 0, 1_509_978_240, 1_215_971_899_390_074_240]);
    }

    #[test]
    fn gaussian_has_the_moments_it_says() {
        let mut random = Random::new(1, 0);
        let n = 2_000_000;
        let mut moments = [0.0; 4];
        for _ in 0..n {
            let x = random.gaussian();
            assert!(x.abs() < 4.9);
            for (k, moment) in moments.iter_mut().enumerate() {
                *moment += libm::pow(x, (k + 1) as f64) / f64::from(n);
            }
        }
        for (moment, (wanted, bound)) in
            moments
                .into_iter()
                .zip([(0.0, 4e-3), (1.0, 5e-3), (0.0, 1e-2), (2.85, 3e-2)])
        {
            assert!((moment - wanted).abs() < bound, "{moments:?}");
        }
    }

    #[test]
    fn uniform_fills_its_range() {
        let mut random = Random::new(2, 0);
        let draws: Vec<f64> = (0..10_000).map(|_| random.uniform()).collect();
        assert!(draws.iter().all(|x| (0.0..1.0).contains(x)));
        let mean = draws.iter().sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
    }

    #[test]
    fn streams_and_seeds_differ_and_repeat() {
        let first = |seed, stream| Random::new(seed, stream).bits();
        assert_eq!(first(7, 1), first(7, 1));
        let mut all = vec![];
        for seed in 0..100 {
            for stream in 0..100 {
                all.push(first(seed, stream));
            }
        }
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 10_000);
    }
}
