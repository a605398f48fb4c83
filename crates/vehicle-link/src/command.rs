//! What a request means to the core.

use windhover_autopilot::mode::Target;
use windhover_autopilot::{Command, Mode as CoreMode, MotorTest, OuterReport, Phase};
use windhover_ground_link::{Calibration, CommandResult, Ground, Mode, Request, SpeedKind};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::sqrt;

/// "Land there" is "land here" within this distance, m.
const NEAR: f32 = 3.0;

/// What to do with a request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// The core decides.
    Command(Command),
    /// A calibration is to begin or to end.
    Calibrate(Calibration),
    /// Something of the link's end itself.
    Own,
    /// That is the answer, and why.
    Answer(CommandResult, Option<&'static str>),
}

/// What a request means, to a vehicle in this state.
pub fn meaning(request: &Request, report: &OuterReport) -> Meaning {
    Meaning::Command(match *request {
        Request::Arm { force: false } => Command::Arm,
        Request::Arm { force: true } => Command::ForceArm,
        Request::Disarm => Command::Disarm,
        // Asked for again, because the answer was lost.
        Request::Takeoff { .. } if report.mode == CoreMode::Takeoff && report.phase == Phase::Flying => {
            return Meaning::Answer(CommandResult::Accepted, None);
        }
        Request::Takeoff { altitude, heading } => Command::Takeoff(altitude, heading),
        Request::Land { place } if place.is_none_or(|place| is_near(place, report)) => {
            Command::Fly(CoreMode::Land)
        }
        Request::Land { .. } => {
            let why = "Landing is here only: go there first, then land";
            return Meaning::Answer(CommandResult::Denied, Some(why));
        }
        Request::Return => Command::Fly(CoreMode::Return),
        Request::Hold => Command::Fly(CoreMode::Hold),
        Request::Continue => Command::Fly(CoreMode::Mission),
        Request::Reposition {
            place: None,
            altitude: None,
            heading: None,
            ..
        } if report.phase != Phase::Flying => Command::Fly(CoreMode::Hold),
        Request::Reposition {
            place,
            altitude,
            heading,
            speed,
        } => Command::GoTo(Target {
            ground: place.map(|place| (place.latitude, place.longitude)),
            altitude,
            heading,
            speed,
        }),
        Request::ChangeSpeed {
            kind: SpeedKind::Ground,
            speed,
        } => Command::SetSpeed(speed),
        Request::ChangeSpeed { .. } => {
            let why = "Speeds up and down are parameters: MPC_Z_VEL_MAX_UP, MPC_Z_VEL_MAX_DN";
            return Meaning::Answer(CommandResult::Unsupported, Some(why));
        }
        Request::SetMode(mode) => match core_mode(mode) {
            Some(mode) => Command::Fly(mode),
            None => return Meaning::Answer(CommandResult::Unsupported, Some("There is no acro mode")),
        },
        Request::StartMission { first } => Command::StartMission(first),
        Request::SetCurrentItem { index } => Command::SelectItem(index),
        Request::SetHome(place) => Command::SetHome(place),
        Request::LookAt(place) => Command::LookAt(place),
        Request::TakePhotos { count: 1, .. } => Command::TakePhoto,
        Request::TestMotor {
            motor,
            throttle,
            duration,
        } => Command::TestMotor(MotorTest {
            rotor: motor.saturating_sub(1),
            share: throttle,
            duration,
        }),
        Request::Calibrate(kind) => return Meaning::Calibrate(kind),
        _ => return Meaning::Own,
    })
}

/// The core's name of a mode.
fn core_mode(mode: Mode) -> Option<CoreMode> {
    Some(match mode {
        Mode::Manual | Mode::Stabilize => CoreMode::Stabilize,
        Mode::Altitude => CoreMode::Altitude,
        Mode::Position => CoreMode::Position,
        Mode::Acro => return None,
        Mode::Offboard => CoreMode::Offboard,
        Mode::Takeoff => CoreMode::Takeoff,
        Mode::Hold => CoreMode::Hold,
        Mode::Mission => CoreMode::Mission,
        Mode::Return => CoreMode::Return,
        Mode::Land => CoreMode::Land,
    })
}

/// A mode as ground stations know it: a descent is a landing.
pub fn link_mode(mode: CoreMode) -> Mode {
    match mode {
        CoreMode::Stabilize => Mode::Stabilize,
        CoreMode::Altitude => Mode::Altitude,
        CoreMode::Position => Mode::Position,
        CoreMode::Takeoff => Mode::Takeoff,
        CoreMode::Hold => Mode::Hold,
        CoreMode::Mission => Mode::Mission,
        CoreMode::Return => Mode::Return,
        CoreMode::Land | CoreMode::Descend => Mode::Land,
        CoreMode::Offboard => Mode::Offboard,
    }
}

/// A command's name for people.
pub fn name(command: &Command) -> &'static str {
    match command {
        Command::Arm | Command::ForceArm => "Arming",
        Command::Disarm => "Disarming",
        Command::Fly(mode) => match mode {
            CoreMode::Stabilize => "Mode stabilize",
            CoreMode::Altitude => "Mode altitude",
            CoreMode::Position => "Mode position",
            CoreMode::Takeoff => "Takeoff",
            CoreMode::Hold => "Hold",
            CoreMode::Mission => "Mission",
            CoreMode::Return => "Return",
            CoreMode::Land => "Landing",
            CoreMode::Offboard => "Offboard",
            CoreMode::Descend => "Descent",
        },
        Command::Takeoff(..) => "Takeoff",
        Command::GoTo(_) => "Going there",
        Command::StartMission(_) => "Mission",
        Command::SelectItem(_) => "Mission item",
        Command::SetSpeed(_) => "Speed",
        Command::SetHome(_) => "Home",
        Command::LookAt(_) => "Region of interest",
        Command::TakePhoto => "Photo",
        Command::Commit(..) => "Plan",
        Command::TestMotor(_) => "Motor test",
    }
}

fn is_near(place: Ground, report: &OuterReport) -> bool {
    let Some(origin) = report.origin else {
        return false;
    };
    let there = LocalFrame::new(origin).to_local(GlobalPosition {
        latitude: place.latitude,
        longitude: place.longitude,
        altitude: origin.altitude,
    });
    let here = report.estimate.position;
    let (north, east) = (there.x - here.x, there.y - here.y);
    sqrt(north * north + east * east) <= NEAR
}

/// How a refusal is told to a machine: what may be gone the next time, and what may not.
pub fn result(why: &windhover_autopilot::Why) -> CommandResult {
    use windhover_autopilot::Why;
    match why {
        Why::Blocked(_) | Why::InFlight | Why::OnGround | Why::Armed | Why::Failsafe(_) => {
            CommandResult::TemporarilyRejected
        }
        Why::Mission(..) | Why::Fence(..) | Why::NotANumber | Why::Place(_) => CommandResult::Denied,
    }
}
