//! What a log says of an outer result: views for people, each a message of its own.

use windhover_autopilot::{Imu, MotorCommand, OuterResult, Snapshot};

use super::{LONGEST, LoggerConfig, SLOW};
use crate::record::{Topic, data};
use crate::views::{
    ActuatorMotors, BatteryStatus, Disturbance, EstimatorStatus, FlightPhase, Leg, Mission, Refusal,
    SensorCombined, TickCounts, VehicleAttitude, VehicleAttitudeSetpoint, VehicleLandDetected,
    VehicleLocalPosition, VehicleLocalPositionSetpoint, VehicleStatus,
};
use crate::wire::{kind, message};

/// What the logger knows and the views show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Latest {
    /// The last tick's input.
    pub imu: Option<Imu>,
    /// The last tick's command.
    pub motors: Option<MotorCommand>,
    /// Boundaries at which the outer step was still at work.
    pub missed: u32,
    /// Messages for people that found no room.
    pub dropped_outputs: u32,
}

/// Makes the views of outer results. It belongs to whoever runs the outer step: where the logger
/// is shared with an interrupt, views are made here, outside of its lock.
#[derive(Clone, Debug)]
pub struct Reporter {
    config: LoggerConfig,
    /// Outer results so far.
    steps: u32,
    phase: Option<(FlightPhase, bool)>,
    leg: Option<Leg>,
    counts: TickCounts,
}

/// Takes one message at a time.
struct Out<'a, F> {
    time: u64,
    push: &'a mut F,
}

impl<F: FnMut(&[u8])> Out<'_, F> {
    fn view<T: Topic>(&mut self, view: &T) {
        let mut buffer = [0; LONGEST];
        let length = data(&mut buffer, T::TOPIC.id, self.time, |out| view.put(out));
        if let Some(message) = length.and_then(|length| buffer.get(..length)) {
            (self.push)(message);
        }
    }

    /// A line of text at one of PX4's levels, in pieces.
    fn text(&mut self, level: u8, pieces: &[&str]) {
        let mut buffer = [0; LONGEST];
        let time = self.time;
        let length = message(&mut buffer, kind::TEXT, |out| {
            out.bytes([level]);
            out.bytes(time.to_le_bytes());
            for piece in pieces {
                out.slice(piece.as_bytes());
            }
        });
        if let Some(message) = length.and_then(|length| buffer.get(..length)) {
            (self.push)(message);
        }
    }
}

impl Reporter {
    /// Before the first result.
    pub fn new(config: LoggerConfig) -> Self {
        Self {
            config,
            steps: 0,
            phase: None,
            leg: None,
            counts: TickCounts::default(),
        }
    }

    /// Hands the messages that are due to `push`, one by one.
    pub fn report<F: FnMut(&[u8])>(
        &mut self,
        snapshot: &Snapshot,
        result: &OuterResult,
        latest: impl FnOnce() -> Latest,
        push: &mut F,
    ) {
        let increments = &snapshot.increments;
        let counts = &mut self.counts;
        counts.ticks = counts.ticks.wrapping_add(u32::from(increments.ticks));
        counts.missing = counts.missing.wrapping_add(u32::from(increments.missing));
        counts.saturated = counts.saturated.wrapping_add(u32::from(increments.saturated));
        if self.config.view_divider == 0 {
            return;
        }
        let time = snapshot.time;
        let mut out = Out { time, push };
        for event in &result.report.events {
            out.view(&Mission::from(event));
        }
        for refused in &result.report.refusals {
            out.view(&Refusal::from(refused));
        }
        let slow = self.steps.is_multiple_of(SLOW);
        let fast = self.steps.is_multiple_of(self.config.view_divider);
        if slow || fast {
            let latest = latest();
            self.counts.missed = latest.missed;
            self.counts.dropped_outputs = latest.dropped_outputs;
            if fast {
                self.fast(result, &latest, &mut out);
            }
        }
        self.slow(snapshot, result, slow, &mut out);
        self.steps = self.steps.wrapping_add(1);
    }

    fn fast<F: FnMut(&[u8])>(&self, result: &OuterResult, latest: &Latest, out: &mut Out<'_, F>) {
        out.view(&VehicleAttitude::new(result));
        out.view(&VehicleAttitudeSetpoint::new(result, self.config.thrust_max));
        out.view(&VehicleLocalPosition::new(result));
        if let Some(setpoint) = VehicleLocalPositionSetpoint::new(result) {
            out.view(&setpoint);
        }
        if let Some(command) = latest.motors {
            let share = |rotor| f32::from(rotor) / f32::from(u16::MAX);
            let control = command.rotors().unwrap_or_default().map(share);
            out.view(&ActuatorMotors { control });
        }
        if let Some(Imu::Sample { counts, .. }) = latest.imu {
            let inertial = self.config.sensing.convert(&counts);
            out.view(&SensorCombined {
                gyro_rad: inertial.rate,
                accelerometer_m_s2: inertial.specific_force,
            });
        }
        out.view(&Disturbance::new(result));
    }

    fn slow<F: FnMut(&[u8])>(
        &mut self,
        snapshot: &Snapshot,
        result: &OuterResult,
        due: bool,
        out: &mut Out<'_, F>,
    ) {
        let phase = (FlightPhase::new(snapshot, result), result.landed);
        let before = self.phase.replace(phase);
        if due || before != Some(phase) {
            out.view(&phase.0);
            out.view(&VehicleStatus::new(result));
            out.view(&VehicleLandDetected::new(result));
        }
        if due {
            out.view(&self.counts);
            out.view(&EstimatorStatus::new(result));
            if result.report.battery.voltage.is_some() {
                out.view(&BatteryStatus::new(result));
            }
        }
        let (before, _) = before.unwrap_or_default();
        if phase.0.failsafe != before.failsafe {
            match result.report.failsafe {
                Some(row) => {
                    let watched = row.watched();
                    out.text(b'4', &["failsafe ", watched.name, ": ", watched.text]);
                }
                None => out.text(b'6', &["failsafe over"]),
            }
        }
        if phase.0.mode != before.mode {
            out.text(b'6', &["mode ", result.report.mode.name()]);
        }
        let leg = result.report.leg_end.map(|destination| Leg { destination });
        if leg.is_some() && leg != self.leg {
            self.leg = leg;
            if let Some(leg) = leg {
                out.view(&leg);
            }
        }
    }
}
