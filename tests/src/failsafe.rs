//! Flights in which something goes wrong: what is injected, what follows, and where it ends.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::mode::Guidance;
use windhover_autopilot::{Command, Mode, Phase, Row};
use windhover_math::Vector3;
use windhover_sim::closed_loop::ClosedLoop;
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file::MissionFile;
use windhover_sim::operator::Operator;
use windhover_sim::recording::Recording;

use crate::trace::{Step, Trace};

/// A flight longer than this has no end, s.
const TIME_LIMIT: f64 = 900.0;

/// What happened, and when.
#[derive(Clone, Debug, Default)]
pub struct Story {
    /// Step by step.
    pub trace: Trace,
    /// Why it is broken, if it hit the ground too hard.
    pub crash: Option<String>,
}

impl Story {
    /// The first step of each phase, mode and failsafe.
    pub fn turns(&self) -> Vec<&Step> {
        let mut turns: Vec<&Step> = self.trace.steps.iter().collect();
        turns.dedup_by_key(|step| (step.phase, step.mode, step.failsafe));
        turns
    }

    /// The step in which this row began to act.
    pub fn acted(&self, row: Row) -> Option<&Step> {
        let mut steps = self.trace.steps.iter();
        steps.find(|step| step.failsafe == Some(row))
    }

    /// The first step from `time` on in which this mode flew.
    pub fn flew(&self, mode: Mode, time: f64) -> Option<&Step> {
        let mut steps = self.trace.steps.iter();
        steps.find(|step| step.time >= time && step.mode == mode && step.phase == Phase::Flying)
    }

    /// Whether the mission came to its end.
    pub fn finished(&self) -> bool {
        self.trace
            .events()
            .any(|(_, event)| event == MissionEvent::Finished)
    }

    /// Whether it ended disarmed.
    pub fn disarmed(&self) -> bool {
        let last = self.trace.steps.last();
        last.is_some_and(|step| step.phase == Phase::Disarmed)
    }

    /// Whether it ended disarmed on the ground without a crash.
    pub fn landed(&self) -> bool {
        self.crash.is_none() && self.disarmed()
    }

    /// Horizontal distance of the end from a place, m.
    pub fn ended_at(&self, north: f64, east: f64) -> f64 {
        let end = self.trace.steps.last().expect("at least one step").position;
        libm::hypot(end.x - north, end.y - east)
    }
}

/// Whether this is the tick at a time, s, of a sensor of 1 kHz.
pub fn once(time: f64, at: f64) -> bool {
    (at..at + 0.000_9).contains(&time)
}

/// Whether this is a tick of every so many ms.
pub fn every(time: f64, ms: u64) -> bool {
    // Times are a hair beside their milliseconds.
    ((time * 1000.0).round() as u64).is_multiple_of(ms)
}

/// An operator chooses a mode.
pub fn choose(flown: &mut ClosedLoop, mode: Mode) {
    flown.mailboxes.queues.command.push(Command::Fly(mode));
}

/// A computer on board wants this velocity north and east, m/s, at the same height.
pub fn guide(flown: &mut ClosedLoop, north: f32, east: f32) {
    flown.mailboxes.queues.guidance.push(Guidance {
        uses: Guidance::VELOCITY | Guidance::CLIMB,
        velocity: Vector3::new(north, east, 0.0),
        ..Guidance::default()
    });
}

/// Flies a mission with the usual operator while `meddle` does what it likes, before each tick,
/// until the vehicle has disarmed again. The flight is recorded, and replays equal.
pub fn fly(setup: &Setup, mission: &MissionFile, mut meddle: impl FnMut(&mut ClosedLoop, f64)) -> Story {
    let mut flown = flight::ready(setup, mission).expect("a flight that starts");
    let mut operator = Operator::new(setup.sensors.is_some(), &mission.items);
    let (mut story, mut recording) = (Story::default(), Recording::default());
    let mut was_armed = false;
    for tick in 0u64.. {
        let time = tick as f64 / f64::from(setup.imu_rate);
        operator.step(&mut flown, time);
        meddle(&mut flown, time);
        flown.tick(&mut (&mut recording, &mut story.trace));
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
