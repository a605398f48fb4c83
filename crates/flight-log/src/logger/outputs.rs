//! What the logger makes of an outer result: its hash, and views of it.

use windhover_autopilot::{Imu, OuterResult, Snapshot};

use super::{Logger, SLOW};
use crate::hash::result_hash;
use crate::views::{
    ActuatorMotors, Disturbance, FlightPhase, Leg, Mission, Refusal, SensorCombined, VehicleAttitude,
    VehicleAttitudeSetpoint, VehicleLandDetected, VehicleLocalPosition, VehicleLocalPositionSetpoint,
    VehicleStatus,
};

impl<const N: usize> Logger<N> {
    /// What the outer step made of a snapshot.
    pub fn result(&mut self, snapshot: &Snapshot, result: &OuterResult) {
        self.result = Some(result_hash(result));
        let increments = &snapshot.increments;
        self.counts.ticks = self.counts.ticks.wrapping_add(u32::from(increments.ticks));
        self.counts.missing = self.counts.missing.wrapping_add(u32::from(increments.missing));
        self.counts.saturated = self
            .counts
            .saturated
            .wrapping_add(u32::from(increments.saturated));
        if self.config.view_divider == 0 {
            return;
        }
        let time = snapshot.time;
        for event in &result.report.events {
            self.view(time, &Mission::from(event));
        }
        for refused in &result.report.refusals {
            self.view(time, &Refusal::from(refused));
        }
        if self.views.is_multiple_of(self.config.view_divider) {
            self.fast_views(time, result);
        }
        self.slow_views(snapshot, result);
        self.views = self.views.wrapping_add(1);
    }

    fn fast_views(&mut self, time: u64, result: &OuterResult) {
        self.view(time, &VehicleAttitude::new(result));
        self.view(
            time,
            &VehicleAttitudeSetpoint::new(result, self.config.thrust_max),
        );
        self.view(time, &VehicleLocalPosition::new(result));
        if let Some(setpoint) = VehicleLocalPositionSetpoint::new(result) {
            self.view(time, &setpoint);
        }
        if let Some(command) = self.motors.commands().last() {
            let share = |rotor| f32::from(rotor) / f32::from(u16::MAX);
            let control = command.rotors().unwrap_or_default().map(share);
            self.view(time, &ActuatorMotors { control });
        }
        if let Some(Imu::Sample { counts, .. }) = self.last_imu() {
            let inertial = self.config.sensing.convert(&counts);
            let sample = SensorCombined {
                gyro_rad: inertial.rate,
                accelerometer_m_s2: inertial.specific_force,
            };
            self.view(time, &sample);
        }
        self.view(time, &Disturbance::new(result));
    }

    fn last_imu(&self) -> Option<Imu> {
        self.imu.imu(usize::from(self.imu.count).checked_sub(1)?)
    }

    fn slow_views(&mut self, snapshot: &Snapshot, result: &OuterResult) {
        let time = snapshot.time;
        let phase = (FlightPhase::new(snapshot, result), result.landed);
        let due = self.views.is_multiple_of(SLOW);
        if due || self.phase != Some(phase) {
            self.phase = Some(phase);
            self.view(time, &phase.0);
            self.view(time, &VehicleStatus::new(snapshot, result));
            self.view(time, &VehicleLandDetected::new(result));
        }
        if due {
            let counts = self.counts;
            self.view(time, &counts);
        }
        let leg = result.report.leg_end.map(|destination| Leg { destination });
        if leg.is_some() && leg != self.leg {
            self.leg = leg;
            if let Some(leg) = leg {
                self.view(time, &leg);
            }
        }
    }
}
