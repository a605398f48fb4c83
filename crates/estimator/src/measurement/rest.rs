//! Standing still: no velocity, and all that the gyro shows is its bias. Six direct scalars.
//!
//! The gyro's noise is in the interval's rotation too, by which the attitude moved; that both are
//! one is neglected, as an interval's noise is far smaller than a bias.

use crate::border::{Refusal, deviation};
use crate::covariance::{Axis, Group, Reference};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::Sensor;
use crate::history::Past;
use crate::state::InertialIncrements;

impl Filter {
    /// Takes in an interval at rest. Standard deviations of the velocity (m/s, how still it
    /// stands) and of the interval's mean rate (rad/s, the gyro's noise).
    pub fn fuse_rest(
        &mut self,
        increments: &InertialIncrements,
        velocity_deviation: f32,
        rate_deviation: f32,
    ) -> Result<Report<6>, Refusal> {
        let checked = increments
            .check()
            .and_then(|()| deviation(velocity_deviation))
            .and_then(|()| deviation(rate_deviation));
        self.counted(Sensor::Rest, checked)?;
        let noise = velocity_deviation * velocity_deviation;
        let rate_noise = rate_deviation * rate_deviation;
        let rate = increments.mean_rate();
        let v = -self.state.velocity;
        let b = rate - self.state.gyro_bias;
        let tests = [
            self.test_direct(Reference::Velocity, Axis::X, v.x, noise),
            self.test_direct(Reference::Velocity, Axis::Y, v.y, noise),
            self.test_direct(Reference::Velocity, Axis::Z, v.z, noise),
            self.test_direct(Reference::GyroBias, Axis::X, b.x, rate_noise),
            self.test_direct(Reference::GyroBias, Axis::Y, b.y, rate_noise),
            self.test_direct(Reference::GyroBias, Axis::Z, b.z, rate_noise),
        ];
        Ok(self.decide(
            Sensor::Rest,
            tests,
            |filter| {
                filter.fuse_velocity(windhover_math::Vector3::zeros(), &Past::NOW, noise);
                let wrong = rate.x - filter.state.gyro_bias.x;
                filter.fuse_direct(Reference::GyroBias, Axis::X, wrong, rate_noise);
                let wrong = rate.y - filter.state.gyro_bias.y;
                filter.fuse_direct(Reference::GyroBias, Axis::Y, wrong, rate_noise);
                let wrong = rate.z - filter.state.gyro_bias.z;
                filter.fuse_direct(Reference::GyroBias, Axis::Z, wrong, rate_noise);
            },
            |filter| {
                filter.state.velocity += v;
                filter.state.gyro_bias += b;
                for axis in Axis::ALL {
                    filter.covariance.decouple(Group::Velocity, axis, noise);
                    filter.covariance.decouple(Group::GyroBias, axis, rate_noise);
                }
            },
        ))
    }
}
