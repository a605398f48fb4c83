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

#[cfg(test)]
mod tests {
    use super::*;

    /// What rotations need, computed in either number.
    fn values<T: Real>(x: f32) -> [T; 7] {
        let x = T::of(x);
        let (s, c) = x.sin_cos();
        [
            T::PI * x,
            x.sqrt(),
            s,
            c,
            x.asin(),
            x.atan2(T::TWO),
            T::HALF - T::ONE + T::ZERO,
        ]
    }

    #[test]
    fn both_numbers_give_the_same_values() {
        for i in -300..=300 {
            let x = i as f32 * 0.01;
            let single = values::<f32>(x);
            let double = values::<f64>(x);
            for (a, b) in single.iter().zip(double) {
                assert!((f64::from(*a) - b).abs() < 1e-6, "{a} {b} of {x}");
            }
        }
    }

    #[test]
    fn both_numbers_are_total_in_the_same_way() {
        assert_eq!(<f32 as Real>::sqrt(-4.0), 2.0);
        assert_eq!(<f64 as Real>::sqrt(-4.0), 2.0);
        assert_eq!(<f32 as Real>::asin(-1.5), -core::f32::consts::FRAC_PI_2);
        assert_eq!(<f64 as Real>::asin(-1.5), -core::f64::consts::FRAC_PI_2);
        assert_eq!(<f64 as Real>::of(0.1), f64::from(0.1_f32));
    }
}
