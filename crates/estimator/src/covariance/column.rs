//! Columns of the covariance: of a state, and of the sums of states that sensors measure.

use super::block::{Row, add_row, column, product, scaled, set_column};
use super::{Axis, Covariance};

/// Covariance of every error state with one scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) p: Row,
    pub(crate) v: Row,
    pub(crate) a: Row,
    pub(crate) g: Row,
    pub(crate) b: Row,
}

impl Column {
    #[inline(always)]
    pub(super) fn scaled(&self, s: f32) -> Self {
        Self {
            p: scaled(self.p, s),
            v: scaled(self.v, s),
            a: scaled(self.a, s),
            g: scaled(self.g, s),
            b: scaled(self.b, s),
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, s: f32, other: &Self) {
        add_row(&mut self.p, s, other.p);
        add_row(&mut self.v, s, other.v);
        add_row(&mut self.a, s, other.a);
        add_row(&mut self.g, s, other.g);
        add_row(&mut self.b, s, other.b);
    }
}

impl Covariance {
    #[inline(always)]
    pub(super) fn position_column(&self, axis: Axis) -> Column {
        let k = axis as usize;
        Column {
            p: self.pp[k],
            v: self.pv[k],
            a: self.pa[k],
            g: self.pg[k],
            b: self.pb[k],
        }
    }

    #[inline(always)]
    pub(super) fn velocity_column(&self, axis: Axis) -> Column {
        let k = axis as usize;
        Column {
            p: column(&self.pv, k),
            v: self.vv[k],
            a: self.va[k],
            g: self.vg[k],
            b: self.vb[k],
        }
    }

    #[inline(always)]
    pub(super) fn set_position_column(&mut self, axis: Axis, c: &Column) {
        let k = axis as usize;
        set_column(&mut self.pp, k, c.p);
        self.pp[k] = c.p;
        self.pv[k] = c.v;
        self.pa[k] = c.a;
        self.pg[k] = c.g;
        self.pb[k] = c.b;
    }

    #[inline(always)]
    pub(super) fn set_velocity_column(&mut self, axis: Axis, c: &Column) {
        let k = axis as usize;
        set_column(&mut self.pv, k, c.p);
        set_column(&mut self.vv, k, c.v);
        self.vv[k] = c.v;
        self.va[k] = c.a;
        self.vg[k] = c.g;
        self.vb[k] = c.b;
    }

    #[inline(always)]
    pub(super) fn attitude_column(&self, axis: Axis) -> Column {
        let k = axis as usize;
        Column {
            p: column(&self.pa, k),
            v: column(&self.va, k),
            a: self.aa[k],
            g: self.ag[k],
            b: self.ab[k],
        }
    }

    #[inline(always)]
    pub(super) fn gyro_bias_column(&self, axis: Axis) -> Column {
        let k = axis as usize;
        Column {
            p: column(&self.pg, k),
            v: column(&self.vg, k),
            a: column(&self.ag, k),
            g: self.gg[k],
            b: self.gb[k],
        }
    }

    #[inline(always)]
    pub(super) fn set_attitude_column(&mut self, axis: Axis, c: &Column) {
        let k = axis as usize;
        set_column(&mut self.pa, k, c.p);
        set_column(&mut self.va, k, c.v);
        set_column(&mut self.aa, k, c.a);
        self.aa[k] = c.a;
        self.ag[k] = c.g;
        self.ab[k] = c.b;
    }

    #[inline(always)]
    pub(super) fn set_gyro_bias_column(&mut self, axis: Axis, c: &Column) {
        let k = axis as usize;
        set_column(&mut self.pg, k, c.p);
        set_column(&mut self.vg, k, c.v);
        set_column(&mut self.ag, k, c.a);
        set_column(&mut self.gg, k, c.g);
        self.gg[k] = c.g;
        self.gb[k] = c.b;
    }

    /// Covariance with h · attitude error. By columns, so that a coefficient of 1 costs nothing.
    #[inline(always)]
    pub(super) fn direction_column(&self, h: Row) -> Column {
        let mut c = self.attitude_column(Axis::Z).scaled(h[2]);
        c.add(h[0], &self.attitude_column(Axis::X));
        c.add(h[1], &self.attitude_column(Axis::Y));
        c
    }

    /// Covariance with h · error of the accelerometer bias.
    #[inline(always)]
    pub(super) fn bias_column(&self, h: Row) -> Column {
        Column {
            p: product(&self.pb, h),
            v: product(&self.vb, h),
            a: product(&self.ab, h),
            g: product(&self.gb, h),
            b: product(&self.bb, h),
        }
    }
}
