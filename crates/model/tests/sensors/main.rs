//! Sensors measured: each declared figure against what comes out, from fixed seeds.

mod barometer;
mod battery;
mod compass;
mod fault;
mod gnss;
mod inertial;
mod injection;
mod rc;
mod suite;

use windhover_math::{Quaternion, Vector3};
use windhover_model::{GRAVITY, Truth};

/// At rest on the ground at the origin, level, facing north, in calm air.
fn at_rest() -> Truth {
    Truth {
        time: 0.0,
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Quaternion::IDENTITY,
        body_rate: Vector3::zeros(),
        mean_rate: Vector3::zeros(),
        specific_force: Vector3::new(0.0, 0.0, -GRAVITY),
        rotor_speed: [0.0; 4],
        wind: Vector3::zeros(),
        power: 0.0,
        energy: 0.0,
    }
}

/// Mean and variance.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, variance)
}

/// That a standard deviation found in independent Gaussian values is the one declared, within
/// four standard errors of it.
#[track_caller]
fn assert_deviation(values: &[f64], declared: f64) {
    let (_, variance) = moments(values);
    let ratio = variance.sqrt() / declared;
    let bound = 4.0 / (2.0 * values.len() as f64).sqrt();
    assert!(
        (ratio - 1.0).abs() < bound,
        "{} of the declared {declared}, allowed ±{bound}",
        ratio
    );
}
