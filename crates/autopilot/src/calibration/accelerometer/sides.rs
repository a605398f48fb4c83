//! The six sides of a vehicle, and sets of them.

use core::fmt;

use windhover_math::Vector3;
use windhover_math::scalar::norm;

/// A side of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The front axis points down.
    Front,
    /// The front axis points up.
    Back,
    /// The right axis points down.
    Right,
    /// The right axis points up.
    Left,
    /// The down axis points down: it stands as it flies.
    Bottom,
    /// The down axis points up.
    Top,
}

/// Cosine of the largest angle between an axis and the vertical: 25°.
const LEAST_COSINE: f32 = 0.906;
/// Between these sizes, m/s², a mean is gravity with the largest offset and scale.
const GRAVITY_SHOWN: core::ops::RangeInclusive<f32> = 6.0..=14.0;

impl Side {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::Front,
        Self::Back,
        Self::Right,
        Self::Left,
        Self::Bottom,
        Self::Top,
    ];

    /// The side that is down under this specific force, m/s².
    pub(super) fn down(force: Vector3) -> Option<Self> {
        let size = norm(force);
        if !GRAVITY_SHOWN.contains(&size) {
            return None;
        }
        let least = LEAST_COSINE * size;
        // At rest the force points up: against the side that is down.
        let along = [-force.x, force.x, -force.y, force.y, -force.z, force.z];
        Self::ALL
            .into_iter()
            .zip(along)
            .find(|(_, component)| *component >= least)
            .map(|(side, _)| side)
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Right => "right side",
            Self::Left => "left side",
            Self::Bottom => "bottom",
            Self::Top => "top",
        })
    }
}

/// A set of sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sides(u8);

impl Sides {
    /// Whether this side is in it.
    pub fn contains(self, side: Side) -> bool {
        self.0 & (1 << side as u8) != 0
    }

    /// With this side.
    #[must_use]
    pub fn with(self, side: Side) -> Self {
        Self(self.0 | (1 << side as u8))
    }

    /// The sides that are not in it.
    #[must_use]
    pub fn others(self) -> Self {
        Self(!self.0 & 0x3F)
    }

    /// How many there are.
    pub fn count(self) -> u8 {
        self.0.count_ones() as u8
    }

    /// One after the other.
    pub fn iter(self) -> impl Iterator<Item = Side> {
        Side::ALL.into_iter().filter(move |side| self.contains(*side))
    }
}

impl fmt::Display for Sides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, side) in self.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{side}")?;
        }
        Ok(())
    }
}
