//! The covariance in world axes that are turned about down.

use windhover_math::sin_cos;

use super::Covariance;
use super::block::{Block, mirror};

/// R M, where R turns about the third axis by the angle with this sine and cosine.
fn turn_rows(m: &mut Block, (sin, cos): (f32, f32)) {
    let [north, east, _] = m;
    for (n, e) in north.iter_mut().zip(east) {
        (*n, *e) = (cos * *n - sin * *e, sin * *n + cos * *e);
    }
}

/// M Rᵀ.
fn turn_columns(m: &mut Block, (sin, cos): (f32, f32)) {
    for [n, e, _] in m {
        (*n, *e) = (cos * *n - sin * *e, sin * *n + cos * *e);
    }
}

impl Covariance {
    /// P ← R P Rᵀ: the errors of position, velocity and attitude turn by `angle`, rad, about down,
    /// east of north positive. Biases are in body axes and stay.
    pub(crate) fn turn(&mut self, angle: f32) {
        let by = sin_cos(angle);
        let s = self;
        for block in [
            &mut s.pp, &mut s.pv, &mut s.pa, &mut s.pg, &mut s.pb, &mut s.vv, &mut s.va, &mut s.vg,
            &mut s.vb, &mut s.aa, &mut s.ag, &mut s.ab,
        ] {
            turn_rows(block, by);
        }
        for block in [&mut s.pp, &mut s.pv, &mut s.pa, &mut s.vv, &mut s.va, &mut s.aa] {
            turn_columns(block, by);
        }
        for diagonal in [&mut s.pp, &mut s.vv, &mut s.aa] {
            mirror(diagonal);
        }
    }
}
