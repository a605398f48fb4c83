//! The operator of a desktop flight: arms when nothing speaks against it, takes off, flies the
//! mission, returns and lands. When a failsafe acts, looks on.

use windhover_autopilot::{Action, Command, Mode, Phase};

use crate::closed_loop::ClosedLoop;

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// To wait until nothing speaks against arming.
    Wait,
    /// To wait until the takeoff is done.
    Takeoff,
    /// To wait until the mission flies.
    Start,
    /// To wait until the mission is done.
    Mission,
    /// Nothing: it returns and lands by itself.
    Home,
}

/// The operator.
#[derive(Clone, Debug)]
pub struct Operator {
    stage: Stage,
    /// Since when nothing speaks against arming, s.
    clear_since: Option<f64>,
    /// For so long nothing has to, s.
    settling: f64,
}

/// On sensors, nothing must have spoken against arming for so long, s.
const SETTLED: f64 = 2.0;

/// Whether a failsafe does more than warn.
fn is_interrupted(flown: &ClosedLoop) -> bool {
    let parameters = flown.outer().parameters();
    let acting = flown.outer().supervisor().acting();
    acting.is_some_and(|row| (row.watched().action)(parameters) > Action::Warn)
}

impl Operator {
    /// Of a vehicle on its sensors, or one that is told the truth.
    pub fn new(on_sensors: bool) -> Self {
        Self {
            stage: Stage::Wait,
            clear_since: None,
            settling: if on_sensors { SETTLED } else { 0.0 },
        }
    }

    /// Looks at the vehicle at `time` s and gives commands.
    #[inline]
    pub fn step(&mut self, flown: &mut ClosedLoop, time: f64) {
        let supervisor = flown.outer().supervisor();
        let (phase, mode) = (supervisor.phase(), supervisor.mode());
        match self.stage {
            Stage::Wait => self.wait(flown, time),
            Stage::Takeoff if phase == Phase::Flying && mode == Mode::Hold && !is_interrupted(flown) => {
                self.stage = Stage::Start;
                flown.mailboxes.queues.command.push(Command::Fly(Mode::Mission));
            }
            Stage::Start if mode == Mode::Mission => self.stage = Stage::Mission,
            // A mission that ends in the air ends in hold; one that returns or lands does so itself,
            // and what a failsafe does is left to it.
            Stage::Mission if phase == Phase::Flying && mode == Mode::Hold && !is_interrupted(flown) => {
                self.stage = Stage::Home;
                flown.mailboxes.queues.command.push(Command::Fly(Mode::Return));
            }
            _ => {}
        }
    }

    fn wait(&mut self, flown: &mut ClosedLoop, time: f64) {
        let outer = flown.outer();
        let clear = outer.blockers().is_empty() && outer.estimation().estimate().known.position;
        if !clear {
            self.clear_since = None;
            return;
        }
        if time - *self.clear_since.get_or_insert(time) >= self.settling {
            self.stage = Stage::Takeoff;
            for command in [Command::Fly(Mode::Takeoff), Command::Arm] {
                flown.mailboxes.queues.command.push(command);
            }
        }
    }
}
