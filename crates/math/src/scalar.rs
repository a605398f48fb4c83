//! Minimum, maximum, square root, saturation and wrapping, with equal bits everywhere.
//!
//! `f32::max(-0.0, 0.0)` differs between debug and release builds on x86-64, and is a library
//! call on a Cortex-M4F; here a comparison and a selection decide.

use nalgebra::Vector3;

use crate::Real;

/// The smaller of two; `b` when they are equal or not comparable.
#[inline(always)]
pub fn min<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The larger of two; `b` when they are equal or not comparable.
#[inline(always)]
pub fn max<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// `value` limited to ±`limit`; `limit` must not be negative.
#[inline(always)]
pub fn saturate<T: Real>(value: T, limit: T) -> T {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}

#[cfg(all(target_arch = "arm", target_os = "none"))]
#[allow(unsafe_code)]
mod arm {
    // SAFETY: the C library's `sqrtf`, a pure function of its argument. It is never linked: the
    // compiler replaces the call by `vsqrt.f32`, and with an argument that cannot be negative
    // no call remains for the error case (xtask's probe ELF would fail to link if one did).
    unsafe extern "C" {
        pub(super) safe fn sqrtf(x: f32) -> f32;
    }
}

/// Square root of the magnitude of `x`, correctly rounded: `vabs.f32` and `vsqrt.f32` on a
/// Cortex-M4F. A total function: rounding that leaves a tiny negative argument cannot make a NaN.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_os = "none"))]
    return arm::sqrtf(x.abs());
    #[cfg(not(all(target_arch = "arm", target_os = "none")))]
    return libm::sqrtf(x.abs());
}

/// Length of a vector.
#[inline(always)]
pub fn norm<T: Real>(v: Vector3<T>) -> T {
    (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}

/// The vector, shortened to `limit` where it is longer; its direction stays.
#[inline]
pub fn limit_norm<T: Real>(v: Vector3<T>, limit: T) -> Vector3<T> {
    let length = norm(v);
    if length > limit {
        let s = limit / length;
        Vector3::new(v.x * s, v.y * s, v.z * s)
    } else {
        v
    }
}

/// Whether all three components are finite.
#[inline]
pub fn is_finite(v: Vector3<f32>) -> bool {
    v.x.is_finite() && v.y.is_finite() && v.z.is_finite()
}

/// The same angle between −π and π, in radians. Exact enough for a few turns; angles beyond
/// ±1e4 rad lose precision as any `f32` does.
#[inline]
pub fn wrap_pi(angle: f32) -> f32 {
    const TURN_HIGH: f32 = 6.281_25; // 2π in two pieces, the first short enough to multiply exactly
    const TURN_LOW: f32 = 1.935_307_2e-3;
    const ROUND: f32 = 12_582_912.0; // 1.5·2^23: adding and subtracting it rounds to an integer
    if angle.abs() <= core::f32::consts::PI {
        return angle;
    }
    let turns = angle * (0.5 * core::f32::consts::FRAC_1_PI);
    if turns.abs() > 4.0e6 {
        return 0.0;
    }
    let n = (turns + ROUND) - ROUND;
    (angle - n * TURN_HIGH) - n * TURN_LOW
}
