//! Standing still: the means of rate and specific force over a few seconds without motion.
//!
//! Samples are averaged over tenths of a second, which takes noise, the vibration of a fan and the
//! tremble of a hand (8 to 12 Hz) out. Every such block must lie near the mean of the blocks before
//! it; one that does not starts the rest again and says how it was disturbed. A slow drift shows
//! too: the last block then lies half the drift away from the mean.

use core::fmt;

use windhover_math::Vector3;
use windhover_math::scalar::norm;

use super::{BadSample, check};
use crate::sensing::Inertial;

/// What counts as standing still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stillness {
    /// How long, s.
    pub duration: f32,
    /// Largest difference of a block's mean rate from the mean so far, rad/s.
    pub rate: f32,
    /// Largest difference of a block's mean specific force from the mean so far, m/s²: 0.3 is a
    /// tilt by 1.8°.
    pub force: f32,
}

impl Default for Stillness {
    /// On a stand or on the ground.
    fn default() -> Self {
        Self {
            duration: 2.5,
            rate: 0.02,
            force: 0.3,
        }
    }
}

/// How a rest was disturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// It turned.
    Turned,
    /// It was pushed or tilted.
    Pushed,
}

/// What the human is to do while the vehicle rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeepStill {
    /// How the last attempt was disturbed, if one was.
    pub again: Option<Disturbance>,
}

impl fmt::Display for KeepStill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.again {
            None => "keep the vehicle still",
            Some(Disturbance::Turned) => "it turned: keep the vehicle still",
            Some(Disturbance::Pushed) => "it was pushed: keep the vehicle still",
        })
    }
}

/// How a rest goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resting {
    /// Still so far.
    Collecting,
    /// It begins again.
    Disturbed(Disturbance),
    /// Long enough.
    Still,
}

/// Time-weighted sums of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sums {
    time: f32,
    rate: Vector3,
    force: Vector3,
}

impl Sums {
    fn zero() -> Self {
        Self {
            time: 0.0,
            rate: Vector3::zeros(),
            force: Vector3::zeros(),
        }
    }

    fn add(&mut self, sample: &Inertial, duration: f32) {
        self.time += duration;
        self.rate += sample.rate * duration;
        self.force += sample.specific_force * duration;
    }

    fn mean(&self) -> Inertial {
        if self.time > 0.0 {
            Inertial {
                rate: self.rate / self.time,
                specific_force: self.force / self.time,
            }
        } else {
            Inertial::default()
        }
    }
}

/// Length of a block, s: a period of the tremble of a hand.
const BLOCK: f32 = 0.1;
/// More than any gyro shows, rad/s (±4000 °/s).
const LARGEST_RATE: f32 = 70.0;
/// More than any accelerometer shows, m/s² (±64 g).
const LARGEST_FORCE: f32 = 640.0;

/// Whether a sample may be computed with.
pub(super) fn check_sample(sample: &Inertial) -> Result<(), BadSample> {
    check(sample.rate, LARGEST_RATE)?;
    check(sample.specific_force, LARGEST_FORCE)
}

/// The sums since the vehicle stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rest {
    limits: Stillness,
    block: Sums,
    total: Sums,
}

impl Rest {
    /// Nothing known.
    pub(super) fn new(limits: Stillness) -> Self {
        Self {
            limits,
            block: Sums::zero(),
            total: Sums::zero(),
        }
    }

    /// Forgets the rest so far.
    pub(super) fn restart(&mut self) {
        *self = Self::new(self.limits);
    }

    /// Means of rate and force since it stands still; zero before the first block.
    pub(super) fn mean(&self) -> Inertial {
        self.total.mean()
    }

    /// Share of the time that is done, 0 to 1.
    pub(super) fn share(&self) -> f32 {
        let share = self.total.time / self.limits.duration;
        if share < 1.0 { share } else { 1.0 }
    }

    /// Takes in a sample that has passed the border.
    pub(super) fn take_in(&mut self, sample: &Inertial, duration: f32) -> Resting {
        self.block.add(sample, duration);
        if self.block.time >= BLOCK {
            if let Some(disturbance) = self.disturbance() {
                self.restart();
                return Resting::Disturbed(disturbance);
            }
            self.total.time += self.block.time;
            self.total.rate += self.block.rate;
            self.total.force += self.block.force;
            self.block = Sums::zero();
        }
        if self.total.time >= self.limits.duration {
            Resting::Still
        } else {
            Resting::Collecting
        }
    }

    /// How the block that is complete differs from those before it.
    fn disturbance(&self) -> Option<Disturbance> {
        let (block, mean) = (self.block.mean(), self.total.mean());
        if self.total.time <= 0.0 {
            None
        } else if norm(block.rate - mean.rate) > self.limits.rate {
            Some(Disturbance::Turned)
        } else if norm(block.specific_force - mean.specific_force) > self.limits.force {
            Some(Disturbance::Pushed)
        } else {
            None
        }
    }
}
