//! Coverage: which of 24 equal parts of the sphere have been reached.
//!
//! A direction belongs to the face of a cube that its largest component points to, and on that face
//! to one of four squares by the signs of the other two. All 24 are alike. A vehicle that is turned
//! once around the vertical on each of its six sides, anywhere but at the equator, reaches them all.

use windhover_math::Vector3;

/// How many there are.
const COUNT: u8 = 24;
/// So many samples reach a cell.
const ENOUGH: u8 = 2;

/// A set of cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cells(u32);

impl Cells {
    /// The cells that enough of these samples lie in, seen from `centre`.
    pub(super) fn covered(samples: &[Vector3], centre: Vector3) -> Self {
        let mut counts = [0_u8; COUNT as usize];
        for sample in samples {
            if let Some(count) = counts.get_mut(usize::from(Self::index(sample - centre))) {
                *count = count.saturating_add(1);
            }
        }
        let reached = counts.iter().enumerate().filter(|(_, count)| **count >= ENOUGH);
        Self(reached.fold(0, |cells, (index, _)| cells | 1 << index))
    }

    /// The number of the cell of this direction, below 24.
    fn index(v: Vector3) -> u8 {
        let (x, y, z) = (v.x.abs(), v.y.abs(), v.z.abs());
        let (face, along, one, other) = if x >= y && x >= z {
            (0, v.x, v.y, v.z)
        } else if y >= z {
            (1, v.y, v.x, v.z)
        } else {
            (2, v.z, v.x, v.y)
        };
        face * 8 + u8::from(along > 0.0) * 4 + u8::from(one > 0.0) * 2 + u8::from(other > 0.0)
    }

    /// How many are in the set, of 24.
    pub fn count(self) -> u8 {
        self.0.count_ones() as u8
    }

    /// The cells that are not in the set.
    #[must_use]
    pub fn others(self) -> Self {
        Self(!self.0 & ((1 << COUNT) - 1))
    }

    /// The middle of each cell of the set: directions of the field in body axes, of length 1.
    pub fn directions(self) -> impl Iterator<Item = Vector3> {
        (0..COUNT)
            .filter(move |index| self.0 & (1 << index) != 0)
            .map(Self::middle)
    }

    fn middle(index: u8) -> Vector3 {
        // (2, 1, 1)/√6: 35° from the axis.
        let side = |bit: u8, size: f32| if index & bit != 0 { size } else { -size };
        let (along, one, other) = (side(4, 0.816_496_6), side(2, 0.408_248_3), side(1, 0.408_248_3));
        match index / 8 {
            0 => Vector3::new(along, one, other),
            1 => Vector3::new(one, along, other),
            _ => Vector3::new(one, other, along),
        }
    }
}

#[cfg(test)]
mod tests {
    use windhover_math::scalar::norm;

    use super::*;
    use crate::calibration::testing::Noise;

    /// If this failed, the human would be sent to directions that do not count.
    #[test]
    fn the_middle_of_a_cell_lies_in_it() {
        for (index, middle) in Cells(0xFF_FFFF).directions().enumerate() {
            assert_eq!(usize::from(Cells::index(middle)), index);
            assert!((norm(middle) - 1.0).abs() < 1e-6);
        }
    }

    /// If this failed, some directions would weigh more in the coverage than others.
    #[test]
    fn cells_are_equally_large() {
        let mut noise = Noise::new(3);
        let mut counts = [0; 24];
        for _ in 0..240_000 {
            counts[usize::from(Cells::index(noise.direction()))] += 1;
        }
        // Five standard deviations of a count of ten thousand.
        assert!(counts.iter().all(|n| (9_500..10_500).contains(n)), "{counts:?}");
    }

    /// If this failed, one stray sample could pass for coverage.
    #[test]
    fn a_cell_takes_two_samples() {
        let (once, centre) = ([Vector3::new(11.0, 3.0, 3.0)], Vector3::new(1.0, 2.0, 2.0));
        assert_eq!(Cells::covered(&once, centre).count(), 0);
        let twice = [once[0]; 2];
        assert_eq!(Cells::covered(&twice, centre).count(), 1);
        assert_eq!(Cells::covered(&twice, centre).others().count(), 23);
    }
}
