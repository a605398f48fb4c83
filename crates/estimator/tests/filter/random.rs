//! Seeded random numbers.

use windhover_math::{Quaternion, Vector3};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Between 0 and 1.
    pub fn share(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Between ±1.
    pub fn either(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }

    /// Standard normal, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(self.share()));
        radius * libm::cos(core::f64::consts::TAU * self.share())
    }

    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.either(), self.either(), self.either())
    }

    pub fn normals(&mut self) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal())
    }

    pub fn attitude(&mut self) -> Quaternion<f64> {
        Quaternion::new(self.normal(), self.normal(), self.normal(), self.normal()).normalized()
    }
}
