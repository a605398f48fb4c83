//! As [`crate::jacobian`]: the vehicle at rest, and the pose from outside.

use windhover_estimator::measurement::ExternalPose;
use windhover_estimator::{InertialIncrements, Test};
use windhover_math::{Quaternion, Vector3};

use crate::jacobian::{compare, filter, scalar};
use crate::oracle::{GRAVITY, State64, narrow, narrow_rotation, wide};
use crate::random::Random;

#[test]
fn gravity_at_rest() {
    let mut random = Random(16);
    for _ in 0..200 {
        let (mut filter, _) = filter(&mut random, 2);
        let before = filter.clone();
        let state = State64::from(before.state());
        let up = state.attitude.inverse_rotate(-GRAVITY);
        let force = up + state.accel_bias + random.vector() * 0.005;
        let increments = InertialIncrements {
            rotation: Quaternion::IDENTITY,
            gyro_bias: Vector3::zeros(),
            velocity: narrow(force * 0.004),
            duration: 0.004,
        };
        let report = filter.fuse_gravity(&increments, 0.05).unwrap();
        let world = |s: &State64| s.attitude.rotate(force - s.accel_bias);
        let scalars = [
            scalar(move |s| world(s).x, 0.0, 0.05),
            scalar(move |s| world(s).y, 0.0, 0.05),
            scalar(move |s| world(s).z, -GRAVITY.z, 0.05),
        ];
        // Rows after the first are linearised where the row before has left the state, so the
        // innovation is small here.
        compare(&before, &filter, &report.tests, &scalars, [1e-4, 2e-2]);
    }
}

#[test]
fn rest() {
    let mut random = Random(17);
    for _ in 0..200 {
        let (mut filter, _) = filter(&mut random, 2);
        let before = filter.clone();
        let taken = wide(before.state().gyro_bias);
        let rate = taken + random.vector() * 0.01;
        let increments = InertialIncrements {
            rotation: narrow_rotation(Quaternion::from_rotation_vector((rate - taken) * 0.004)),
            gyro_bias: narrow(taken),
            velocity: Vector3::new(0.0, 0.0, -0.04),
            duration: 0.004,
        };
        let report = filter.fuse_rest(&increments, 0.5, 0.01).unwrap();
        let scalars = [
            scalar(|s| s.velocity.x, 0.0, 0.5),
            scalar(|s| s.velocity.y, 0.0, 0.5),
            scalar(|s| s.velocity.z, 0.0, 0.5),
            scalar(|s| s.gyro_bias.x, rate.x, 0.01),
            scalar(|s| s.gyro_bias.y, rate.y, 0.01),
            scalar(|s| s.gyro_bias.z, rate.z, 0.01),
        ];
        let passes = report.tests.iter().all(Test::passes);
        if passes {
            compare(&before, &filter, &report.tests, &scalars, [1e-4, 1e-3]);
        }
    }
}

#[test]
fn external_pose() {
    let mut random = Random(18);
    for _ in 0..200 {
        let (mut filter, _) = filter(&mut random, 2);
        let before = filter.clone();
        let state = State64::from(before.state());
        let turn = random.vector() * 0.05;
        let position = state.position + random.vector() * 0.1;
        let velocity = state.velocity + random.vector() * 0.1;
        let attitude = Quaternion::from_rotation_vector(turn) * state.attitude;
        let report = filter
            .fuse_pose(&ExternalPose {
                time: filter.time(),
                position: narrow(position),
                velocity: narrow(velocity),
                attitude: narrow_rotation(attitude),
                position_deviation: 0.02,
                velocity_deviation: 0.05,
                attitude_deviation: 0.01,
            })
            .unwrap();
        let axis = move |s: &State64, k: usize| s.minus(&state)[6 + k];
        let scalars = [
            scalar(|s| s.position.x, position.x, 0.02),
            scalar(|s| s.position.y, position.y, 0.02),
            scalar(|s| s.position.z, position.z, 0.02),
            scalar(|s| s.velocity.x, velocity.x, 0.05),
            scalar(|s| s.velocity.y, velocity.y, 0.05),
            scalar(|s| s.velocity.z, velocity.z, 0.05),
            scalar(move |s| axis(s, 0), turn.x, 0.01),
            scalar(move |s| axis(s, 1), turn.y, 0.01),
            scalar(move |s| axis(s, 2), turn.z, 0.01),
        ];
        compare(&before, &filter, &report.tests, &scalars, [1e-4, 1e-3]);
    }
}
