//! How far what the vehicle believes is from the truth.

use std::collections::VecDeque;

use windhover_autopilot::{GnssSample, OuterResult, Snapshot};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{Quaternion, Vector3};
use windhover_model::Truth;
use windhover_model::sensor::gnss::GnssErrors;

use crate::figures::{ErrorSum, ScalarErrorSum};
use crate::flight::Setup;

/// Errors of the estimate and of the receiver, over a flight.
#[derive(Clone, Debug)]
pub struct BeliefErrors {
    /// Of the receiver's positions, m.
    pub gnss: ErrorSum,
    /// Of the estimated position, m.
    pub estimate: ErrorSum,
    /// Of the estimated vertical about north and about east, each for itself, rad.
    pub tilt: ScalarErrorSum,
    /// Of the estimated heading, rad.
    pub heading: ScalarErrorSum,
    on_sensors: bool,
    /// Altitude of the ground, m.
    ground: f64,
    latency_us: u64,
    /// Where the vehicle was, for as long as a receiver's message takes.
    past: VecDeque<(u64, Vector3<f64>)>,
}

impl BeliefErrors {
    /// Of a flight of this `setup` that starts at `home`.
    pub fn new(setup: &Setup, home: GlobalPosition) -> Self {
        Self {
            gnss: ErrorSum::default(),
            estimate: ErrorSum::default(),
            tilt: ScalarErrorSum::default(),
            heading: ScalarErrorSum::default(),
            on_sensors: setup.sensors.is_some(),
            ground: f64::from(home.altitude) * 1e-3,
            latency_us: GnssErrors::standard().latency_us,
            past: VecDeque::new(),
        }
    }

    /// Looks at what the receiver says, in flight and before.
    pub fn look(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        if !self.on_sensors {
            return;
        }
        self.past.push_back((snapshot.time, truth.position));
        while self.past.len() > 2 && self.past[1].0 + self.latency_us < snapshot.time {
            self.past.pop_front();
        }
        let (Some(origin), Some(_)) = (result.report.origin, result.report.trajectory) else {
            return;
        };
        for sample in snapshot.inputs.gnss.iter().filter(|sample| sample.is_fix()) {
            if let Some(then) = self.past_at(sample.time.saturating_sub(self.latency_us)) {
                self.gnss.add(self.measured(sample, origin) - then);
            }
        }
    }

    /// Where the receiver says the vehicle was, from the core's origin and the ground, m.
    fn measured(&self, sample: &GnssSample, origin: GlobalPosition) -> Vector3<f64> {
        let local = LocalFrame::new(origin).to_local(sample.position);
        let height = f64::from(sample.position.altitude) * 1e-3 - self.ground;
        Vector3::new(f64::from(local.x), f64::from(local.y), -height)
    }

    /// The true position at a moment of the past.
    fn past_at(&self, time: u64) -> Option<Vector3<f64>> {
        let after = self.past.iter().position(|(at, _)| *at >= time)?;
        let (end, to) = self.past[after];
        let Some((begin, from)) = after.checked_sub(1).map(|before| self.past[before]) else {
            return Some(to);
        };
        let share = (time - begin) as f64 / (end - begin) as f64;
        Some(from + (to - from) * share)
    }

    /// Adds a moment of the mission.
    pub fn add(&mut self, truth: &Truth, result: &OuterResult) {
        if !self.on_sensors {
            return;
        }
        let estimate = &result.report.estimate;
        self.estimate
            .add(estimate.position.map(f64::from) - truth.position);
        let q = &estimate.attitude;
        let believed = Quaternion::new(f64::from(q.w), f64::from(q.x), f64::from(q.y), f64::from(q.z));
        let turn = (believed * truth.attitude.conjugate()).shortest();
        self.tilt.add(2.0 * turn.x);
        self.tilt.add(2.0 * turn.y);
        self.heading.add(2.0 * turn.z);
    }
}
