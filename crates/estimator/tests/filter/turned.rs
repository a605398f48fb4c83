//! World axes that turn: all that the filter believes turns along, and nothing else changes.

use windhover_estimator::measurement::{GnssPosition, GnssVelocity};
use windhover_estimator::{Filter, Refusal};
use windhover_math::{Quaternion, Vector3, max};

use crate::dense::{self, Column, Matrix};
use crate::flight::{Flight, Manoeuvre};

const ANGLE: f32 = 0.35;

fn turn() -> Quaternion {
    Quaternion::from_heading(ANGLE)
}

/// Of the error states: the first three groups are in the world's axes.
fn rotation() -> Matrix {
    let mut r = Matrix::identity();
    let (s, c) = (libm::sin(ANGLE.into()), libm::cos(ANGLE.into()));
    for k in [0, 3, 6] {
        (r[(k, k)], r[(k, k + 1)]) = (c, -s);
        (r[(k + 1, k)], r[(k + 1, k + 1)]) = (s, c);
    }
    r
}

/// Largest difference of the turned filter from the other one in turned axes, in standard deviations.
fn difference(filter: &Filter, turned: &Filter) -> f64 {
    let (from, to) = (filter.state(), turned.state());
    let wanted = turn() * from.attitude;
    let attitude = (to.attitude * wanted.conjugate()).shortest();
    let parts = [
        to.position - turn().rotate(from.position),
        to.velocity - turn().rotate(from.velocity),
        Vector3::new(attitude.x, attitude.y, attitude.z) * 2.0,
        to.gyro_bias - from.gyro_bias,
        to.accel_bias - from.accel_bias,
    ];
    let p = dense::of(turned.covariance());
    let off = Column::from_fn(|i, _| f64::from(parts[i / 3][i % 3]) / p[(i, i)].sqrt());
    let r = rotation();
    let exact = r * dense::of(filter.covariance()) * r.transpose();
    let spread = Matrix::from_fn(|i, j| (p[(i, j)] - exact[(i, j)]) / (p[(i, i)] * p[(j, j)]).sqrt());
    max(off.amax(), spread.amax())
}

#[test]
fn a_turned_filter_believes_the_same_in_other_axes_and_of_the_past_too() {
    for seed in 1..=5 {
        let mut flight = Flight::new(seed, Manoeuvre::Lively, 120_000);
        for _ in 0..2_000 + 7 * seed {
            flight.step();
        }
        let mut filter = flight.filter.clone();
        let mut turned = filter.clone();
        turned.turn(ANGLE).unwrap();
        let off = difference(&filter, &turned);
        assert!(off < 1e-3, "{off}");

        let time = flight.time - 120_000;
        let velocity = filter.state().velocity + Vector3::new(0.1, -0.05, 0.02);
        let measured = |velocity| GnssVelocity {
            time,
            velocity,
            deviation: 0.05,
        };
        filter.fuse_gnss_velocity(&measured(velocity)).unwrap();
        turned
            .fuse_gnss_velocity(&measured(turn().rotate(velocity)))
            .unwrap();
        let position = filter.state().position + Vector3::new(0.3, 0.2, -0.1);
        let measured = |position| GnssPosition {
            time,
            position,
            horizontal_deviation: 0.5,
            vertical_deviation: 1.0,
        };
        filter.fuse_gnss_position(&measured(position)).unwrap();
        turned
            .fuse_gnss_position(&measured(turn().rotate(position)))
            .unwrap();
        let off = difference(&filter, &turned);
        assert!(off < 0.02, "{off}");
    }
}

#[test]
fn what_is_no_bearing_turns_nothing() {
    let flight = Flight::new(1, Manoeuvre::Hover, 0);
    let mut turned = flight.filter.clone();
    assert_eq!(turned.turn(f32::NAN), Err(Refusal::NotFinite));
    assert_eq!(turned.turn(4.0), Err(Refusal::OutOfRange));
    assert_eq!(turned, flight.filter);
}
