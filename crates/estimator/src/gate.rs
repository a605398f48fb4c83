//! Whether a measurement is believed.
//!
//! The innovation's square over its variance is, for a sensor that is as good as it claims, a χ²
//! variable of one degree of freedom. Beyond [`GATE`] the measurement is rejected. What belongs
//! together (the three velocities of a receiver) is believed together or not at all.

use crate::health::Sensor;
use crate::reset::Reset;

/// The gate, in variances: 5 σ, which a true Gaussian passes 1,744,277 times of 1,744,278.
pub const GATE: f32 = 25.0;

/// One scalar of a measurement against what the filter expected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Test {
    /// Measured less expected, in the measurement's unit.
    pub innovation: f32,
    /// Variance of that: of the state and of the measurement together.
    pub variance: f32,
}

impl Test {
    /// The innovation in variances; 1 on average where all is as assumed.
    #[inline]
    pub fn ratio(&self) -> f32 {
        self.innovation * self.innovation / self.variance
    }

    /// Whether the gate lets it pass. What is not a number does not pass.
    #[inline(always)]
    pub fn passes(&self) -> bool {
        self.innovation * self.innovation <= GATE * self.variance
    }
}

/// What became of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It was taken in.
    Accepted,
    /// It failed the gate and changed nothing.
    Rejected,
    /// It failed the gate so often that the state it measures was set to it.
    Reset,
}

/// What became of a measurement of `N` scalars, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<const N: usize> {
    /// Its scalars, before any of them was taken in.
    pub tests: [Test; N],
    /// What was done.
    pub verdict: Verdict,
    /// The step that this made in the state, where it was a reset or where the sensor came back
    /// after a time-out: controllers shift their setpoints by it.
    pub step: Option<Reset>,
}

/// When a sensor that is not believed is given in to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Policy {
    /// Rejections in a row after which the state is set to the measurement.
    pub patience: u32,
    /// Without an accepted measurement for so long, µs, [`INSISTENCE`] rejections are enough.
    pub timeout: u64,
    /// Without an accepted measurement for so long, µs, the sensor is no longer good.
    pub stale: u64,
}

/// Rejections in a row that a sensor needs after its time-out: the first word of a receiver that
/// has just found its satellites again is often wrong.
pub const INSISTENCE: u32 = 3;

impl Policy {
    /// What holds for a sensor. Rejections in a row last about 2 s at the usual rates.
    pub const fn of(sensor: Sensor) -> Self {
        let (patience, timeout, stale) = match sensor {
            Sensor::GnssPosition | Sensor::GnssHeight | Sensor::GnssVelocity => (20, 5_000_000, 500_000),
            Sensor::Barometer => (100, 2_000_000, 200_000),
            Sensor::Compass | Sensor::Heading => (100, 5_000_000, 500_000),
            Sensor::Pose => (50, 1_000_000, 100_000),
            Sensor::Rest | Sensor::Gravity => (250, 60_000_000, 1_000_000),
        };
        Self {
            patience,
            timeout,
            stale,
        }
    }
}
