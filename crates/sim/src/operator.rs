//! The operator of a desktop flight: arms when nothing speaks against it, takes off, flies the
//! mission, returns and lands. When a failsafe acts, looks on.

use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::mission::action::{self, Altitude, interpret};
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
    /// Where the takeoff leads: the height of the mission's first point.
    altitude: Option<Altitude>,
    /// Since when the vehicle stays where a failsafe has put it, s.
    stays_since: Option<f64>,
}

/// A vehicle that a failsafe has stopped is waited for so long, s, and then called back.
const PATIENCE: f64 = 90.0;

/// On sensors, nothing must have spoken against arming for so long, s.
const SETTLED: f64 = 2.0;

/// Whether a failsafe does more than warn.
fn is_interrupted(flown: &ClosedLoop) -> bool {
    let parameters = flown.outer().parameters();
    let acting = flown.outer().supervisor().acting();
    acting.is_some_and(|row| (row.watched().action)(parameters) > Action::Warn)
}

impl Operator {
    /// Of a vehicle on its sensors, or one that is told the truth, with this mission.
    pub fn new(on_sensors: bool, mission: &[MissionItem]) -> Self {
        Self {
            stage: Stage::Wait,
            clear_since: None,
            settling: if on_sensors { SETTLED } else { 0.0 },
            altitude: first_altitude(mission),
            stays_since: None,
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
            // A mission that ends in the air ends in hold; one that returns or lands does so
            // itself, and what a failsafe does is left to it.
            Stage::Mission if phase == Phase::Flying && mode == Mode::Hold && !is_interrupted(flown) => {
                self.stage = Stage::Home;
                flown.mailboxes.queues.command.push(Command::Fly(Mode::Return));
            }
            _ => self.call_back(flown, time),
        }
    }

    /// Calls a vehicle back that does not come by itself; where it cannot return, it lands.
    fn call_back(&mut self, flown: &mut ClosedLoop, time: f64) {
        let supervisor = flown.outer().supervisor();
        let stays =
            supervisor.phase() == Phase::Flying && matches!(supervisor.mode(), Mode::Hold | Mode::Altitude);
        if !stays {
            self.stays_since = None;
        } else if time - *self.stays_since.get_or_insert(time) > PATIENCE {
            self.stays_since = Some(time);
            self.stage = Stage::Home;
            let known = flown.outer().estimation().estimate().known.position;
            let mode = if known { Mode::Return } else { Mode::Land };
            flown.mailboxes.queues.command.push(Command::Fly(mode));
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
            for command in [Command::Takeoff(self.altitude, None), Command::Arm] {
                flown.mailboxes.queues.command.push(command);
            }
        }
    }
}

/// The height of the first point of a mission.
fn first_altitude(mission: &[MissionItem]) -> Option<Altitude> {
    let altitude = |item: &MissionItem| match interpret(item).ok()? {
        action::Action::Takeoff { altitude } => Some(altitude),
        action::Action::Waypoint { place, .. } => Some(place.altitude),
        _ => None,
    };
    mission.iter().find_map(altitude)
}
