//! The covariance from one interval to the next: P ← F P Fᵀ + Q.
//!
//! With the attitude error in the world (Solà, *Quaternion kinematics for the error-state Kalman
//! filter*, 2017, section 7, eq. 309 and following) the transition of the errors is, to first
//! order in the interval's length dt,
//!
//! - δp ← δp + δv dt
//! - δv ← δv + δθ × (f dt) − R δb_a dt, with f the specific force in the world
//! - δθ ← δθ − R δb_g dt
//!
//! and the biases stay. δθ itself does not turn with the body, and both biases enter by the same
//! nine numbers: that is what makes it cheap. F is applied as three row operations in place, each
//! followed by its mirror on the columns; no product of full matrices is formed.

use super::Covariance;
use super::block::{Block, Row, add, add_diagonal, add_transposed, column, from_columns, mirror, scaled};

/// What the interval does to errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transition {
    /// Integral of the specific force, NED, m/s.
    pub(crate) force: Row,
    /// −R dt, with R from body to world.
    pub(crate) turn: Block,
    /// Length, s.
    pub(crate) duration: f32,
}

/// Variance that an interval adds, per group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Added {
    pub(crate) velocity: f32,
    pub(crate) attitude: f32,
    pub(crate) gyro_bias: f32,
    pub(crate) accel_bias: f32,
}

impl Transition {
    /// x + a × force + turn b: what attitude error a and accelerometer bias b do to velocity x.
    #[inline(always)]
    fn on_velocity(&self, x: Row, a: Row, b: Row) -> Row {
        let (f, m) = (&self.force, &self.turn);
        [
            x[0] + a[1] * f[2] - a[2] * f[1] + m[0][0] * b[0] + m[0][1] * b[1] + m[0][2] * b[2],
            x[1] + a[2] * f[0] - a[0] * f[2] + m[1][0] * b[0] + m[1][1] * b[1] + m[1][2] * b[2],
            x[2] + a[0] * f[1] - a[1] * f[0] + m[2][0] * b[0] + m[2][1] * b[1] + m[2][2] * b[2],
        ]
    }

    /// x + turn g: what gyro bias g does to attitude x.
    #[inline(always)]
    fn on_attitude(&self, x: Row, g: Row) -> Row {
        let m = &self.turn;
        [
            x[0] + m[0][0] * g[0] + m[0][1] * g[1] + m[0][2] * g[2],
            x[1] + m[1][0] * g[0] + m[1][1] * g[1] + m[1][2] * g[2],
            x[2] + m[2][0] * g[0] + m[2][1] * g[1] + m[2][2] * g[2],
        ]
    }

    /// The row of velocity in block X, from the rows of attitude (A) and accelerometer bias (B).
    #[inline(always)]
    fn velocity_row(&self, x: &mut Block, a: &Block, b: &Block) {
        let c = |k| self.on_velocity(column(x, k), column(a, k), column(b, k));
        *x = from_columns(c(0), c(1), c(2));
    }

    /// The same where block B is stored transposed.
    #[inline(always)]
    fn velocity_row_bt(&self, x: &mut Block, a: &Block, b: &Block) {
        let c = |k: usize| self.on_velocity(column(x, k), column(a, k), b[k]);
        *x = from_columns(c(0), c(1), c(2));
    }

    /// The same where blocks A and B are stored transposed.
    #[inline(always)]
    fn velocity_row_at_bt(&self, x: &mut Block, a: &Block, b: &Block) {
        let c = |k: usize| self.on_velocity(column(x, k), a[k], b[k]);
        *x = from_columns(c(0), c(1), c(2));
    }

    /// The column of velocity in block X.
    #[inline(always)]
    fn velocity_column(&self, x: &mut Block, a: &Block, b: &Block) {
        x[0] = self.on_velocity(x[0], a[0], b[0]);
        x[1] = self.on_velocity(x[1], a[1], b[1]);
        x[2] = self.on_velocity(x[2], a[2], b[2]);
    }

    /// The row of attitude in block X, from the row of gyro bias (G).
    #[inline(always)]
    fn attitude_row(&self, x: &mut Block, g: &Block) {
        let c = |k| self.on_attitude(column(x, k), column(g, k));
        *x = from_columns(c(0), c(1), c(2));
    }

    /// The same where block G is stored transposed.
    #[inline(always)]
    fn attitude_row_gt(&self, x: &mut Block, g: &Block) {
        let c = |k: usize| self.on_attitude(column(x, k), g[k]);
        *x = from_columns(c(0), c(1), c(2));
    }

    /// The column of attitude in block X.
    #[inline(always)]
    fn attitude_column(&self, x: &mut Block, g: &Block) {
        x[0] = self.on_attitude(x[0], g[0]);
        x[1] = self.on_attitude(x[1], g[1]);
        x[2] = self.on_attitude(x[2], g[2]);
    }
}

impl Added {
    /// Variance densities (per second) over an interval.
    #[inline(always)]
    pub(crate) fn over(densities: &Self, duration: f32) -> Self {
        let [velocity, attitude, gyro_bias] = scaled(
            [densities.velocity, densities.attitude, densities.gyro_bias],
            duration,
        );
        Self {
            velocity,
            attitude,
            gyro_bias,
            accel_bias: densities.accel_bias * duration,
        }
    }
}

impl Covariance {
    /// P ← F P Fᵀ + Q. Inlined, it would have to share the registers: 85 instructions more.
    #[inline(never)]
    pub(crate) fn predict(&mut self, t: &Transition, added: &Added) {
        self.velocity_into_position(t.duration);
        self.attitude_and_bias_inon_velocity(t);
        self.bias_inon_attitude(t);
        add_diagonal(&mut self.vv, added.velocity);
        add_diagonal(&mut self.aa, added.attitude);
        add_diagonal(&mut self.gg, added.gyro_bias);
        add_diagonal(&mut self.bb, added.accel_bias);
    }

    #[inline(always)]
    fn velocity_into_position(&mut self, dt: f32) {
        add_transposed(&mut self.pp, dt, &self.pv);
        add(&mut self.pv, dt, &self.vv);
        add(&mut self.pa, dt, &self.va);
        add(&mut self.pg, dt, &self.vg);
        add(&mut self.pb, dt, &self.vb);
        add(&mut self.pp, dt, &self.pv);
        mirror(&mut self.pp);
    }

    #[inline(always)]
    fn attitude_and_bias_inon_velocity(&mut self, t: &Transition) {
        t.velocity_row_at_bt(&mut self.vv, &self.va, &self.vb);
        t.velocity_column(&mut self.pv, &self.pa, &self.pb);
        t.velocity_row_bt(&mut self.va, &self.aa, &self.ab);
        t.velocity_row_bt(&mut self.vg, &self.ag, &self.gb);
        t.velocity_row(&mut self.vb, &self.ab, &self.bb);
        t.velocity_column(&mut self.vv, &self.va, &self.vb);
        mirror(&mut self.vv);
    }

    #[inline(always)]
    fn bias_inon_attitude(&mut self, t: &Transition) {
        t.attitude_row_gt(&mut self.aa, &self.ag);
        t.attitude_column(&mut self.pa, &self.pg);
        t.attitude_column(&mut self.va, &self.vg);
        t.attitude_row(&mut self.ag, &self.gg);
        t.attitude_row(&mut self.ab, &self.gb);
        t.attitude_column(&mut self.aa, &self.ag);
        mirror(&mut self.aa);
    }
}
