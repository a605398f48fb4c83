//! Pulses for electronic speed controllers: from the core's motor command to a timer's compare
//! value, in integers.
//!
//! The standard of the field: a pulse of 1 ms stops a motor, one of 2 ms turns it at full speed.

/// A pulse's length in counts of its timer, for a command of 65535·ω/ω_max: 1 ms to 2 ms, linear.
/// `per_millisecond` is the timer's rate in counts per ms, at most 65,535.
///
/// The result is rounded down, so that 0 is exactly 1 ms and 65535 exactly 2 ms.
#[inline]
pub const fn counts(command: u16, per_millisecond: u16) -> u32 {
    let (command, full) = (command as u32, per_millisecond as u32);
    full + command * full / u16::MAX as u32
}

/// The pulse that stops a motor and keeps its controller awake, in counts.
#[inline]
pub const fn stop(per_millisecond: u16) -> u32 {
    per_millisecond as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_one_and_two_milliseconds() {
        for per_millisecond in [1_000, 21_000, 28_000, u16::MAX] {
            assert_eq!(counts(0, per_millisecond), u32::from(per_millisecond));
            assert_eq!(counts(u16::MAX, per_millisecond), 2 * u32::from(per_millisecond));
            assert_eq!(stop(per_millisecond), counts(0, per_millisecond));
        }
    }

    /// Against real numbers: the count below the exact value, and never less than before.
    #[test]
    fn linear_in_between() {
        for per_millisecond in [1_000u16, 21_000, 28_000, u16::MAX] {
            let mut last = 0;
            for command in 0..=u16::MAX {
                let exact = f64::from(per_millisecond) * (1.0 + f64::from(command) / 65_535.0);
                let counts = counts(command, per_millisecond);
                assert!(
                    counts >= last && (exact + 1e-6).floor() == f64::from(counts),
                    "{command}"
                );
                last = counts;
            }
        }
    }
}
