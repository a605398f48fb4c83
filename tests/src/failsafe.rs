//! Flights in which something goes wrong: what is injected, what follows, and where it ends.

use windhover_autopilot::{
    InnerInput, Mode, MotorCommand, OuterResult, Phase, Row, ScheduleRecord, Snapshot,
};
use windhover_math::Vector3;
use windhover_model::Truth;
use windhover_sim::closed_loop::{ClosedLoop, Recorder};
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file::MissionFile;
use windhover_sim::operator::Operator;
use windhover_sim::recording::Recording;

/// A flight longer than this has no end, s.
const TIME_LIMIT: f64 = 900.0;

/// What happened, and when.
#[derive(Clone, Debug, Default)]
pub struct Story {
    /// Each change of phase, mode and failsafe, with its time (s) and the true position.
    pub turns: Vec<Turn>,
    /// How it stood at the end.
    pub end: Option<Truth>,
    /// Why it is broken, if it hit the ground too hard.
    pub crash: Option<String>,
    /// Whether the mission came to its end.
    pub finished: bool,
    /// Photos.
    pub photos: usize,
    last: Option<(Phase, Mode, Option<Row>)>,
}

/// One change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// s.
    pub time: f64,
    /// Phase from then on.
    pub phase: Phase,
    /// Mode from then on.
    pub mode: Mode,
    /// Failsafe from then on.
    pub failsafe: Option<Row>,
    /// True position, NED, m.
    pub position: Vector3<f64>,
}

impl Recorder for Story {
    fn tick(&mut self, _: &Truth, _: &InnerInput, _: MotorCommand, _: Option<ScheduleRecord>) {}

    fn outer(&mut self, truth: &Truth, _: &Snapshot, result: &OuterResult) {
        use windhover_autopilot::mission::MissionEvent::{Finished, Photo};
        let report = &result.report;
        let now = (report.phase, report.mode, report.failsafe);
        if self.last != Some(now) {
            self.last = Some(now);
            self.turns.push(Turn {
                time: truth.time,
                phase: report.phase,
                mode: report.mode,
                failsafe: report.failsafe,
                position: truth.position,
            });
        }
        for event in &report.events {
            self.finished |= *event == Finished;
            self.photos += usize::from(matches!(event, Photo { .. }));
        }
        self.end = Some(*truth);
    }
}

impl Story {
    /// When this row began to act, and the turn.
    pub fn acted(&self, row: Row) -> Option<&Turn> {
        self.turns.iter().find(|turn| turn.failsafe == Some(row))
    }

    /// The first turn from `time` on in which this mode flew.
    pub fn flew(&self, mode: Mode, time: f64) -> Option<&Turn> {
        self.turns
            .iter()
            .find(|turn| turn.time >= time && turn.mode == mode && turn.phase == Phase::Flying)
    }

    /// Whether it ended disarmed on the ground without a crash.
    pub fn landed(&self) -> bool {
        let last = self.turns.last();
        self.crash.is_none() && last.is_some_and(|turn| turn.phase == Phase::Disarmed)
    }

    /// Horizontal distance of the end from a place, m.
    pub fn ended_at(&self, north: f64, east: f64) -> f64 {
        let end = self
            .end
            .as_ref()
            .map_or_else(Vector3::zeros, |truth| truth.position);
        libm::hypot(end.x - north, end.y - east)
    }
}

/// Flies a mission with the usual operator while `meddle` does what it likes, before each tick, until
/// the vehicle has disarmed again. The flight is recorded, and replays equal.
pub fn fly(setup: &Setup, mission: &MissionFile, mut meddle: impl FnMut(&mut ClosedLoop, f64)) -> Story {
    let mut flown = flight::ready(setup, mission).expect("a flight that starts");
    let mut operator = Operator::new(setup.sensors.is_some(), &mission.items);
    let (mut story, mut recording) = (Story::default(), Recording::default());
    let mut was_armed = false;
    for tick in 0u64.. {
        let time = tick as f64 / f64::from(setup.imu_rate);
        operator.step(&mut flown, time);
        meddle(&mut flown, time);
        flown.tick(&mut (&mut recording, &mut story));
        let disarmed = flown.outer().supervisor().phase() == Phase::Disarmed;
        was_armed |= !disarmed;
        let diverged = flown.world.diverged().map(|divergence| divergence.to_string());
        story.crash = flown.world.crash().map(|crash| crash.to_string()).or(diverged);
        if story.crash.is_some() || (was_armed && disarmed) || time > TIME_LIMIT {
            break;
        }
    }
    crate::replay(setup, mission, &recording);
    story
}
