//! The part's times and rates, in the owner's ticks.

/// Millionths.
const MILLION: u64 = 1_000_000;

/// How the part's times and the owner's ticks are related.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Clock {
    ticks_per_microsecond: u64,
    /// How much faster the part's oscillator is than it should be, in millionths.
    error_ppm: i32,
}

impl Clock {
    pub fn new(ticks_per_microsecond: u64) -> Self {
        Self {
            ticks_per_microsecond,
            error_ppm: 0,
        }
    }

    pub fn with_error(self, error_ppm: i32) -> Self {
        Self { error_ppm, ..self }
    }

    /// Ticks in some microseconds; the oscillator's error does not count.
    pub fn microseconds(&self, us: u64) -> u64 {
        us * self.ticks_per_microsecond
    }

    /// Ticks from one sample to the `n`th after it, at a rate in thousandths of Hz. In integers
    /// from the first sample on, so that samples never drift.
    fn samples(&self, n: u64, millihertz: u64) -> u64 {
        // Within ±1 %, as every oscillator of this kind is.
        let part = u128::from(MILLION.saturating_add_signed(i64::from(self.error_ppm)));
        let ticks = u128::from(n) * u128::from(self.ticks_per_microsecond * MILLION * MILLION) * 1000;
        let ticks = ticks / (u128::from(millihertz) * part);
        u64::try_from(ticks).unwrap_or(u64::MAX)
    }
}

/// A rate in thousandths of Hz by the code of GYRO_ODR and ACCEL_ODR; `None` if it is reserved.
pub(super) fn millihertz(code: u8) -> Option<u64> {
    Some(match code & 0x0F {
        1 => 32_000_000,
        2 => 16_000_000,
        3 => 8_000_000,
        4 => 4_000_000,
        5 => 2_000_000,
        6 => 1_000_000,
        7 => 200_000,
        8 => 100_000,
        9 => 50_000,
        10 => 25_000,
        11 => 12_500,
        15 => 500_000,
        _ => return None,
    })
}

/// The moments at which samples are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    start: u64,
    millihertz: u64,
    /// Number of the next sample.
    next: u64,
    /// When it is taken.
    time: u64,
}

impl Grid {
    /// Samples at this rate, the first one a period after `start`.
    pub fn new(clock: &Clock, start: u64, millihertz: u64) -> Self {
        let mut grid = Self {
            start,
            millihertz,
            next: 0,
            time: start,
        };
        grid.advance(clock);
        grid
    }

    /// When the next sample is taken.
    pub fn time(&self) -> u64 {
        self.time
    }

    /// On to the sample after it.
    pub fn advance(&mut self, clock: &Clock) {
        self.next += 1;
        self.time = self.start + clock.samples(self.next, self.millihertz);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(clock: Clock, code: u8, samples: u64) -> u64 {
        let mut grid = Grid::new(&clock, 0, millihertz(code).unwrap());
        for _ in 1..samples {
            grid.advance(&clock);
        }
        grid.time()
    }

    #[test]
    fn rates_are_whole_ticks_without_an_error() {
        for ticks in [336, 1000] {
            let clock = Clock::new(ticks);
            assert_eq!(after(clock, 6, 1), 1000 * ticks);
            assert_eq!(after(clock, 4, 8001), 8001 * 250 * ticks);
            assert_eq!(after(clock, 11, 2), 160_000 * ticks);
        }
    }

    #[test]
    fn a_fast_oscillator_samples_early_and_never_drifts() {
        let clock = Clock::new(336).with_error(2500);
        // 1 s of the part's time is 1/1.0025 s.
        assert_eq!(after(clock, 6, 1_002_500), 336_000_000_000);
        let slow = Clock::new(336).with_error(-2500);
        assert_eq!(after(slow, 6, 997_500), 336_000_000_000);
    }
}
