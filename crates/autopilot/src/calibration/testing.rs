//! What the tests of calibrations share: numbers drawn from a seed, samples as a sensor gives them.

use proptest::prelude::*;
use windhover_math::scalar::norm;
use windhover_math::{GRAVITY, Quaternion, Vector3};
use windhover_parameters::Group;

use crate::sensing::Inertial;

/// Numbers from a seed: xorshift64*.
pub struct Noise(u64);

impl Noise {
    /// From this seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Even between 0 and 1.
    pub fn share(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    /// Even within ± `limit`.
    pub fn within(&mut self, limit: f32) -> f32 {
        (2.0 * self.share() - 1.0) * limit
    }

    /// Normal with this deviation, nearly: the sum of twelve.
    pub fn normal(&mut self, deviation: f32) -> f32 {
        let sum: f32 = (0..12).map(|_| self.share()).sum();
        (sum - 6.0) * deviation
    }

    /// Three of these.
    pub fn vector(&mut self, deviation: f32) -> Vector3 {
        Vector3::from_fn(|_, _| self.normal(deviation))
    }

    /// A direction, all alike.
    pub fn direction(&mut self) -> Vector3 {
        let v = self.vector(1.0);
        v / norm(v)
    }
}

/// Sample interval of the tests, s: as the outer loop has it.
pub const INTERVAL: f32 = 0.004;

/// A sensor at rest in this attitude: noise of 0.01 rad/s and 0.2 m/s², and the vibration of a fan
/// at 93 Hz with 0.05 rad/s and 1 m/s².
pub fn at_rest(noise: &mut Noise, attitude: Quaternion, time: f32) -> Inertial {
    let gravity = attitude.inverse_rotate(Vector3::new(0.0, 0.0, -GRAVITY));
    let phase = windhover_math::wrap_pi(time * 93.0 * core::f32::consts::TAU);
    let shake = Vector3::new(0.3, -0.5, 0.8) * windhover_math::sin(phase);
    Inertial {
        specific_force: gravity + shake + noise.vector(0.2),
        rate: shake * 0.05 + noise.vector(0.01),
    }
}

/// Any `f32` there is, but often one that a sensor could give.
pub fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>().prop_map(f32::from_bits), -20.0_f32..20.0, Just(0.0)]
}

/// Any duration, but mostly one that is let through.
pub fn any_duration() -> impl Strategy<Value = f32> {
    prop_oneof![1 => any::<u32>().prop_map(f32::from_bits), 50 => 0.2_f32..0.5]
}

/// Any inertial sample.
pub fn any_inertial() -> impl Strategy<Value = Inertial> {
    prop::array::uniform6(any_number()).prop_map(|[a, b, c, d, e, f]| Inertial {
        specific_force: Vector3::new(a, b, c),
        rate: Vector3::new(d, e, f),
    })
}

/// Every value must be one that the parameter table would accept.
pub fn within_declarations<G: Group>(parameters: &G) {
    for (index, declaration) in G::DECLARATIONS.iter().enumerate() {
        let value = parameters.get(index).unwrap();
        assert_eq!(declaration.check(value), Ok(()), "{} {value}", declaration.name);
    }
}
