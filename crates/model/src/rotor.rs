//! Rotors: a first-order lag of the speed, and what the speeds do to the body.

use windhover_math::Vector3;

use crate::integrate::Stage;
use crate::vehicle::Plant;

/// Mechanical power of the rotors over electrical power of the vehicle: propeller shaft, motor
/// and speed controller together. An assumption, the same for every vehicle.
pub const DRIVE_EFFICIENCY: f64 = 0.6;

/// Directions of the rotors in the core's order: 1 counter-clockwise seen from above.
const COUNTER_CLOCKWISE: [f64; 4] = [1.0, 1.0, -1.0, -1.0];

/// Force and torque of the rotors on the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Sum of the thrusts in N, up along the body's axis.
    pub thrust: f64,
    /// Torque about front, right and down in N·m.
    pub torque: Vector3<f64>,
    /// J_r Ω_r in kg·m²/s: angular momentum of the rotors about the body's up axis; positive
    /// when those that turn counter-clockwise are faster.
    pub spin: f64,
}

/// What rotor speeds do, from the geometry of a vehicle.
#[derive(Clone, Debug)]
pub struct RotorForces {
    k_f: f64,
    k_z: f64,
    rotor_inertia: f64,
    x: [f64; 4],
    y: [f64; 4],
}

impl RotorForces {
    /// The rotors of `plant`.
    pub fn new(plant: &Plant) -> Self {
        Self {
            k_f: plant.k_f,
            k_z: plant.k_z,
            rotor_inertia: plant.rotor_inertia,
            x: plant.rotor_position.map(|[x, _]| x),
            y: plant.rotor_position.map(|[_, y]| y),
        }
    }

    /// Force and torque at the given speeds in rad/s. Thrust acts up, so a rotor on the right
    /// rolls to the left, and one in front pitches up; the reaction to a rotor that turns
    /// counter-clockwise seen from above turns the body clockwise, which is positive about down.
    #[inline(always)]
    pub fn wrench(&self, speed: &[f64; 4]) -> Wrench {
        let square = speed.map(|w| w * w);
        let sum = |weight: &[f64; 4]| {
            (square[0] * weight[0] + square[1] * weight[1]) + (square[2] * weight[2] + square[3] * weight[3])
        };
        Wrench {
            thrust: self.k_f * sum(&[1.0; 4]),
            torque: Vector3::new(
                -self.k_f * sum(&self.y),
                self.k_f * sum(&self.x),
                self.k_z * sum(&COUNTER_CLOCKWISE),
            ),
            spin: self.rotor_inertia * (speed[0] + speed[1] - speed[2] - speed[3]),
        }
    }

    /// Electrical power of the vehicle in W: k_z ω³ of every rotor over [`DRIVE_EFFICIENCY`].
    #[inline(always)]
    pub fn power(&self, speed: &[f64; 4]) -> f64 {
        let cube = speed.map(|w| w * w * w);
        ((cube[0] + cube[1]) + (cube[2] + cube[3])) * (self.k_z / DRIVE_EFFICIENCY)
    }
}

/// Rotor speeds during a step in rad/s.
#[derive(Clone, Copy, Debug)]
pub struct StepSpeeds {
    /// At its start.
    pub start: [f64; 4],
    /// In its middle.
    pub middle: [f64; 4],
    /// At its end.
    pub end: [f64; 4],
}

impl StepSpeeds {
    /// The speeds at a stage of the step.
    #[inline(always)]
    pub fn at(&self, stage: Stage) -> &[f64; 4] {
        match stage {
            Stage::Start => &self.start,
            Stage::Middle => &self.middle,
            Stage::End => &self.end,
        }
    }
}

/// The lag for steps of one length.
#[derive(Clone, Copy, Debug)]
pub struct LagStep {
    /// What is left of a lack of speed after half a step.
    up: f64,
    /// What is left of an excess of speed after half a step.
    down: f64,
}

impl LagStep {
    /// The lag of `plant` for steps of `dt` seconds.
    pub fn new(plant: &Plant, dt: f64) -> Self {
        let decay = |lag: f64| libm::exp(-0.5 * dt / lag);
        Self {
            up: decay(plant.rotor_lag),
            down: decay(plant.rotor_lag_down.unwrap_or(plant.rotor_lag)),
        }
    }

    /// Speeds after half a step towards `target`: exact, for a target that stands still.
    #[inline(always)]
    pub fn half(&self, speed: &[f64; 4], target: &[f64; 4]) -> [f64; 4] {
        core::array::from_fn(|i| {
            let lack = target[i] - speed[i];
            let decay = if lack > 0.0 { self.up } else { self.down };
            target[i] - lack * decay
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::length::Length;
    use crate::vehicle::Vehicle;

    fn plant(name: &str) -> Plant {
        Vehicle::named(name).unwrap().plant
    }

    #[test]
    fn torques_have_the_signs_of_front_right_down() {
        let forces = RotorForces::new(&plant("x450"));
        let arm = 0.159_099;
        let thrust = 1.105e-5 * 500.0 * 500.0;
        let torque = 1.779e-7 * 500.0 * 500.0;
        // Per rotor: (roll, pitch, yaw) signs, with momentum about up.
        let expected = [
            (-1.0, 1.0, 1.0),   // front right, counter-clockwise
            (1.0, -1.0, 1.0),   // rear left, counter-clockwise
            (1.0, 1.0, -1.0),   // front left, clockwise
            (-1.0, -1.0, -1.0), // rear right, clockwise
        ];
        for (rotor, (roll, pitch, yaw)) in expected.into_iter().enumerate() {
            let mut speed = [0.0; 4];
            speed[rotor] = 500.0;
            let wrench = forces.wrench(&speed);
            let wanted = Vector3::new(roll * arm * thrust, pitch * arm * thrust, yaw * torque);
            assert!((wrench.torque - wanted).length() < 1e-12, "rotor {rotor}");
            assert!((wrench.thrust - thrust).abs() < 1e-12);
            assert!((wrench.spin - yaw * 1.287e-4 * 500.0).abs() < 1e-12);
        }
    }

    #[test]
    fn hovering_speed_carries_the_weight_without_torque() {
        for name in ["os4", "x450"] {
            let plant = plant(name);
            let wrench = RotorForces::new(&plant).wrench(&[plant.hover_speed(); 4]);
            assert!((wrench.thrust - plant.weight()).abs() < 1e-12);
            assert!(wrench.torque.length() < 1e-15 && wrench.spin == 0.0);
        }
    }

    #[test]
    fn power_is_torque_times_speed() {
        let plant = plant("os4");
        let forces = RotorForces::new(&plant);
        let power = forces.power(&[100.0, 200.0, 0.0, 300.0]);
        let wanted = 7.5e-7 * (1e6 + 8e6 + 27e6) / 0.6;
        assert!((power - wanted).abs() < 1e-9);
    }

    #[test]
    fn the_lag_is_an_exponential_for_any_step() {
        let plant = plant("os4");
        for steps in [1, 10, 1000] {
            let lag = LagStep::new(&plant, 0.03 / f64::from(steps));
            let mut speed = [0.0, 100.0, 400.0, 200.0];
            for _ in 0..2 * steps {
                speed = lag.half(&speed, &[300.0, 300.0, 0.0, 200.0]);
            }
            let left = libm::exp(-1.0);
            let wanted = [300.0 * (1.0 - left), 300.0 - 200.0 * left, 400.0 * left, 200.0];
            for i in 0..4 {
                assert!((speed[i] - wanted[i]).abs() < 1e-9, "{steps} steps, rotor {i}");
            }
        }
    }

    #[test]
    fn slowing_down_may_take_longer() {
        let mut plant = plant("os4");
        plant.rotor_lag_down = Some(0.06);
        let lag = LagStep::new(&plant, 0.12);
        let speed = lag.half(&[0.0, 100.0, 100.0, 0.0], &[100.0, 0.0, 100.0, 0.0]);
        let wanted = [
            100.0 * (1.0 - libm::exp(-2.0)),
            100.0 * libm::exp(-1.0),
            100.0,
            0.0,
        ];
        for i in 0..4 {
            assert!((speed[i] - wanted[i]).abs() < 1e-9);
        }
    }
}
