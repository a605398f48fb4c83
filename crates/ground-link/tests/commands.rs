//! The command protocol: what each command means, and that each is acknowledged once.
#![allow(deprecated)]

mod common;

use common::*;
use mavlink::dialects::common::MavCmd as Cmd;
use mavlink::dialects::common::MavResult as R;
use mavlink::dialects::common::*;
use windhover_autopilot::mission::action::{Altitude, Place};
use windhover_ground_link::{Calibration, CommandResult, Config, Ground, Identity, Mode, Request, SpeedKind};

const N: f32 = NAN;
const PI: f32 = std::f32::consts::PI;

/// What a command asks of the vehicle.
fn meant(command: Cmd, params: [f32; 7]) -> Option<Request> {
    let mut bench = Bench::new();
    let result = bench.result(command, params);
    let requests = bench.vehicle.requests();
    assert_eq!(
        result == R::MAV_RESULT_ACCEPTED,
        requests.len() == 1,
        "{command:?}"
    );
    requests.first().copied()
}

fn reposition(place: Option<(i32, i32)>, altitude: Option<Altitude>, heading: Option<f32>) -> Request {
    Request::Reposition {
        place: place.map(|(latitude, longitude)| Ground { latitude, longitude }),
        altitude,
        heading,
        speed: None,
    }
}

#[test]
fn every_command_becomes_its_request() {
    let forced = 21_196.0;
    for (command, params, request) in [
        (
            Cmd::MAV_CMD_COMPONENT_ARM_DISARM,
            [1.0, 0.0, N, N, N, N, N],
            Request::Arm { force: false },
        ),
        (
            Cmd::MAV_CMD_COMPONENT_ARM_DISARM,
            [1.0, forced, N, N, N, N, N],
            Request::Arm { force: true },
        ),
        (
            Cmd::MAV_CMD_COMPONENT_ARM_DISARM,
            [0.0, N, N, N, N, N, N],
            Request::Disarm,
        ),
        (
            Cmd::MAV_CMD_COMPONENT_ARM_DISARM,
            [0.0, forced, N, N, N, N, N],
            Request::Kill,
        ),
        (
            Cmd::MAV_CMD_DO_FLIGHTTERMINATION,
            [1.0, N, N, N, N, N, N],
            Request::Kill,
        ),
        (
            Cmd::MAV_CMD_NAV_TAKEOFF,
            [N, N, N, N, N, N, 510.5],
            Request::Takeoff {
                altitude: Some(Altitude::SeaLevel(510.5)),
                heading: None,
            },
        ),
        (
            Cmd::MAV_CMD_NAV_TAKEOFF,
            [N; 7],
            Request::Takeoff {
                altitude: None,
                heading: None,
            },
        ),
        (Cmd::MAV_CMD_NAV_LAND, [N; 7], Request::Land { place: None }),
        (Cmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, [N; 7], Request::Return),
        (Cmd::MAV_CMD_NAV_LOITER_UNLIM, [N; 7], Request::Hold),
        (
            Cmd::MAV_CMD_DO_PAUSE_CONTINUE,
            [0.0, N, N, N, N, N, N],
            Request::Hold,
        ),
        (
            Cmd::MAV_CMD_DO_PAUSE_CONTINUE,
            [1.0, N, N, N, N, N, N],
            Request::Continue,
        ),
        // QGroundControl's pause, and its change of altitude.
        (
            Cmd::MAV_CMD_DO_REPOSITION,
            [-1.0, 1.0, 0.0, N, N, N, N],
            Request::Hold,
        ),
        (
            Cmd::MAV_CMD_DO_REPOSITION,
            [-1.0, 1.0, 0.0, N, N, N, 520.0],
            reposition(None, Some(Altitude::SeaLevel(520.0)), None),
        ),
        (
            Cmd::MAV_CMD_DO_CHANGE_ALTITUDE,
            [30.0, 3.0, N, N, N, N, N],
            reposition(None, Some(Altitude::Home(30.0)), None),
        ),
        (
            Cmd::MAV_CMD_DO_CHANGE_SPEED,
            [1.0, 4.5, -1.0, N, N, N, N],
            Request::ChangeSpeed {
                kind: SpeedKind::Ground,
                speed: Some(4.5),
            },
        ),
        (
            Cmd::MAV_CMD_DO_SET_MODE,
            [1.0, 4.0, 4.0, N, N, N, N],
            Request::SetMode(Mode::Mission),
        ),
        (
            Cmd::MAV_CMD_DO_SET_MODE,
            [129.0, 6.0, 0.0, N, N, N, N],
            Request::SetMode(Mode::Offboard),
        ),
        (
            Cmd::MAV_CMD_MISSION_START,
            [0.0, 0.0, N, N, N, N, N],
            Request::StartMission { first: 0 },
        ),
        (
            Cmd::MAV_CMD_DO_SET_MISSION_CURRENT,
            [7.0, N, N, N, N, N, N],
            Request::SetCurrentItem { index: 7 },
        ),
        (
            Cmd::MAV_CMD_DO_SET_HOME,
            [1.0, N, N, N, N, N, N],
            Request::SetHome(None),
        ),
        (
            Cmd::MAV_CMD_DO_SET_ROI_LOCATION,
            [N, N, N, N, 47.5, 8.25, 400.0],
            Request::LookAt(Some(Place {
                latitude: 475_000_000,
                longitude: 82_500_000,
                altitude: Altitude::SeaLevel(400.0),
            })),
        ),
        (Cmd::MAV_CMD_DO_SET_ROI_NONE, [N; 7], Request::LookAt(None)),
        (
            Cmd::MAV_CMD_NAV_LOITER_UNLIM,
            [N, N, N, 180.0, 47.5, 8.25, 510.0],
            reposition(
                Some((475_000_000, 82_500_000)),
                Some(Altitude::SeaLevel(510.0)),
                Some(PI),
            ),
        ),
        // A heading of many turns, and an altitude whose square is no float.
        (
            Cmd::MAV_CMD_DO_REPOSITION,
            [-1.0, 1.0, 0.0, 1e30, 47.5, 8.25, 3e38],
            reposition(
                Some((475_000_000, 82_500_000)),
                Some(Altitude::SeaLevel(1e9)),
                Some(0.0),
            ),
        ),
        (
            Cmd::MAV_CMD_DO_CHANGE_SPEED,
            [1.0, -2.0, -1.0, N, N, N, N],
            Request::ChangeSpeed {
                kind: SpeedKind::Ground,
                speed: None,
            },
        ),
        (
            Cmd::MAV_CMD_IMAGE_START_CAPTURE,
            [0.0, 0.0, 1.0, N, N, N, N],
            Request::TakePhotos {
                interval: 0.0,
                count: 1,
            },
        ),
        // Three, and without end.
        (
            Cmd::MAV_CMD_IMAGE_START_CAPTURE,
            [0.0, 2.0, 3.0, N, N, N, N],
            Request::TakePhotos {
                interval: 2.0,
                count: 3,
            },
        ),
        (
            Cmd::MAV_CMD_IMAGE_START_CAPTURE,
            [0.0, 2.0, 0.0, N, N, N, N],
            Request::TakePhotos {
                interval: 2.0,
                count: 0,
            },
        ),
        (Cmd::MAV_CMD_IMAGE_STOP_CAPTURE, [N; 7], Request::StopPhotos),
        (
            Cmd::MAV_CMD_DO_SET_CAM_TRIGG_DIST,
            [12.5, 0.0, 0.0, N, N, N, N],
            Request::PhotosByDistance {
                distance: 12.5,
                at_once: false,
            },
        ),
        // With a distance it is more than one photo.
        (
            Cmd::MAV_CMD_DO_SET_CAM_TRIGG_DIST,
            [12.5, 0.0, 1.0, N, N, N, N],
            Request::PhotosByDistance {
                distance: 12.5,
                at_once: true,
            },
        ),
        (
            Cmd::MAV_CMD_DO_SET_CAM_TRIGG_DIST,
            [0.0, 0.0, 1.0, N, N, N, N],
            ONE_PHOTO,
        ),
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [N; 7], ONE_PHOTO),
        (
            Cmd::MAV_CMD_PREFLIGHT_CALIBRATION,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            Request::Calibrate(Calibration::Gyro),
        ),
        (
            Cmd::MAV_CMD_PREFLIGHT_CALIBRATION,
            [0.0; 7],
            Request::Calibrate(Calibration::Cancel),
        ),
        (
            Cmd::MAV_CMD_DO_MOTOR_TEST,
            [2.0, 0.0, 15.0, 3.0, 0.0, 0.0, 0.0],
            Request::TestMotor {
                motor: 2,
                throttle: 0.15,
                duration: 3.0,
            },
        ),
        (
            Cmd::MAV_CMD_ACTUATOR_TEST,
            [0.25, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0],
            Request::TestMotor {
                motor: 4,
                throttle: 0.25,
                duration: 2.0,
            },
        ),
        (
            Cmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN,
            [1.0, 0.0, 0.0, N, N, N, N],
            Request::Reboot,
        ),
        (
            Cmd::MAV_CMD_PREFLIGHT_STORAGE,
            [1.0, -1.0, 0.0, N, N, N, N],
            Request::StoreParameters,
        ),
        (Cmd::MAV_CMD_RUN_PREARM_CHECKS, [N; 7], Request::CheckArming),
    ] {
        assert_eq!(meant(command, params), Some(request), "{command:?} {params:?}");
    }
}

const ONE_PHOTO: Request = Request::TakePhotos {
    interval: 0.0,
    count: 1,
};

/// "No change" of the speed is no reason to fly at another one.
#[test]
fn a_speed_that_is_not_to_change_does_not() {
    for speed in [-1.0, N] {
        let mut bench = Bench::new();
        let result = bench.result(Cmd::MAV_CMD_DO_CHANGE_SPEED, [1.0, speed, 50.0, N, N, N, N]);
        assert_eq!(result, R::MAV_RESULT_ACCEPTED);
        assert!(bench.vehicle.orders.is_empty());
    }
}

/// What is not calibrated here must not end a calibration that is.
#[test]
fn calibrations_of_parts_that_there_are_not_are_unsupported() {
    for (number, value) in [(0, 3.0), (3, 2.0), (4, 9.0), (5, 1.0), (5, 2.0), (6, 1.0)] {
        let mut params = [0.0; 7];
        params[number] = value;
        let mut bench = Bench::new();
        let result = bench.result(Cmd::MAV_CMD_PREFLIGHT_CALIBRATION, params);
        assert_eq!(result, R::MAV_RESULT_UNSUPPORTED, "{number} {value}");
        assert!(bench.vehicle.orders.is_empty());
    }
}

#[test]
fn what_cannot_be_meant_is_denied() {
    for (command, params) in [
        (Cmd::MAV_CMD_COMPONENT_ARM_DISARM, [7.0, N, N, N, N, N, N]),
        (Cmd::MAV_CMD_DO_SET_MODE, [1.0, 4.0, 99.0, N, N, N, N]),
        (Cmd::MAV_CMD_DO_SET_MODE, [0.0, 4.0, 4.0, N, N, N, N]),
        (Cmd::MAV_CMD_DO_MOTOR_TEST, [9.0, 0.0, 15.0, 3.0, 0.0, 0.0, 0.0]),
        (Cmd::MAV_CMD_DO_MOTOR_TEST, [1.0, 0.0, 150.0, 3.0, 0.0, 0.0, 0.0]),
        (Cmd::MAV_CMD_DO_MOTOR_TEST, [1.0, 0.0, 15.0, 300.0, 0.0, 0.0, 0.0]),
        (Cmd::MAV_CMD_ACTUATOR_TEST, [-0.5, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
        (Cmd::MAV_CMD_DO_CHANGE_SPEED, [1.0, -5.0, N, N, N, N, N]),
        (
            Cmd::MAV_CMD_PREFLIGHT_CALIBRATION,
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ),
        (Cmd::MAV_CMD_DO_SET_HOME, [0.0, N, N, N, N, N, N]),
        (Cmd::MAV_CMD_DO_PAUSE_CONTINUE, [2.0, N, N, N, N, N, N]),
        (Cmd::MAV_CMD_DO_FLIGHTTERMINATION, [0.0, N, N, N, N, N, N]),
        // Places that are none: to be flown to no other one instead.
        (
            Cmd::MAV_CMD_DO_REPOSITION,
            [-1.0, 1.0, 0.0, N, 147.5, 8.25, 510.0],
        ),
        (Cmd::MAV_CMD_NAV_LAND, [N, N, N, N, 47.5, 1e9, N]),
        (Cmd::MAV_CMD_NAV_LOITER_UNLIM, [N, N, N, N, -91.0, 8.0, N]),
        // Photos without time between them.
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [0.0, 0.0, 0.0, N, N, N, N]),
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [0.0, 0.0, 5.0, N, N, N, N]),
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [0.0, -1.0, 1.0, N, N, N, N]),
        // Less than one photo, which 0 and with it no end must not come of.
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [0.0, 2.0, -1.0, N, N, N, N]),
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [0.0, 2.0, -0.1, N, N, N, N]),
        (Cmd::MAV_CMD_IMAGE_START_CAPTURE, [0.0, 2.0, 0.9, N, N, N, N]),
        (Cmd::MAV_CMD_DO_SET_CAM_TRIGG_DIST, [-1.0, 0.0, 0.0, N, N, N, N]),
    ] {
        let mut bench = Bench::new();
        let result = bench.result(command, params);
        assert_eq!(result, R::MAV_RESULT_DENIED, "{command:?} {params:?}");
        assert!(bench.vehicle.orders.is_empty());
    }
}

fn goto(x: i32, y: i32, z: f32, frame: MavFrame) -> COMMAND_INT_DATA {
    COMMAND_INT_DATA {
        param1: -1.0,
        param2: 1.0,
        param3: 0.0,
        param4: 0.5,
        x,
        y,
        z,
        command: Cmd::MAV_CMD_DO_REPOSITION,
        target_system: 1,
        target_component: 1,
        frame,
        current: 0,
        autocontinue: 0,
    }
}

#[test]
fn a_place_as_integers_keeps_every_digit_and_its_frame() {
    for (frame, altitude) in [
        (MavFrame::MAV_FRAME_GLOBAL, Altitude::SeaLevel(510.0)),
        (MavFrame::MAV_FRAME_GLOBAL_INT, Altitude::SeaLevel(510.0)),
        (MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT, Altitude::Home(510.0)),
    ] {
        let mut bench = Bench::new();
        let acks: Vec<COMMAND_ACK_DATA> = all(&bench.ask(&goto(473_977_419, -85_455_939, 510.0, frame)));
        assert_eq!((acks.len(), acks[0].result), (1, R::MAV_RESULT_ACCEPTED));
        let request = reposition(Some((473_977_419, -85_455_939)), Some(altitude), Some(0.5));
        assert_eq!(bench.vehicle.requests(), [request]);
    }
    // Metres in a local frame are no degrees.
    for command in [
        Cmd::MAV_CMD_DO_REPOSITION,
        Cmd::MAV_CMD_NAV_LAND,
        Cmd::MAV_CMD_NAV_LOITER_UNLIM,
        Cmd::MAV_CMD_DO_SET_ROI_LOCATION,
    ] {
        let mut bench = Bench::new();
        let local = COMMAND_INT_DATA {
            command,
            ..goto(10, 20, -30.0, MavFrame::MAV_FRAME_LOCAL_NED)
        };
        let acks: Vec<COMMAND_ACK_DATA> = all(&bench.ask(&local));
        assert_eq!(acks[0].result, R::MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME);
        assert!(bench.vehicle.orders.is_empty());
    }
    let mut bench = Bench::new();
    let terrain = goto(1, 2, 3.0, MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT);
    let acks: Vec<COMMAND_ACK_DATA> = all(&bench.ask(&terrain));
    assert_eq!(acks[0].result, R::MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME);
    let acks: Vec<COMMAND_ACK_DATA> =
        all(&bench.ask(&goto(i32::MAX, i32::MAX, N, MavFrame::MAV_FRAME_GLOBAL)));
    assert_eq!(acks[0].result, R::MAV_RESULT_ACCEPTED);
    assert_eq!(
        bench.vehicle.requests(),
        [Request::Hold],
        "nothing set is a pause"
    );
}

#[test]
fn a_takeoff_altitude_means_what_the_identity_makes_clients_mean() {
    let config = Config {
        identity: Identity::Generic,
        bandwidth: 1_000_000,
        ..Config::default()
    };
    let mut bench = Bench::with(Vehicle::with(config));
    bench.result(Cmd::MAV_CMD_NAV_TAKEOFF, [N, N, N, N, N, N, 10.0]);
    let altitude = Some(Altitude::Home(10.0));
    assert_eq!(
        bench.vehicle.requests(),
        [Request::Takeoff {
            altitude,
            heading: None
        }]
    );
}

#[test]
fn what_is_not_understood_is_unsupported_at_once_whatever_its_number() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.result(Cmd::MAV_CMD_DO_WINCH, [N; 7]),
        R::MAV_RESULT_UNSUPPORTED
    );
    let frame = bench.station.frame(&long(Cmd::MAV_CMD_NAV_WAYPOINT, [0.0; 7]));
    let mut payload = frame[10..frame.len() - 2].to_vec();
    payload[28..30].copy_from_slice(&54_321u16.to_le_bytes());
    let bytes = bench.station.raw(76, &payload);
    let acks: Vec<_> = bench
        .bytes(&bytes)
        .into_iter()
        .filter(|seen| seen.id == 77)
        .collect();
    assert_eq!(acks.len(), 1);
    assert_eq!(acks[0].payload[..3], [0x31, 0xd4, 3], "the number comes back");
}

#[test]
fn only_what_is_for_us_is_acknowledged() {
    let mut bench = Bench::new();
    for (system, component, answered) in [
        (1, 1, true),
        (0, 0, true),
        (1, 0, true),
        (2, 1, false),
        (1, 100, false),
        (1, 154, false),
    ] {
        let command = COMMAND_LONG_DATA {
            target_system: system,
            target_component: component,
            ..long(Cmd::MAV_CMD_DO_WINCH, [0.0; 7])
        };
        let acks: Vec<COMMAND_ACK_DATA> = all(&bench.ask(&command));
        assert_eq!(acks.len(), usize::from(answered), "{system}/{component}");
    }
}

#[test]
fn what_takes_time_is_in_progress_until_it_is_finished() {
    let mut bench = Bench::new();
    bench.vehicle.answer = |_| None;
    let calibrate = long(
        Cmd::MAV_CMD_PREFLIGHT_CALIBRATION,
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    );
    assert!(all::<COMMAND_ACK_DATA>(&bench.ask(&calibrate)).is_empty());
    let acks: Vec<COMMAND_ACK_DATA> = all(&bench.run(90_000));
    assert_eq!(
        (acks.len(), acks[0].result),
        (1, R::MAV_RESULT_IN_PROGRESS),
        "within 100 ms"
    );
    let id = bench.vehicle.orders[0].id.unwrap();
    bench.vehicle.link.progress(id, 40, bench.now);
    let acks: Vec<COMMAND_ACK_DATA> = all(&bench.run(STEP));
    assert_eq!(
        (acks[0].result, acks[0].progress),
        (R::MAV_RESULT_IN_PROGRESS, 40)
    );
    for _ in 0..2 {
        bench.vehicle.link.finish(id, CommandResult::Accepted, bench.now);
    }
    let acks: Vec<COMMAND_ACK_DATA> = all(&bench.run(1_000_000));
    assert_eq!(
        (acks.len(), acks[0].result),
        (1, R::MAV_RESULT_ACCEPTED),
        "finished once"
    );
    bench.vehicle.link.finish(id, CommandResult::Failed, bench.now);
    assert!(all::<COMMAND_ACK_DATA>(&bench.run(1_000_000)).is_empty());
}

#[test]
fn a_repeated_command_gets_the_same_answer_and_acts_once() {
    let mut bench = Bench::new();
    let mut command = long(Cmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, [N; 7]);
    for confirmation in 0..4 {
        command.confirmation = confirmation;
        let acks: Vec<COMMAND_ACK_DATA> = all(&bench.ask(&command));
        assert_eq!((acks.len(), acks[0].result), (1, R::MAV_RESULT_ACCEPTED));
        bench.run(500_000);
    }
    assert_eq!(bench.vehicle.requests(), [Request::Return]);
    command.confirmation = 0;
    bench.ask(&command);
    assert_eq!(bench.vehicle.orders.len(), 2, "asked for anew");
    // The network repeats a frame byte for byte.
    let frame = bench.station.frame(&command);
    let acks: usize = (0..3)
        .map(|_| all::<COMMAND_ACK_DATA>(&bench.bytes(&frame)).len())
        .sum();
    assert_eq!((acks, bench.vehicle.orders.len()), (1, 3));
    assert_eq!(bench.vehicle.link.counters().repeated, 2);
}

#[test]
fn when_the_queue_is_full_a_command_is_rejected_for_now() {
    let mut bench = Bench::new();
    bench.vehicle.takes = false;
    let mut results = Vec::new();
    for first in 0..12 {
        let acks = bench.command(Cmd::MAV_CMD_MISSION_START, [first as f32, 0.0, N, N, N, N, N]);
        results.extend(acks.iter().map(|ack| ack.result));
    }
    let rejected = results
        .iter()
        .filter(|result| **result == R::MAV_RESULT_TEMPORARILY_REJECTED);
    assert_eq!(rejected.count(), 4);
    assert_eq!(bench.vehicle.link.counters().dropped.requests, 4);
    // A vehicle that answers nothing: in the end every command is told so.
    bench.vehicle.answer = |_| None;
    bench.vehicle.takes = true;
    bench.vehicle.receive(&[], bench.now);
    let acks: Vec<COMMAND_ACK_DATA> = all(&bench.run(130_000_000));
    let failed = acks.iter().filter(|ack| ack.result == R::MAV_RESULT_FAILED);
    assert_eq!(failed.count(), 8);
    assert_eq!(
        bench.result(Cmd::MAV_CMD_DO_WINCH, [N; 7]),
        R::MAV_RESULT_UNSUPPORTED
    );
}

/// A narrow channel that owes answers to a flood of other questions: within 100 ms all the same.
#[test]
fn a_flood_of_questions_does_not_hold_up_an_acknowledgement() {
    let config = Config {
        bandwidth: 2_000,
        ..Config::default()
    };
    let mut bench = Bench::with(Vehicle::with(config));
    for index in 0..200 {
        let read = PARAM_REQUEST_READ_DATA {
            param_index: index % 100,
            target_system: 1,
            target_component: 1,
            ..PARAM_REQUEST_READ_DATA::DEFAULT
        };
        let frame = bench.station.frame(&read);
        bench.vehicle.receive(&frame, bench.now);
    }
    for _ in 0..5 {
        let frame = bench.station.frame(&long(Cmd::MAV_CMD_DO_WINCH, [N; 7]));
        bench.vehicle.receive(&frame, bench.now);
    }
    let acks: Vec<COMMAND_ACK_DATA> = all(&bench.run(STEP));
    assert_eq!(acks.len(), 5);
    assert!(
        bench.vehicle.link.counters().dropped.replies > 100,
        "the flood is counted"
    );
}

/// Noise that looks like the start of a long frame of MAVLink 1.
#[test]
fn noise_before_a_command_does_not_hold_up_its_acknowledgement() {
    let noise = [0xfe, 255, 0, 1, 1, 76, 1, 2, 3];
    let mut bench = Bench::new();
    let mut bytes = noise.to_vec();
    bytes.extend(bench.station.frame(&long(Cmd::MAV_CMD_DO_WINCH, [N; 7])));
    bench.vehicle.receive(&bytes, bench.now);
    assert_eq!(
        all::<COMMAND_ACK_DATA>(&bench.run(100_000)).len(),
        1,
        "on a stream"
    );
    bench.vehicle.receive_packet(&noise, bench.now);
    let frame = bench.station.frame(&long(Cmd::MAV_CMD_DO_WINCH, [N; 7]));
    bench.vehicle.receive_packet(&frame, bench.now);
    assert_eq!(all::<COMMAND_ACK_DATA>(&bench.run(STEP)).len(), 1, "in packets");
}
