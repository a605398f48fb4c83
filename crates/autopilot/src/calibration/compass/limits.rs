//! What is asked of a calibration of the compass, what it asks of a human, and why there is none.

use core::fmt;

use core::ops::RangeInclusive;
use windhover_parameters::Decimal;

use super::Cells;
use crate::calibration::{Axis, BadSample};

/// What is asked of a compass' calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassLimits {
    /// Strength of the earth's field at this place, µT, where it is known.
    pub expected: Option<f32>,
    /// Largest difference of the strength found from the expected one, as a share of that: iron
    /// and the sensor's scale change it.
    pub strength: f32,
    /// So many of the 24 cells must be reached.
    pub cells: u8,
    /// Largest offset of an axis, µT.
    pub offset: f32,
    /// Largest ratio of the longest axis of the ellipsoid to the shortest. With 2.2 all factors lie
    /// between 0.55 and 1.58 and all cross terms within 0.43.
    pub ratio: f32,
    /// Of 100 samples 85, and of the last 16 half, must lie so near to the ellipsoid, as a share of its
    /// size. Good ones of 3000 trials showed up to 0.013, with noise of 0.3 µT.
    pub spread: f32,
    /// Time limit for turning, s.
    pub timeout: f32,
}

impl Default for CompassLimits {
    fn default() -> Self {
        Self {
            expected: None,
            strength: 0.4,
            cells: 22,
            offset: 150.0,
            ratio: 2.2,
            spread: 0.025,
            timeout: 180.0,
        }
    }
}

/// The earth's field anywhere, µT: 22 to 67 (World Magnetic Model), with a third for iron.
const ANYWHERE: RangeInclusive<f32> = 15.0..=90.0;

impl CompassLimits {
    /// Least and largest strength, µT.
    pub(super) fn strengths(&self) -> RangeInclusive<f32> {
        match self.expected {
            None => ANYWHERE,
            Some(expected) => expected * (1.0 - self.strength)..=expected * (1.0 + self.strength),
        }
    }
}

/// What the human is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompassInstruction {
    /// Turn the vehicle until the field has come from these directions too.
    Turn(Cells),
    /// The same, more slowly: samples lie too far apart.
    TurnSlower(Cells),
    /// Enough: the fit is being made.
    Wait,
}

impl fmt::Display for CompassInstruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Turn(missing) => write!(
                f,
                "turn the vehicle every way; {} directions of 24 missing",
                missing.count()
            ),
            Self::TurnSlower(missing) => {
                write!(f, "turn more slowly; {} directions missing", missing.count())
            }
            Self::Wait => f.write_str("enough samples"),
        }
    }
}

/// Why there is no calibration of the compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CompassRefusal {
    /// A sample is none.
    Sample(BadSample),
    /// Time ran out with hardly any samples that differ and agree with those next to them.
    Timeout,
    /// Time ran out with only these directions reached.
    Coverage(Cells),
    /// The samples do not lie on an ellipsoid.
    NoEllipsoid,
    /// Too many samples lie as far as this, or farther, from the ellipsoid, as a share of its size.
    Residual(f32),
    /// The strength found, µT, is not the earth's.
    Strength(f32),
    /// The longest axis is so many times the shortest.
    Ratio(f32),
    /// The offset of an axis, µT, is larger than any.
    Offset(Axis, f32),
}

impl fmt::Display for CompassRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sample(bad) => bad.fmt(f),
            Self::Timeout => f.write_str("time ran out: the field did not change, or too fast"),
            Self::Coverage(cells) => write!(
                f,
                "time ran out with {} of 24 directions: turn the vehicle onto all its sides",
                cells.count()
            ),
            Self::NoEllipsoid => f.write_str("the field is distorted beyond repair: move away from iron"),
            Self::Residual(share) => write!(
                f,
                "the field varies by {} %: something magnetic moved nearby",
                Decimal::rounded(share * 100.0, 0)
            ),
            Self::Strength(strength) => {
                let strength = Decimal::rounded(*strength, 0);
                write!(
                    f,
                    "a field of {strength} µT is not the earth's: move away from iron"
                )
            }
            Self::Ratio(ratio) => {
                let ratio = Decimal::rounded(*ratio, 1);
                write!(
                    f,
                    "the field is {ratio} times as strong one way as another: iron at the compass"
                )
            }
            Self::Offset(axis, offset) => {
                let offset = Decimal::rounded(*offset, 0);
                write!(f, "{offset} µT on the {axis}: a magnet near the compass")
            }
        }
    }
}
