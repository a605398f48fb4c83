//! The shell that samples lie on: a sphere to begin with, then an ellipsoid, by weighted least
//! squares.
//!
//! Samples are taken about the centre of the shell before and in units of its size, so that all
//! unknowns are small and single precision is enough. The quadric is written as
//! x² + y² + z² = p·(x² + y² − 2z²) + q·(x² + z² − 2y²) + 2(r·xy + s·xz + t·yz) +
//! 2(u·x + v·y + w·z) + k: unlike "… = 1" it also holds for a surface that passes through the
//! origin.

use windhover_math::scalar::norm;
use windhover_math::{Matrix3, Vector3, sqrt};

use super::CompassCorrection;
use super::store::{CAPACITY, square};
use crate::calibration::solve::{NormalEquations, eigen};

/// An ellipsoid: all m with |shape·(m − centre)| = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shell {
    /// µT.
    pub(super) centre: Vector3,
    /// Symmetric and positive definite, 1/µT.
    shape: Matrix3,
}

/// How well samples lie on a shell, all as shares of its size.
pub(super) struct Quality {
    /// 85 of 100 samples lie as near as this, and half of the last ones.
    pub(super) spread: f32,
    /// Root mean square of those that lie as near.
    pub(super) residual: f32,
}

/// The share of samples that must lie on the shell.
const GOOD_SHARE: f32 = 0.85;
/// So many of the last samples are looked at by themselves: iron that moved late makes few
/// outliers, but they come one after the other.
const LAST: usize = 16;
/// Median distance below which samples are as good as exact.
const LEAST_MEDIAN: f32 = 1e-4;
/// From median distance to the distance at which a weight has fallen to a quarter: three standard
/// deviations of a normal distribution.
const WIDTH: f32 = 3.0 * 1.483;

/// The sphere nearest to the samples; around their mean where they do not determine one.
pub(super) fn sphere(samples: &[Vector3]) -> Shell {
    let count = windhover_math::max(samples.len(), 1) as f32;
    let mean = samples.iter().sum::<Vector3>() / count;
    let sum = samples.iter().map(|m| square(m - mean)).sum::<f32>();
    let size = windhover_math::max(sqrt(sum / count), 1.0);
    let mut equations = NormalEquations::<4>::new();
    for sample in samples {
        let v = (sample - mean) / size;
        // |v|² = 2 c·v + k
        equations.add(&[2.0 * v.x, 2.0 * v.y, 2.0 * v.z, 1.0], square(v), 1.0);
    }
    let [x, y, z, k] = equations.solve().unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let centre = Vector3::new(x, y, z);
    let radius = size * sqrt(k + square(centre));
    Shell {
        centre: mean + centre * size,
        shape: Matrix3::identity() / windhover_math::max(radius, 1.0),
    }
}

/// The quadric nearest to the samples, computed about the shell before; `None` if it is no
/// ellipsoid.
pub(super) fn quadric(samples: &[Vector3], weights: &[f32; CAPACITY], before: &Shell) -> Option<Shell> {
    let per_size = before.shape.trace() / 3.0;
    let mut equations = NormalEquations::<9>::new();
    for (sample, weight) in samples.iter().zip(weights) {
        let v = (sample - before.centre) * per_size;
        let (xx, yy, zz) = (v.x * v.x, v.y * v.y, v.z * v.z);
        let row = [
            xx + yy - 2.0 * zz,
            xx + zz - 2.0 * yy,
            2.0 * v.x * v.y,
            2.0 * v.x * v.z,
            2.0 * v.y * v.z,
            2.0 * v.x,
            2.0 * v.y,
            2.0 * v.z,
            1.0,
        ];
        equations.add(&row, xx + yy + zz, *weight);
    }
    let [p, q, xy, xz, yz, x, y, z, k] = equations.solve()?;
    #[rustfmt::skip]
    let matrix = Matrix3::new(
        1.0 - p - q, -xy, -xz,
        -xy, 1.0 - p + 2.0 * q, -yz,
        -xz, -yz, 1.0 - q + 2.0 * p,
    );
    ellipsoid(matrix, Vector3::new(x, y, z), k).map(|(centre, shape)| Shell {
        centre: before.centre + centre / per_size,
        shape: shape * per_size,
    })
}

/// Centre and shape of v·M·v − 2 l·v = k.
fn ellipsoid(matrix: Matrix3, linear: Vector3, k: f32) -> Option<(Vector3, Matrix3)> {
    let (values, vectors) = eigen(matrix);
    // A tenth of a per cent: an axis thirty times as long as the others.
    if !(values.x > 1e-3 && values.y > 1e-3 && values.z > 1e-3) {
        return None;
    }
    let turned = vectors.tr_mul(&linear);
    let centre = vectors * turned.component_div(&values);
    let size = k + centre.dot(&linear);
    if !(size > 1e-3 && size.is_finite()) {
        return None;
    }
    let roots = values.map(|value| sqrt(value / size));
    let shape = vectors * Matrix3::from_diagonal(&roots) * vectors.transpose();
    // Rounding leaves it not quite symmetric.
    Some((centre, (shape + shape.transpose()) * 0.5))
}

impl Shell {
    /// How far a sample lies from the shell, as a share of its size.
    fn distance(&self, sample: &Vector3) -> f32 {
        (norm(self.shape * (sample - self.centre)) - 1.0).abs()
    }

    /// Those of all samples; 0 beyond them.
    fn distances(&self, samples: &[Vector3]) -> [f32; CAPACITY] {
        let mut distances = [0.0; CAPACITY];
        for (distance, sample) in distances.iter_mut().zip(samples) {
            *distance = self.distance(sample);
        }
        distances
    }

    /// What each sample weighs in the next fit: 1 on the shell, next to nothing far from it.
    pub(super) fn weights(&self, samples: &[Vector3]) -> [f32; CAPACITY] {
        let mut weights = self.distances(samples);
        let median = quantile(weights.get(..samples.len()).unwrap_or(&[]), 0.5);
        let width = WIDTH * windhover_math::max(median, LEAST_MEDIAN);
        for weight in &mut weights {
            let ratio = *weight / width;
            let root = 1.0 / (1.0 + ratio * ratio);
            *weight = root * root;
        }
        weights
    }

    /// How well the samples lie on it.
    pub(super) fn quality(&self, samples: &[Vector3]) -> Quality {
        let all = self.distances(samples);
        let distances = all.get(..samples.len()).unwrap_or(&[]);
        let good = quantile(distances, GOOD_SHARE);
        let last = distances
            .get(distances.len().saturating_sub(LAST)..)
            .unwrap_or(&[]);
        let spread = windhover_math::max(good, quantile(last, 0.5));
        let (mut count, mut sum) = (0.0, 0.0);
        for distance in distances.iter().filter(|distance| **distance <= spread) {
            count += 1.0;
            sum += distance * distance;
        }
        Quality {
            spread,
            residual: sqrt(sum / windhover_math::max(count, 1.0)),
        }
    }

    /// The correction, with the strength of the corrected field (µT) and the ratio of the longest
    /// to the shortest axis. Of all the factors that soft iron may have, the mean of the diagonal
    /// is 1.
    pub(super) fn correction(&self) -> (CompassCorrection, f32, f32) {
        let strength = 3.0 / self.shape.trace();
        let (values, _) = eigen(self.shape);
        let longest = windhover_math::max(values.x, windhover_math::max(values.y, values.z));
        let shortest = windhover_math::min(values.x, windhover_math::min(values.y, values.z));
        let correction = CompassCorrection {
            offset: self.centre,
            soft: self.shape * strength,
        };
        (correction, strength, longest / shortest)
    }
}

/// The value that this share of the numbers does not exceed, by bisection, to 2⁻²⁰ of the largest.
fn quantile(numbers: &[f32], share: f32) -> f32 {
    let wanted = share * numbers.len() as f32;
    let (mut low, mut high) = (0.0, 0.0);
    for number in numbers {
        high = windhover_math::max(*number, high);
    }
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        let below = numbers.iter().filter(|number| **number <= middle).count();
        if below as f32 >= wanted {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::testing::Noise;

    /// If this failed, the weights would follow the outliers, or nothing.
    #[test]
    fn a_quantile_splits_the_numbers() {
        let numbers: [f32; 101] = core::array::from_fn(|i| (i * 37 % 101) as f32);
        for (share, value) in [(0.5, 50.0), (0.85, 85.0), (1.0, 100.0)] {
            assert!((quantile(&numbers, share) - value).abs() < 1e-3, "{share}");
        }
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    /// If this failed, a fit of exact samples would not be exact: the eight corners and six ends of
    /// an ellipsoid with axes 3, 4, 5 about (1, 2, 3).
    #[test]
    fn exact_samples_give_the_exact_ellipsoid() {
        let (axes, centre) = (Vector3::new(30.0, 40.0, 50.0), Vector3::new(10.0, 20.0, 30.0));
        let mut samples = [Vector3::zeros(); 14];
        for (i, sample) in samples.iter_mut().enumerate() {
            let sign = |bit: usize| if i & bit == 0 { 1.0 } else { -1.0 };
            let mut v = Vector3::new(sign(1), sign(2), sign(4)) / sqrt(3.0);
            if i >= 8 {
                v = Vector3::zeros();
                v[(i - 8) / 2] = sign(1);
            }
            *sample = centre + v.component_mul(&axes);
        }
        let shell = quadric(&samples, &[1.0; CAPACITY], &sphere(&samples)).unwrap();
        assert!(norm(shell.centre - centre) < 1e-4, "{shell:?}");
        let expected = Matrix3::from_diagonal(&axes.map(|axis| 1.0 / axis));
        assert!((shell.shape - expected).abs().max() < 1e-7, "{shell:?}");
    }

    /// If this failed, a flat ring of samples could move the centre anywhere along its axis.
    #[test]
    fn a_ring_has_no_sphere_and_no_ellipsoid() {
        let ring: [Vector3; 40] = core::array::from_fn(|i| {
            let (sin, cos) = windhover_math::sin_cos(i as f32 * 0.157);
            Vector3::new(5.0 + 30.0 * cos, 30.0 * sin, 12.0)
        });
        let sphere = sphere(&ring);
        assert!(
            norm(sphere.centre - Vector3::new(5.0, 0.0, 12.0)) < 0.5,
            "{sphere:?}"
        );
        assert_eq!(quadric(&ring, &[1.0; CAPACITY], &sphere), None);
    }

    /// If this failed, iron that moved when nearly all was done would be one outlier among others.
    #[test]
    fn the_last_samples_are_looked_at_by_themselves() {
        let mut noise = Noise::new(9);
        let mut samples = [Vector3::zeros(); CAPACITY];
        for sample in &mut samples {
            *sample = noise.direction() * 50.0;
        }
        let shell = Shell {
            centre: Vector3::zeros(),
            shape: Matrix3::identity() / 50.0,
        };
        assert!(shell.quality(&samples).spread < 1e-5);
        for sample in &mut samples[..10] {
            *sample *= 1.2;
        }
        assert!(shell.quality(&samples).spread < 1e-5);
        for sample in &mut samples[150..] {
            *sample *= 1.2;
        }
        assert!((shell.quality(&samples).spread - 0.2).abs() < 1e-5);
    }
}
