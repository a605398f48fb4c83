//! Sine, cosine and their inverses in single precision, by polynomial.
//!
//! A libm made for `f32` computes in `f64`, which a Cortex-M4F has to do in software, twenty times
//! slower than this. These functions use only additions, multiplications, divisions, square roots
//! and comparisons of `f32`, each of which IEEE 754 rounds in one way, so that all machines agree.
//!
//! The polynomials are the minimax polynomials of the Cephes library's single-precision functions
//! (S. L. Moshier, *Methods and Programs for Mathematical Functions*, 1989; `sinf.c`, `asinf.c`,
//! `atanf.c`). The reduction of large angles is Cody and Waite's, in three pieces.
//!
//! | function | largest error | where |
//! |---|---|---|
//! | [`sin`], [`cos`], [`sin_cos`] | 1e-7 | up to ±1e4 rad |
//! | | 1e-6 | up to ±1e5 rad |
//! | [`asin`], [`acos`] | 1e-7, or 2 units in the last place where that is more | everywhere |
//! | [`atan2`] | 1e-7, or 2 units in the last place where that is more | everywhere |
//!
//! All functions are total: whatever the argument, the result is finite and in range. An argument
//! that is not a number counts as 0, and so does an angle beyond ±1e5 rad, where the spacing of
//! `f32` nears a hundredth of a radian. The result then means nothing, but it stays a number.

use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

use crate::scalar::sqrt;

/// Angles beyond this, in radians, are not reduced: up to here the product of the quarter turns
/// and the first piece of π/2 is exact.
pub(crate) const LARGEST_ANGLE: f32 = 1.0e5;

/// 1.5·2²³. A number added to it is rounded to an integer, which the low bits of the sum then hold.
pub(crate) const ROUND: f32 = 12_582_912.0;

/// π/2 in three pieces of 8, 11 and 24 bits: multiples by integers of 16 and 13 bits are exact for
/// the first and the second.
pub(crate) const QUARTER_TURN: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];

/// What the `f32` next to π/2 is more than π/2.
const FRAC_PI_2_EXCESS: f32 = 4.371_139e-8;

/// What the `f32` next to π is more than π.
const PI_EXCESS: f32 = 8.742_278e-8;

/// Tangent of π/8.
const TAN_FRAC_PI_8: f32 = 0.414_213_56;

/// Bits of positive infinity.
const INFINITY_BITS: u32 = f32::INFINITY.to_bits();

/// Sine of an angle in radians, −1 to 1.
#[must_use]
pub fn sin(angle: f32) -> f32 {
    let (rest, quarter) = reduce(angle);
    sin_in_quarter(rest, quarter)
}

/// Cosine of an angle in radians, −1 to 1.
#[must_use]
pub fn cos(angle: f32) -> f32 {
    let (rest, quarter) = reduce(angle);
    sin_in_quarter(rest, quarter.wrapping_add(1))
}

/// Sine and cosine of an angle in radians, the same bits as [`sin`] and [`cos`] for little more
/// than the price of one.
#[must_use]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let (rest, quarter) = reduce(angle);
    let square = rest * rest;
    let s = sin_polynomial(rest, square);
    let c = cos_polynomial(square);
    let (sin, cos) = if quarter & 1 == 0 { (s, c) } else { (c, s) };
    let cos_sign = quarter.wrapping_add(1);
    (negate_if(sin, quarter >> 1), negate_if(cos, cos_sign >> 1))
}

/// Arcsine in radians, −π/2 to π/2; arguments outside ±1 count as ±1.
#[must_use]
pub fn asin(x: f32) -> f32 {
    let x = within_one(x);
    let size = x.abs();
    // asin(x) = π/2 − 2 asin(√((1 − x)/2)) keeps the polynomial's argument below 1/2.
    let outer = size > 0.5;
    let (square, root) = if outer {
        let square = 0.5 - 0.5 * size;
        (square, sqrt(square))
    } else {
        (size * size, size)
    };
    let bend = asin_bend(root, square);
    let angle = if outer {
        // π/2 in two parts, so that only the last sum is rounded as coarsely as the result.
        (1.0 - (root + root)) + ((FRAC_PI_2 - 1.0) - (bend + bend))
    } else {
        root + bend
    };
    angle.copysign(x)
}

/// Arccosine in radians, 0 to π; arguments outside ±1 count as ±1.
#[must_use]
pub fn acos(x: f32) -> f32 {
    let x = within_one(x);
    let size = x.abs();
    if size > 0.5 {
        let square = 0.5 - 0.5 * size;
        let root = sqrt(square);
        let bend = asin_bend(root, square);
        if x > 0.0 {
            (root + root) + (bend + bend)
        } else {
            (PI - (root + root)) - (bend + bend + PI_EXCESS)
        }
    } else {
        (FRAC_PI_2 - x) - (asin_bend(x, x * x) + FRAC_PI_2_EXCESS)
    }
}

/// Angle of the point (`x`, `y`) in radians, −π to π.
///
/// The result has the sign of `y`, a zero's sign included: on the negative x axis it is π for
/// `y` = 0 and −π for `y` = −0. The origin gives 0 (again with the sign of `y`) whichever zero `x`
/// is. A point with an infinite coordinate lies in the direction that the infinite ones give; a
/// point with a coordinate that is not a number counts as the origin.
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    // One comparison of integers finds all points that need care: for 0, infinity and NaN the
    // bits less 1 are all at least those of the largest finite number.
    let sum = x.abs() + y.abs();
    let (y, x, sum) = if sum.to_bits().wrapping_sub(1) < INFINITY_BITS - 1 {
        (y, x, sum)
    } else {
        tame(y, x)
    };
    let width = x.abs();
    let height = y.abs();
    // The point's mirror image across the diagonal, if need be, has an angle of at most π/4.
    let steep = height > width;
    let (opposite, adjacent) = if steep { (width, height) } else { (height, width) };
    // Above π/8: atan(t) = π/4 + atan((t − 1)/(t + 1)).
    let (numerator, denominator, offset) = if opposite > TAN_FRAC_PI_8 * adjacent {
        (opposite - adjacent, sum, FRAC_PI_4)
    } else {
        (opposite, adjacent, 0.0)
    };
    let arc = offset + atan_polynomial(numerator / denominator);
    let arc = if steep {
        FRAC_PI_2 - (arc + FRAC_PI_2_EXCESS)
    } else {
        arc
    };
    let arc = if x < 0.0 { PI - (arc + PI_EXCESS) } else { arc };
    arc.copysign(y)
}

/// A point (`y`, `x`) in the direction that [`atan2`] promises for the origin, for points whose
/// coordinates are infinite or not numbers, and for points too far out for the sum of their
/// coordinates; third that sum.
#[cold]
fn tame(y: f32, x: f32) -> (f32, f32, f32) {
    let sum = x.abs() + y.abs();
    let (y, x) = if sum.is_nan() {
        (0.0, 1.0)
    } else if sum == 0.0 {
        (y, 1.0)
    } else if x.is_infinite() || y.is_infinite() {
        (unit_if_infinite(y), unit_if_infinite(x))
    } else {
        (0.25 * y, 0.25 * x)
    };
    (y, x, x.abs() + y.abs())
}

/// 1 for infinity and 0 for a finite number, with its sign.
fn unit_if_infinite(x: f32) -> f32 {
    let size = if x.is_infinite() { 1.0 } else { 0.0_f32 };
    size.copysign(x)
}

/// The angle less the nearest number of quarter turns, within ±π/4, and that number, of which
/// only the low bits count.
#[inline(always)]
fn reduce(angle: f32) -> (f32, u32) {
    let angle = if angle.abs() <= LARGEST_ANGLE { angle } else { 0.0 };
    let shifted = angle * FRAC_2_PI + ROUND;
    let n = shifted - ROUND;
    let [high, middle, low] = QUARTER_TURN;
    let rest = ((angle - n * high) - n * middle) - n * low;
    (rest, shifted.to_bits())
}

/// Sine of `rest` plus a number of quarter turns.
#[inline(always)]
fn sin_in_quarter(rest: f32, quarter: u32) -> f32 {
    let square = rest * rest;
    let size = if quarter & 1 == 0 {
        sin_polynomial(rest, square)
    } else {
        cos_polynomial(square)
    };
    negate_if(size, quarter >> 1)
}

/// `x`, negated if the lowest bit is set.
#[inline(always)]
fn negate_if(x: f32, bit: u32) -> f32 {
    f32::from_bits(x.to_bits() ^ (bit << 31))
}

/// `x` limited to ±1; 0 for what is not a number.
#[inline(always)]
fn within_one(x: f32) -> f32 {
    if x.abs() <= 1.0 {
        x
    } else if x.is_nan() {
        0.0
    } else {
        1.0_f32.copysign(x)
    }
}

/// Sine for |`x`| ≤ π/4, given also its square.
#[inline(always)]
fn sin_polynomial(x: f32, square: f32) -> f32 {
    let p = 8.332_161e-3 + square * -1.951_529_6e-4;
    let p = -1.666_665_5e-1 + square * p;
    x + x * square * p
}

/// Cosine of an angle of at most π/4, given its square.
#[inline(always)]
fn cos_polynomial(square: f32) -> f32 {
    let p = -1.388_731_6e-3 + square * 2.443_315_7e-5;
    let p = 4.166_664_6e-2 + square * p;
    let p = -0.5 + square * p;
    1.0 + square * p
}

/// What the arcsine of `x` is more than `x`, for |`x`| ≤ 1/2, given also its square. Added last
/// it is small enough for its rounding not to matter.
#[inline(always)]
fn asin_bend(x: f32, square: f32) -> f32 {
    let p = 2.418_131_2e-2 + square * 4.216_32e-2;
    let p = 4.547_002_6e-2 + square * p;
    let p = 7.495_300_5e-2 + square * p;
    let p = 1.666_675_2e-1 + square * p;
    x * square * p
}

/// Arctangent for |`x`| ≤ tan(π/8).
#[inline(always)]
fn atan_polynomial(x: f32) -> f32 {
    let square = x * x;
    let p = -1.387_768_6e-1 + square * 8.053_744_6e-2;
    let p = 1.997_771_1e-1 + square * p;
    let p = -3.333_295e-1 + square * p;
    x + x * square * p
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The spacing of `f32` at `x`.
    fn ulp(x: f64) -> f64 {
        let exponent = libm::ilogb(x).max(-126);
        libm::scalbn(1.0, exponent - 23)
    }

    /// The largest error over some numbers, where it is, and by how much it exceeds the larger of
    /// 1e-7 and 2 units in the last place.
    struct Worst {
        error: f64,
        at: (f32, f32),
        excess: f64,
    }

    fn worst(points: impl Iterator<Item = ((f32, f32), f32, f64)>) -> Worst {
        let mut worst = Worst {
            error: 0.0,
            at: (0.0, 0.0),
            excess: f64::NEG_INFINITY,
        };
        for (at, result, exact) in points {
            assert!(result.is_finite(), "{result} at {at:?}");
            let error = (f64::from(result) - exact).abs();
            let allowed = if exact == 0.0 {
                1e-7
            } else {
                crate::max(2.0 * ulp(exact), 1e-7)
            };
            if error > worst.error {
                worst.error = error;
                worst.at = at;
            }
            worst.excess = crate::max(worst.excess, error - allowed);
        }
        worst
    }

    /// Every `step`-th number from 0 to `last`, and their negatives.
    fn every(step: usize, last: f32) -> impl Iterator<Item = f32> {
        let bits = (0..=last.to_bits()).step_by(step);
        bits.flat_map(|b| [f32::from_bits(b), -f32::from_bits(b)])
    }

    /// Numbers on a uniform grid of `count` steps from −`last` to `last`.
    fn uniform(count: u32, last: f32) -> impl Iterator<Item = f32> {
        (0..=count).map(move |i| (2.0 * i as f32 / count as f32 - 1.0) * last)
    }

    /// Small numbers, large numbers, and what is no number.
    const STRANGE: [f32; 16] = [
        0.0,
        -0.0,
        1e-45,
        -1e-45,
        f32::MIN_POSITIVE,
        1.0,
        -1.0,
        1.000_1,
        1.001e5,
        1e10,
        -1e30,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];

    #[test]
    fn sine_is_within_1e_7_up_to_1e4_radians() {
        let points = every(257, 1e4).chain(uniform(2_000_000, 1e4));
        let w = worst(points.map(|x| ((x, 0.0), sin(x), libm::sin(x.into()))));
        assert!(w.error <= 0.9e-7, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn cosine_is_within_1e_7_up_to_1e4_radians() {
        let points = every(257, 1e4).chain(uniform(2_000_000, 1e4));
        let w = worst(points.map(|x| ((x, 0.0), cos(x), libm::cos(x.into()))));
        assert!(w.error <= 0.9e-7, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn sine_and_cosine_lose_a_digit_up_to_1e5_radians() {
        let points = || uniform(3_000_000, LARGEST_ANGLE);
        let w = worst(points().map(|x| ((x, 0.0), sin(x), libm::sin(x.into()))));
        assert!(w.error <= 1e-6, "{:e} at {:?}", w.error, w.at);
        let w = worst(points().map(|x| ((x, 0.0), cos(x), libm::cos(x.into()))));
        assert!(w.error <= 1e-6, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn the_pair_has_the_bits_of_sine_and_cosine() {
        for x in every(1021, f32::MAX).chain(STRANGE) {
            let (s, c) = sin_cos(x);
            assert_eq!(s.to_bits(), sin(x).to_bits(), "{x:e}");
            assert_eq!(c.to_bits(), cos(x).to_bits(), "{x:e}");
        }
    }

    #[test]
    fn sine_and_cosine_stay_in_range_whatever_the_angle() {
        for x in every(1021, f32::MAX)
            .chain(uniform(1_000_000, 1e5))
            .chain(STRANGE)
        {
            let (s, c) = sin_cos(x);
            assert!((-1.0..=1.0).contains(&s), "sin({x:e}) = {s}");
            assert!((-1.0..=1.0).contains(&c), "cos({x:e}) = {c}");
        }
    }

    #[test]
    fn no_angle_and_too_large_an_angle_count_as_zero() {
        for x in [
            f32::NAN,
            -f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            1.001e5,
            -1e30,
        ] {
            assert_eq!(sin(x).to_bits(), 0.0_f32.to_bits(), "{x:e}");
            assert_eq!(cos(x), 1.0, "{x:e}");
        }
    }

    #[test]
    fn sine_is_odd_and_cosine_even() {
        for x in every(997, 1e5) {
            assert_eq!(sin(-x), -sin(x), "{x:e}");
            assert_eq!(cos(-x).to_bits(), cos(x).to_bits(), "{x:e}");
        }
    }

    #[test]
    fn exact_points_of_sine_and_cosine() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!(sin(FRAC_PI_2), 1.0);
        assert_eq!(sin(-FRAC_PI_2), -1.0);
        assert_eq!(cos(PI), -1.0);
        // The f32 next to π is not π; the sine shows by how much.
        assert_eq!(sin(PI), -PI_EXCESS);
        // A small angle is its own sine.
        assert_eq!(sin(1e-5), 1e-5);
        assert_eq!(sin(f32::MIN_POSITIVE), f32::MIN_POSITIVE);
    }

    #[test]
    fn sine_rises_from_minus_to_plus_a_quarter_turn() {
        let mut last = -1.1;
        for x in uniform(4000, 1.57) {
            assert!(sin(x) >= last, "{x}");
            last = sin(x);
        }
    }

    #[test]
    fn arcsine_is_within_1e_7_or_two_units() {
        let points = every(127, 1.0).chain(uniform(1_000_000, 1.0));
        let w = worst(points.map(|x| ((x, 0.0), asin(x), libm::asin(x.into()))));
        assert!(w.excess <= 0.0, "{:e} at {:?}", w.error, w.at);
        assert!(w.error <= 1.8e-7, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn arccosine_is_within_1e_7_or_two_units() {
        let points = every(127, 1.0).chain(uniform(1_000_000, 1.0));
        let w = worst(points.map(|x| ((x, 0.0), acos(x), libm::acos(x.into()))));
        assert!(w.excess <= 0.0, "{:e} at {:?}", w.error, w.at);
        assert!(w.error <= 2.8e-7, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn exact_points_of_arcsine_and_arccosine() {
        assert_eq!(asin(0.0).to_bits(), 0.0_f32.to_bits());
        assert_eq!(asin(-0.0).to_bits(), (-0.0_f32).to_bits());
        assert_eq!(asin(1.0), FRAC_PI_2);
        assert_eq!(asin(-1.0), -FRAC_PI_2);
        assert_eq!(acos(1.0), 0.0);
        assert_eq!(acos(0.0), FRAC_PI_2);
        assert_eq!(acos(-1.0), PI);
    }

    #[test]
    fn arguments_outside_one_count_as_one() {
        for x in [1.000_000_1, 2.0, f32::MAX, f32::INFINITY] {
            assert_eq!(asin(x), FRAC_PI_2);
            assert_eq!(asin(-x), -FRAC_PI_2);
            assert_eq!(acos(x), 0.0);
            assert_eq!(acos(-x), PI);
        }
    }

    #[test]
    fn not_a_number_counts_as_zero_whatever_its_sign() {
        for nan in [f32::NAN, -f32::NAN] {
            assert_eq!(asin(nan).to_bits(), 0.0_f32.to_bits());
            assert_eq!(acos(nan), FRAC_PI_2);
            assert_eq!(atan2(nan, -1.0).to_bits(), 0.0_f32.to_bits());
            assert_eq!(atan2(-1.0, nan).to_bits(), 0.0_f32.to_bits());
            assert_eq!(atan2(nan, nan).to_bits(), 0.0_f32.to_bits());
            assert_eq!(atan2(nan, f32::NEG_INFINITY).to_bits(), 0.0_f32.to_bits());
        }
    }

    #[test]
    fn arcsine_is_odd_and_monotonic() {
        let mut last = (-2.0, 4.0);
        for x in uniform(20_000, 1.0) {
            assert_eq!(asin(-x), -asin(x), "{x}");
            assert!(asin(x) > last.0, "{x}");
            assert!(acos(x) < last.1, "{x}");
            last = (asin(x), acos(x));
        }
    }

    #[test]
    fn arctangent_is_within_1e_7_or_two_units_around_the_circle() {
        let circle = (0..4_000_000).map(|i| {
            let (s, c) = libm::sincos(f64::from(i) * (core::f64::consts::TAU / 4e6));
            // the radius passes through all exponents
            let radius = libm::scalbn(1.0, i % 250 - 125);
            ((s * radius) as f32, (c * radius) as f32)
        });
        let w = worst(circle.map(|(y, x)| ((y, x), atan2(y, x), libm::atan2(y.into(), x.into()))));
        assert!(w.excess <= 0.0, "{:e} at {:?}", w.error, w.at);
        assert!(w.error <= 3e-7, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn arctangent_is_within_1e_7_or_two_units_for_all_ratios() {
        let ratios = every(1021, f32::MAX).flat_map(|t| [(t, 1.0), (t, -1.0), (1.0, t)]);
        let w = worst(ratios.map(|(y, x)| ((y, x), atan2(y, x), libm::atan2(y.into(), x.into()))));
        assert!(w.excess <= 0.0, "{:e} at {:?}", w.error, w.at);
    }

    #[test]
    fn arctangent_of_strange_points() {
        let numbers = STRANGE.iter().filter(|v| !v.is_nan());
        for &y in numbers.clone() {
            for &x in numbers.clone() {
                let exact = if x == 0.0 && y == 0.0 {
                    0.0_f64.copysign(y.into())
                } else {
                    libm::atan2(y.into(), x.into())
                };
                let angle = atan2(y, x);
                assert!(
                    (f64::from(angle) - exact).abs() < 3e-7,
                    "atan2({y:e}, {x:e}) = {angle}"
                );
                assert_eq!(
                    angle.is_sign_negative(),
                    y.is_sign_negative(),
                    "atan2({y:e}, {x:e})"
                );
                assert!(angle.abs() <= PI);
            }
        }
    }

    #[test]
    fn arctangent_on_the_axes_and_diagonals() {
        assert_eq!(atan2(0.0, 0.0).to_bits(), 0.0_f32.to_bits());
        assert_eq!(atan2(-0.0, -0.0).to_bits(), (-0.0_f32).to_bits());
        assert_eq!(atan2(0.0, 3.0).to_bits(), 0.0_f32.to_bits());
        assert_eq!(atan2(3.0, 0.0), FRAC_PI_2);
        assert_eq!(atan2(-3.0, -0.0), -FRAC_PI_2);
        assert_eq!(atan2(0.0, -3.0), PI);
        assert_eq!(atan2(-0.0, -3.0), -PI);
        assert_eq!(atan2(3.0, 3.0), FRAC_PI_4);
        assert_eq!(atan2(f32::MAX, f32::MAX), FRAC_PI_4);
        assert_eq!(atan2(f32::NEG_INFINITY, f32::INFINITY), -FRAC_PI_4);
        assert_eq!(atan2(1.0, f32::NEG_INFINITY), PI);
    }
}
