//! Gravity, of a vehicle that stands still: the accelerometer shows nothing else.
//!
//! In the world the specific force is then (0, 0, −g). Estimated is f = R(f_body − b_a); the truth
//! is f + δθ × f − R δb_a. For the f in δθ × f the force is taken that is known, (0, 0, −g): the
//! estimated one would let what an accelerating vehicle shows turn a heading that is not known (by
//! 2° in a minute of attitudes flown without a compass). Row by row of the difference: at most one
//! non-zero in the attitude, three in the bias. What tells tilt and bias apart is turning the
//! vehicle; at rest the filter learns their sum, and keeps the correlation.

use windhover_math::{GRAVITY, Vector3};

use crate::border::{LARGEST_FORCE, Refusal, deviation, vector};
use crate::covariance::{Axis, Force};
use crate::filter::Filter;
use crate::gate::{Report, Test};
use crate::health::Sensor;
use crate::state::{InertialIncrements, State};

/// What an axis of the world should show less what it shows, and what that depends on.
#[inline(always)]
fn row(state: &State, force: Vector3, axis: Axis) -> (f32, Force) {
    let r = state.attitude.to_matrix();
    let own = force - state.accel_bias;
    let (expected, tilt, [x, y, z]) = match axis {
        Axis::X => (0.0, Some((Axis::Y, -GRAVITY)), [r.m11, r.m12, r.m13]),
        Axis::Y => (0.0, Some((Axis::X, GRAVITY)), [r.m21, r.m22, r.m23]),
        Axis::Z => (-GRAVITY, None, [r.m31, r.m32, r.m33]),
    };
    let innovation = expected - (x * own.x + y * own.y + z * own.z);
    let bias = [-x, -y, -z];
    (innovation, Force { tilt, bias })
}

impl Filter {
    /// Takes in the mean specific force of an interval at rest; `deviation` is that of each
    /// component of the mean, m/s².
    pub fn fuse_gravity(
        &mut self,
        increments: &InertialIncrements,
        deviation: f32,
    ) -> Result<Report<3>, Refusal> {
        let checked = increments.check();
        self.counted(Sensor::Gravity, checked)?;
        self.fuse_gravity_force(increments.velocity / increments.duration, deviation)
    }

    /// The same for a mean specific force, FRD, m/s².
    pub(crate) fn fuse_gravity_force(&mut self, force: Vector3, claimed: f32) -> Result<Report<3>, Refusal> {
        let checked = deviation(claimed).and_then(|()| vector(force, LARGEST_FORCE));
        self.counted(Sensor::Gravity, checked)?;
        let noise = claimed * claimed;
        let test = |axis| {
            let (innovation, row) = row(&self.state, force, axis);
            Test {
                innovation,
                variance: self.covariance.force_variance(&row) + noise,
            }
        };
        let tests = [test(Axis::X), test(Axis::Y), test(Axis::Z)];
        let take_in = |filter: &mut Self| {
            // Each against the state that the one before has left.
            filter.fuse_gravity_axis(force, Axis::X, noise);
            filter.fuse_gravity_axis(force, Axis::Y, noise);
            filter.fuse_gravity_axis(force, Axis::Z, noise);
        };
        // There is no reset by gravity: what does not pass time and again is a vehicle that does
        // not stand still.
        Ok(self.decide(Sensor::Gravity, tests, take_in, |_| {}))
    }
    #[inline(always)]
    fn fuse_gravity_axis(&mut self, force: Vector3, axis: Axis, noise: f32) {
        let (innovation, row) = row(&self.state, force, axis);
        self.covariance
            .fuse_force(&mut self.state, &row, innovation, noise);
    }
}
