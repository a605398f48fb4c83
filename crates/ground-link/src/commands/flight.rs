//! Commands about flight: from parameters to requests.

use windhover_autopilot::mission::action::Altitude;
use windhover_math::wrap_pi;

use super::CommandResult;
use super::arguments::Parameters;
use super::translate::{Identity, Translated};
use crate::mode::Mode;
use crate::request::{Request, SpeedKind};
use crate::scale::{DEGREE, Datum};

/// The number that forces arming and disarming.
const FORCE: f32 = 21_196.0;

pub(super) fn arm(p: &Parameters) -> Translated {
    match (p.number(1), p.is(2, FORCE)) {
        (1.0, force) => Ok(Request::Arm { force }),
        (0.0, true) => Ok(Request::Kill),
        (0.0, false) => Ok(Request::Disarm),
        _ => Err(CommandResult::Denied),
    }
}

/// QGroundControl sends PX4 the altitude above the sea; others send it above home.
pub(super) fn takeoff(p: &Parameters, identity: Identity) -> Request {
    let implied = match identity {
        Identity::Px4 => Altitude::SeaLevel,
        Identity::Generic => Altitude::Home,
    };
    Request::Takeoff {
        altitude: p.altitude(implied),
        heading: p.get(4).map(|degrees| wrap_pi(degrees * DEGREE)),
    }
}

/// With neither place nor altitude it is QGroundControl's pause. The heading is in rad already.
pub(super) fn reposition(p: &Parameters) -> Request {
    let speed = p.get(1).filter(|speed| *speed > 0.0);
    go(p, p.get(4), speed)
}

/// The heading is in degrees; without a place it is a pause.
pub(super) fn loiter(p: &Parameters) -> Request {
    match p.ground {
        Some(_) => go(p, p.get(4).map(|degrees| degrees * DEGREE), None),
        None => Request::Hold,
    }
}

fn go(p: &Parameters, heading: Option<f32>, speed: Option<f32>) -> Request {
    let altitude = p.altitude(Altitude::SeaLevel);
    if p.ground.is_none() && altitude.is_none() {
        return Request::Hold;
    }
    Request::Reposition {
        place: p.ground,
        altitude,
        heading: heading.map(wrap_pi),
        speed,
    }
}

/// -1, or none, is "no change": then there is nothing to do. -2 is the default.
pub(super) fn speed(p: &Parameters) -> Translated {
    let speed = match p.get(2) {
        None | Some(-1.0) => return Err(CommandResult::Accepted),
        Some(-2.0) => None,
        speed => speed,
    };
    // 0 is air speed: to a multicopter the same as ground speed.
    let kind = match p.number(1) {
        0.0 | 1.0 => SpeedKind::Ground,
        2.0 => SpeedKind::Climb,
        3.0 => SpeedKind::Descent,
        _ => return Err(CommandResult::Denied),
    };
    match speed {
        Some(speed) if speed <= 0.0 => Err(CommandResult::Denied),
        speed => Ok(Request::ChangeSpeed { kind, speed }),
    }
}

/// Parameter 1 is the altitude, 2 the frame that it counts in.
pub(super) fn altitude(p: &Parameters) -> Translated {
    let value = p.get(1).ok_or(CommandResult::Denied)?;
    let altitude = Datum::of(p.number(2) as u8).altitude(value);
    Ok(Request::Reposition {
        place: None,
        altitude: Some(altitude.ok_or(CommandResult::UnsupportedFrame)?),
        heading: None,
        speed: None,
    })
}

pub(super) fn mode(p: &Parameters) -> Translated {
    const CUSTOM: u8 = 1;
    if p.number(1) as u8 & CUSTOM == 0 {
        return Err(CommandResult::Denied);
    }
    Mode::from_numbers(p.number(2) as u8, p.number(3) as u8)
        .map(Request::SetMode)
        .ok_or(CommandResult::Denied)
}

/// Parameter 1 is an item of the mission.
pub(super) fn index(p: &Parameters) -> Result<u16, CommandResult> {
    match p.number(1) {
        index @ 0.0..=65_534.0 => Ok(index as u16),
        _ => Err(CommandResult::Denied),
    }
}

pub(super) fn home(p: &Parameters) -> Translated {
    if p.is(1, 1.0) {
        return Ok(Request::SetHome(None));
    }
    p.place()
        .map(|place| Request::SetHome(Some(place)))
        .ok_or(CommandResult::Denied)
}
