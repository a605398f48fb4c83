//! How far a compass is trusted.
//!
//! A calibrated compass errs by some degrees, and errs alike for minutes: what it says of the
//! heading is worth little, what it says of a *change* of the heading much. So it is taken in
//! with the variance of errors that are alike; but when what it says runs away from what it said
//! before, the gyro has begun to drift: then the change is taken in as it is.

use windhover_math::{saturate, wrap_pi};

/// What a compass usually says differently is followed with this time constant, s.
const USUAL: f32 = 10.0;
/// What it says lately, s.
const LATELY: f32 = 0.2;
/// So far apart, in standard deviations of a sample, they are when the gyro has begun to drift.
const APART: f32 = 1.05;
/// A gyro's drift of 3 °/s takes longer from half of that to all of it, s.
const LEAST_RISE: f32 = 0.3;
/// For so long the change is taken in as it is, s.
const AGILE: f32 = 4.0;
/// Time over which the compass errs alike then, s.
const AGILE_CORRELATION: f32 = 0.2;
/// No single innovation counts for more, rad.
const LARGEST: f32 = 0.5;

/// Watches what the compass says differently from the filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct HeadingWatch {
    /// What it usually says differently, rad.
    usual: f32,
    /// What it says differently lately, beside that, rad.
    lately: f32,
    /// For how long that has been more than half of too much, s.
    rising: f32,
    /// How long changes are still taken in, s.
    agile: f32,
}

/// How the next sample is taken in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trust {
    /// In how many samples in a row the error counts as the same.
    pub(super) repeats: f32,
    /// What is taken off the bearing, rad.
    pub(super) offset: f32,
}

impl HeadingWatch {
    /// How a sample is taken in that comes `dt` seconds after the last one, of a compass that errs
    /// alike for `correlation` seconds.
    pub(super) fn trust(&self, correlation: f32, dt: f32) -> Trust {
        let (correlation, offset) = if self.agile > 0.0 {
            (AGILE_CORRELATION, self.usual)
        } else {
            (correlation, 0.0)
        };
        let repeats = if dt > 1e-3 {
            1.0 + 2.0 * correlation / dt
        } else {
            1.0
        };
        Trust { repeats, offset }
    }

    /// Takes in the innovation, rad, and its variance, `dt` seconds after the last one. Whether the
    /// gyro has begun to drift.
    pub(super) fn look(&mut self, innovation: f32, variance: f32, dt: f32) -> bool {
        let share = |time: f32| dt / (time + dt);
        let differs = saturate(wrap_pi(innovation - self.usual), LARGEST);
        self.lately += (differs - self.lately) * share(LATELY);
        if self.agile > 0.0 {
            // What changes now is the gyro's doing.
            self.agile -= dt;
            return false;
        }
        self.usual += differs * share(USUAL);
        let apart = self.lately * self.lately / (APART * APART * variance);
        self.rising = if apart > 0.25 { self.rising + dt } else { 0.0 };
        if apart <= 1.0 || apart.is_nan() {
            return false;
        }
        if self.rising < LEAST_RISE {
            // No gyro drifts so fast: it is the compass that has stepped.
            self.usual = wrap_pi(self.usual + self.lately);
            self.lately = 0.0;
            return false;
        }
        self.agile = AGILE;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f32 = 0.02;
    const VARIANCE: f32 = 0.048 * 0.048;

    fn noise(n: usize) -> f32 {
        // ±1°, without order
        ((n * 7919 % 101) as f32 / 101.0 - 0.5) * 0.035
    }

    #[test]
    fn a_compass_that_errs_alike_is_no_drift() {
        let mut watch = HeadingWatch::default();
        let mut n = 0;
        // an error of 3° that has built up over a minute
        let slow = |n: usize| 0.05 * windhover_math::min(1.0, n as f32 / 3000.0);
        while n < 6000 {
            assert!(!watch.look(slow(n) + noise(n), VARIANCE, DT), "{n}");
            n += 1;
        }
        assert!(watch.trust(20.0, DT).repeats > 1000.0);
    }

    #[test]
    fn a_gyro_that_drifts_is_found_within_two_seconds_and_believed_less() {
        let mut watch = HeadingWatch::default();
        for n in 0..1000 {
            watch.look(0.03 + noise(n), VARIANCE, DT);
        }
        // 2 °/s
        let found = (0..200).find(|n| watch.look(0.03 + 0.035 * *n as f32 * DT + noise(*n), VARIANCE, DT));
        assert!(found.is_some_and(|n| n as f32 * DT < 2.2), "{found:?}");
        let trust = watch.trust(20.0, DT);
        assert!(
            trust.repeats < 30.0 && (trust.offset - 0.03).abs() < 0.01,
            "{trust:?}"
        );
    }

    #[test]
    fn a_compass_that_steps_is_no_drift() {
        let mut watch = HeadingWatch::default();
        for n in 0..500 {
            watch.look(noise(n), VARIANCE, DT);
        }
        for step in [0.1, -0.1, 0.3] {
            assert!(
                (0..500).all(|n| !watch.look(step + noise(n), VARIANCE, DT)),
                "{step}"
            );
        }
    }

    #[test]
    fn what_is_no_number_of_samples_is_one() {
        assert_eq!(HeadingWatch::default().trust(20.0, 0.0).repeats, 1.0);
    }
}
