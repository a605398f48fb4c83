//! What keeps variances positive and finite: decoupling of single states, floor and ceiling.

use windhover_math::max;

use super::block::{Block, set_column};
use super::{Axis, Covariance, Group};

/// Between what bounds the variances of a group stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest variance.
    pub floor: f32,
    /// Largest variance: a state that reaches it is as good as unknown.
    pub ceiling: f32,
}

impl Limits {
    /// Bounds for a group, as standard deviations: what no sensor of this class can tell apart,
    /// and what no flight can reach.
    pub const fn of(group: Group) -> Self {
        let (smallest, largest) = match group {
            Group::Position => (1e-4, 1e5),
            Group::Velocity => (1e-4, 1e3),
            Group::Attitude => (1e-5, 3.0),
            Group::GyroBias => (1e-6, 1.0),
            Group::AccelBias => (1e-5, 10.0),
        };
        Self {
            floor: smallest * smallest,
            ceiling: largest * largest,
        }
    }
}

impl Covariance {
    /// Adds to the variance of a state; what it has to do with the others stays.
    pub(crate) fn widen(&mut self, group: Group, axis: Axis, more: f32) {
        let k = axis as usize;
        let (_, _, diagonal) = self.blocks_of(group);
        diagonal[k][k] = windhover_math::min(diagonal[k][k] + more, Limits::of(group).ceiling);
    }

    /// Forgets what a state has to do with the others, and gives it this variance.
    pub(crate) fn decouple(&mut self, group: Group, axis: Axis, variance: f32) {
        let k = axis as usize;
        let (row, column, diagonal) = self.blocks_of(group);
        for block in row.into_iter().flatten() {
            block[k] = [0.0; 3];
        }
        for block in column.into_iter().flatten() {
            set_column(block, k, [0.0; 3]);
        }
        diagonal[k] = [0.0; 3];
        set_column(diagonal, k, [0.0; 3]);
        diagonal[k][k] = variance;
    }

    /// Blocks right of a group's diagonal block, blocks above it, and itself.
    #[allow(clippy::type_complexity)]
    fn blocks_of(&mut self, group: Group) -> ([Option<&mut Block>; 4], [Option<&mut Block>; 4], &mut Block) {
        let s = self;
        match group {
            Group::Position => (
                [Some(&mut s.pv), Some(&mut s.pa), Some(&mut s.pg), Some(&mut s.pb)],
                [None, None, None, None],
                &mut s.pp,
            ),
            Group::Velocity => (
                [Some(&mut s.va), Some(&mut s.vg), Some(&mut s.vb), None],
                [Some(&mut s.pv), None, None, None],
                &mut s.vv,
            ),
            Group::Attitude => (
                [Some(&mut s.ag), Some(&mut s.ab), None, None],
                [Some(&mut s.pa), Some(&mut s.va), None, None],
                &mut s.aa,
            ),
            Group::GyroBias => (
                [Some(&mut s.gb), None, None, None],
                [Some(&mut s.pg), Some(&mut s.vg), Some(&mut s.ag), None],
                &mut s.gg,
            ),
            Group::AccelBias => (
                [None, None, None, None],
                [Some(&mut s.pb), Some(&mut s.vb), Some(&mut s.ab), Some(&mut s.gb)],
                &mut s.bb,
            ),
        }
    }

    /// Whether a variance is below zero: the sign bits of all fifteen at once.
    #[inline(always)]
    pub(super) fn has_negative_variance(&self) -> bool {
        let signs = |m: &Block| m[0][0].to_bits() | m[1][1].to_bits() | m[2][2].to_bits();
        let all = signs(&self.pp) | signs(&self.vv) | signs(&self.aa) | signs(&self.gg) | signs(&self.bb);
        all >> 31 != 0
    }

    /// Keeps the variances, within their bounds, and nothing else.
    #[cold]
    pub(super) fn forget_correlations(&mut self) {
        let repairs = self.repairs.saturating_add(1);
        let kept = Group::ALL.map(|group| {
            let limits = Limits::of(group);
            self.variances(group).map(|variance| {
                if variance <= limits.ceiling {
                    max(limits.floor, variance)
                } else {
                    limits.ceiling
                }
            })
        });
        *self = Self::diagonal(&kept);
        self.repairs = repairs;
    }

    /// How often correlations were forgotten since rounding had spoiled them. Never in a flight
    /// with sensors as they are; see the tests.
    pub fn repairs(&self) -> u32 {
        self.repairs
    }

    /// Whether every variance is positive and every entry finite.
    pub(crate) fn is_sound(&self) -> bool {
        let positive = Group::ALL
            .iter()
            .all(|group| self.variances(*group).iter().all(|v| *v > 0.0));
        positive && self.to_rows().iter().flatten().all(|entry| entry.is_finite())
    }

    /// Whether one variance is within its bounds.
    #[inline(always)]
    pub(crate) fn is_bounded(&self, group: Group, axis: Axis) -> bool {
        let limits = Limits::of(group);
        let variance = self.variances(group)[axis as usize];
        variance >= limits.floor && variance <= limits.ceiling
    }

    /// Brings one variance within its bounds.
    pub(crate) fn bound(&mut self, group: Group, axis: Axis) {
        let limits = Limits::of(group);
        let k = axis as usize;
        let variance = self.variances(group)[k];
        if variance < limits.floor {
            let (_, _, diagonal) = self.blocks_of(group);
            diagonal[k][k] = limits.floor;
        } else if variance > limits.ceiling || variance.is_nan() {
            self.decouple(group, axis, limits.ceiling);
        }
    }
}
