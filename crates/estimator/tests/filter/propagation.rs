//! Prediction against the oracle and a dense reference.

use windhover_estimator::covariance::STATES;
use windhover_estimator::{Filter, InertialIncrements, NoiseParameters, State};
use windhover_math::{Quaternion, Vector3};

use crate::dense::{self, Matrix};
use crate::oracle::{State64, narrow, narrow_rotation};
use crate::random::Random;

pub fn any_state(random: &mut Random) -> State {
    State::from(&State64 {
        position: random.vector() * 100.0,
        velocity: random.vector() * 10.0,
        attitude: random.attitude(),
        gyro_bias: random.vector() * 0.01,
        accel_bias: random.vector() * 0.1,
    })
}

pub fn any_increments(random: &mut Random) -> InertialIncrements {
    let dt = 0.004;
    InertialIncrements {
        rotation: narrow_rotation(Quaternion::from_rotation_vector(random.vector() * (5.0 * dt))),
        gyro_bias: narrow(random.vector() * 0.02),
        velocity: narrow(random.vector() * (20.0 * dt)),
        duration: dt as f32,
    }
}

/// F by central differences of the oracle.
fn transition(from: &State64, increments: &InertialIncrements) -> Matrix {
    let base = from.after(increments);
    let mut f = Matrix::zeros();
    for i in 0..STATES {
        let column = from.differentiate(|state| state.after(increments).minus(&base)[i]);
        f.set_row(i, &column.transpose());
    }
    f
}

fn added(noise: &NoiseParameters, dt: f32) -> Matrix {
    let densities = [0.0, noise.accel, noise.gyro, noise.gyro_walk, noise.accel_walk];
    Matrix::from_fn(|i, j| {
        let density = f64::from(densities[i / 3]);
        if i == j {
            density * density * f64::from(dt)
        } else {
            0.0
        }
    })
}

#[test]
fn one_step_moves_the_state_as_the_oracle_does() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let state = any_state(&mut random);
        let increments = any_increments(&mut random);
        let covariance = dense::random(&mut random);
        let mut filter = Filter::resume(&state, &covariance, &NoiseParameters::default(), 0).unwrap();
        filter.predict(&increments, 4000).unwrap();
        let error = State64::from(filter.state()).minus(&State64::from(&state).after(&increments));
        assert!(error.amax() < 2e-5, "{error}");
    }
}

#[test]
fn one_step_moves_the_covariance_as_a_dense_product_does() {
    let mut random = Random(2);
    let noise = NoiseParameters::default();
    let mut worst = 0.0;
    for _ in 0..500 {
        let state = any_state(&mut random);
        let increments = any_increments(&mut random);
        let covariance = dense::random(&mut random);
        let mut filter = Filter::resume(&state, &covariance, &noise, 0).unwrap();
        filter.predict(&increments, 4000).unwrap();
        let f = transition(&State64::from(&state), &increments);
        let exact = f * dense::of(&covariance) * f.transpose() + added(&noise, increments.duration);
        let found = dense::of(filter.covariance());
        worst = windhover_math::max(worst, dense::difference(&found, &exact));
    }
    // The neglected terms of second order: dt²/2 times rate or force, 4e-5 and below.
    assert!(worst < 1e-4, "{worst:e}");
}

#[test]
fn along_a_flight_without_measurements_the_covariance_stays_with_the_reference() {
    let mut random = Random(3);
    let noise = NoiseParameters::default();
    let covariance = dense::random(&mut random);
    let state = State::default();
    let mut filter = Filter::resume(&state, &covariance, &noise, 0).unwrap();
    let mut exact = dense::of(&covariance);
    let mut oracle = State64::from(&state);
    let mut rate = Vector3::zeros();
    for n in 0..2500 {
        rate = rate * 0.99 + random.normals() * 0.05;
        let increments = InertialIncrements {
            rotation: narrow_rotation(Quaternion::from_rotation_vector(rate * 0.004)),
            gyro_bias: Vector3::zeros(),
            velocity: narrow((Vector3::new(0.0, 0.0, -9.8) + random.normals()) * 0.004),
            duration: 0.004,
        };
        let f = transition(&oracle, &increments);
        exact = f * exact * f.transpose() + added(&noise, increments.duration);
        oracle = oracle.after(&increments);
        filter.predict(&increments, 4000 * (n + 1)).unwrap();
    }
    let worst = dense::difference(&dense::of(filter.covariance()), &exact);
    assert!(worst < 2e-3, "{worst:e}");
    let error = State64::from(filter.state()).minus(&oracle);
    assert!(error.amax() < 0.02, "{error}");
}
