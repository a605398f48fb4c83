//! Doubt: a filter that is sure of itself, and wrong.
//!
//! Where all is as assumed, innovations are white: each as likely above as below. A gyro or an
//! accelerometer that has begun to show something else makes them lean to one side long before
//! the gate is reached, while the filter, sure of its biases, learns too slowly. [`Leaning`]
//! notices, and [`Filter::doubt`] makes it learn again.

use windhover_math::saturate;

use crate::covariance::{Axis, Group};
use crate::filter::Filter;
use crate::gate::Test;

/// Share of the last innovation in the mean that is watched.
const SHARE: f32 = 0.3;
/// The mean of white innovations has a standard deviation of √(0.3/1.7) = 0.42; this is 4.8 of
/// them, and one innovation alone cannot reach it.
const LEANS: f32 = 2.0;
/// No single innovation counts for more.
const LARGEST: f32 = 5.0;

/// Watches the innovations of one scalar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leaning {
    mean: f32,
}

impl Leaning {
    /// Takes in a test; whether the last ones lean to one side. Then it begins anew.
    #[inline]
    pub fn look(&mut self, test: &Test) -> bool {
        let normalised = test.innovation / windhover_math::sqrt(test.variance);
        if normalised.is_finite() {
            self.mean += (saturate(normalised, LARGEST) - self.mean) * SHARE;
        }
        let leans = self.mean.abs() > LEANS;
        if leans {
            self.mean = 0.0;
        }
        leans
    }
}

/// By how much the filter may be wrong, beside what it thinks: standard deviations that are added
/// to its own, as squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doubt {
    /// Of roll and pitch, rad.
    pub tilt: f32,
    /// Of the heading, rad.
    pub heading: f32,
    /// Of the gyro's bias, FRD, rad/s.
    pub gyro_bias: [f32; 3],
    /// Of the accelerometer's bias, each axis, m/s².
    pub accel_bias: f32,
}

impl Filter {
    /// Makes the filter less sure. What it believes stays.
    pub fn doubt(&mut self, doubt: &Doubt) {
        let mut add = |group, axis, deviation: f32| {
            if (0.0..10.0).contains(&deviation) {
                self.covariance.widen(group, axis, deviation * deviation);
            }
        };
        add(Group::Attitude, Axis::X, doubt.tilt);
        add(Group::Attitude, Axis::Y, doubt.tilt);
        add(Group::Attitude, Axis::Z, doubt.heading);
        for (axis, gyro) in Axis::ALL.into_iter().zip(doubt.gyro_bias) {
            add(Group::GyroBias, axis, gyro);
            add(Group::AccelBias, axis, doubt.accel_bias);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(innovation: f32) -> Test {
        Test {
            innovation,
            variance: 0.01,
        }
    }

    #[test]
    fn what_leans_is_noticed_and_what_jumps_once_is_not() {
        let mut leaning = Leaning::default();
        for n in 0..1000 {
            // two σ, in turn up and down
            assert!(!leaning.look(&test(if n % 2 == 0 { 0.2 } else { -0.2 })));
        }
        assert!(!leaning.look(&test(1e9)), "one that is far off");
        assert!(!leaning.look(&test(f32::NAN)));
        let mut leaning = Leaning::default();
        let noticed = (0..20).find(|_| leaning.look(&test(0.3)));
        assert_eq!(noticed, Some(3), "three σ, four times");
    }
}
