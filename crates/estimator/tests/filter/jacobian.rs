//! Each measurement against numerical differentiation of what it measures: innovation, its
//! variance, and the covariance after it.

use windhover_estimator::measurement::{
    BarometricHeight, GnssPosition, GnssVelocity, Heading, MagneticField,
};
use windhover_estimator::{Filter, InertialIncrements, NoiseParameters, Test};
use windhover_math::{Quaternion, Vector3};

use crate::dense::{self, Matrix};
use crate::oracle::{State64, narrow, narrow_rotation, wide};
use crate::propagation::{any_increments, any_state};
use crate::random::Random;

/// A scalar that a measurement consists of: what it measures as a function of the state, what was
/// measured, and the variance of its noise.
pub struct Scalar<'a> {
    model: Box<dyn Fn(&State64) -> f64 + 'a>,
    measured: f64,
    noise: f64,
}

pub fn scalar<'a>(model: impl Fn(&State64) -> f64 + 'a, measured: f64, deviation: f32) -> Scalar<'a> {
    Scalar {
        model: Box::new(model),
        measured,
        noise: f64::from(deviation) * f64::from(deviation),
    }
}

/// A filter after some steps at random, with a random covariance at its end.
pub fn filter(random: &mut Random, steps: u64) -> (Filter, Vec<InertialIncrements>) {
    let covariance = dense::random(random);
    let mut state = any_state(random);
    state.attitude = narrow_rotation(Quaternion::from_rotation_vector(random.vector()));
    let mut filter = Filter::resume(&state, &covariance, &NoiseParameters::default(), 1_000_000).unwrap();
    let increments: Vec<_> = (0..steps).map(|_| any_increments(random)).collect();
    for (n, increments) in increments.iter().enumerate() {
        filter.predict(increments, 1_004_000 + 4000 * n as u64).unwrap();
    }
    (filter, increments)
}

/// The tests in the report, and the covariance after, are those of a dense update with H by
/// differentiation; the tolerances are of innovations (absolute) and of all else (relative).
pub fn compare(before: &Filter, after: &Filter, tests: &[Test], scalars: &[Scalar], tolerance: [f64; 2]) {
    let state = State64::from(before.state());
    let first = dense::of(before.covariance());
    let mut p: Matrix = first;
    assert_eq!(tests.len(), scalars.len());
    for (test, scalar) in tests.iter().zip(scalars) {
        let h = state.differentiate(&scalar.model);
        let innovation = scalar.measured - (scalar.model)(&state);
        assert!(
            (f64::from(test.innovation) - innovation).abs() < tolerance[0],
            "{test:?} {innovation}"
        );
        let variance = (first * h).dot(&h) + scalar.noise;
        assert!(
            (f64::from(test.variance) / variance - 1.0).abs() < tolerance[1],
            "{test:?} {variance}"
        );
        p = dense::update(&p, &h, scalar.noise);
    }
    let found = dense::of(after.covariance());
    let worst = dense::difference(&found, &p);
    assert!(worst < tolerance[1], "{worst:e}");
}

/// The state that the filter was in, at the start of the increments, as seen from `now`.
fn back(now: &State64, increments: &[InertialIncrements]) -> State64 {
    increments
        .iter()
        .rev()
        .fold(*now, |state, increments| state.before(increments))
}

#[test]
fn gnss_position_now_and_late() {
    let mut random = Random(10);
    for steps in [0, 30].repeat(100) {
        let (mut filter, increments) = filter(&mut random, steps);
        let before = filter.clone();
        // Late, ½ lag² f δθ is left out: 2 cm for the heading's 0.2 rad and 20 m/s² here.
        let tolerance = [1e-4, if steps == 0 { 1e-4 } else { 6e-2 }];
        let past = back(&State64::from(before.state()), &increments);
        let position = past.position + random.vector() * 0.3;
        let measured = GnssPosition {
            time: 1_000_000,
            position: narrow(position),
            horizontal_deviation: 0.3,
            vertical_deviation: 0.6,
        };
        let (n, d) = (&increments, &position);
        let horizontal = [
            scalar(move |s| back(s, n).position.x, d.x, 0.3),
            scalar(move |s| back(s, n).position.y, d.y, 0.3),
        ];
        let report = filter.fuse_gnss_position(&measured).unwrap();
        compare(&before, &filter, &report.tests, &horizontal, tolerance);
        let mut filter = before.clone();
        let vertical = [scalar(move |s| back(s, n).position.z, d.z, 0.6)];
        let report = filter.fuse_gnss_height(&measured).unwrap();
        compare(&before, &filter, &report.tests, &vertical, tolerance);
    }
}

#[test]
fn gnss_velocity_now() {
    let mut random = Random(11);
    for _ in 0..200 {
        let (mut filter, _) = filter(&mut random, 3);
        let before = filter.clone();
        let velocity = wide(before.state().velocity) + random.vector() * 0.2;
        let measured = GnssVelocity {
            time: filter.time(),
            velocity: narrow(velocity),
            deviation: 0.1,
        };
        let scalars = [
            scalar(|s| s.velocity.x, velocity.x, 0.1),
            scalar(|s| s.velocity.y, velocity.y, 0.1),
            scalar(|s| s.velocity.z, velocity.z, 0.1),
        ];
        let report = filter.fuse_gnss_velocity(&measured).unwrap();
        compare(&before, &filter, &report.tests, &scalars, [1e-5, 1e-4]);
    }
}

#[test]
fn a_late_velocity_is_compared_with_the_velocity_then() {
    let mut random = Random(12);
    for _ in 0..50 {
        let (mut filter, increments) = filter(&mut random, 30);
        let past = back(&State64::from(filter.state()), &increments);
        let measured = GnssVelocity {
            time: 1_000_000,
            velocity: narrow(past.velocity),
            deviation: 0.1,
        };
        let report = filter.fuse_gnss_velocity(&measured).unwrap();
        assert!(
            report.tests.iter().all(|test| test.innovation.abs() < 1e-4),
            "{report:?}"
        );
    }
}

#[test]
fn barometric_height() {
    let mut random = Random(13);
    for _ in 0..200 {
        let (mut filter, _) = filter(&mut random, 3);
        let down = f64::from(filter.state().position.z);
        let mut measured = BarometricHeight {
            time: filter.time(),
            height: 500.0,
            deviation: 0.2,
        };
        let first = filter.fuse_barometer(&measured).unwrap();
        assert!(first.tests[0].innovation.abs() < 1e-4);
        let datum = filter.datum().unwrap();
        assert!((f64::from(datum.height) - 500.0 - down).abs() < 1e-4);
        let before = filter.clone();
        measured.height = 500.5;
        let scalars = [scalar(|s| f64::from(datum.height) - s.position.z, 500.5, 0.2)];
        let report = filter.fuse_barometer(&measured).unwrap();
        // Height is up, the state is down: the same innovation with the other sign.
        let test = Test {
            innovation: -report.tests[0].innovation,
            ..report.tests[0]
        };
        compare(&before, &filter, &[test], &scalars, [1e-4, 1e-4]);
    }
}

/// Bearing in the world of a direction of the body.
fn bearing(state: &State64, direction: Vector3<f64>) -> f64 {
    let d = state.attitude.rotate(direction);
    libm::atan2(d.y, d.x)
}

#[test]
fn compass() {
    let mut random = Random(14);
    for steps in [0, 5].repeat(100) {
        let (mut filter, increments) = filter(&mut random, steps);
        let before = filter.clone();
        let past = back(&State64::from(before.state()), &increments);
        let declination = 0.05;
        let truth = Vector3::new(20.0 * libm::cos(declination), 20.0 * libm::sin(declination), 40.0);
        let error = Quaternion::from_rotation_vector(random.vector() * 0.02);
        let field = (error * past.attitude).inverse_rotate(truth);
        let measured = MagneticField {
            repeats: 1.0,
            time: 1_000_000,
            field: narrow(field),
            deviation: 1.0,
            declination: declination as f32,
        };
        let across = past.attitude.rotate(field);
        let deviation = 1.0 / libm::hypot(across.x, across.y);
        let n = &increments;
        let scalars = [Scalar {
            model: Box::new(|s| bearing(&back(s, n), field)),
            measured: declination,
            noise: deviation * deviation,
        }];
        let report = filter.fuse_compass(&measured).unwrap();
        compare(&before, &filter, &report.tests, &scalars, [1e-5, 1e-1]);
    }
}

#[test]
fn heading() {
    let mut random = Random(15);
    for _ in 0..200 {
        let (mut filter, _) = filter(&mut random, 2);
        let before = filter.clone();
        let nose = Vector3::new(1.0, 0.0, 0.0);
        let measured = bearing(&State64::from(before.state()), nose) + 0.05 * random.either();
        let report = filter
            .fuse_heading(&Heading {
                time: filter.time(),
                heading: windhover_math::wrap_pi(measured as f32),
                deviation: 0.05,
            })
            .unwrap();
        let scalars = [scalar(|s| bearing(s, nose), measured, 0.05)];
        compare(&before, &filter, &report.tests, &scalars, [1e-5, 1e-4]);
    }
}
