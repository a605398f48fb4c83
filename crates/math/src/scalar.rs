//! Minimum, maximum, square root, saturation and wrapping, with equal bits everywhere.
//!
//! `f32::max(-0.0, 0.0)` differs between debug and release builds on x86-64, and is a library
//! call on a Cortex-M4F; here a comparison and a selection decide.

use core::f32::consts::{FRAC_1_PI, PI};

use nalgebra::Vector3;

use crate::Real;
use crate::trig::{LARGEST_ANGLE, QUARTER_TURN, ROUND};

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

/// The same angle between −π and π, in radians; angles beyond ±1e5 rad, and what is not a number,
/// give 0. Up to ±1e4 rad the error is below 2.5e-7 rad, the spacing of `f32` at π.
#[inline]
pub fn wrap_pi(angle: f32) -> f32 {
    // 2π is four times the three pieces of π/2: scaling by a power of two is exact.
    const TURN: [f32; 3] = [
        4.0 * QUARTER_TURN[0],
        4.0 * QUARTER_TURN[1],
        4.0 * QUARTER_TURN[2],
    ];
    if angle.abs() <= PI {
        return angle;
    }
    if angle.abs() <= LARGEST_ANGLE {
        let n = (angle * (0.5 * FRAC_1_PI) + ROUND) - ROUND;
        let rest = ((angle - n * TURN[0]) - n * TURN[1]) - n * TURN[2];
        // The number of turns is itself rounded, and near half a turn may be one off.
        if rest > PI {
            ((rest - TURN[0]) - TURN[1]) - TURN[2]
        } else if rest < -PI {
            ((rest + TURN[0]) + TURN[1]) + TURN[2]
        } else {
            rest
        }
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    /// Bits without regard to which NaN it is.
    fn bits(x: f32) -> Option<u32> {
        if x.is_nan() { None } else { Some(x.to_bits()) }
    }

    #[test]
    fn minimum_and_maximum_select() {
        assert_eq!(min(1.0, 2.0), 1.0);
        assert_eq!(min(2.0, 1.0), 1.0);
        assert_eq!(max(1.0, 2.0), 2.0);
        assert_eq!(max(2.0, 1.0), 2.0);
        assert_eq!(min(3, -3), -3);
        assert_eq!(max(3, -3), 3);
    }

    #[test]
    fn of_equals_and_of_the_incomparable_it_is_the_second() {
        for select in [min::<f32>, max::<f32>] {
            assert_eq!(bits(select(0.0, -0.0)), bits(-0.0));
            assert_eq!(bits(select(-0.0, 0.0)), bits(0.0));
            assert_eq!(bits(select(f32::NAN, 1.0)), bits(1.0));
            assert_eq!(bits(select(1.0, f32::NAN)), None);
        }
    }

    #[test]
    fn saturation_limits_both_ways() {
        assert_eq!(saturate(0.5, 1.0), 0.5);
        assert_eq!(saturate(1.5, 1.0), 1.0);
        assert_eq!(saturate(-1.5, 1.0), -1.0);
        assert_eq!(saturate(-1.0, 1.0), -1.0);
        assert_eq!(saturate(f32::INFINITY, 2.0), 2.0);
        assert_eq!(saturate(-1e300, 2.0_f64), -2.0);
        assert_eq!(saturate(3.0, 0.0), 0.0);
        assert!(saturate(f32::NAN, 1.0).is_nan());
    }

    /// The `f32` nearest to the square root: the root in `f64` is rounded twice, but twice is as
    /// good as once since 53 ≥ 2·24 + 2 (Figueroa 1995).
    fn nearest_root(x: f32) -> f32 {
        libm::sqrt(f64::from(x)) as f32
    }

    #[test]
    fn square_root_is_correctly_rounded_for_all_exponents() {
        for exponent in 0..=254_u32 {
            // 2¹⁶ mantissas, spread over all 2²³ by an odd number that reaches the low bits too
            for i in 0..=0xFFFF_u32 {
                let mantissa = i.wrapping_mul(0x9E37_79B1) >> 9;
                let x = f32::from_bits(exponent << 23 | mantissa);
                assert_eq!(bits(sqrt(x)), bits(nearest_root(x)), "{x:e}");
            }
        }
    }

    #[test]
    fn square_root_of_squares_of_the_negative_and_of_the_infinite() {
        for i in 0..=4096_u16 {
            let x = f32::from(i);
            assert_eq!(sqrt(x * x), x);
            assert_eq!(sqrt(-x * x), x);
        }
        assert_eq!(bits(sqrt(-0.0)), bits(0.0));
        assert_eq!(sqrt(f32::INFINITY), f32::INFINITY);
        assert_eq!(sqrt(f32::NEG_INFINITY), f32::INFINITY);
        assert_eq!(bits(sqrt(f32::NAN)), None);
    }

    #[test]
    fn finite_is_every_component() {
        assert!(is_finite(Vector3::new(f32::MAX, f32::MAX, f32::MIN)));
        for i in 0..3 {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut v = Vector3::new(1.0, 2.0, 3.0);
                v[i] = bad;
                assert!(!is_finite(v));
            }
        }
    }

    #[test]
    fn a_limited_vector_keeps_its_direction() {
        assert_eq!(norm(Vector3::new(2.0, -3.0, 6.0)), 7.0);
        let v = Vector3::new(3.0, 0.0, -4.0);
        assert_eq!(limit_norm(v, 5.0), v);
        assert_eq!(limit_norm(v, 2.5), Vector3::new(1.5, 0.0, -2.0));
        assert_eq!(limit_norm(v, 0.0), Vector3::zeros());
        assert_eq!(limit_norm(Vector3::zeros(), 0.0), Vector3::<f32>::zeros());
    }

    /// How far `wrap_pi` is from the angle less its whole turns, computed in `f64`.
    fn wrap_error(angle: f32) -> f64 {
        let wrapped = wrap_pi(angle);
        assert!(wrapped.abs() <= PI, "{wrapped} of {angle}");
        let difference = f64::from(angle) - f64::from(wrapped);
        let turn = core::f64::consts::TAU;
        (difference - turn * libm::round(difference / turn)).abs()
    }

    #[test]
    fn wrapping_is_exact_within_half_a_turn() {
        for i in -10_000..=10_000 {
            let angle = i as f32 * (PI / 10_000.0);
            assert_eq!(bits(wrap_pi(angle)), bits(angle));
        }
        assert_eq!(wrap_pi(PI), PI);
        assert_eq!(wrap_pi(-PI), -PI);
    }

    #[test]
    fn wrapping_is_accurate_and_in_range_up_to_1e4_radians() {
        let mut worst = (0.0, 0.0);
        for i in -2_000_000..=2_000_000 {
            let angle = i as f32 * 0.005;
            worst = max(worst, (wrap_error(angle), angle));
        }
        assert!(worst.0 < 2.5e-7, "{worst:?}");
    }

    #[test]
    fn wrapping_is_in_range_next_to_odd_multiples_of_half_a_turn() {
        let mut worst = (0.0, 0.0);
        for odd in (1..3000).step_by(2) {
            let mut angle = odd as f32 * PI;
            for _ in 0..20 {
                angle = angle.next_down();
            }
            for _ in 0..40 {
                worst = max(worst, (wrap_error(angle), angle));
                worst = max(worst, (wrap_error(-angle), -angle));
                angle = angle.next_up();
            }
        }
        assert!(worst.0 < 2.5e-7, "{worst:?}");
    }

    #[test]
    fn wrapping_stays_in_range_up_to_1e5_radians() {
        for i in -1_000_000..=1_000_000 {
            let angle = i as f32 * 0.1;
            assert!(wrap_error(angle) < 2e-6, "{angle}");
        }
    }

    #[test]
    fn wrapping_what_is_no_angle_gives_zero() {
        for bad in [f32::NAN, -f32::NAN, f32::INFINITY, -1e30, 1.001e5] {
            assert_eq!(bits(wrap_pi(bad)), bits(0.0));
        }
    }

    proptest! {
        #[test]
        fn wrapping_twice_is_wrapping_once(angle in -1e4_f32..1e4) {
            let once = wrap_pi(angle);
            prop_assert_eq!(wrap_pi(once), once);
            prop_assert_eq!(wrap_pi(-angle), -once);
        }

        #[test]
        fn a_limited_vector_is_no_longer_than_the_limit(
            x in -1e3_f32..1e3, y in -1e3_f32..1e3, z in -1e3_f32..1e3, limit in 0.0_f32..2e3,
        ) {
            let v = Vector3::new(x, y, z);
            let limited = limit_norm(v, limit);
            prop_assert!(norm(limited) <= limit * (1.0 + 3e-7));
            prop_assert!(norm(limited.cross(&v)) <= 1e-6 * norm(limited) * norm(v));
            prop_assert!(limited.dot(&v) >= 0.0);
        }
    }
}
