//! What a command means: from its number and parameters to a request.
//!
//! Parameters that are not set are `None` here, and a reason to refuse only where a command means
//! nothing without them. Commands and parameters are MAVLink's (`common.xml`).

use mavlink::MessageData;
use mavlink::dialects::common::{AUTOPILOT_VERSION_DATA, HOME_POSITION_DATA, PROTOCOL_VERSION_DATA};

use super::arguments::Parameters;
use super::{CommandResult, flight, number, upkeep};
use crate::request::Request;
use crate::scale::Datum;

/// As which autopilot the vehicle introduces itself: it decides what clients mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Identity {
    /// PX4: without this, QGroundControl neither takes off nor starts a mission.
    #[default]
    Px4,
    /// None in particular.
    Generic,
}

/// What a command leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// Something asked of the vehicle.
    Request(Request),
    /// Something that the link does by itself.
    Ours(Ours),
    /// An answer at once.
    Answer(CommandResult),
}

/// What the link does by itself; the numbers are those of messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ours {
    /// Send one message once.
    Once { command: u16, message: u32 },
    /// Send a message every so many µs; 0 is the default, `None` is never.
    Every { message: u32, interval: Option<u32> },
    /// Say how often a message is sent.
    Interval { message: u32 },
}

impl Ours {
    /// The command that asked for it.
    pub fn command(self) -> u16 {
        match self {
            Self::Once { command, .. } => command,
            Self::Every { .. } => number::SET_MESSAGE_INTERVAL,
            Self::Interval { .. } => number::GET_MESSAGE_INTERVAL,
        }
    }
}

/// What a command means with these parameters.
#[inline(never)]
pub(crate) fn meaning(command: u16, p: &Parameters, identity: Identity) -> Meaning {
    if PLACED.contains(&command) {
        let is_placed = p.ground.is_some() || p.number(7) != 0.0;
        if p.datum == Datum::Unsupported && is_placed {
            return Meaning::Answer(CommandResult::UnsupportedFrame);
        }
        if p.ground.is_some_and(|place| !place.is_on_earth()) {
            return Meaning::Answer(CommandResult::Denied);
        }
    }
    let request = match command {
        number::COMPONENT_ARM_DISARM => flight::arm(p),
        number::DO_FLIGHTTERMINATION if p.number(1) > 0.5 => Ok(Request::Kill),
        number::DO_FLIGHTTERMINATION => Err(CommandResult::Denied),
        number::NAV_TAKEOFF => Ok(flight::takeoff(p, identity)),
        number::NAV_LAND => Ok(Request::Land { place: p.ground }),
        number::NAV_RETURN_TO_LAUNCH => Ok(Request::Return),
        number::NAV_LOITER_UNLIM => Ok(flight::loiter(p)),
        number::DO_PAUSE_CONTINUE if p.is(1, 0.0) => Ok(Request::Hold),
        number::DO_PAUSE_CONTINUE if p.is(1, 1.0) => Ok(Request::Continue),
        number::DO_PAUSE_CONTINUE => Err(CommandResult::Denied),
        number::DO_REPOSITION => Ok(flight::reposition(p)),
        number::DO_CHANGE_SPEED => flight::speed(p),
        number::DO_CHANGE_ALTITUDE => flight::altitude(p),
        number::DO_SET_MODE => flight::mode(p),
        number::MISSION_START => flight::index(p).map(|first| Request::StartMission { first }),
        number::DO_SET_MISSION_CURRENT => flight::index(p).map(|index| Request::SetCurrentItem { index }),
        number::DO_SET_HOME => flight::home(p),
        number::DO_SET_ROI_NONE => Ok(Request::LookAt(None)),
        number::DO_SET_ROI_LOCATION | number::DO_SET_ROI => p
            .place()
            .map(|place| Request::LookAt(Some(place)))
            .ok_or(CommandResult::Denied),
        number::RUN_PREARM_CHECKS => Ok(Request::CheckArming),
        number::PREFLIGHT_CALIBRATION => upkeep::calibration(p),
        number::PREFLIGHT_STORAGE => upkeep::storage(p),
        number::PREFLIGHT_REBOOT_SHUTDOWN => upkeep::reboot(p),
        number::DO_MOTOR_TEST => upkeep::motor_test(p),
        number::ACTUATOR_TEST => upkeep::actuator_test(p),
        _ => match upkeep::camera(command, p) {
            Some(request) => request,
            None => return messages(command, p).unwrap_or(UNSUPPORTED),
        },
    };
    request.map_or_else(Meaning::Answer, Meaning::Request)
}

/// Commands whose parameters 5 to 7 are a place, or nothing.
const PLACED: [u16; 7] = [
    number::NAV_TAKEOFF,
    number::NAV_LAND,
    number::NAV_LOITER_UNLIM,
    number::DO_REPOSITION,
    number::DO_SET_HOME,
    number::DO_SET_ROI_LOCATION,
    number::DO_SET_ROI,
];

const UNSUPPORTED: Meaning = Meaning::Answer(CommandResult::Unsupported);

/// A request, or the answer in its place.
pub(super) type Translated = Result<Request, CommandResult>;

/// Commands about messages.
#[inline(never)]
fn messages(command: u16, p: &Parameters) -> Option<Meaning> {
    let message = p.number(1) as u32;
    Some(Meaning::Ours(match command {
        number::GET_HOME_POSITION => Ours::Once {
            command,
            message: HOME_POSITION_DATA::ID,
        },
        number::REQUEST_PROTOCOL_VERSION => Ours::Once {
            command,
            message: PROTOCOL_VERSION_DATA::ID,
        },
        number::REQUEST_AUTOPILOT_CAPABILITIES => Ours::Once {
            command,
            message: AUTOPILOT_VERSION_DATA::ID,
        },
        number::REQUEST_MESSAGE => Ours::Once { command, message },
        number::GET_MESSAGE_INTERVAL => Ours::Interval { message },
        number::SET_MESSAGE_INTERVAL => Ours::Every {
            message,
            interval: (p.number(2) >= 0.0).then_some(p.number(2) as u32),
        },
        _ => return None,
    }))
}
