//! What a flight did, outer step by outer step.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::{
    InnerInput, Mode, MotorCommand, OuterResult, Phase, Refused, Row, ScheduleRecord, Snapshot,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::Vector3;
use windhover_model::Truth;
use windhover_sim::closed_loop::Recorder;

/// One outer step, with the truth at its tick.
#[derive(Clone, Debug)]
pub struct Step {
    /// Simulated time, s.
    pub time: f64,
    /// True position, NED, m.
    pub position: Vector3<f64>,
    /// True velocity, NED, m/s.
    pub velocity: Vector3<f64>,
    /// True heading, rad.
    pub heading: f64,
    /// Where the vehicle should be.
    pub trajectory: Option<TrajectorySetpoint>,
    /// What attitude control is told.
    pub attitude_setpoint: AttitudeSetpoint,
    /// Phase of flight.
    pub phase: Phase,
    /// Mode of flight.
    pub mode: Mode,
    /// The failsafe that acts.
    pub failsafe: Option<Row>,
    /// Whether the core takes the vehicle for landed.
    pub landed: bool,
    /// What happened in the mission.
    pub events: Vec<MissionEvent>,
    /// What was refused.
    pub refusals: Vec<Refused>,
}

impl Step {
    /// A result with the truth behind it.
    pub fn new(truth: &Truth, result: &OuterResult) -> Self {
        Self {
            time: truth.time,
            position: truth.position,
            velocity: truth.velocity,
            heading: truth.attitude.heading(),
            trajectory: result.report.trajectory,
            attitude_setpoint: result.setpoint,
            phase: result.report.phase,
            mode: result.report.mode,
            failsafe: result.report.failsafe,
            landed: result.landed,
            events: result.report.events.to_vec(),
            refusals: result.report.refusals.to_vec(),
        }
    }

    /// Distance from a place, m.
    pub fn distance(&self, north: f64, east: f64, height: f64) -> f64 {
        windhover_math::scalar::norm(self.position - Vector3::new(north, east, -height))
    }

    /// True horizontal speed, m/s.
    pub fn ground_speed(&self) -> f64 {
        libm::hypot(self.velocity.x, self.velocity.y)
    }
}

/// All outer steps of a flight.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// In order of time.
    pub steps: Vec<Step>,
}

impl Recorder for Trace {
    fn tick(&mut self, _: &Truth, _: &InnerInput, _: MotorCommand, _: Option<ScheduleRecord>) {}

    fn outer(&mut self, truth: &Truth, _: &Snapshot, result: &OuterResult) {
        self.steps.push(Step::new(truth, result));
    }
}

impl Trace {
    /// What happened, with the step in which it did.
    pub fn events(&self) -> impl Iterator<Item = (&Step, MissionEvent)> {
        let of_step = |step| std::iter::repeat(step).zip(step_events(step));
        self.steps.iter().flat_map(of_step)
    }

    /// Indices of the items reached, in order.
    pub fn reached(&self) -> Vec<u16> {
        let reached = |(_, event)| match event {
            MissionEvent::Reached(item) => Some(item),
            _ => None,
        };
        self.events().filter_map(reached).collect()
    }

    /// Photos: the step, the index of the item, and whether the vehicle had settled.
    pub fn photos(&self) -> Vec<(&Step, u16, bool)> {
        let photo = |(step, event)| match event {
            MissionEvent::Photo { item, settled, .. } => Some((step, item, settled)),
            _ => None,
        };
        self.events().filter_map(photo).collect()
    }

    /// Indices of the items that asked for the photos, in order.
    pub fn photo_items(&self) -> Vec<u16> {
        self.photos().into_iter().map(|(_, item, _)| item).collect()
    }

    /// When this happened first, s.
    pub fn time_of(&self, wanted: MissionEvent) -> f64 {
        let found = self.events().find(|(_, event)| *event == wanted);
        found
            .unwrap_or_else(|| panic!("{wanted:?} did not happen"))
            .0
            .time
    }

    /// The steps in which the vehicle follows a trajectory.
    pub fn flying(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter().filter(|step| step.trajectory.is_some())
    }

    /// The steps from one time to another, s.
    pub fn between(&self, from: f64, to: f64) -> impl Iterator<Item = &Step> {
        self.steps
            .iter()
            .filter(move |step| step.time >= from && step.time <= to)
    }

    /// How near the vehicle came to a place, m.
    pub fn nearest(&self, north: f64, east: f64, height: f64) -> f64 {
        let distances = self.steps.iter().map(|step| step.distance(north, east, height));
        distances.fold(f64::INFINITY, windhover_math::min)
    }
}

fn step_events(step: &Step) -> impl Iterator<Item = MissionEvent> {
    step.events.iter().copied()
}
