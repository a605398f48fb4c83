//! Payload: a box hung under the vehicle.

use thiserror::Error;
use windhover_math::Vector3;

/// Depth of the payload's centre below the vehicle's centre of mass, in m.
const DEPTH: f64 = 0.05;

/// Edge of the payload, a solid cube, in m.
const EDGE: f64 = 0.1;

/// A solid cube of 0.1 m, fixed with its centre 0.05 m below the centre of mass. It adds to mass
/// and inertia; the centre of mass and so the rotors' arms stay where they are, as if the
/// battery had been moved to balance it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Payload {
    mass: f64,
}

/// A payload that is not one.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("payload is {0} kg: must be 0 to 100")]
pub struct PayloadError(pub f64);

impl Payload {
    /// No payload.
    pub const NONE: Self = Self { mass: 0.0 };

    /// A payload of `mass` kg.
    ///
    /// ```
    /// use windhover_model::Payload;
    /// assert!(Payload::new(0.7).is_ok());
    /// assert!(Payload::new(-0.1).is_err() && Payload::new(f64::NAN).is_err());
    /// ```
    pub fn new(mass: f64) -> Result<Self, PayloadError> {
        if (0.0..=100.0).contains(&mass) {
            Ok(Self { mass })
        } else {
            Err(PayloadError(mass))
        }
    }

    /// Mass in kg.
    pub fn mass(self) -> f64 {
        self.mass
    }

    /// Inertia about the vehicle's centre of mass: front, right, down, in kg·m².
    pub fn inertia(self) -> Vector3<f64> {
        let own = EDGE * EDGE / 6.0;
        let hung = DEPTH * DEPTH;
        Vector3::new(own + hung, own + hung, own) * self.mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Body;
    use crate::length::Length;
    use crate::vehicle::Vehicle;

    #[test]
    fn payload_adds_to_mass_and_inertia() {
        let plant = Vehicle::named("x450").unwrap().plant;
        let payload = Payload::new(0.6).unwrap();
        let body = Body::new(&plant, payload);
        assert!((body.mass - 2.0).abs() < 1e-15);
        let added = body.inertia - Vector3::from(plant.inertia);
        // 0.6·(0.01/6 + 0.0025) and 0.6·0.01/6
        assert!((added - Vector3::new(0.0025, 0.0025, 0.001)).length() < 1e-15);
    }

    #[test]
    fn payload_out_of_range_is_refused_with_its_value() {
        assert_eq!(
            Payload::new(-1.0).unwrap_err().to_string(),
            "payload is -1 kg: must be 0 to 100"
        );
        assert!(Payload::new(f64::INFINITY).is_err());
    }
}
