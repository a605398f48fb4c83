//! The disturbance observer: what wind, payload and model errors do to the vehicle.
//!
//! The accelerometer measures all forces but gravity, per unit mass. What the rotors' thrust does
//! not explain of it is the disturbance: drag in the wind, a push, a mass that is not the one
//! reckoned with. Fed back with the opposite sign it is gone before a position error has grown.
//!
//! e' = (f − f_thrust − e)/T, d' = (e − d)/T, with f the specific force in the world and
//! f_thrust = −z_B·P/m. Two low-passes, because the accelerometer shakes with the rotors: what of
//! that reached the thrust would come back by the rotors' speed, in phase with the shaking, and be
//! measured as a force that is not there.

use windhover_math::{Vector3, scalar};
use windhover_parameters::parameters;

use crate::pid::low_pass_share;

parameters! {
    /// The disturbance observer. Defaults: preset `windhover`.
    pub struct ObserverParameters {
        share: "OBS_SHARE", "", 0.0..=1.0, 1.0, "Share of the observed disturbance that is taken out";
        time_constant: "OBS_TC", "s", 0.005..=10.0, 0.06, "Time constant of each of the observer's two low-passes";
        scale_time: "OBS_SCALE_TC", "s", 0.0..=100.0, 4.0, "Time constant of the observed thrust scale; 0 for none: the thrust is what the parameters say";
        limit: "OBS_MAX", "m/s^2", 0.0..=30.0, 12.0, "Largest disturbance that is believed";
    }
}

impl ObserverParameters {
    /// The paper has no observer.
    pub fn paper() -> Self {
        Self {
            share: 0.0,
            scale_time: 0.0,
            ..Self::default()
        }
    }
}

/// The disturbance as believed so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisturbanceObserver {
    smoothed: Vector3,
    disturbance: Vector3,
}

impl DisturbanceObserver {
    /// Takes in the mean `specific_force` over the last `dt` seconds and the part of it that the
    /// rotors' `thrust` made, both in the world (NED) and in m/s².
    pub fn step(
        &mut self,
        parameters: &ObserverParameters,
        specific_force: Vector3,
        thrust: Vector3,
        dt: f32,
    ) {
        let unexplained = scalar::limit_norm(specific_force - thrust, parameters.limit);
        let share = low_pass_share(parameters.time_constant, dt);
        self.smoothed += (unexplained - self.smoothed) * share;
        self.disturbance += (self.smoothed - self.disturbance) * share;
    }

    /// The disturbance to be taken out, NED, m/s².
    pub fn disturbance(&self, parameters: &ObserverParameters) -> Vector3 {
        self.disturbance * parameters.share
    }

    /// Forgets the disturbance.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

/// How much more or less acceleration the rotors give than the parameters say, beyond what wind may
/// do: a payload, a worn battery, thin air. It is 1 for a vehicle that is nearly as described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustScale {
    scale: f32,
}

impl Default for ThrustScale {
    fn default() -> Self {
        Self { scale: 1.0 }
    }
}

/// Bounds of what is believed of the scale.
const SCALES: (f32, f32) = (0.4, 1.6);

/// What is off by less than this share may be wind along the thrust, and is left to the disturbance
/// observer: it goes with the wind, the scale does not.
const WIND: f32 = 0.15;

/// Below so much thrust per mass, m/s², nothing is learned of its scale.
const LEAST_THRUST: f32 = 3.0;

impl ThrustScale {
    /// Takes in the mean specific force along the thrust over the last `dt` seconds, and the thrust
    /// per mass that should have made it, both m/s².
    pub fn step(&mut self, parameters: &ObserverParameters, measured: f32, thrust: f32, dt: f32) {
        if parameters.scale_time > 0.0 && thrust > LEAST_THRUST {
            let (least, most) = SCALES;
            let off = measured / thrust - 1.0;
            let beyond = off - windhover_math::saturate(off, WIND);
            let seen = windhover_math::max(least, windhover_math::min(most, 1.0 + beyond));
            self.scale += (seen - self.scale) * low_pass_share(parameters.scale_time, dt);
        }
    }

    /// The scale.
    pub fn scale(&self) -> f32 {
        self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_a_step_as_two_low_passes_do() {
        let parameters = ObserverParameters::default();
        let mut observer = DisturbanceObserver::default();
        let wind = Vector3::new(1.0, -2.0, 0.5);
        let thrust = Vector3::new(0.3, 0.2, -9.8);
        for _ in 0..240 {
            observer.step(&parameters, wind + thrust, thrust, 0.0005);
        }
        // after two time constants: 1 − (1 + 2) e⁻²
        let exact = wind * (1.0 - 3.0 * libm::exp(-2.0)) as f32;
        assert!(scalar::norm(observer.disturbance(&parameters) - exact) < 0.01);
    }

    #[test]
    fn a_payload_shows_in_the_thrust_scale() {
        let parameters = ObserverParameters::default();
        let mut thrust = ThrustScale::default();
        for _ in 0..10_000 {
            // half as heavy again as described, and hovering
            thrust.step(&parameters, 9.8, 9.8 * 1.5, 0.004);
        }
        assert!((thrust.scale() - (1.0 / 1.5 + WIND)).abs() < 1e-3);
        let learned = thrust.scale();
        for _ in 0..10_000 {
            thrust.step(&parameters, 9.8, 0.1, 0.004);
        }
        assert_eq!(thrust.scale(), learned, "nothing to learn from");
        let mut thrust = ThrustScale::default();
        for _ in 0..10_000 {
            // up-wind of 1 m/s²
            thrust.step(&parameters, 8.8, 9.8, 0.004);
        }
        assert_eq!(thrust.scale(), 1.0);
        for _ in 0..10_000 {
            thrust.step(&parameters, 300.0, 5.0, 0.004);
        }
        assert!(thrust.scale() <= 1.6);
        let paper = ObserverParameters::paper();
        let mut thrust = ThrustScale::default();
        thrust.step(&paper, 5.0, 10.0, 1.0);
        assert_eq!(thrust.scale(), 1.0);
    }

    #[test]
    fn believes_no_more_than_its_limit() {
        let parameters = ObserverParameters::default();
        let mut observer = DisturbanceObserver::default();
        for _ in 0..1000 {
            observer.step(&parameters, Vector3::new(1e4, 0.0, 0.0), Vector3::zeros(), 0.01);
        }
        assert!(observer.disturbance(&parameters).x <= parameters.limit);
    }
}
