//! What people are told when the state of the vehicle changes, and how far the mission is.

use core::fmt;

use windhover_autopilot::{Action, Mode, OuterReport, Parameters, Phase, Row};
use windhover_ground_link::Severity;
use windhover_ground_link::telemetry::{MissionState, Progress};

/// What was told last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shown {
    seen: Option<Seen>,
    /// The mission was flown to its end.
    finished: bool,
}

#[derive(Clone, Copy, Debug)]
struct Seen {
    phase: Phase,
    mode: Mode,
    failsafe: Option<Row>,
    active: windhover_autopilot::supervisor::RowSet,
}

impl Shown {
    /// Tells what has changed.
    pub fn changes(
        &mut self,
        report: &OuterReport,
        parameters: &Parameters,
        say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    ) {
        let now = Seen {
            phase: report.phase,
            mode: report.mode,
            failsafe: report.failsafe,
            active: report.active,
        };
        let Some(before) = self.seen.replace(now) else {
            return;
        };
        // What a vehicle on the ground lacks speaks against arming, and is told when somebody asks.
        let armed = now.phase != Phase::Disarmed;
        for row in report.active.iter().filter(|_| armed) {
            let acts = (row.watched().action)(parameters);
            let is_new = !before.active.contains(row);
            if is_new && acts != Action::None && report.failsafe != Some(row) {
                say(Severity::Warning, format_args!("Warning: {}", row.watched().text));
            }
        }
        match (before.failsafe, now.failsafe) {
            (was, Some(row)) if was != Some(row) => {
                let text = row.watched().text;
                let acts = (row.watched().action)(parameters);
                match acts.mode() {
                    Some(_) | None if acts <= Action::Warn => {
                        say(Severity::Warning, format_args!("Warning: {text}"));
                    }
                    Some(mode) => say(
                        Severity::Critical,
                        format_args!("Failsafe: {text} ({})", mode.name()),
                    ),
                    None => say(Severity::Emergency, format_args!("Failsafe: {text}")),
                }
            }
            (Some(row), None) => say(Severity::Notice, format_args!("Over: {}", row.watched().text)),
            _ => {}
        }
        if before.phase != now.phase {
            self.phase(before.phase, now.phase, say);
        }
        if before.mode != now.mode {
            say(Severity::Info, format_args!("Mode: {}", now.mode.name()));
        }
    }

    fn phase(&mut self, before: Phase, now: Phase, say: &mut dyn FnMut(Severity, fmt::Arguments<'_>)) {
        match (before, now) {
            (Phase::Disarmed, _) => {
                self.finished = false;
                say(Severity::Info, format_args!("Armed"));
            }
            (_, Phase::Disarmed) => say(Severity::Info, format_args!("Disarmed")),
            (_, Phase::Flying) => say(Severity::Info, format_args!("Airborne")),
            _ => {}
        }
    }

    /// The mission was flown to its end.
    pub fn finish(&mut self) {
        self.finished = true;
    }

    /// How far the mission is.
    pub fn progress(&mut self, report: &OuterReport) -> Progress {
        let flies = report.mode == Mode::Mission && report.phase != Phase::Disarmed;
        if flies && report.mission.begun {
            self.finished = false;
        }
        Progress {
            current: report.mission.current,
            state: match (flies, report.mission.begun) {
                (true, _) => MissionState::Active,
                (false, true) => MissionState::Paused,
                (false, false) if self.finished => MissionState::Complete,
                (false, false) => MissionState::NotStarted,
            },
        }
    }
}
