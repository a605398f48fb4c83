//! Position by a satellite receiver: three direct scalars, of the position when it was measured.
//!
//! The horizontal pair and the height are judged apart, as the height is the worse by far and
//! often has a better source. z = p(t) = p − lag · v + …, H = [I, −lag I, 0, 0, 0].

use windhover_math::Vector3;

use crate::border::{LARGEST_POSITION, Refusal, deviation, vector};
use crate::covariance::{Axis, Group, Reference};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::Sensor;
use crate::history::Past;

/// A receiver's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GnssPosition {
    /// When it was measured, µs.
    pub time: u64,
    /// NED from the origin, m.
    pub position: Vector3,
    /// Standard deviation of north and of east, m.
    pub horizontal_deviation: f32,
    /// Standard deviation of down, m.
    pub vertical_deviation: f32,
}

impl Filter {
    /// Takes in north and east.
    #[inline]
    pub fn fuse_gnss_position(&mut self, measured: &GnssPosition) -> Result<Report<2>, Refusal> {
        let past = self.gnss_border(measured, measured.horizontal_deviation);
        let past = self.counted(Sensor::GnssPosition, past)?;
        let noise = self.late_noise(measured.horizontal_deviation, past.lag);
        let reference = Reference::Position { lag: past.lag };
        let wrong = measured.position - past.position(&self.state);
        let tests = [
            self.test_direct(reference, Axis::X, wrong.x, noise),
            self.test_direct(reference, Axis::Y, wrong.y, noise),
        ];
        Ok(self.decide(
            Sensor::GnssPosition,
            tests,
            |filter| {
                filter.fuse_direct(reference, Axis::X, wrong.x, noise);
                let wrong = measured.position.y - past.position(&filter.state).y;
                filter.fuse_direct(reference, Axis::Y, wrong, noise);
            },
            |filter| {
                filter.state.position.x += wrong.x;
                filter.state.position.y += wrong.y;
                filter.forget_position(Axis::X, noise, past.lag);
                filter.forget_position(Axis::Y, noise, past.lag);
            },
        ))
    }

    /// Takes in down.
    #[inline]
    pub fn fuse_gnss_height(&mut self, measured: &GnssPosition) -> Result<Report<1>, Refusal> {
        let past = self.gnss_border(measured, measured.vertical_deviation);
        let past = self.counted(Sensor::GnssHeight, past)?;
        let noise = self.late_noise(measured.vertical_deviation, past.lag);
        let reference = Reference::Position { lag: past.lag };
        let wrong = measured.position.z - past.position(&self.state).z;
        let tests = [self.test_direct(reference, Axis::Z, wrong, noise)];
        Ok(self.decide(
            Sensor::GnssHeight,
            tests,
            |filter| filter.fuse_direct(reference, Axis::Z, wrong, noise),
            |filter| {
                filter.state.position.z += wrong;
                filter.forget_position(Axis::Z, noise, past.lag);
                filter.shift_datum(wrong);
            },
        ))
    }

    /// Variance of a late position against the present one less lag · velocity: the process noise
    /// since then has moved the position by Q·lag³/3 that the velocity does not tell of.
    #[inline]
    fn late_noise(&self, deviation: f32, lag: f32) -> f32 {
        deviation * deviation + self.densities.velocity * (lag * lag * lag * (1.0 / 3.0))
    }

    fn gnss_border(&self, measured: &GnssPosition, claimed: f32) -> Result<Past, Refusal> {
        vector(measured.position, LARGEST_POSITION)?;
        deviation(claimed)?;
        self.past(measured.time)
    }

    /// The position of an axis is now known by a measurement of that lag alone.
    pub(crate) fn forget_position(&mut self, axis: Axis, noise: f32, lag: f32) {
        let moved = lag * lag * self.covariance.variances(Group::Velocity)[axis as usize];
        self.covariance.decouple(Group::Position, axis, noise + moved);
    }
}
