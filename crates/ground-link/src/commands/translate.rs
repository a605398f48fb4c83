//! What a command means: from its number and parameters to a request.
//!
//! Parameters that are not set are `None` here, and never a reason to refuse. Commands and
//! parameters are MAVLink's (`common.xml`).

use windhover_autopilot::mission::action::Altitude;
use windhover_math::wrap_pi;

use super::CommandResult;
use super::arguments::{Datum, Parameters, datum};
use crate::mode::Mode;
use crate::request::{Calibration, Request, SpeedKind};
use crate::scale::DEGREE;

/// Numbers of the `MAV_CMD`s that are understood.
#[rustfmt::skip]
mod number {
    pub const NAV_LOITER_UNLIM: u16 = 17;
    pub const NAV_RETURN_TO_LAUNCH: u16 = 20;
    pub const NAV_LAND: u16 = 21;
    pub const NAV_TAKEOFF: u16 = 22;
    pub const DO_SET_MODE: u16 = 176;
    pub const DO_CHANGE_SPEED: u16 = 178;
    pub const DO_SET_HOME: u16 = 179;
    pub const DO_FLIGHTTERMINATION: u16 = 185;
    pub const DO_CHANGE_ALTITUDE: u16 = 186;
    pub const DO_REPOSITION: u16 = 192;
    pub const DO_PAUSE_CONTINUE: u16 = 193;
    pub const DO_SET_ROI_LOCATION: u16 = 195;
    pub const DO_SET_ROI_NONE: u16 = 197;
    pub const DO_SET_ROI: u16 = 201;
    pub const DO_DIGICAM_CONTROL: u16 = 203;
    pub const DO_SET_CAM_TRIGG_DIST: u16 = 206;
    pub const DO_MOTOR_TEST: u16 = 209;
    pub const DO_SET_MISSION_CURRENT: u16 = 224;
    pub const PREFLIGHT_CALIBRATION: u16 = 241;
    pub const PREFLIGHT_STORAGE: u16 = 245;
    pub const PREFLIGHT_REBOOT_SHUTDOWN: u16 = 246;
    pub const MISSION_START: u16 = 300;
    pub const ACTUATOR_TEST: u16 = 310;
    pub const COMPONENT_ARM_DISARM: u16 = 400;
    pub const RUN_PREARM_CHECKS: u16 = 401;
    pub const GET_HOME_POSITION: u16 = 410;
    pub const GET_MESSAGE_INTERVAL: u16 = 510;
    pub const SET_MESSAGE_INTERVAL: u16 = 511;
    pub const REQUEST_MESSAGE: u16 = 512;
    pub const REQUEST_PROTOCOL_VERSION: u16 = 519;
    pub const REQUEST_AUTOPILOT_CAPABILITIES: u16 = 520;
    pub const IMAGE_START_CAPTURE: u16 = 2000;
    pub const IMAGE_STOP_CAPTURE: u16 = 2001;
}

/// The number that forces arming and disarming.
const FORCE: f32 = 21_196.0;

/// The largest time that a motor is tested for, s.
const LONGEST_TEST: f32 = 10.0;

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
        if p.is_off_earth {
            return Meaning::Answer(CommandResult::Denied);
        }
    }
    if command == number::DO_CHANGE_SPEED && !p.get(2).is_some_and(|speed| speed != -1.0) {
        return Meaning::Answer(CommandResult::Accepted); // "no change"
    }
    let request = match command {
        number::COMPONENT_ARM_DISARM => arm(p),
        number::DO_FLIGHTTERMINATION if p.number(1) > 0.5 => Ok(Request::Kill),
        number::DO_FLIGHTTERMINATION => Err(CommandResult::Denied),
        number::NAV_TAKEOFF => Ok(takeoff(p, identity)),
        number::NAV_LAND => Ok(Request::Land { place: p.ground }),
        number::NAV_RETURN_TO_LAUNCH => Ok(Request::Return),
        number::NAV_LOITER_UNLIM => Ok(loiter(p)),
        number::DO_PAUSE_CONTINUE if p.is(1, 0.0) => Ok(Request::Hold),
        number::DO_PAUSE_CONTINUE if p.is(1, 1.0) => Ok(Request::Continue),
        number::DO_PAUSE_CONTINUE => Err(CommandResult::Denied),
        number::DO_REPOSITION => Ok(reposition(p)),
        number::DO_CHANGE_SPEED => speed(p),
        number::DO_CHANGE_ALTITUDE => altitude(p),
        number::DO_SET_MODE => mode(p),
        number::MISSION_START => index(p, 1).map(|first| Request::StartMission { first }),
        number::DO_SET_MISSION_CURRENT => index(p, 1).map(|index| Request::SetCurrentItem { index }),
        number::DO_SET_HOME => home(p),
        number::DO_SET_ROI_NONE => Ok(Request::LookAt(None)),
        number::DO_SET_ROI_LOCATION | number::DO_SET_ROI => p
            .place()
            .map(|place| Request::LookAt(Some(place)))
            .ok_or(CommandResult::Denied),
        number::RUN_PREARM_CHECKS => Ok(Request::CheckArming),
        number::PREFLIGHT_CALIBRATION => calibration(p),
        number::PREFLIGHT_STORAGE => storage(p),
        number::PREFLIGHT_REBOOT_SHUTDOWN => reboot(p),
        number::DO_MOTOR_TEST => motor_test(p),
        number::ACTUATOR_TEST => actuator_test(p),
        _ => {
            return camera(command, p)
                .or_else(|| messages(command, p))
                .unwrap_or(UNSUPPORTED);
        }
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

type Translated = Result<Request, CommandResult>;

fn arm(p: &Parameters) -> Translated {
    match (p.number(1), p.is(2, FORCE)) {
        (1.0, force) => Ok(Request::Arm { force }),
        (0.0, true) => Ok(Request::Kill),
        (0.0, false) => Ok(Request::Disarm),
        _ => Err(CommandResult::Denied),
    }
}

/// QGroundControl sends PX4 the altitude above the sea; others send it above home.
fn takeoff(p: &Parameters, identity: Identity) -> Request {
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
fn reposition(p: &Parameters) -> Request {
    let speed = p.get(1).filter(|speed| *speed > 0.0);
    go(p, p.get(4), speed)
}

/// The heading is in degrees; without a place it is a pause.
fn loiter(p: &Parameters) -> Request {
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

fn speed(p: &Parameters) -> Translated {
    // 0 is air speed: to a multicopter the same as ground speed.
    let kind = match p.number(1) {
        0.0 | 1.0 => SpeedKind::Ground,
        2.0 => SpeedKind::Climb,
        3.0 => SpeedKind::Descent,
        _ => return Err(CommandResult::Denied),
    };
    let speed = p.get(2).filter(|speed| *speed != -2.0);
    match speed {
        Some(speed) if speed <= 0.0 => Err(CommandResult::Denied),
        speed => Ok(Request::ChangeSpeed { kind, speed }),
    }
}

/// Parameter 1 is the altitude, 2 the frame that it counts in.
fn altitude(p: &Parameters) -> Translated {
    let value = p.get(1).ok_or(CommandResult::Denied)?;
    let altitude = match datum(p.number(2) as u8) {
        Datum::SeaLevel => Altitude::SeaLevel(value),
        Datum::Home => Altitude::Home(value),
        _ => return Err(CommandResult::UnsupportedFrame),
    };
    Ok(Request::Reposition {
        place: None,
        altitude: Some(altitude),
        heading: None,
        speed: None,
    })
}

fn mode(p: &Parameters) -> Translated {
    const CUSTOM: u8 = 1;
    if p.number(1) as u8 & CUSTOM == 0 {
        return Err(CommandResult::Denied);
    }
    Mode::from_numbers(p.number(2) as u8, p.number(3) as u8)
        .map(Request::SetMode)
        .ok_or(CommandResult::Denied)
}

fn index(p: &Parameters, number: usize) -> Result<u16, CommandResult> {
    match p.number(number) {
        index @ 0.0..=65_534.0 => Ok(index as u16),
        _ => Err(CommandResult::Denied),
    }
}

fn home(p: &Parameters) -> Translated {
    if p.is(1, 1.0) {
        return Ok(Request::SetHome(None));
    }
    p.place()
        .map(|place| Request::SetHome(Some(place)))
        .ok_or(CommandResult::Denied)
}

/// One calibration at a time, by the number of its parameter and what that says; none at all ends
/// the one that is under way.
fn calibration(p: &Parameters) -> Translated {
    let mut wanted = None;
    for number in 1..=7 {
        let value = p.number(number);
        if value != 0.0 && wanted.replace((number, value as u8)).is_some() {
            return Err(CommandResult::Denied);
        }
    }
    Ok(Request::Calibrate(match wanted {
        None => Calibration::Cancel,
        Some((1, 1)) => Calibration::Gyro,
        Some((2, 1)) => Calibration::Compass,
        Some((3, 1)) => Calibration::Pressure,
        Some((4, 1)) => Calibration::Radio,
        Some((5, 1)) => Calibration::Accelerometer,
        Some((5, 2)) => Calibration::Level,
        Some((5, 4)) => Calibration::AccelerometerOffset,
        // Air speed, motors, temperatures and the like.
        Some(_) => return Err(CommandResult::Unsupported),
    }))
}

fn storage(p: &Parameters) -> Translated {
    match p.number(1) {
        1.0 => Ok(Request::StoreParameters),
        2.0 | 3.0 => Ok(Request::ResetParameters),
        _ => Err(CommandResult::Denied),
    }
}

fn reboot(p: &Parameters) -> Translated {
    match p.number(1) {
        1.0 => Ok(Request::Reboot),
        _ => Err(CommandResult::Denied),
    }
}

/// Throttle in percent (type 0) or as a pulse of 1000 to 2000 µs (type 1), for some seconds.
fn motor_test(p: &Parameters) -> Translated {
    let throttle = match p.number(2) {
        0.0 => p.number(3) / 100.0,
        1.0 => (p.number(3) - 1000.0) * 1e-3,
        _ => return Err(CommandResult::Denied),
    };
    motor(p.number(1), throttle, p.number(4))
}

/// `ACTUATOR_OUTPUT_FUNCTION` 1 to 8 are motors; a value of NaN ends the test.
fn actuator_test(p: &Parameters) -> Translated {
    let duration = p.number(2);
    match p.get(1) {
        None => motor(p.number(5), 0.0, duration),
        Some(value) if value < 0.0 => Err(CommandResult::Denied),
        Some(value) => motor(p.number(5), value, duration),
    }
}

fn motor(number: f32, throttle: f32, duration: f32) -> Translated {
    let fits = (1.0..=8.0).contains(&number)
        && (0.0..=1.0).contains(&throttle)
        && (0.0..=LONGEST_TEST).contains(&duration);
    if !fits {
        return Err(CommandResult::Denied);
    }
    Ok(Request::TestMotor {
        motor: number as u8,
        throttle,
        duration,
    })
}

#[inline(never)]
fn camera(command: u16, p: &Parameters) -> Option<Meaning> {
    let request = match command {
        number::IMAGE_START_CAPTURE => Request::TakePhotos {
            interval: p.number(2),
            count: p.get(3).unwrap_or(1.0) as u32,
        },
        number::IMAGE_STOP_CAPTURE => Request::StopPhotos,
        number::DO_DIGICAM_CONTROL if p.number(5) > 0.5 => Request::TakePhotos {
            interval: 0.0,
            count: 1,
        },
        // Without a distance it is one photo, now.
        number::DO_SET_CAM_TRIGG_DIST if p.is(3, 1.0) && p.number(1) <= 0.0 => Request::TakePhotos {
            interval: 0.0,
            count: 1,
        },
        number::DO_SET_CAM_TRIGG_DIST => Request::PhotosByDistance {
            distance: p.number(1),
        },
        _ => return None,
    };
    Some(match request {
        // Several, or without end, need time between two.
        Request::TakePhotos { interval, count } if interval < 0.0 || count != 1 && interval == 0.0 => {
            Meaning::Answer(CommandResult::Denied)
        }
        Request::PhotosByDistance { distance } if distance < 0.0 => Meaning::Answer(CommandResult::Denied),
        request => Meaning::Request(request),
    })
}

/// Commands about messages: `HOME_POSITION` 242, `PROTOCOL_VERSION` 300, `AUTOPILOT_VERSION` 148.
#[inline(never)]
fn messages(command: u16, p: &Parameters) -> Option<Meaning> {
    let message = p.number(1) as u32;
    Some(Meaning::Ours(match command {
        number::GET_HOME_POSITION => Ours::Once {
            command,
            message: 242,
        },
        number::REQUEST_PROTOCOL_VERSION => Ours::Once {
            command,
            message: 300,
        },
        number::REQUEST_AUTOPILOT_CAPABILITIES => Ours::Once {
            command,
            message: 148,
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
