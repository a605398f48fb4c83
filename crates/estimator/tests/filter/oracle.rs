//! The nominal model once more, in double precision and by other formulas: what the filter's
//! matrices are differentiated from.

use windhover_estimator::{InertialIncrements, State};
use windhover_math::{Quaternion, Vector3};

use crate::dense::Column;

#[derive(Clone, Copy, Debug)]
pub struct State64 {
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub attitude: Quaternion<f64>,
    pub gyro_bias: Vector3<f64>,
    pub accel_bias: Vector3<f64>,
}

pub const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, windhover_math::GRAVITY as f64);

pub fn wide(v: Vector3) -> Vector3<f64> {
    v.map(f64::from)
}

pub fn narrow(v: Vector3<f64>) -> Vector3 {
    v.map(|x| x as f32)
}

pub fn wide_rotation(q: Quaternion) -> Quaternion<f64> {
    Quaternion::new(q.w.into(), q.x.into(), q.y.into(), q.z.into()).normalized()
}

pub fn narrow_rotation(q: Quaternion<f64>) -> Quaternion {
    Quaternion::new(q.w as f32, q.x as f32, q.y as f32, q.z as f32)
}

/// The rotation vector of a rotation.
pub fn logarithm(q: Quaternion<f64>) -> Vector3<f64> {
    let q = q.shortest();
    let v = Vector3::new(q.x, q.y, q.z);
    let s = libm::sqrt(v.dot(&v));
    if s < 1e-12 {
        v * 2.0
    } else {
        v * (2.0 * libm::atan2(s, q.w) / s)
    }
}

impl From<&State> for State64 {
    fn from(s: &State) -> Self {
        Self {
            position: wide(s.position),
            velocity: wide(s.velocity),
            attitude: wide_rotation(s.attitude),
            gyro_bias: wide(s.gyro_bias),
            accel_bias: wide(s.accel_bias),
        }
    }
}

impl From<&State64> for State {
    fn from(s: &State64) -> Self {
        Self {
            position: narrow(s.position),
            velocity: narrow(s.velocity),
            attitude: narrow_rotation(s.attitude),
            gyro_bias: narrow(s.gyro_bias),
            accel_bias: narrow(s.accel_bias),
        }
    }
}

fn part(errors: &Column, from: usize) -> Vector3<f64> {
    Vector3::new(errors[from], errors[from + 1], errors[from + 2])
}

impl State64 {
    /// The state with these errors.
    pub fn plus(&self, errors: &Column) -> Self {
        Self {
            position: self.position + part(errors, 0),
            velocity: self.velocity + part(errors, 3),
            attitude: Quaternion::from_rotation_vector(part(errors, 6)) * self.attitude,
            gyro_bias: self.gyro_bias + part(errors, 9),
            accel_bias: self.accel_bias + part(errors, 12),
        }
    }

    /// The errors by which `self` is off `from`.
    pub fn minus(&self, from: &Self) -> Column {
        let parts = [
            self.position - from.position,
            self.velocity - from.velocity,
            logarithm(self.attitude * from.attitude.conjugate()),
            self.gyro_bias - from.gyro_bias,
            self.accel_bias - from.accel_bias,
        ];
        Column::from_fn(|i, _| parts[i / 3][i % 3])
    }

    fn rotation(&self, increments: &InertialIncrements) -> Quaternion<f64> {
        let wrong = wide(increments.gyro_bias) - self.gyro_bias;
        let turn = Quaternion::from_rotation_vector(wrong * f64::from(increments.duration));
        wide_rotation(increments.rotation) * turn
    }

    fn gained(&self, attitude: Quaternion<f64>, increments: &InertialIncrements) -> Vector3<f64> {
        let dt = f64::from(increments.duration);
        attitude.rotate(wide(increments.velocity) - self.accel_bias * dt) + GRAVITY * dt
    }

    /// After an interval.
    pub fn after(&self, increments: &InertialIncrements) -> Self {
        let gained = self.gained(self.attitude, increments);
        Self {
            position: self.position + (self.velocity + gained / 2.0) * f64::from(increments.duration),
            velocity: self.velocity + gained,
            attitude: (self.attitude * self.rotation(increments)).normalized(),
            ..*self
        }
    }

    /// Before an interval: the inverse of [`Self::after`].
    pub fn before(&self, increments: &InertialIncrements) -> Self {
        let attitude = self.attitude * self.rotation(increments).conjugate();
        let gained = self.gained(attitude, increments);
        let velocity = self.velocity - gained;
        Self {
            position: self.position - (velocity + gained / 2.0) * f64::from(increments.duration),
            velocity,
            attitude,
            ..*self
        }
    }

    /// The derivative of `f` with respect to the errors, by central differences.
    pub fn differentiate(&self, f: impl Fn(&Self) -> f64) -> Column {
        Column::from_fn(|i, _| {
            let h = 1e-5;
            let mut errors = Column::zeros();
            errors[i] = h;
            (f(&self.plus(&errors)) - f(&self.plus(&-errors))) / (2.0 * h)
        })
    }
}
