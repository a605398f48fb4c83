//! Rotations between the body (FRD) and the world (NED).
//!
//! A [`Quaternion`] `q` turns body coordinates into world coordinates: `v_ned = q · v_frd · q*`.
//! [`Euler`] angles are the intrinsic sequence heading ψ about down, pitch θ about right, roll φ
//! about front: `q = q_z(ψ) q_y(θ) q_x(φ)`. Angles in radians.

use core::ops::{Add, Mul, Sub};

use nalgebra::{Matrix3, Vector3};

use crate::Real;

/// A rotation as a unit quaternion (Hamilton's product, scalar first), body to world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<T = f32> {
    /// Scalar part.
    pub w: T,
    /// First component of the vector part.
    pub x: T,
    /// Second component of the vector part.
    pub y: T,
    /// Third component of the vector part.
    pub z: T,
}

/// Roll, pitch and heading in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Euler<T = f32> {
    /// Roll φ about the body's front axis, −π to π.
    pub roll: T,
    /// Pitch θ about the intermediate right axis, −π/2 to π/2.
    pub pitch: T,
    /// Heading ψ about down, −π to π; 0 is north.
    pub yaw: T,
}

impl<T: Real> Default for Quaternion<T> {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl<T: Real> Quaternion<T> {
    /// No rotation: level, facing north.
    pub const IDENTITY: Self = Self {
        w: T::ONE,
        x: T::ZERO,
        y: T::ZERO,
        z: T::ZERO,
    };

    /// A quaternion from its four components, which should have norm 1.
    #[inline(always)]
    pub const fn new(w: T, x: T, y: T, z: T) -> Self {
        Self { w, x, y, z }
    }

    /// The opposite rotation.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self::new(self.w, -self.x, -self.y, -self.z)
    }

    /// Inner product of the components.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.w * other.w + self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The same rotation with norm 1. A quaternion of zeros becomes the identity.
    #[inline]
    pub fn normalized(self) -> Self {
        let norm = self.dot(self).sqrt();
        if norm > T::ZERO {
            let s = T::ONE / norm;
            Self::new(self.w * s, self.x * s, self.y * s, self.z * s)
        } else {
            Self::IDENTITY
        }
    }

    /// The same rotation, pulled towards norm 1 by one Newton step: exact to second order when
    /// the norm is near 1, as after a step of integration, and cheaper than a square root.
    #[inline(always)]
    pub fn renormalized(self) -> Self {
        let s = (T::of(3.0) - self.dot(self)) * T::HALF;
        Self::new(self.w * s, self.x * s, self.y * s, self.z * s)
    }

    /// The same rotation with a scalar part that is not negative: the shorter way round.
    #[inline(always)]
    pub fn shortest(self) -> Self {
        if self.w < T::ZERO {
            Self::new(-self.w, -self.x, -self.y, -self.z)
        } else {
            self
        }
    }

    /// Turns a vector from body into world coordinates.
    #[inline(always)]
    pub fn rotate(self, v: Vector3<T>) -> Vector3<T> {
        // v + 2w (q × v) + 2 q × (q × v), with t = 2 q × v
        let tx = T::TWO * (self.y * v.z - self.z * v.y);
        let ty = T::TWO * (self.z * v.x - self.x * v.z);
        let tz = T::TWO * (self.x * v.y - self.y * v.x);
        Vector3::new(
            v.x + self.w * tx + (self.y * tz - self.z * ty),
            v.y + self.w * ty + (self.z * tx - self.x * tz),
            v.z + self.w * tz + (self.x * ty - self.y * tx),
        )
    }

    /// Turns a vector from world into body coordinates.
    #[inline(always)]
    pub fn inverse_rotate(self, v: Vector3<T>) -> Vector3<T> {
        self.conjugate().rotate(v)
    }

    /// The body's down axis in the world: thrust acts along its negative.
    #[inline(always)]
    pub fn down_axis(self) -> Vector3<T> {
        Vector3::new(
            T::TWO * (self.x * self.z + self.w * self.y),
            T::TWO * (self.y * self.z - self.w * self.x),
            T::ONE - T::TWO * (self.x * self.x + self.y * self.y),
        )
    }

    /// Rotation about the vector's direction by its length in radians, by series: the error is
    /// below 1e-7 up to 1 rad, and below 1e-16 up to 0.05 rad. For steps of integration.
    #[inline(always)]
    pub fn from_small_rotation(v: Vector3<T>) -> Self {
        let half = T::HALF;
        let q = (v.x * v.x + v.y * v.y + v.z * v.z) * T::of(0.25);
        // cos and sinc of half the angle, q its square
        let c =
            T::ONE - q * half * (T::ONE - q * (T::ONE / T::of(12.0)) * (T::ONE - q * (T::ONE / T::of(30.0))));
        let s = half
            * (T::ONE
                - q * (T::ONE / T::of(6.0))
                    * (T::ONE - q * (T::ONE / T::of(20.0)) * (T::ONE - q * (T::ONE / T::of(42.0)))));
        Self::new(c, v.x * s, v.y * s, v.z * s)
    }

    /// Rotation about the vector's direction by its length in radians, of any length.
    pub fn from_rotation_vector(v: Vector3<T>) -> Self {
        let angle = (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
        if angle > T::HALF {
            let (s, c) = (angle * T::HALF).sin_cos();
            let s = s / angle;
            Self::new(c, v.x * s, v.y * s, v.z * s)
        } else {
            Self::from_small_rotation(v)
        }
    }

    /// The rotation of roll, pitch and heading.
    pub fn from_euler(e: Euler<T>) -> Self {
        let (sr, cr) = (e.roll * T::HALF).sin_cos();
        let (sp, cp) = (e.pitch * T::HALF).sin_cos();
        let (sy, cy) = (e.yaw * T::HALF).sin_cos();
        Self::new(
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )
    }

    /// A rotation about down by `yaw` radians.
    pub fn from_heading(yaw: T) -> Self {
        let (s, c) = (yaw * T::HALF).sin_cos();
        Self::new(c, T::ZERO, T::ZERO, s)
    }

    /// Roll, pitch and heading. At a pitch of ±90° roll and heading turn about the same axis;
    /// whatever division between them comes out is a right one.
    pub fn to_euler(self) -> Euler<T> {
        let Self { w, x, y, z } = self;
        Euler {
            roll: (T::TWO * (w * x + y * z)).atan2(T::ONE - T::TWO * (x * x + y * y)),
            pitch: (T::TWO * (w * y - z * x)).asin(),
            yaw: self.heading(),
        }
    }

    /// Heading ψ in radians, −π to π.
    #[inline]
    pub fn heading(self) -> T {
        let Self { w, x, y, z } = self;
        (T::TWO * (w * z + x * y)).atan2(T::ONE - T::TWO * (y * y + z * z))
    }

    /// Cosine of the angle between the body's down axis and the world's.
    #[inline(always)]
    pub fn cos_tilt(self) -> T {
        T::ONE - T::TWO * (self.x * self.x + self.y * self.y)
    }

    /// The matrix that turns body into world coordinates.
    #[rustfmt::skip]
    pub fn to_matrix(self) -> Matrix3<T> {
        let Self { w, x, y, z } = self;
        let (one, two) = (T::ONE, T::TWO);
        Matrix3::new(
            one - two * (y * y + z * z), two * (x * y - w * z),       two * (x * z + w * y),
            two * (x * y + w * z),       one - two * (x * x + z * z), two * (y * z - w * x),
            two * (x * z - w * y),       two * (y * z + w * x),       one - two * (x * x + y * y),
        )
    }

    /// Whether every component is finite.
    pub fn is_finite(self) -> bool {
        // Zero times infinity or NaN is NaN, and equal to nothing.
        let zero = T::ZERO;
        self.w * zero == zero && self.x * zero == zero && self.y * zero == zero && self.z * zero == zero
    }
}

impl<T: Real> Mul for Quaternion<T> {
    type Output = Self;

    /// First the rotation on the right, then the one on the left.
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let a = self;
        Self::new(
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        )
    }
}

/// Body rate W(φ, θ)·(φ̇, θ̇, ψ̇), in rad/s, from the rates of change of the Euler angles.
#[inline]
pub fn body_rate_from_euler_rate<T: Real>(attitude: Euler<T>, rate: Euler<T>) -> Vector3<T> {
    let (sr, cr) = attitude.roll.sin_cos();
    let (sp, cp) = attitude.pitch.sin_cos();
    Vector3::new(
        rate.roll - sp * rate.yaw,
        cr * rate.pitch + sr * cp * rate.yaw,
        cr * cp * rate.yaw - sr * rate.pitch,
    )
}

impl<T: Real> Add for Euler<T> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            roll: self.roll + o.roll,
            pitch: self.pitch + o.pitch,
            yaw: self.yaw + o.yaw,
        }
    }
}

impl<T: Real> Sub for Euler<T> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self {
            roll: self.roll - o.roll,
            pitch: self.pitch - o.pitch,
            yaw: self.yaw - o.yaw,
        }
    }
}
