//! The covariance of the fifteen error states, as the fifteen 3×3 blocks of its upper triangle.
//!
//! Error states, in this order: position, velocity, attitude, gyro bias, accelerometer bias. The
//! blocks below the diagonal do not exist, and the diagonal blocks are mirrored wherever they are
//! written, so that the matrix is symmetric by construction. Of all forms that were counted on a
//! Cortex-M4F this is the cheapest.
//!
//! - `predict`: P ← F P Fᵀ + Q, as three row operations in place.
//! - `column` and `update`: one scalar measurement.
//! - `bound`: decoupling, floor and ceiling.
//! - `turn`: other world axes.

pub(crate) mod block;
mod bound;
mod column;
mod predict;
mod turn;
mod update;

pub use bound::Limits;
pub(crate) use column::Column;
pub(crate) use predict::{Added, Transition};
pub(crate) use update::{Force, LateVelocity, Reference};

use block::{Block, ZERO};

/// Number of error states.
pub const STATES: usize = 15;

/// An axis of the frame in which a group of error states is written: north, east, down, or front,
/// right, down for the biases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// North or front.
    X = 0,
    /// East or right.
    Y = 1,
    /// Down.
    Z = 2,
}

impl Axis {
    /// All three.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];
}

/// A group of three error states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Position, NED, m.
    Position,
    /// Velocity, NED, m/s.
    Velocity,
    /// Attitude: the rotation vector in the world (NED) by which the truth is turned, rad.
    Attitude,
    /// Gyro bias, FRD, rad/s.
    GyroBias,
    /// Accelerometer bias, FRD, m/s².
    AccelBias,
}

impl Group {
    /// All five, in the order of the error states.
    pub const ALL: [Self; 5] = [
        Self::Position,
        Self::Velocity,
        Self::Attitude,
        Self::GyroBias,
        Self::AccelBias,
    ];
}

/// The covariance. Block names: `p`osition, `v`elocity, `a`ttitude, `g`yro bias, accelerometer
/// `b`ias.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Covariance {
    pp: Block,
    pv: Block,
    pa: Block,
    pg: Block,
    pb: Block,
    vv: Block,
    va: Block,
    vg: Block,
    vb: Block,
    aa: Block,
    ag: Block,
    ab: Block,
    gg: Block,
    gb: Block,
    bb: Block,
    repairs: u32,
}

impl Covariance {
    /// Uncorrelated, with these variances, in the order of the error states.
    pub fn diagonal(variances: &[[f32; 3]; 5]) -> Self {
        let d = |v: [f32; 3]| [[v[0], 0.0, 0.0], [0.0, v[1], 0.0], [0.0, 0.0, v[2]]];
        let [p, v, a, g, b] = *variances;
        Self {
            pp: d(p),
            vv: d(v),
            aa: d(a),
            gg: d(g),
            bb: d(b),
            ..Self::default()
        }
    }

    /// The three variances of a group.
    #[inline]
    pub fn variances(&self, group: Group) -> [f32; 3] {
        let m = match group {
            Group::Position => &self.pp,
            Group::Velocity => &self.vv,
            Group::Attitude => &self.aa,
            Group::GyroBias => &self.gg,
            Group::AccelBias => &self.bb,
        };
        [m[0][0], m[1][1], m[2][2]]
    }

    /// The blocks of the upper triangle, row of blocks by row of blocks.
    fn blocks(&self) -> [[&Block; 5]; 5] {
        let z = &ZERO;
        [
            [&self.pp, &self.pv, &self.pa, &self.pg, &self.pb],
            [z, &self.vv, &self.va, &self.vg, &self.vb],
            [z, z, &self.aa, &self.ag, &self.ab],
            [z, z, z, &self.gg, &self.gb],
            [z, z, z, z, &self.bb],
        ]
    }

    /// The whole matrix, both triangles: for logs and tests.
    pub fn to_rows(&self) -> [[f32; STATES]; STATES] {
        let blocks = self.blocks();
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                if i / 3 <= j / 3 {
                    blocks[i / 3][j / 3][i % 3][j % 3]
                } else {
                    blocks[j / 3][i / 3][j % 3][i % 3]
                }
            })
        })
    }

    /// From a symmetric matrix, of which the upper triangle is read: for tests.
    pub fn from_rows(rows: &[[f32; STATES]; STATES]) -> Self {
        let block = |a: usize, b: usize| {
            core::array::from_fn(|i| {
                core::array::from_fn(|j| {
                    let (i, j) = (3 * a + i, 3 * b + j);
                    if i <= j { rows[i][j] } else { rows[j][i] }
                })
            })
        };
        Self {
            pp: block(0, 0),
            pv: block(0, 1),
            pa: block(0, 2),
            pg: block(0, 3),
            pb: block(0, 4),
            vv: block(1, 1),
            va: block(1, 2),
            vg: block(1, 3),
            vb: block(1, 4),
            aa: block(2, 2),
            ag: block(2, 3),
            ab: block(2, 4),
            gg: block(3, 3),
            gb: block(3, 4),
            bb: block(4, 4),
            repairs: 0,
        }
    }
}
