//! Full matrices in double precision.

use nalgebra::SMatrix;
use windhover_estimator::covariance::{Covariance, STATES};

use crate::random::Random;

pub type Matrix = SMatrix<f64, STATES, STATES>;
pub type Column = SMatrix<f64, STATES, 1>;

/// Standard deviations of a filter in flight, in the order of the error states.
pub const SCALES: [f64; STATES] = [
    2.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.05, 0.05, 0.2, 0.01, 0.01, 0.01, 0.1, 0.1, 0.1,
];

pub fn of(covariance: &Covariance) -> Matrix {
    let rows = covariance.to_rows();
    Matrix::from_fn(|i, j| f64::from(rows[i][j]))
}

/// A random covariance of realistic scales, as the filter can hold it.
pub fn random(random: &mut Random) -> Covariance {
    let mut l = Matrix::zeros();
    for i in 0..STATES {
        for j in 0..=i {
            let entry = if i == j {
                0.3 + random.share()
            } else {
                0.4 * random.either()
            };
            l[(i, j)] = entry * SCALES[i];
        }
    }
    let p = l * l.transpose();
    Covariance::from_rows(&core::array::from_fn(|i| {
        core::array::from_fn(|j| p[(i, j)] as f32)
    }))
}

/// Largest difference in units of the standard deviations of `exact`.
pub fn difference(found: &Matrix, exact: &Matrix) -> f64 {
    let mut worst = 0.0;
    for i in 0..STATES {
        for j in 0..STATES {
            let scale = libm::sqrt(exact[(i, i)] * exact[(j, j)]);
            worst = windhover_math::max(worst, (found[(i, j)] - exact[(i, j)]).abs() / scale);
        }
    }
    worst
}

/// P − P Hᵀ H P/S.
pub fn update(p: &Matrix, h: &Column, noise: f64) -> Matrix {
    let c = p * h;
    let s = h.dot(&c) + noise;
    p - c * c.transpose() / s
}

/// The smallest pivot of the correlation matrix: positive if and only if it is positive definite.
pub fn smallest_pivot(p: &Matrix) -> f64 {
    let d = Column::from_fn(|i, _| libm::sqrt(p[(i, i)]));
    let mut a = Matrix::from_fn(|i, j| p[(i, j)] / (d[i] * d[j]));
    let mut smallest = f64::INFINITY;
    for k in 0..STATES {
        let pivot = a[(k, k)];
        smallest = if pivot < smallest { pivot } else { smallest };
        for i in k + 1..STATES {
            let factor = a[(i, k)] / pivot;
            for j in k..STATES {
                a[(i, j)] -= factor * a[(k, j)];
            }
        }
    }
    smallest
}
