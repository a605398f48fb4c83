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
use crate::filter::Filter;
use crate::gate::{Report, Test};
use crate::health::Sensor;
use crate::state::{InertialIncrements, State};

/// One row: what it should be less what it is, with its coefficients.
struct Row {
    innovation: f32,
    attitude: [f32; 3],
    bias: [f32; 3],
}

fn rows(state: &State, force: Vector3) -> [Row; 3] {
    let r = state.attitude.to_matrix();
    let f = state.attitude.rotate(force - state.accel_bias);
    [
        Row {
            innovation: -f.x,
            attitude: [0.0, -GRAVITY, 0.0],
            bias: [-r.m11, -r.m12, -r.m13],
        },
        Row {
            innovation: -f.y,
            attitude: [GRAVITY, 0.0, 0.0],
            bias: [-r.m21, -r.m22, -r.m23],
        },
        Row {
            innovation: -GRAVITY - f.z,
            attitude: [0.0; 3],
            bias: [-r.m31, -r.m32, -r.m33],
        },
    ]
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
        let tests = rows(&self.state, force).map(|row| Test {
            innovation: row.innovation,
            variance: self.covariance.force_variance(row.attitude, row.bias) + noise,
        });
        let take_in = |filter: &mut Self| {
            // Against the state that the row before has left.
            for k in 0..3 {
                if let Some(row) = rows(&filter.state, force).get(k) {
                    filter.covariance.fuse_force(
                        &mut filter.state,
                        row.attitude,
                        row.bias,
                        row.innovation,
                        noise,
                    );
                }
            }
        };
        // There is no reset by gravity: what does not pass time and again is a vehicle that does
        // not stand still.
        Ok(self.decide(Sensor::Gravity, tests, take_in, |_| {}))
    }
}
