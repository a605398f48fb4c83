//! Velocity by a satellite receiver (Doppler): three direct scalars, judged together.
//!
//! z = v(t). Of the present velocity H = [0, I, 0, 0, 0]; of a past one H has the attitude's and
//! the accelerometer bias's part in what the velocity has changed by since, see
//! [`crate::history`]. The gate looks at the velocity's own variance in both cases.

use windhover_math::Vector3;

use crate::border::{LARGEST_VELOCITY, Refusal, deviation, vector};
use crate::covariance::{Axis, Group, Reference};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::Sensor;
use crate::history::Past;

/// A receiver's velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GnssVelocity {
    /// When it was measured, µs.
    pub time: u64,
    /// NED, m/s.
    pub velocity: Vector3,
    /// Standard deviation of each of the three, m/s.
    pub deviation: f32,
}

impl Filter {
    /// Takes it in.
    #[inline]
    pub fn fuse_gnss_velocity(&mut self, measured: &GnssVelocity) -> Result<Report<3>, Refusal> {
        let past = self.gnss_velocity_border(measured);
        let past = self.counted(Sensor::GnssVelocity, past)?;
        let noise = measured.deviation * measured.deviation;
        let wrong = measured.velocity - past.velocity(&self.state);
        let tests = [
            self.test_direct(Reference::Velocity, Axis::X, wrong.x, noise),
            self.test_direct(Reference::Velocity, Axis::Y, wrong.y, noise),
            self.test_direct(Reference::Velocity, Axis::Z, wrong.z, noise),
        ];
        Ok(self.decide(
            Sensor::GnssVelocity,
            tests,
            |filter| filter.fuse_velocity(measured.velocity, &past, noise),
            |filter| {
                filter.state.velocity += wrong;
                for axis in Axis::ALL {
                    filter.covariance.decouple(Group::Velocity, axis, noise);
                }
            },
        ))
    }

    fn gnss_velocity_border(&self, measured: &GnssVelocity) -> Result<Past, Refusal> {
        vector(measured.velocity, LARGEST_VELOCITY)?;
        deviation(measured.deviation)?;
        self.past(measured.time)
    }

    /// The three components, one after the other, each against what the one before has left.
    #[inline]
    pub(crate) fn fuse_velocity(&mut self, measured: Vector3, past: &Past, noise: f32) {
        let wrong = measured.x - past.velocity(&self.state).x;
        self.fuse_velocity_axis(Axis::X, past, wrong, noise);
        let wrong = measured.y - past.velocity(&self.state).y;
        self.fuse_velocity_axis(Axis::Y, past, wrong, noise);
        let wrong = measured.z - past.velocity(&self.state).z;
        self.fuse_velocity_axis(Axis::Z, past, wrong, noise);
    }

    #[inline(always)]
    fn fuse_velocity_axis(&mut self, axis: Axis, past: &Past, innovation: f32, noise: f32) {
        if past.lag > 0.0 {
            let late = past.late_velocity(&self.state, axis, self.densities.velocity);
            self.covariance
                .fuse_late_velocity(&mut self.state, axis, &late, innovation, noise);
        } else {
            self.fuse_direct(Reference::Velocity, axis, innovation, noise);
        }
    }
}
