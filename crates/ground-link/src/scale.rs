//! Numbers between the wire's units and ours.

use core::f32::consts::PI;

use mavlink::dialects::common::MavFrame;
use windhover_autopilot::mission::action::Altitude;

/// Radians in a degree.
pub(crate) const DEGREE: f32 = PI / 180.0;

/// 1e-7 degrees in a degree.
pub(crate) const E7: u32 = 10_000_000;

/// Numbers from outside end here: whatever is done with them later, their squares are finite.
const LARGEST: f32 = 1e9;

/// The integer nearest to a value times a factor; what is beyond the range, or no number, ends at
/// its edge, or at 0. Exact, by integers: `f64` is software on the target, and takes flash.
#[inline(never)]
pub(crate) fn integer(value: f32, factor: u32) -> i32 {
    if value.is_nan() {
        return 0;
    }
    // |value| = mantissa · 2^(exponent - 150)
    let (exponent, fraction) = (value.to_bits() >> 23 & 0xff, value.to_bits() & 0x7f_ffff);
    let mantissa = if exponent == 0 {
        fraction
    } else {
        fraction | 0x80_0000
    };
    let product = u64::from(mantissa) * u64::from(factor);
    let size = match exponent {
        0..=92 => 0, // below a half
        93..=149 => {
            let down = 150 - exponent;
            (product + (1 << (down - 1))) >> down
        }
        150..=157 => product << (exponent - 150),
        _ => u64::MAX,
    };
    let size = i32::try_from(size).unwrap_or(i32::MAX);
    if value < 0.0 { -size } else { size }
}

/// A time divided by 10 or 1000: by long division with digits of 16 bits,
/// because 64 bits are divided in software.
#[inline(never)]
pub(crate) fn divided(time: u64, divisor: u16) -> u64 {
    let divisor = u32::from(divisor);
    let (mut rest, mut quotient) = (0, 0);
    for shift in [48, 32, 16, 0] {
        let digit = rest << 16 | (time >> shift) as u32 & 0xffff;
        let part = digit.checked_div(divisor).unwrap_or_default();
        rest = digit - part * divisor;
        quotient = quotient << 16 | u64::from(part);
    }
    quotient
}

/// A float that may say "unset".
pub(crate) fn set(value: f32) -> Option<f32> {
    value.is_finite().then(|| value.clamp(-LARGEST, LARGEST))
}

/// The nearest integer to a value times `scale`, within a range; `unset` when it is no number.
#[inline(never)]
pub(crate) fn scaled(value: f32, scale: u32, unset: i32, (low, high): (i32, i32)) -> i32 {
    match value.is_finite() {
        true => integer(value, scale).clamp(low, high),
        false => unset,
    }
}

/// The same for `u16`, whose largest value says "unknown".
pub(crate) fn word(value: Option<f32>, scale: u32) -> u16 {
    let value = value.unwrap_or(f32::NAN);
    scaled(value, scale, 0xffff, (0, 0xfffe)) as u16
}

/// The same for `i16`; 0 when it is no number.
pub(crate) fn short(value: f32, scale: u32) -> i16 {
    scaled(value, scale, 0, (-0x7fff, 0x7fff)) as i16
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
    (scaled(positive / DEGREE, 100, 0, (0, 36_000)) % 36_000) as u16
}

/// What an altitude counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Datum {
    SeaLevel,
    Home,
    /// As the client's idea of us has it.
    Implied,
    Unsupported,
}

impl Datum {
    /// That of a `MAV_FRAME`.
    #[inline(never)]
    pub fn of(frame: u8) -> Self {
        const SEA_LEVEL: [u8; 2] = [
            MavFrame::MAV_FRAME_GLOBAL as u8,
            MavFrame::MAV_FRAME_GLOBAL_INT as u8,
        ];
        const HOME: [u8; 2] = [
            MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT as u8,
            MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT as u8,
        ];
        match frame {
            frame if SEA_LEVEL.contains(&frame) => Self::SeaLevel,
            frame if HOME.contains(&frame) => Self::Home,
            frame if frame == MavFrame::MAV_FRAME_MISSION as u8 => Self::Implied,
            _ => Self::Unsupported,
        }
    }

    /// So many metres from there; `None` where that is not said.
    pub fn altitude(self, metres: f32) -> Option<Altitude> {
        match self {
            Self::SeaLevel => Some(Altitude::SeaLevel(metres)),
            Self::Home => Some(Altitude::Home(metres)),
            Self::Implied | Self::Unsupported => None,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use windhover_autopilot::mission::MissionItem;
    use windhover_autopilot::mission::action::{Action, interpret};

    use super::*;

    #[test]
    fn what_is_no_number_or_too_large_stays_within_bounds() {
        assert_eq!((integer(f32::NAN, 1), integer(-2.5, 1)), (0, -3));
        assert_eq!(
            (integer(f32::INFINITY, 1), integer(f32::MIN, 7)),
            (i32::MAX, -i32::MAX)
        );
        assert_eq!(
            (word(None, 1), word(Some(1e9), 1), word(Some(-1.0), 1)),
            (0xffff, 0xfffe, 0)
        );
        assert_eq!(
            (short(f32::NAN, 1), short(1e9, 1), short(-1.234, 100)),
            (0, 0x7fff, -123)
        );
        assert_eq!((set(f32::NAN), set(-3e38)), (None, Some(-LARGEST)));
    }

    /// The same frame must not mean one altitude in a command and another in a mission.
    #[test]
    fn altitudes_count_as_in_a_mission_in_every_frame() {
        for frame in 0..=u8::MAX {
            let item = MissionItem {
                command: 16,
                frame,
                autocontinue: true,
                params: [0.0; 4],
                x: 473_977_418,
                y: 85_455_938,
                z: 30.5,
            };
            let flown = match interpret(&item) {
                Ok(Action::Waypoint { place, .. }) => Some(place.altitude),
                _ => None,
            };
            assert_eq!(Datum::of(frame).altitude(30.5), flown, "frame {frame}");
        }
    }

    proptest! {
        #[test]
        fn times_are_divided_as_by_the_operator(time in any::<u64>(), divisor in prop::sample::select(&[10u16, 1000, u16::MAX][..])) {
            prop_assert_eq!(divided(time, divisor), time / u64::from(divisor));
        }

        /// A product of 24 and 29 bits is exact in `f64`: the reference.
        #[test]
        fn every_float_is_multiplied_as_by_f64(bits in any::<u32>(), factor in prop::sample::select(&[1u32, 100, 1000, 10_000, 10_000_000][..])) {
            let value = f32::from_bits(bits);
            let exact = f64::from(value) * f64::from(factor);
            let half = if exact < 0.0 { -0.5 } else { 0.5 };
            let expected = ((exact + half) as i32).max(-i32::MAX);
            prop_assert_eq!(integer(value, factor), expected, "{} {}", value, factor);
        }
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
