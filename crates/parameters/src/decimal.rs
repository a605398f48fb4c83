//! Numbers as text, without the standard way of writing floats: that can panic, and takes as much
//! flash as the whole of control. `cold` keeps this small.

use core::fmt;

/// A whole number as text.
#[derive(Clone, Copy, Debug)]
pub struct Whole(pub u32);

impl fmt::Display for Whole {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_digits(f, self.0, 1)
    }
}

/// A number as text: rounded to as many decimals as are asked for, or with as many as it has, four at
/// most.
#[derive(Clone, Copy, Debug)]
pub struct Decimal {
    value: f32,
    places: u8,
    trimmed: bool,
}

impl Decimal {
    /// With as many decimals as it has, four at most.
    pub const fn new(value: f32) -> Self {
        Self {
            value,
            places: 4,
            trimmed: true,
        }
    }

    /// Rounded to so many decimals, four at most; half goes away from zero.
    pub const fn rounded(value: f32, places: u8) -> Self {
        Self {
            value,
            places: if places > 4 { 4 } else { places },
            trimmed: false,
        }
    }
}

impl fmt::Display for Decimal {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.value.is_nan() {
            return f.write_str("nan");
        }
        let size = self.value.abs();
        if size >= 1e9 {
            return f.write_str(if self.value < 0.0 {
                "below -1e9"
            } else {
                "above 1e9"
            });
        }
        let (unit, scale) = match self.places {
            0 => (1, 1.0),
            1 => (10, 10.0),
            2 => (100, 100.0),
            3 => (1_000, 1e3),
            _ => (10_000, 1e4),
        };
        let whole = size as u32;
        let rest = ((size - whole as f32) * scale + 0.5) as u32;
        let (whole, mut rest) = if rest >= unit {
            (whole + 1, 0)
        } else {
            (whole, rest)
        };
        if self.value < 0.0 && (whole, rest) != (0, 0) {
            f.write_str("-")?;
        }
        write_digits(f, whole, 1)?;
        let mut places = self.places;
        while self.trimmed && places > 0 && rest.is_multiple_of(10) {
            (rest, places) = (rest / 10, places - 1);
        }
        if places == 0 {
            return Ok(());
        }
        f.write_str(".")?;
        write_digits(f, rest, usize::from(places))
    }
}

/// Digits, with zeros before them up to the least number of places.
#[cold]
#[inline(never)]
fn write_digits(f: &mut fmt::Formatter<'_>, number: u32, least: usize) -> fmt::Result {
    let (mut digits, mut rest, mut count) = ([b'0'; 10], number, 0);
    for place in digits.iter_mut().rev() {
        *place = b'0' + (rest % 10) as u8;
        rest /= 10;
        count += 1;
        if rest == 0 && count >= least {
            break;
        }
    }
    let digits = digits.get(10 - count..).unwrap_or_default();
    f.write_str(core::str::from_utf8(digits).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::format;
    use std::string::ToString;

    #[test]
    fn whole_numbers_are_written_as_the_standard_way_does() {
        for number in [0, 9, 10, 65_535, u32::MAX] {
            assert_eq!(Whole(number).to_string(), number.to_string());
        }
    }

    #[test]
    fn decimals_are_written_without_zeros_at_the_end() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (30.0, "30"),
            (-0.5, "-0.5"),
            (0.0002, "0.0002"),
            (0.00004, "0"),
            (-0.00004, "0"),
            (5000.5, "5000.5"),
            (1.99999, "2"),
            (f32::NAN, "nan"),
            (f32::INFINITY, "above 1e9"),
            (-3e9, "below -1e9"),
        ] {
            assert_eq!(Decimal::new(value).to_string(), text);
        }
    }

    /// As the standard way rounds, but where a half is in between.
    #[test]
    fn rounded_ones_are_written_as_the_standard_way_does() {
        for step in -400..400 {
            let value = step as f32 * 3.123_47;
            for places in 0..=3u8 {
                let wide = f64::from(value) * [1.0, 10.0, 100.0, 1000.0][usize::from(places)];
                if (wide.abs().fract() - 0.5).abs() < 1e-3 {
                    continue;
                }
                let standard = format!("{value:.*}", usize::from(places));
                let standard = standard
                    .strip_prefix("-0")
                    .filter(|rest| rest.chars().all(|c| c == '0' || c == '.'))
                    .map_or(standard.clone(), |rest| format!("0{rest}"));
                assert_eq!(Decimal::rounded(value, places).to_string(), standard);
            }
        }
    }
}
