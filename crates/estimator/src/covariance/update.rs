//! One scalar measurement z = H x + noise of variance R: P ← P − c cᵀ/S, x ← x ⊕ c y/S.
//!
//! c = P Hᵀ is a [`Column`], S = H c + R the variance of the innovation y. Measurements that see a
//! single state, or position by way of a past one, then have row and column of that state
//! overwritten with the exact result c R/S: where R is much smaller than P the subtraction would
//! leave nothing but rounding (P = 1e6, R = 1e-4 would give 0).

use windhover_math::max;

use super::block::{Row, add_outer, add_outer_symmetric, dot, product, scaled};
use super::column::Column;
use super::{Axis, Covariance};
use crate::state::State;

/// The states that are measured directly, one axis at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reference {
    /// Position as it was `lag` seconds ago, which is position − lag · velocity.
    Position { lag: f32 },
    /// Velocity.
    Velocity,
    /// Attitude error.
    Attitude,
    /// Gyro bias.
    GyroBias,
}

/// How a past velocity differs from the present one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LateVelocity {
    /// Coefficients of the attitude error about the other two axes.
    pub(crate) attitude: [(Axis, f32); 2],
    /// Coefficients of the error of the accelerometer bias.
    pub(crate) bias: Row,
    /// Process noise since then, m²/s².
    pub(crate) since: f32,
    /// Half of the time since then, s: what its mean has moved the position by for each m/s.
    pub(crate) half_lag: f32,
}

/// How a component of the specific force depends on errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Force {
    /// The axis of the attitude error, with its coefficient.
    pub(crate) tilt: Option<(Axis, f32)>,
    /// Coefficients of the error of the accelerometer bias.
    pub(crate) bias: Row,
}

/// Least share of a variance that one measurement leaves. `f32` has seven digits: what is left of
/// a larger cut is rounding, and correlations beyond ±1 come of it. A better measurement counts
/// as one of this share, and the next one does the rest.
const LEAST_LEFT: f32 = 1e-6;

/// What a measurement is worth.
#[derive(Clone, Copy)]
struct Weight {
    /// 1/S.
    gain: f32,
    /// R, as far as `f32` can follow.
    noise: f32,
}

/// From H P Hᵀ and R; nothing if they are no variances. `scale` is what H P Hᵀ would be without
/// correlations: the size of the terms that it is the sum of, and of whose digits it consists.
#[inline(always)]
fn weigh(variance: f32, scale: f32, noise: f32) -> Option<Weight> {
    let noise = max(LEAST_LEFT * scale, noise);
    let whole = max(variance, 0.0) + noise;
    (noise > 0.0 && whole < f32::MAX).then(|| Weight {
        gain: 1.0 / whole,
        noise,
    })
}

impl Covariance {
    /// Variance of what is measured directly.
    #[inline(always)]
    pub(crate) fn variance(&self, reference: Reference, axis: Axis) -> f32 {
        let k = axis as usize;
        match reference {
            Reference::Position { lag } => {
                self.pp[k][k] - lag * (self.pv[k][k] + self.pv[k][k]) + lag * lag * self.vv[k][k]
            }
            Reference::Velocity => self.vv[k][k],
            Reference::Attitude => self.aa[k][k],
            Reference::GyroBias => self.gg[k][k],
        }
    }

    #[inline(always)]
    fn weigh_direct(&self, reference: Reference, axis: Axis, noise: f32) -> Option<Weight> {
        let k = axis as usize;
        let variance = self.variance(reference, axis);
        let scale = match reference {
            Reference::Position { lag } => self.pp[k][k] + lag * lag * self.vv[k][k],
            _ => variance,
        };
        weigh(variance, scale, noise)
    }

    /// Variance of h · attitude error without correlations.
    #[inline(always)]
    fn attitude_scale(&self, h: Row) -> f32 {
        h[0] * h[0] * self.aa[0][0] + h[1] * h[1] * self.aa[1][1] + h[2] * h[2] * self.aa[2][2]
    }

    /// Variance of hb · error of the accelerometer bias without correlations.
    #[inline(always)]
    fn bias_scale(&self, hb: Row) -> f32 {
        hb[0] * hb[0] * self.bb[0][0] + hb[1] * hb[1] * self.bb[1][1] + hb[2] * hb[2] * self.bb[2][2]
    }

    /// Takes in a direct measurement.
    #[inline(always)]
    pub(crate) fn fuse_direct(
        &mut self,
        state: &mut State,
        reference: Reference,
        axis: Axis,
        innovation: f32,
        noise: f32,
    ) {
        let Some(Weight { gain, noise }) = self.weigh_direct(reference, axis, noise) else {
            return;
        };
        match reference {
            Reference::Position { lag } => {
                let mut c = self.position_column(axis);
                if lag > 0.0 {
                    c.add(-lag, &self.velocity_column(axis));
                }
                self.apply(state, &c, gain, innovation);
                // H P after the update is c R/S; H is the row of position − lag · velocity.
                let mut row = c.scaled(noise * gain);
                if lag > 0.0 {
                    row.add(lag, &self.velocity_column(axis));
                    // In the row itself stands (position, position), which takes lag · (v, p) as
                    // it will be: the entry just computed.
                    let k = axis as usize;
                    row.p[k] += lag * (row.v[k] - self.pv[k][k]);
                }
                self.set_position_column(axis, &row);
            }
            Reference::Velocity => {
                let c = self.velocity_column(axis);
                self.apply(state, &c, gain, innovation);
                self.set_velocity_column(axis, &c.scaled(noise * gain));
            }
            Reference::Attitude => {
                let c = self.attitude_column(axis);
                self.apply(state, &c, gain, innovation);
                self.set_attitude_column(axis, &c.scaled(noise * gain));
            }
            Reference::GyroBias => {
                let c = self.gyro_bias_column(axis);
                self.apply(state, &c, gain, innovation);
                self.set_gyro_bias_column(axis, &c.scaled(noise * gain));
            }
        }
    }

    /// Variance of h · attitude error.
    #[inline(always)]
    pub(crate) fn direction_variance(&self, h: Row) -> f32 {
        // As in the column, so that it is computed once.
        dot(h, self.direction_column(h).a)
    }

    /// Takes in a measurement of h · attitude error.
    #[inline(always)]
    pub(crate) fn fuse_direction(&mut self, state: &mut State, h: Row, innovation: f32, noise: f32) {
        let c = self.direction_column(h);
        if let Some(Weight { gain, .. }) = weigh(dot(h, c.a), self.attitude_scale(h), noise) {
            self.apply(state, &c, gain, innovation);
        }
    }

    /// Variance of a force.
    #[inline(always)]
    pub(crate) fn force_variance(&self, force: &Force) -> f32 {
        let hb = force.bias;
        let bias = dot(hb, product(&self.bb, hb));
        let Some((axis, h)) = force.tilt else {
            return bias;
        };
        let k = axis as usize;
        h * h * self.aa[k][k] + 2.0 * h * dot(self.ab[k], hb) + bias
    }

    /// Takes in a measurement of a force.
    #[inline(always)]
    pub(crate) fn fuse_force(&mut self, state: &mut State, force: &Force, innovation: f32, noise: f32) {
        let hb = force.bias;
        let mut c = self.bias_column(hb);
        let mut scale = self.bias_scale(hb);
        let mut variance = 0.0;
        if let Some((axis, h)) = force.tilt {
            let k = axis as usize;
            c.add(h, &self.attitude_column(axis));
            scale += h * h * self.aa[k][k];
            variance = h * c.a[k];
        }
        if let Some(Weight { gain, .. }) = weigh(variance + dot(hb, c.b), scale, noise) {
            self.apply(state, &c, gain, innovation);
        }
    }

    /// Takes in a velocity that is no longer the present one: velocity of the axis + what turns it
    /// + hb · error of the accelerometer bias, less the process noise of variance `since`.
    #[inline(always)]
    pub(crate) fn fuse_late_velocity(
        &mut self,
        state: &mut State,
        axis: Axis,
        late: &LateVelocity,
        innovation: f32,
        noise: f32,
    ) {
        let ([(i, hi), (j, hj)], hb) = (late.attitude, late.bias);
        let k = axis as usize;
        let mut c = self.bias_column(hb);
        c.add(hi, &self.attitude_column(i));
        c.add(hj, &self.attitude_column(j));
        c.add(1.0, &self.velocity_column(axis));
        // The process noise since then is in the present velocity, and in the position.
        c.v[k] -= late.since;
        c.p[k] -= late.since * late.half_lag;
        let (i, j) = (i as usize, j as usize);
        let variance = c.v[k] + hi * c.a[i] + hj * c.a[j] + dot(hb, c.b);
        let turning = hi * hi * self.aa[i][i] + hj * hj * self.aa[j][j];
        let scale = self.vv[k][k] + turning + self.bias_scale(hb);
        if let Some(Weight { gain, .. }) = weigh(variance, scale, noise) {
            self.apply(state, &c, gain, innovation);
        }
    }

    /// P ← P − gain c cᵀ, x ← x ⊕ gain · innovation · c. Not inlined: every measurement comes here.
    ///
    /// A true covariance has gain c_j² ≤ P_jj. Where rounding has spoiled it, a variance would
    /// become negative: then the measurement is left out and correlations are forgotten. With
    /// that, no correction is larger than the gate times the state's own standard deviation.
    #[inline(never)]
    fn apply(&mut self, state: &mut State, c: &Column, gain: f32, innovation: f32) {
        let k = scaled(c.p, -gain);
        add_outer_symmetric(&mut self.pp, k, c.p);
        add_outer(&mut self.pv, k, c.v);
        add_outer(&mut self.pa, k, c.a);
        add_outer(&mut self.pg, k, c.g);
        add_outer(&mut self.pb, k, c.b);
        let k = scaled(c.v, -gain);
        add_outer_symmetric(&mut self.vv, k, c.v);
        add_outer(&mut self.va, k, c.a);
        add_outer(&mut self.vg, k, c.g);
        add_outer(&mut self.vb, k, c.b);
        let k = scaled(c.a, -gain);
        add_outer_symmetric(&mut self.aa, k, c.a);
        add_outer(&mut self.ag, k, c.g);
        add_outer(&mut self.ab, k, c.b);
        let k = scaled(c.g, -gain);
        add_outer_symmetric(&mut self.gg, k, c.g);
        add_outer(&mut self.gb, k, c.b);
        let k = scaled(c.b, -gain);
        add_outer_symmetric(&mut self.bb, k, c.b);
        if self.has_negative_variance() {
            self.forget_correlations();
        } else {
            state.inject(c, gain * innovation);
        }
    }
}
