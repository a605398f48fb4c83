//! The body that all models move: mass, inertia and drag, of vehicle and payload together.

use windhover_math::Vector3;

use crate::GRAVITY;
use crate::length::Length;
use crate::payload::Payload;
use crate::vehicle::Plant;

/// Mass, inertia and drag.
#[derive(Clone, Debug)]
pub struct Body {
    /// Mass in kg.
    pub mass: f64,
    /// Moments of inertia about front, right and down in kg·m².
    pub inertia: Vector3<f64>,
    /// Drag force per airspeed in kg/s.
    pub linear_drag: f64,
    /// Drag force per squared airspeed in kg/m.
    pub quadratic_drag: f64,
    pub(crate) inverse_mass: f64,
    pub(crate) inverse_inertia: Vector3<f64>,
}

/// What acts on a body from outside during a step, besides its rotors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outside {
    /// Velocity of the air in NED, in m/s.
    pub wind: Vector3<f64>,
    /// Sum of the pushes in NED, in N.
    pub force: Vector3<f64>,
    /// Acceleration in NED that acts on every mass alike, in m/s², besides gravity.
    pub acceleration: Vector3<f64>,
}

impl Body {
    /// The body of `plant` with `payload` below it.
    pub fn new(plant: &Plant, payload: Payload) -> Self {
        let mass = plant.mass + payload.mass();
        let inertia = Vector3::from(plant.inertia) + payload.inertia();
        Self {
            mass,
            inertia,
            linear_drag: plant.linear_drag,
            quadratic_drag: plant.quadratic_drag,
            inverse_mass: 1.0 / mass,
            inverse_inertia: Vector3::new(1.0 / inertia.x, 1.0 / inertia.y, 1.0 / inertia.z),
        }
    }

    /// Acceleration in NED, in m/s², of everything but the rotors: gravity, drag against the
    /// air, pushes.
    #[inline(always)]
    pub fn outside_acceleration(&self, velocity: Vector3<f64>, outside: &Outside) -> Vector3<f64> {
        let through_air = outside.wind - velocity;
        let mut drag = self.linear_drag;
        if self.quadratic_drag > 0.0 {
            drag += self.quadratic_drag * through_air.length();
        }
        let force = through_air * drag + outside.force;
        let mut acceleration = outside.acceleration + force * self.inverse_mass;
        acceleration.z += GRAVITY;
        acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::Vehicle;

    #[test]
    fn drag_acts_against_the_velocity_through_the_air() {
        let mut plant = Vehicle::named("os4").unwrap().plant;
        plant.quadratic_drag = 0.1;
        let body = Body::new(&plant, Payload::NONE);
        let outside = Outside {
            wind: Vector3::new(4.0, 2.0, 0.0),
            force: Vector3::new(0.0, 0.0, 1.3),
            acceleration: Vector3::new(0.0, 0.5, 0.0),
        };
        let carried = body.outside_acceleration(outside.wind, &outside);
        assert!((carried - Vector3::new(0.0, 0.5, GRAVITY + 2.0)).length() < 1e-12);
        let velocity = Vector3::new(4.0, -2.0, 3.0); // through the air: east -4, down 3
        let drag = body.outside_acceleration(velocity, &outside) - carried;
        let wanted = Vector3::new(0.0, 4.0, -3.0) * ((0.25 + 0.1 * 5.0) / 0.65);
        assert!((drag - wanted).length() < 1e-12);
    }
}
