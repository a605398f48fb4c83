//! From what a mode demands to attitude and thrust.

use windhover_control::VehicleParameters;
use windhover_control::position::{AttitudeSetpoint, PositionEstimate};
use windhover_math::{Quaternion, Vector3};

use super::Outer;
use crate::inner::Snapshot;
use crate::mode::Demand;

impl Outer {
    /// Attitude and thrust that do what is demanded.
    pub(super) fn control(&mut self, snapshot: &Snapshot, dt: u32) -> AttitudeSetpoint {
        match &self.modes.last().demand {
            Demand::Rest => {
                self.position.reset();
                self.level(0.0)
            }
            Demand::Attitude(setpoint) => {
                self.position.reset();
                *setpoint
            }
            Demand::Follow(point) => {
                let handover = self.estimation.handover();
                let point = handover.shifted(point);
                let (estimate, vehicle) = (self.position_estimate(), self.vehicle());
                self.position.step(
                    &self.parameters.position,
                    &vehicle,
                    &point,
                    &estimate,
                    self.shortfall(snapshot),
                    dt as f32 * 1e-6,
                )
            }
            Demand::Tilt {
                attitude,
                heading_rate,
                point,
            } => {
                let handover = self.estimation.handover();
                let (point, turn) = (handover.shifted(point), handover.heading);
                let (estimate, vehicle) = (self.position_estimate(), self.vehicle());
                let thrust = self.position.lift(
                    &self.parameters.position,
                    &vehicle,
                    &point,
                    &estimate,
                    self.shortfall(snapshot),
                    dt as f32 * 1e-6,
                );
                AttitudeSetpoint {
                    attitude: Quaternion::from_heading(turn) * *attitude,
                    rate: Vector3::new(0.0, 0.0, *heading_rate),
                    thrust,
                }
            }
        }
    }

    fn position_estimate(&self) -> PositionEstimate {
        let believed = self.estimation.estimate();
        PositionEstimate {
            position: believed.position,
            velocity: believed.velocity - self.estimation.handover().velocity,
            attitude: believed.attitude,
            disturbance: self.observer.disturbance(&self.parameters.observer),
        }
    }

    /// The vehicle, as heavy as the thrust feels it to be.
    fn vehicle(&self) -> VehicleParameters {
        VehicleParameters {
            mass: self.parameters.vehicle.mass / self.thrust_scale.scale(),
            ..self.parameters.vehicle
        }
    }

    /// What the mixer added to the thrust, in the mean, N.
    fn shortfall(&self, snapshot: &Snapshot) -> f32 {
        let increments = &snapshot.increments;
        if self.landing.is_landed() || increments.duration <= 0.0 {
            return 0.0;
        }
        increments.thrust_shortfall / increments.duration
    }

    /// Upright, with the heading kept.
    pub(super) fn level(&self, thrust: f32) -> AttitudeSetpoint {
        AttitudeSetpoint {
            attitude: Quaternion::from_heading(self.estimation.estimate().attitude.heading()),
            rate: Vector3::zeros(),
            thrust,
        }
    }
}
