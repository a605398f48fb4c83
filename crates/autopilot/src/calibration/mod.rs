//! Calibrations: machines that turn samples of a sensor into the parameters that correct it.
//!
//! - [`gyro`]: the rates at rest.
//! - [`accelerometer`]: offset and scale, from six sides put down in turn.
//! - [`compass`]: hard and soft iron, from turning the vehicle every way.
//! - [`level`]: how the board lies in the vehicle.
//! - [`rc`]: the ends and the middle of the transmitter's channels.
//!
//! All of them are the same kind of machine. Each `step` takes a sample and how long it stands for,
//! and answers with a [`Progress`]: what the human is to do now, or the end, which is a result or a
//! reason. Time is the sum of the samples' durations: no clock, no allocation, no static. A machine
//! ends within its time limit whatever it is fed, and an ended one repeats its end. What is no
//! number, or larger than any sensor shows, ends it at once and is never computed with.
//!
//! Inertial and compass samples are in body axes (front, right, down), from a
//! [`SensingBorder`](crate::sensing::SensingBorder) with default calibration: a result replaces the
//! one before, it does not add to it. Only [`level`] wants the accelerometer as calibrated.

pub mod accelerometer;
pub mod compass;
pub mod gyro;
pub mod level;
pub mod rc;
pub mod rest;
mod solve;
#[cfg(test)]
mod testing;

use core::fmt;

use windhover_math::Vector3;
use windhover_math::scalar::is_finite;

/// Where a calibration is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress<Instruction, Outcome, Reason> {
    /// It goes on.
    Going {
        /// Share that is done, 0 to 1. Falls back when something has to be repeated.
        share: f32,
        /// What the human is to do.
        instruction: Instruction,
    },
    /// It ended well.
    Done(Outcome),
    /// It ended without a result.
    Refused(Reason),
}

impl<Instruction, Outcome, Reason> Progress<Instruction, Outcome, Reason> {
    /// The end that was reached, or where it is until then.
    fn of(end: Option<Result<Outcome, Reason>>, share: f32, instruction: Instruction) -> Self {
        match end {
            None => Self::Going { share, instruction },
            Some(Ok(outcome)) => Self::Done(outcome),
            Some(Err(reason)) => Self::Refused(reason),
        }
    }
}

/// Why a sample is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadSample {
    /// A component is not a finite number.
    NotANumber,
    /// A component is larger than any sensor shows.
    TooLarge,
    /// The time that it stands for is not between 10 µs and half a second.
    Duration,
}

impl fmt::Display for BadSample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotANumber => "the sensor gave something that is not a number",
            Self::TooLarge => "the sensor gave more than it can measure",
            Self::Duration => "the samples came too fast or too slowly",
        })
    }
}

/// `v` if it may be computed with.
fn check(v: Vector3, largest: f32) -> Result<(), BadSample> {
    if !is_finite(v) {
        Err(BadSample::NotANumber)
    } else if v.x.abs() <= largest && v.y.abs() <= largest && v.z.abs() <= largest {
        Ok(())
    } else {
        Err(BadSample::TooLarge)
    }
}

/// An axis of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// x.
    Front,
    /// y.
    Right,
    /// z.
    Down,
}

impl Axis {
    /// In the order of components.
    pub const ALL: [Self; 3] = [Self::Front, Self::Right, Self::Down];

    /// The first axis whose component does not lie within ± `limit`, with the component.
    fn beyond(v: Vector3, limit: f32) -> Option<(Self, f32)> {
        let components = Self::ALL.into_iter().zip([v.x, v.y, v.z]);
        // Written so that what is not a number lies beyond.
        let within = |value: f32| value.abs() <= limit;
        components.into_iter().find(|(_, value)| !within(*value))
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Front => "front axis",
            Self::Right => "right axis",
            Self::Down => "down axis",
        })
    }
}

/// The time that a calibration has taken, in whole microseconds: a sum that cannot stall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Timer {
    elapsed: u32,
    limit: u32,
}

/// Shortest and longest time that a sample may stand for, s.
const DURATIONS: core::ops::RangeInclusive<f32> = 1e-5..=0.5;
/// Longest that any calibration may be given, µs: an hour.
const LONGEST: u32 = 3_600_000_000;

impl Timer {
    /// Runs out after `limit` seconds, at most an hour; at once if that is not a number.
    fn new(limit: f32) -> Self {
        // A conversion of a float saturates, and makes 0 of what is not a number.
        let limit = (limit * 1e6) as u32;
        Self {
            elapsed: 0,
            limit: windhover_math::min(limit, LONGEST),
        }
    }

    /// Whether the time has run out after so many seconds more.
    fn advance(&mut self, duration: f32) -> Result<bool, BadSample> {
        if !DURATIONS.contains(&duration) {
            return Err(BadSample::Duration);
        }
        self.elapsed = self.elapsed.saturating_add((duration * 1e6 + 0.5) as u32);
        Ok(self.elapsed > self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this failed, a machine fed very short samples could run for ever: in `f32` a sum of
    /// many of them stalls.
    #[test]
    fn the_timer_runs_out_with_the_shortest_samples_and_with_any_limit() {
        let mut timer = Timer::new(3.0);
        let steps = (0..).take_while(|_| timer.advance(1e-5) == Ok(false)).count();
        assert_eq!(steps, 300_000);
        for limit in [f32::NAN, -1.0, 0.0, f32::NEG_INFINITY] {
            assert_eq!(Timer::new(limit).advance(0.01), Ok(true), "{limit}");
        }
        let hour = Timer::new(f32::INFINITY);
        assert_eq!(hour.limit, LONGEST);
    }

    /// If this failed, a sample of no length or of an absurd one would count.
    #[test]
    fn durations_that_are_none_are_refused() {
        for bad in [0.0, -0.01, 9e-6, 0.6, f32::NAN, f32::INFINITY] {
            assert_eq!(Timer::new(1.0).advance(bad), Err(BadSample::Duration), "{bad}");
        }
    }

    /// If this failed, NaN could reach a mean, from where it never leaves.
    #[test]
    fn the_border_lets_only_plausible_numbers_through() {
        for (bad, why) in [
            (f32::NAN, BadSample::NotANumber),
            (f32::NEG_INFINITY, BadSample::NotANumber),
            (-10.1, BadSample::TooLarge),
            (f32::MAX, BadSample::TooLarge),
        ] {
            for i in 0..3 {
                let mut v = Vector3::zeros();
                v[i] = bad;
                assert_eq!(check(v, 10.0), Err(why));
            }
        }
        assert_eq!(check(Vector3::repeat(-10.0), 10.0), Ok(()));
    }

    /// If this failed, the machines would no longer fit where the firmware keeps them.
    #[test]
    fn machines_are_small() {
        let sizes = [
            size_of::<gyro::GyroCalibrator>(),
            size_of::<level::LevelCalibrator>(),
            size_of::<accelerometer::AccelerometerCalibrator>(),
            size_of::<rc::RcCalibrator>(),
            size_of::<compass::CompassCalibrator>(),
        ];
        let most = [160, 160, 300, 500, 2300];
        for (size, most) in sizes.into_iter().zip(most) {
            assert!(size <= most, "{sizes:?}");
        }
    }
}
