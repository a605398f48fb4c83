//! The numbers that rotations are written for.
//!
//! The core computes in `f32`. Models of the world compute in `f64` on the desktop; the
//! implementation for `f64` does not exist on a target without an operating system, so that no
//! double-precision arithmetic can slip into the firmware.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number with the few functions that rotations need.
///
/// ```
/// use windhover_math::Real;
/// assert_eq!(f32::ONE + f32::ONE, 2.0);
/// ```
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + core::fmt::Debug
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// 1/2.
    const HALF: Self;
    /// π.
    const PI: Self;

    /// The number nearest to `value`.
    fn of(value: f32) -> Self;
    /// Square root of the magnitude, correctly rounded.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Arcsine in radians; arguments outside ±1 count as ±1.
    fn asin(self) -> Self;
    /// Angle of the point (`x`, `self`) in radians, −π to π.
    fn atan2(self, x: Self) -> Self;
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const TWO: Self = 2.0;
    const HALF: Self = 0.5;
    const PI: Self = core::f32::consts::PI;

    #[inline(always)]
    fn of(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        crate::scalar::sqrt(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        crate::trig::sin_cos(self)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        crate::trig::asin(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        crate::trig::atan2(self, x)
    }
}

#[cfg(not(target_os = "none"))]
impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const TWO: Self = 2.0;
    const HALF: Self = 0.5;
    const PI: Self = core::f64::consts::PI;

    #[inline(always)]
    fn of(value: f32) -> Self {
        f64::from(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        libm::sqrt(self.abs())
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        libm::asin(self.clamp(-1.0, 1.0))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
}
