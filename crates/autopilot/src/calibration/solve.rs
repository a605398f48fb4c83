//! Small dense problems: weighted least squares by normal equations, eigenvectors of a symmetric 3×3
//! matrix. The callers scale their unknowns so that single precision is enough.

use windhover_math::{Matrix3, Vector3, sqrt};

/// The normal equations of `row · x = value`, over many weighted rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NormalEquations<const N: usize> {
    /// Lower triangle.
    matrix: [[f32; N]; N],
    right: [f32; N],
}

/// Pivot that counts as zero, as a share of the diagonal element that it was: what is left then is
/// rounding.
const LEAST_PIVOT: f32 = 1e-6;

impl<const N: usize> NormalEquations<N> {
    /// No rows.
    pub(super) fn new() -> Self {
        Self {
            matrix: [[0.0; N]; N],
            right: [0.0; N],
        }
    }

    /// One row more.
    pub(super) fn add(&mut self, row: &[f32; N], value: f32, weight: f32) {
        let lines = self.matrix.iter_mut().zip(&mut self.right).zip(row);
        for (i, ((line, right), factor)) in lines.enumerate() {
            let weighted = factor * weight;
            *right += weighted * value;
            for (element, other) in line.iter_mut().zip(row).take(i + 1) {
                *element += weighted * other;
            }
        }
    }

    /// The unknowns, by Cholesky's decomposition; `None` where the rows do not determine them.
    pub(super) fn solve(mut self) -> Option<[f32; N]> {
        let mut x = self.right;
        // Row by row: L, and L⁻¹ times the right side.
        for i in 0..N {
            let (above, rest) = self.matrix.split_at_mut_checked(i)?;
            let line = rest.first_mut()?;
            let mut square = 0.0;
            let mut known = 0.0;
            for (j, upper) in above.iter().enumerate() {
                let sum: f32 = line.iter().zip(upper).take(j).map(|(a, b)| a * b).sum();
                let element = line.get_mut(j)?;
                *element = (*element - sum) / upper.get(j)?;
                square += *element * *element;
                known += *element * x.get(j)?;
            }
            let diagonal = line.get_mut(i)?;
            let pivot = *diagonal - square;
            // Written so that what is not a number is no pivot.
            if !(pivot > LEAST_PIVOT * *diagonal && pivot.is_finite()) {
                return None;
            }
            *diagonal = sqrt(pivot);
            let value = x.get_mut(i)?;
            *value = (*value - known) / *diagonal;
        }
        self.solve_transposed(&mut x)?;
        Some(x)
    }

    /// Turns L⁻¹b into L⁻ᵀL⁻¹b.
    fn solve_transposed(&self, x: &mut [f32; N]) -> Option<()> {
        for i in (0..N).rev() {
            let line = self.matrix.get(i)?;
            let value = x.get(i)? / line.get(i)?;
            for (other, element) in x.iter_mut().zip(line).take(i) {
                *other -= element * value;
            }
            *x.get_mut(i)? = value;
        }
        Some(())
    }
}

/// Eigenvalues and, as columns, eigenvectors of a symmetric matrix, by Jacobi's rotations.
pub(super) fn eigen(symmetric: Matrix3) -> (Vector3, Matrix3) {
    let (mut matrix, mut vectors) = (symmetric, Matrix3::identity());
    // Convergence is quadratic: four sweeps reach single precision, two more cost nothing.
    for _ in 0..6 {
        rotate::<0, 1>(&mut matrix, &mut vectors);
        rotate::<0, 2>(&mut matrix, &mut vectors);
        rotate::<1, 2>(&mut matrix, &mut vectors);
    }
    (Vector3::new(matrix.m11, matrix.m22, matrix.m33), vectors)
}

/// Turns the plane of axes `P` and `Q` so that the element off the diagonal vanishes.
fn rotate<const P: usize, const Q: usize>(matrix: &mut Matrix3, vectors: &mut Matrix3) {
    let off = matrix[(P, Q)];
    if off == 0.0 {
        return;
    }
    // The smaller of the two angles: tangent t with t² + 2·t·cot − 1 = 0.
    let cot = (matrix[(Q, Q)] - matrix[(P, P)]) / (2.0 * off);
    let size = 1.0 / (cot.abs() + sqrt(cot * cot + 1.0));
    let tangent = if cot < 0.0 { -size } else { size };
    let cosine = 1.0 / sqrt(tangent * tangent + 1.0);
    let sine = tangent * cosine;
    let mut turn = Matrix3::identity();
    turn[(P, P)] = cosine;
    turn[(Q, Q)] = cosine;
    turn[(P, Q)] = sine;
    turn[(Q, P)] = -sine;
    *matrix = turn.transpose() * *matrix * turn;
    matrix[(P, Q)] = 0.0;
    matrix[(Q, P)] = 0.0;
    *vectors *= turn;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::testing::Noise;

    /// If this failed, fits would be wrong however good their samples: rows made from known unknowns
    /// must give them back.
    #[test]
    fn unknowns_that_made_the_rows_come_back() {
        let mut noise = Noise::new(1);
        for _ in 0..200 {
            let truth: [f32; 9] = core::array::from_fn(|_| noise.within(3.0));
            let mut equations = NormalEquations::<9>::new();
            for _ in 0..40 {
                let row: [f32; 9] = core::array::from_fn(|_| noise.within(1.0));
                let value = row.iter().zip(&truth).map(|(a, b)| a * b).sum();
                equations.add(&row, value, 0.5 + noise.within(0.4));
            }
            let found = equations.solve().unwrap();
            for (a, b) in found.iter().zip(&truth) {
                assert!((a - b).abs() < 2e-5, "{found:?} {truth:?}");
            }
        }
    }

    /// If this failed, a mean would not weigh its samples as it says.
    #[test]
    fn one_unknown_is_a_weighted_mean() {
        let mut equations = NormalEquations::<1>::new();
        equations.add(&[1.0], 10.0, 3.0);
        equations.add(&[1.0], 20.0, 1.0);
        assert_eq!(equations.solve(), Some([12.5]));
    }

    /// If this failed, samples that leave an unknown open would give it any value.
    #[test]
    fn rows_that_leave_an_unknown_open_are_refused() {
        let mut equations = NormalEquations::<3>::new();
        assert_eq!(equations.solve(), None);
        for i in 0..20 {
            let x = i as f32 * 0.1;
            equations.add(&[x, 1.0, 2.0 * x + 3.0], x, 1.0);
        }
        assert_eq!(equations.solve(), None);
        let mut equations = NormalEquations::<2>::new();
        equations.add(&[f32::NAN, 1.0], 1.0, 1.0);
        assert_eq!(equations.solve(), None);
    }

    /// If this failed, soft iron would get wrong axes: V·diag(λ)·Vᵀ must be the matrix, V orthogonal.
    #[test]
    fn eigenvectors_make_the_matrix_again() {
        let mut noise = Noise::new(2);
        for _ in 0..500 {
            let mut a = Matrix3::from_fn(|_, _| noise.within(1.0));
            a += a.transpose();
            let (values, vectors) = eigen(a);
            let again = vectors * Matrix3::from_diagonal(&values) * vectors.transpose();
            assert!((again - a).abs().max() < 3e-6, "{a} {again}");
            let unit = vectors.transpose() * vectors - Matrix3::identity();
            assert!(unit.abs().max() < 3e-6, "{vectors}");
        }
        let (values, vectors) = eigen(Matrix3::identity());
        assert_eq!((values, vectors), (Vector3::repeat(1.0), Matrix3::identity()));
    }
}
