//! Whether the filter errs by as much as it says: the normalised estimation error squared
//! (Bar-Shalom, Li and Kirubarajan, *Estimation with Applications to Tracking and Navigation*,
//! section 5.4.2), over 100 seeded flights.

use nalgebra::{Matrix3, Vector3};

use crate::dense;
use crate::flight::{Flight, Manoeuvre};

const RUNS: u64 = 100;

/// Bounds of χ² with 300 degrees of freedom, 2.5 % on either side, over 100 runs.
const BOUNDS: (f64, f64) = (2.5391, 3.4987);

/// eᵀ P⁻¹ e of three of the error states.
fn normalised(p: &dense::Matrix, e: &dense::Column, from: usize) -> f64 {
    let block = Matrix3::from_fn(|i, j| p[(from + i, from + j)]);
    let e = Vector3::new(e[from], e[from + 1], e[from + 2]);
    let [a, b, c] = [block.row(0), block.row(1), block.row(2)].map(|row| row.transpose());
    let determinant = a.dot(&b.cross(&c));
    let adjugate = Matrix3::from_rows(&[
        b.cross(&c).transpose(),
        c.cross(&a).transpose(),
        a.cross(&b).transpose(),
    ]);
    // Symmetric, so the transposed cofactors are the inverse as they stand.
    e.dot(&(adjugate * e)) / determinant
}

/// Shares of epochs within the bounds, for position, velocity and attitude, and the means.
fn shares(manoeuvre: Manoeuvre, latency: u64, seconds: usize) -> ([f64; 3], [f64; 3]) {
    let epochs = seconds * 10;
    let mut sums = vec![[0.0; 3]; epochs];
    for seed in 1..=RUNS {
        let mut flight = Flight::new(seed, manoeuvre, latency);
        for sum in &mut sums {
            for _ in 0..25 {
                flight.step();
            }
            let p = dense::of(flight.filter.covariance());
            let e = flight.errors();
            for k in 0..3 {
                sum[k] += normalised(&p, &e, 3 * k) / RUNS as f64;
            }
        }
    }
    let inside = |k: usize| {
        let within = sums.iter().filter(|sum| sum[k] > BOUNDS.0 && sum[k] < BOUNDS.1);
        within.count() as f64 / epochs as f64
    };
    let mean = |k: usize| sums.iter().map(|sum| sum[k]).sum::<f64>() / (3 * epochs) as f64;
    ([inside(0), inside(1), inside(2)], [mean(0), mean(1), mean(2)])
}

fn check(manoeuvre: Manoeuvre, latency: u64) {
    let (shares, means) = shares(manoeuvre, latency, 40);
    println!("position, velocity, attitude: inside {shares:.3?}, mean per degree of freedom {means:.3?}");
    assert!(shares.iter().all(|share| *share >= 0.9), "{shares:?} {means:?}");
}

#[test]
fn lively_without_latency() {
    check(Manoeuvre::Lively, 0);
}

#[test]
fn lively_with_a_receiver_that_is_120_ms_late() {
    check(Manoeuvre::Lively, 120_000);
}

#[test]
fn hover_with_a_receiver_that_is_120_ms_late() {
    check(Manoeuvre::Hover, 120_000);
}
