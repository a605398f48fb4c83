//! Numbers between the wire's units and ours.

use core::f32::consts::PI;

/// Radians in a degree.
pub(crate) const DEGREE: f32 = PI / 180.0;

/// The nearest integer; what is beyond the range, or no number, ends at its edge, or at 0.
#[inline(never)]
pub(crate) fn integer(value: f64) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}

/// A float that may say "unset".
pub(crate) fn set(value: f32) -> Option<f32> {
    value.is_finite().then_some(value)
}

/// The nearest integer to a value times `scale`, within the type's range; `unset` when it is no
/// number.
pub(crate) fn scaled<T: TryFrom<i32>>(value: f32, scale: f32, unset: T, range: (i32, i32)) -> T {
    if !value.is_finite() {
        return unset;
    }
    let (low, high) = range;
    let scaled = integer(f64::from(value) * f64::from(scale)).clamp(low, high);
    T::try_from(scaled).unwrap_or(unset)
}

/// The same for `u16`, whose largest value says "unknown".
pub(crate) fn word(value: Option<f32>, scale: f32) -> u16 {
    let value = value.unwrap_or(f32::NAN);
    scaled(value, scale, u16::MAX, (0, 0xfffe))
}

/// The same for `i16`; 0 when it is no number.
pub(crate) fn short(value: f32, scale: f32) -> i16 {
    scaled(value, scale, 0, (-0x7fff, 0x7fff))
}

/// A heading or course in rad as hundredths of a degree, 0 to 35999; `u16::MAX` when unknown.
pub(crate) fn centidegrees(angle: Option<f32>) -> u16 {
    let Some(angle) = angle.filter(|angle| angle.is_finite()) else {
        return u16::MAX;
    };
    let wrapped = windhover_math::wrap_pi(angle);
    let positive = if wrapped < 0.0 {
        wrapped + 2.0 * PI
    } else {
        wrapped
    };
    scaled(positive, 100.0 / DEGREE, 0u16, (0, 36_000)) % 36_000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_too_large_stays_within_bounds() {
        assert_eq!(
            (integer(f64::NAN), integer(1e300), integer(-2.5)),
            (0, i32::MAX, -3)
        );
        assert_eq!(
            (word(None, 1.0), word(Some(1e9), 1.0), word(Some(-1.0), 1.0)),
            (0xffff, 0xfffe, 0)
        );
        assert_eq!(
            (short(f32::NAN, 1.0), short(1e9, 1.0), short(-1.234, 100.0)),
            (0, 0x7fff, -123)
        );
        assert_eq!(set(f32::NAN), None);
    }

    #[test]
    fn headings_run_from_north_to_just_below_a_full_turn() {
        assert_eq!(centidegrees(Some(0.0)), 0);
        assert_eq!(centidegrees(Some(-PI / 2.0)), 27_000);
        assert_eq!(centidegrees(Some(-1e-9)), 0);
        assert_eq!(centidegrees(Some(f32::NAN)), u16::MAX);
        assert_eq!(centidegrees(None), u16::MAX);
    }
}
