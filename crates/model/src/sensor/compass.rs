//! What a compass IST8310 or QMC5883L reads: the Earth's field and what the vehicle adds to it.
//!
//! The field is an input in NED: declination, inclination and strength come from outside. What is
//! left after calibration is a hard-iron vector that turns with the body and a symmetric soft-iron
//! matrix; besides, the battery's current makes a field in a direction fixed to the body.

use windhover_math::{Matrix3, Vector3};

use super::mounting::Mounting;
use super::noise::{direction, gaussian3};
use super::{count, stream};
use crate::length::Length;
use crate::random::Random;
use crate::truth::Truth;

/// Which part it is, and in which configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompassPart {
    /// iSentek IST8310 in its 14 bits after a reset: 3.3 counts per µT.
    #[default]
    Ist8310,
    /// iSentek IST8310 with 16 bits on every axis (CNTL3): 13.2 counts per µT.
    Ist8310Fine,
    /// QST QMC5883L at ±2 G: 120 counts per µT.
    Qmc5883l2G,
    /// QST QMC5883L at ±8 G: 30 counts per µT.
    Qmc5883l8G,
}

impl CompassPart {
    /// Counts per µT (data sheets: sensitivity).
    pub const fn scale(self) -> f64 {
        match self {
            Self::Ist8310 => 3.3,
            Self::Ist8310Fine => 13.2,
            Self::Qmc5883l2G => 120.0,
            Self::Qmc5883l8G => 30.0,
        }
    }

    /// How the part's z looks when its x and y are front and right: 1 is down. The IST8310's axes
    /// are left-handed (as its drivers in PX4 say), so that its z points up then.
    pub const fn z_sign(self) -> f64 {
        match self {
            Self::Ist8310 | Self::Ist8310Fine => -1.0,
            Self::Qmc5883l2G | Self::Qmc5883l8G => 1.0,
        }
    }

    /// The largest field of each axis in µT (data sheets: field range). The QMC5883L's at ±2 G
    /// and ±8 G are 200 and 800 µT of at most 32767 counts.
    pub const fn range(self) -> [f64; 3] {
        match self {
            Self::Ist8310 | Self::Ist8310Fine => [1600.0, 1600.0, 2500.0],
            Self::Qmc5883l2G => [200.0; 3],
            Self::Qmc5883l8G => [800.0; 3],
        }
    }
}

/// A magnetic field in NED from its declination (east positive) and inclination (down positive)
/// in rad, and its strength; north, east and down have the strength's unit.
pub fn earth_field(declination: f64, inclination: f64, strength: f64) -> Vector3<f64> {
    let (down, horizontal) = libm::sincos(inclination);
    let (east, north) = libm::sincos(declination);
    Vector3::new(horizontal * north, horizontal * east, down) * strength
}

/// Around Zürich in 2025: 48.4 µT, 3.5° east, 63.4° down; rounded.
pub fn default_field() -> Vector3<f64> {
    let degree = core::f64::consts::PI / 180.0;
    earth_field(3.5 * degree, 63.4 * degree, 48.4)
}

/// Errors of the compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassErrors {
    /// What is left of hard and soft iron, over the field: RMS length of the error vector over
    /// parts, half of its square hard and half soft.
    pub residual: f64,
    /// Field of the motors' current, in µT/A.
    pub current: f64,
    /// Where it points in the body, as a unit vector; `None` for a direction that the seed draws,
    /// uniform on the sphere.
    pub current_direction: Option<Vector3<f64>>,
    /// The battery's voltage by which the truth's power becomes a current, in V.
    pub voltage: f64,
    /// White noise in µT: standard deviation per axis.
    pub noise: f64,
    /// How the part sits, as if its axes were right-handed.
    pub mounting: Mounting,
}

impl CompassErrors {
    /// No errors.
    pub const fn ideal() -> Self {
        Self {
            residual: 0.0,
            current: 0.0,
            current_direction: None,
            voltage: 14.8,
            noise: 0.0,
            mounting: Mounting([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        }
    }
}

impl Default for CompassErrors {
    /// Residual and current: design §5. Noise: the field resolution of 2 mG in the QMC5883L's
    /// data sheet, taken for both. Voltage: four lithium cells at 3.7 V.
    fn default() -> Self {
        Self {
            residual: 0.02,
            current: 1.0,
            noise: 0.2,
            ..Self::ideal()
        }
    }
}

/// One compass.
#[derive(Clone, Debug)]
pub struct Compass {
    part: CompassPart,
    field: Vector3<f64>,
    mounting: Mounting,
    noise: f64,
    random: Random,
    hard: Vector3<f64>,
    /// What of the field is seen: near the identity.
    soft: Matrix3<f64>,
    /// µT per W, in the body.
    per_watt: Vector3<f64>,
}

impl Compass {
    /// The part that `seed` draws, in the magnetic field `field` in NED in µT.
    pub fn new(part: CompassPart, errors: &CompassErrors, field: Vector3<f64>, seed: u64) -> Self {
        let mut random = Random::new(seed, stream::COMPASS);
        let half = errors.residual * core::f64::consts::FRAC_1_SQRT_2;
        let hard = direction(&mut random) * (half * field.length());
        // Each row of three independent entries sees |B| times an entry's deviation.
        let entry = half / 3.0_f64.sqrt();
        let diagonal = gaussian3(&mut random, entry).add_scalar(1.0);
        let off = gaussian3(&mut random, entry);
        let soft = Matrix3::new(
            diagonal.x, off.x, off.y, //
            off.x, diagonal.y, off.z, //
            off.y, off.z, diagonal.z,
        );
        let drawn = direction(&mut random);
        let along = errors.current_direction.unwrap_or(drawn);
        Self {
            part,
            field,
            mounting: errors.mounting,
            noise: errors.noise,
            random,
            hard,
            soft,
            per_watt: along * (errors.current / errors.voltage),
        }
    }

    /// Which part it is.
    pub fn part(&self) -> CompassPart {
        self.part
    }

    /// Measures: counts along the part's axes.
    pub fn measure(&mut self, truth: &Truth) -> [i16; 3] {
        let earth = truth.attitude.inverse_rotate(self.field);
        let body = self.soft * earth + self.hard + self.per_watt * truth.power;
        let noise = gaussian3(&mut self.random, self.noise);
        let mut seen = self.mounting.to_part(body) + noise;
        seen.z *= self.part.z_sign();
        let range = self.part.range();
        core::array::from_fn(|axis| {
            let limit = Ord::min((range[axis] * self.part.scale()) as i32, i16::MAX.into());
            count(seen[axis] * self.part.scale(), -limit, limit) as i16
        })
    }
}
