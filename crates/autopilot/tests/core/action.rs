//! What each command of a mission means, and what is refused about it.

use windhover_autopilot::mission::action::{Action, Altitude, Place, Reason, command, interpret};
use windhover_autopilot::mission::{MissionItem, Refusal};

use super::{HOME, item};

const UNSET: f32 = f32::NAN;

fn means(command: u16, params: [f32; 4]) -> Action {
    interpret(&item(command, params)).unwrap_or_else(|refusal| panic!("{command}: {refusal}"))
}

fn refused(item: &MissionItem) -> Refusal {
    interpret(item).expect_err("refused")
}

/// The field that is named, where the item is changed in this way.
fn refused_field(command: u16, params: [f32; 4]) -> &'static str {
    refused(&item(command, params)).field
}

fn here() -> Place {
    Place {
        latitude: HOME.latitude,
        longitude: HOME.longitude,
        altitude: Altitude::Home(10.0),
    }
}

fn passing() -> Action {
    Action::Waypoint {
        place: here(),
        hold: 0.0,
        acceptance_radius: None,
        heading: None,
    }
}

/// Unset parameters and the zeros that stand for them say the same.
#[test]
fn waypoints() {
    assert_eq!(means(command::NAV_WAYPOINT, [0.0, 0.0, 0.0, UNSET]), passing());
    assert_eq!(
        means(command::NAV_WAYPOINT, [UNSET, UNSET, UNSET, UNSET]),
        passing()
    );
    let Action::Waypoint {
        hold,
        acceptance_radius,
        heading,
        ..
    } = means(command::NAV_WAYPOINT, [3.0, 0.5, 7.0, 90.0])
    else {
        panic!("a waypoint");
    };
    assert_eq!((hold, acceptance_radius), (3.0, Some(0.5)));
    assert!((heading.unwrap() - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
    let Action::Waypoint { hold, heading, .. } = means(command::NAV_LOITER_TIME, [7.0, 1.0, 5.0, 90.0])
    else {
        panic!("a waypoint");
    };
    assert_eq!((hold, heading), (7.0, None));
}

/// 350° and −10° are the same heading, within ±π.
#[test]
fn headings_are_wrapped() {
    for (degrees, wanted) in [
        (350.0f32, -10.0f32),
        (-10.0, -10.0),
        (180.5, -179.5),
        (-360.0, 0.0),
    ] {
        let Action::Waypoint { heading, .. } = means(command::NAV_WAYPOINT, [0.0, 0.0, 0.0, degrees]) else {
            panic!("a waypoint");
        };
        let off = heading.unwrap() - wanted.to_radians();
        assert!(off.abs() < 1e-5, "{degrees}°: {off}");
    }
}

#[test]
fn everything_else_that_flies_or_waits() {
    assert_eq!(
        means(command::NAV_TAKEOFF, [15.0, 0.0, 0.0, UNSET]),
        Action::Takeoff {
            altitude: Altitude::Home(10.0)
        }
    );
    assert_eq!(means(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]), Action::Return);
    assert_eq!(
        means(command::NAV_LAND, [0.0; 4]),
        Action::Land { place: Some(here()) }
    );
    let landing = MissionItem {
        x: 0,
        y: 0,
        z: UNSET,
        ..item(command::NAV_LAND, [0.0; 4])
    };
    assert_eq!(interpret(&landing), Ok(Action::Land { place: None }));
    assert_eq!(
        means(command::NAV_DELAY, [4.0, -1.0, -1.0, -1.0]),
        Action::Delay(4.0)
    );
    assert_eq!(
        means(command::CONDITION_DELAY, [2.5, 0.0, 0.0, 0.0]),
        Action::Delay(2.5)
    );
    assert_eq!(
        means(command::DO_JUMP, [4.0, 3.0, 0.0, 0.0]),
        Action::Jump {
            to: 4,
            times: Some(3)
        }
    );
    assert_eq!(
        means(command::DO_JUMP, [0.0, -1.0, 0.0, 0.0]),
        Action::Jump { to: 0, times: None }
    );
    let speed = |value| means(command::DO_CHANGE_SPEED, [1.0, value, -1.0, 0.0]);
    assert_eq!(speed(4.5), Action::Speed(Some(4.5)));
    for default in [-1.0, -2.0, UNSET] {
        assert_eq!(speed(default), Action::Speed(None), "{default}");
    }
}

#[test]
fn cameras_and_regions_of_interest() {
    assert_eq!(
        means(command::IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0]),
        Action::Photo
    );
    assert_eq!(
        means(command::IMAGE_START_CAPTURE, [0.0, 2.0, 5.0, 0.0]),
        Action::PhotoByTime {
            interval: 2.0,
            count: 5
        }
    );
    assert_eq!(
        means(command::IMAGE_START_CAPTURE, [0.0, 2.0, 0.0, 0.0]),
        Action::PhotoByTime {
            interval: 2.0,
            count: 0
        }
    );
    assert_eq!(means(command::DO_DIGICAM_CONTROL, [0.0; 4]), Action::Photo);
    assert_eq!(means(command::IMAGE_STOP_CAPTURE, [0.0; 4]), Action::PhotoStop);
    let by_distance = |distance, at_once| Action::PhotoByDistance { distance, at_once };
    let trigger = |distance, at_once| means(command::DO_SET_CAM_TRIGG_DIST, [distance, 0.0, at_once, 0.0]);
    assert_eq!(trigger(25.0, 1.0), by_distance(25.0, true));
    assert_eq!(trigger(25.0, 0.0), by_distance(25.0, false));
    assert_eq!(trigger(0.0, 0.0), by_distance(0.0, false));
    assert_eq!(
        means(command::DO_SET_ROI_LOCATION, [0.0; 4]),
        Action::LookAt(here())
    );
    assert_eq!(
        means(command::DO_SET_ROI, [3.0, 0.0, 0.0, 0.0]),
        Action::LookAt(here())
    );
    assert_eq!(means(command::DO_SET_ROI, [0.0; 4]), Action::LookAhead);
    assert_eq!(means(command::DO_SET_ROI_NONE, [0.0; 4]), Action::LookAhead);
    for payload in [
        command::DO_MOUNT_CONTROL,
        command::SET_CAMERA_MODE,
        command::SET_CAMERA_ZOOM,
        command::SET_CAMERA_FOCUS,
        command::DO_GIMBAL_MANAGER_PITCHYAW,
        command::DO_GIMBAL_MANAGER_CONFIGURE,
        command::VIDEO_START_CAPTURE,
        command::VIDEO_STOP_CAPTURE,
    ] {
        assert_eq!(means(payload, [UNSET; 4]), Action::PassOn, "{payload}");
    }
}

/// Altitudes count from the sea in frames 0 and 5, from home in 3 and 6; others are refused.
#[test]
fn frames() {
    for (frame, altitude) in [
        (0, Altitude::SeaLevel(10.0)),
        (5, Altitude::SeaLevel(10.0)),
        (3, Altitude::Home(10.0)),
        (6, Altitude::Home(10.0)),
    ] {
        let takeoff = MissionItem {
            frame,
            ..item(command::NAV_TAKEOFF, [0.0; 4])
        };
        assert_eq!(interpret(&takeoff), Ok(Action::Takeoff { altitude }), "{frame}");
    }
    for frame in [1, 2, 4, 7, 10, 255] {
        let takeoff = MissionItem {
            frame,
            ..item(command::NAV_TAKEOFF, [0.0; 4])
        };
        let refusal = refused(&takeoff);
        assert_eq!((refusal.field, refusal.reason), ("frame", Reason::Frame(frame)));
    }
    let above = Altitude::SeaLevel(500.0).above_home(488_000);
    assert!((above - 12.0).abs() < 1e-3, "{above}");
    assert_eq!(Altitude::Home(12.0).above_home(488_000), 12.0);
}

/// Every refusal names the field; values at the limits are still flown.
#[test]
fn parameters_out_of_range_are_named() {
    use command::*;
    let cases: &[(u16, [f32; 4], &str)] = &[
        (NAV_WAYPOINT, [-1.0, 0.0, 0.0, UNSET], "hold time"),
        (NAV_WAYPOINT, [3601.0, 0.0, 0.0, UNSET], "hold time"),
        (NAV_WAYPOINT, [0.0, 0.04, 0.0, UNSET], "acceptance radius"),
        (NAV_WAYPOINT, [0.0, -2.0, 0.0, UNSET], "acceptance radius"),
        (
            NAV_WAYPOINT,
            [0.0, f32::INFINITY, 0.0, UNSET],
            "acceptance radius",
        ),
        (NAV_WAYPOINT, [0.0, 0.0, 0.0, 361.0], "heading"),
        (NAV_WAYPOINT, [0.0, 0.0, 0.0, f32::INFINITY], "heading"),
        (NAV_LOITER_TIME, [-1.0, 0.0, 0.0, 0.0], "loiter time"),
        (NAV_DELAY, [-1.0, 0.0, 0.0, 0.0], "delay"),
        (NAV_DELAY, [UNSET, 0.0, 0.0, 0.0], "delay"),
        (CONDITION_DELAY, [4000.0, 0.0, 0.0, 0.0], "delay"),
        (DO_JUMP, [-1.0, 1.0, 0.0, 0.0], "jump target"),
        (DO_JUMP, [256.0, 1.0, 0.0, 0.0], "jump target"),
        (DO_JUMP, [UNSET, 1.0, 0.0, 0.0], "jump target"),
        (DO_JUMP, [0.0, -2.0, 0.0, 0.0], "jump repeats"),
        (DO_JUMP, [0.0, UNSET, 0.0, 0.0], "jump repeats"),
        (DO_CHANGE_SPEED, [1.0, 0.0, -1.0, 0.0], "speed"),
        (DO_CHANGE_SPEED, [1.0, 21.0, -1.0, 0.0], "speed"),
        (DO_CHANGE_SPEED, [1.0, -3.0, -1.0, 0.0], "speed"),
        (DO_SET_ROI, [1.0, 0.0, 0.0, 0.0], "region of interest mode"),
        (DO_SET_CAM_TRIGG_DIST, [-5.0, 0.0, 0.0, 0.0], "trigger distance"),
        (IMAGE_START_CAPTURE, [0.0, 0.0, 2.0, 0.0], "photo interval"),
        (IMAGE_START_CAPTURE, [0.0, UNSET, 0.0, 0.0], "photo interval"),
        (IMAGE_START_CAPTURE, [0.0, 1.0, -1.0, 0.0], "number of photos"),
        (IMAGE_START_CAPTURE, [0.0, 1.0, 0.5, 0.0], "number of photos"),
        (IMAGE_START_CAPTURE, [0.0, 1.0, 70_000.0, 0.0], "number of photos"),
    ];
    for (command, params, field) in cases {
        assert_eq!(refused_field(*command, *params), *field, "{command} {params:?}");
    }
    for (command, params) in [
        (NAV_WAYPOINT, [3600.0, 1000.0, 0.0, 360.0]),
        (NAV_WAYPOINT, [0.0, 0.05, 0.0, -360.0]),
        (DO_JUMP, [255.0, 65_535.0, 0.0, 0.0]),
        (DO_CHANGE_SPEED, [1.0, 0.1, 0.0, 0.0]),
        (DO_CHANGE_SPEED, [1.0, 20.0, 0.0, 0.0]),
    ] {
        means(command, params);
    }
}

#[test]
fn places_out_of_the_world_are_named() {
    let at = |x, y, z| MissionItem {
        x,
        y,
        z,
        ..item(command::NAV_WAYPOINT, [0.0, 0.0, 0.0, UNSET])
    };
    assert_eq!(refused(&at(910_000_000, 0, 10.0)).field, "latitude");
    assert_eq!(refused(&at(-900_000_001, 0, 10.0)).field, "latitude");
    assert_eq!(refused(&at(0, 1_800_000_001, 10.0)).field, "longitude");
    assert_eq!(refused(&at(i32::MAX, i32::MAX, 10.0)).field, "latitude");
    let nowhere = refused(&at(0, 0, UNSET));
    assert_eq!((nowhere.field, nowhere.reason), ("altitude", Reason::NotANumber));
    assert_eq!(refused(&at(0, 0, f32::INFINITY)).field, "altitude");
    assert!(interpret(&at(900_000_000, -1_800_000_000, 10.0)).is_ok());
}

#[test]
fn other_commands_are_refused_by_number() {
    for other in [0, 17, 18, 82, 84, 112 + 1, 183, 2002, u16::MAX] {
        let refusal = refused(&item(other, [0.0; 4]));
        assert_eq!(
            (refusal.field, refusal.reason),
            ("command", Reason::Command(other))
        );
        assert!(refusal.to_string().contains(&other.to_string()), "{refusal}");
    }
}

/// Which items move the vehicle, and which need it at rest: passing depends on it.
#[test]
fn what_moves_and_what_needs_rest() {
    use command::*;
    let of = |command, params| {
        let action = means(command, params);
        (action.is_navigation(), action.needs_rest())
    };
    assert_eq!(of(NAV_TAKEOFF, [0.0; 4]), (true, false));
    assert_eq!(of(NAV_WAYPOINT, [0.0; 4]), (true, false));
    assert_eq!(of(NAV_LAND, [0.0; 4]), (true, false));
    assert_eq!(of(NAV_RETURN_TO_LAUNCH, [0.0; 4]), (true, false));
    assert_eq!(of(IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0]), (false, true));
    assert_eq!(of(NAV_DELAY, [1.0, 0.0, 0.0, 0.0]), (false, true));
    assert_eq!(of(IMAGE_START_CAPTURE, [0.0, 1.0, 0.0, 0.0]), (false, false));
    assert_eq!(of(DO_CHANGE_SPEED, [0.0, 2.0, 0.0, 0.0]), (false, false));
}
