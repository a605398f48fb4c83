//! A ground station at the whole vehicle, in simulated time: what it asks for happens, and what it is
//! told is so.

use mavlink::dialects::common::*;
use windhover_autopilot::Phase;
use windhover_flight_log::reader::Log;
use windhover_sim::flight::Setup;
use windhover_sim::replay;
use windhover_sim::sensors::Receiver;
use windhover_tests::station::{Seen, Station};
use windhover_tests::{calm, monitoring, on_sensors};

const NONE: [f32; 7] = [0.0; 7];
const MISSION: MavMissionType = MavMissionType::MAV_MISSION_TYPE_MISSION;
const ACCEPTED: MavMissionResult = MavMissionResult::MAV_MISSION_ACCEPTED;

fn with(values: &[(usize, f32)]) -> [f32; 7] {
    let mut params = NONE;
    for (number, value) in values {
        params[number - 1] = *value;
    }
    params
}

fn arm() -> [f32; 7] {
    with(&[(1, 1.0)])
}

/// A vehicle that is told the truth, ready to arm.
fn ready() -> Station {
    Station::new(&calm()).ready()
}

/// The same, hovering at 10 m.
fn hovering() -> Station {
    let mut station = ready();
    station.order(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm());
    // PX4's identity: the altitude is above the sea.
    station.order(
        MavCmd::MAV_CMD_NAV_TAKEOFF,
        with(&[(5, f32::NAN), (6, f32::NAN), (7, 498.0)]),
    );
    station.until(30.0, "it hovers", |station| station.heartbeat == (true, 4, 3));
    station.run(3.0);
    station
}

fn height(station: &Station) -> f64 {
    -station.served.flown().world.truth().position.z
}

fn replays(station: Station) {
    let mut bytes = station.log;
    bytes.extend(station.served.into_log().finish(&[], &[]));
    let log = Log::open(&bytes).expect("a log");
    let replayed = replay::replay(&log).expect("a log that can be replayed");
    assert_eq!(replayed.difference, None);
    assert_eq!((replayed.missing_from, replayed.cut), (None, None));
    assert!(replayed.ticks > 1000);
}

/// The whole of it, on sensors in the reference wind: upload, arm, fly, ten photos, return; and the
/// log, with the plan as it was uploaded, gives the same flight again.
#[test]
fn an_uploaded_mission_is_flown_and_replays() {
    let mut setup = on_sensors(Receiver::Standard);
    setup.conditions.pushes.clear();
    let mut station = Station::new(&setup).ready();
    let items = monitoring().stored().mission;
    assert_eq!(station.upload(MISSION, &items), ACCEPTED);
    assert_eq!(station.set_mode(4.0, 4.0), MavResult::MAV_RESULT_ACCEPTED);
    station.order(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm());
    let mut photos = Vec::new();
    for index in 0..10 {
        let (_, photo) = station.wait::<CAMERA_IMAGE_CAPTURED_DATA>(120.0, |_| true);
        assert_eq!(photo.image_index, index);
        photos.push((photo.lat, photo.lon));
    }
    photos.dedup();
    assert_eq!(photos.len(), 10, "each is taken somewhere else");
    station.until(60.0, "the mission ends in hold", |station| {
        station.heartbeat == (true, 4, 3)
    });
    station.order(MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, NONE);
    station.until(200.0, "it has landed and disarmed", |station| {
        !station.heartbeat.0
    });
    for text in [
        "Armed",
        "Airborne",
        "Mission finished",
        "Mode: return",
        "Landed",
        "Disarmed",
    ] {
        assert!(
            station.texts.iter().any(|told| told == text),
            "{text}: {:#?}",
            station.texts
        );
    }
    replays(station);
}

/// At 20 % loss both ways the plan that is kept is the plan that was sent.
#[test]
fn a_plan_comes_through_a_network_that_loses() {
    for seed in 1..=4 {
        let mut station = ready().losing(0.2, seed);
        let mut items = monitoring().stored().mission;
        let last = items.pop().expect("an item");
        while items.len() < 249 {
            let next = items[items.len() - 20];
            items.push(next);
        }
        items.push(last);
        assert_eq!(station.upload(MISSION, &items), ACCEPTED, "{:#?}", station.texts);
        let commit = station.served.vehicle().committed()[0];
        assert_eq!(commit.count, 250);
        let kind = windhover_ground_link::PlanKind::Mission;
        let stored = station.served.flown().plans.items(kind, commit.slot);
        assert_eq!(format!("{stored:?}"), format!("{items:?}"), "NaN and all");
    }
}

/// Right after one another: a plan needs some time from the link to the core, of which clients know
/// nothing. And a station that is gone in the middle of an upload leaves nothing behind that refuses
/// the others.
#[test]
fn plans_follow_closely() {
    let mut station = ready();
    let items = monitoring().items;
    for _ in 0..3 {
        assert_eq!(station.upload(MISSION, &items), ACCEPTED, "{:#?}", station.texts);
        assert_eq!(station.upload(MISSION, &[]), ACCEPTED, "{:#?}", station.texts);
    }
    station.send(&MISSION_COUNT_DATA {
        count: 3,
        target_system: 1,
        target_component: 1,
        ..MISSION_COUNT_DATA::default()
    });
    station.wait::<MISSION_REQUEST_INT_DATA>(1.0, |_| true);
    station.served.close(0);
    assert_eq!(station.upload(MISSION, &items), ACCEPTED, "{:#?}", station.texts);
    station.run(1.0);
    let [mission, ..] = station.served.vehicle().committed();
    assert_eq!(usize::from(mission.count), items.len());
}

/// A client that has lost the answer asks again: nothing is done twice, and it is told that it is done.
#[test]
fn what_is_asked_for_again_is_done_once() {
    let mut station = ready();
    station.order(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm());
    let takeoff = with(&[(5, f32::NAN), (6, f32::NAN), (7, 498.0)]);
    station.order(MavCmd::MAV_CMD_NAV_TAKEOFF, takeoff);
    station.until(10.0, "it is off the ground", |station| height(station) > 2.0);
    station.order(MavCmd::MAV_CMD_NAV_TAKEOFF, takeoff);
    for (number, photos) in [(7.0, 1), (7.0, 0), (8.0, 1)] {
        let capture = with(&[(3, 1.0), (4, number)]);
        station.order(MavCmd::MAV_CMD_IMAGE_START_CAPTURE, capture);
        station.run(0.5);
        let taken = |seen: &Seen| seen.read::<CAMERA_IMAGE_CAPTURED_DATA>().is_some();
        assert_eq!(station.seen.iter().filter(|seen| taken(seen)).count(), photos);
        station.seen.clear();
    }
}

/// Every command is answered once, within 100 ms of its bytes, by the vehicle in the air.
#[test]
fn commands_are_answered_in_time() {
    let mut station = hovering();
    let mut largest = 0;
    for (command, params, wanted) in [
        (
            MavCmd::MAV_CMD_DO_PAUSE_CONTINUE,
            NONE,
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
            arm(),
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
            NONE,
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        ),
        (
            MavCmd::MAV_CMD_MISSION_START,
            NONE,
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        ),
        (
            MavCmd::MAV_CMD_IMAGE_START_CAPTURE,
            with(&[(3, 1.0)]),
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (
            MavCmd::MAV_CMD_DO_SET_HOME,
            with(&[(1, 1.0)]),
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (
            MavCmd::MAV_CMD_DO_MOTOR_TEST,
            with(&[(1, 1.0), (3, 10.0), (4, 1.0)]),
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        ),
        (
            MavCmd::MAV_CMD_NAV_TAKEOFF,
            with(&[(7, 500.0)]),
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        ),
        (
            MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN,
            arm(),
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        ),
        (
            MavCmd::MAV_CMD_RUN_PREARM_CHECKS,
            NONE,
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (
            MavCmd::MAV_CMD_DO_REPOSITION,
            with(&[
                (1, -1.0),
                (2, 1.0),
                (4, f32::NAN),
                (5, f32::NAN),
                (6, f32::NAN),
                (7, f32::NAN),
            ]),
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (
            MavCmd::MAV_CMD_NAV_LAND,
            with(&[(5, f32::NAN), (6, f32::NAN)]),
            MavResult::MAV_RESULT_ACCEPTED,
        ),
    ] {
        let (result, took) = station.command(command, params);
        assert_eq!(result, wanted, "{command:?}: {:#?}", station.texts);
        assert!(took <= 100_000, "{command:?}: {took} µs");
        largest = largest.max(took);
        station.run(0.5);
        let again = station
            .seen
            .iter()
            .find_map(|seen| seen.read::<COMMAND_ACK_DATA>());
        assert!(again.is_none(), "answered twice: {again:?}");
    }
    println!("answered within {} ms at most", largest / 1000);
    station.until(60.0, "it has landed", |station| !station.heartbeat.0);
    replays(station);
}

/// What speaks against arming is told, one line each, and force-arm does not ask.
#[test]
fn blockers_are_named() {
    let mut setup = on_sensors(Receiver::Standard);
    setup.vehicle.parameters.insert("COM_RC_IN_MODE".into(), 0.0);
    let mut station = Station::new(&setup);
    station.run(0.1);
    let (result, _) = station.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm());
    assert_eq!(result, MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    station.run(1.0);
    for reason in ["attitude unknown", "position unknown"] {
        let named = |text: &String| text.starts_with("Arming refused: ") && text.contains(reason);
        assert!(station.texts.iter().any(named), "{reason}: {:#?}", station.texts);
    }
    station.order(
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        with(&[(1, 1.0), (2, 21196.0)]),
    );
    station.until(2.0, "armed by force", |station| station.heartbeat.0);
}

/// A mission that is being flown is not exchanged; on hold it is, and what was stored before stays
/// until the new one is whole.
#[test]
fn a_mission_that_flies_stays() {
    let mut station = ready();
    let items = monitoring().stored().mission;
    assert_eq!(station.upload(MISSION, &items), ACCEPTED);
    let before = station.served.vehicle().committed()[0];
    assert_eq!(station.set_mode(4.0, 4.0), MavResult::MAV_RESULT_ACCEPTED);
    station.order(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm());
    station.run(10.0);
    assert_eq!(
        station.upload(MISSION, &items[..4]),
        MavMissionResult::MAV_MISSION_DENIED
    );
    assert_eq!(station.served.vehicle().committed()[0], before);
    station.order(MavCmd::MAV_CMD_DO_PAUSE_CONTINUE, NONE);
    station.run(3.0);
    // A client that goes away in the middle.
    station.send(&MISSION_COUNT_DATA {
        count: 5,
        target_system: 1,
        target_component: 1,
        mission_type: MISSION,
        opaque_id: 0,
    });
    let (_, given_up) = station.wait::<MISSION_ACK_DATA>(10.0, |_| true);
    assert_eq!(
        given_up.mavtype,
        MavMissionResult::MAV_MISSION_OPERATION_CANCELLED
    );
    assert_eq!(station.served.vehicle().committed()[0], before);
    assert_eq!(station.upload(MISSION, &items[..6]), ACCEPTED);
    let after = station.served.vehicle().committed()[0];
    assert_eq!((after.count, after.slot), (6, 1 - before.slot));
    station.order(MavCmd::MAV_CMD_MISSION_START, NONE);
    station.until(60.0, "the new one is flown to its end", |station| {
        station.texts.iter().any(|text| text == "Mission finished")
    });
    replays(station);
}

/// Writes act in the core; what it refuses is told, and the table is as the core's.
#[test]
fn parameters_are_the_cores() {
    let mut station = ready();
    let set = |station: &mut Station, name: &str, value: f32| {
        station.send(&PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        });
        let named = |message: &PARAM_VALUE_DATA| message.param_id.to_str() == Ok(name);
        station.wait::<PARAM_VALUE_DATA>(1.0, named).1.param_value
    };
    assert_eq!(set(&mut station, "MPC_XY_CRUISE", 3.0), 3.0);
    let table = *station.served.flown().outer().parameters();
    assert_eq!(&table, station.served.vehicle().parameters());
    assert!(
        (set(&mut station, "MPC_XY_CRUISE", 1e6) - 3.0).abs() < 1e-6,
        "out of range"
    );
    // In range, and yet no vehicle: all rotors in one place.
    let names = ["CA_ROTOR0_PX", "CA_ROTOR1_PX", "CA_ROTOR2_PX", "CA_ROTOR3_PX"];
    let before: Vec<f32> = names
        .iter()
        .filter_map(|name| windhover_autopilot::Parameters::find(name))
        .filter_map(|index| table.get(index))
        .collect();
    for name in names {
        if windhover_autopilot::Parameters::find(name).is_some() {
            set(&mut station, name, 0.0);
        }
    }
    let table = station.served.flown().outer().parameters();
    assert_eq!(table, station.served.vehicle().parameters(), "{before:?}");
    station.order(MavCmd::MAV_CMD_PREFLIGHT_STORAGE, with(&[(1, 2.0)]));
    station.run(5.0);
    let defaults = windhover_autopilot::Parameters::default();
    assert_eq!(station.served.flown().outer().parameters(), &defaults);
}

/// One motor turns, of a vehicle that stands, and only for its time.
#[test]
fn a_motor_is_tested() {
    let mut station = ready();
    station.order(
        MavCmd::MAV_CMD_DO_MOTOR_TEST,
        with(&[(1, 3.0), (3, 20.0), (4, 1.0)]),
    );
    station.run(0.5);
    assert_eq!(station.served.vehicle().telemetry().motors, [0, 0, 13107, 0]);
    let speeds = station.served.flown().world.truth().rotor_speed;
    assert!(speeds[2] > 10.0 && speeds[0].abs() < 1.0, "{speeds:?}");
    station.run(0.7);
    assert_eq!(station.served.vehicle().telemetry().motors, [0; 4]);
    assert!(!station.heartbeat.0, "it is not armed by that");
}

/// A vehicle at rest calibrates its gyro by what it shows.
#[test]
fn the_gyro_is_calibrated() {
    let setup: Setup = on_sensors(Receiver::Standard);
    let mut station = Station::new(&setup).ready();
    let params = with(&[(1, 1.0)]);
    let (result, _) = station.command(MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION, params);
    assert_eq!(result, MavResult::MAV_RESULT_IN_PROGRESS);
    let done = |ack: &COMMAND_ACK_DATA| ack.result != MavResult::MAV_RESULT_IN_PROGRESS;
    let (_, ack) = station.wait::<COMMAND_ACK_DATA>(30.0, done);
    assert_eq!(ack.result, MavResult::MAV_RESULT_ACCEPTED, "{:#?}", station.texts);
    station.run(0.5);
    for line in [
        "[cal] calibration started: 2 gyro",
        "[cal] calibration done: gyro",
    ] {
        assert!(
            station.texts.iter().any(|text| text == line),
            "{:#?}",
            station.texts
        );
    }
    let calibration = station.served.flown().outer().parameters().calibration;
    let offset = [calibration.gyro_x, calibration.gyro_y, calibration.gyro_z];
    assert!(offset.iter().any(|axis| *axis != 0.0) && offset.iter().all(|axis| axis.abs() < 0.02));
}

/// Setpoints from outside are followed in offboard, and not without them.
#[test]
fn offboard_follows() {
    let mut station = hovering();
    assert_eq!(
        station.set_mode(6.0, 0.0),
        MavResult::MAV_RESULT_TEMPORARILY_REJECTED
    );
    let target = SET_POSITION_TARGET_LOCAL_NED_DATA {
        time_boot_ms: 0,
        x: 5.0,
        y: -4.0,
        z: -12.0,
        vx: 0.0,
        vy: 0.0,
        vz: 0.0,
        afx: 0.0,
        afy: 0.0,
        afz: 0.0,
        yaw: 0.0,
        yaw_rate: 0.0,
        type_mask: PositionTargetTypemask::from_bits_truncate(0b1101_1111_1000),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
    };
    for _ in 0..200 {
        station.send(&target);
        station.run(0.1);
        if station.heartbeat.1 != 6 {
            assert_eq!(station.set_mode(6.0, 0.0), MavResult::MAV_RESULT_ACCEPTED);
        }
    }
    let position = station.served.flown().world.truth().position;
    assert!(
        (position.x - 5.0).abs() < 0.2 && (position.y + 4.0).abs() < 0.2,
        "{position}"
    );
    assert!((position.z + 12.0).abs() < 0.2, "{position}");
    station.run(3.0);
    assert_ne!(station.heartbeat.1, 6, "without setpoints it does not stay");
}

/// A kill stops the motors at once, wherever the vehicle is.
#[test]
fn a_kill_stops_the_motors() {
    let mut station = hovering();
    let high = height(&station);
    assert!(high > 9.0, "{high}");
    let (result, _) = station.command(MavCmd::MAV_CMD_DO_FLIGHTTERMINATION, with(&[(1, 1.0)]));
    assert_eq!(result, MavResult::MAV_RESULT_ACCEPTED);
    station.run(0.5);
    assert_eq!(station.served.vehicle().telemetry().motors, [0; 4]);
    assert!(height(&station) < high);
    assert_eq!(
        station.served.flown().outer().supervisor().phase(),
        Phase::Disarmed
    );
}

/// `DO_CHANGE_SPEED` while it hovers is the speed that it goes somewhere with.
#[test]
fn a_speed_that_is_asked_for_is_flown_with() {
    let mut station = hovering();
    station.order(MavCmd::MAV_CMD_DO_CHANGE_SPEED, with(&[(1, 1.0), (2, 5.0)]));
    let there = (47.398_28, 8.545_594);
    station.order(
        MavCmd::MAV_CMD_DO_REPOSITION,
        with(&[(1, -1.0), (4, f32::NAN), (5, there.0), (6, there.1), (7, 498.0)]),
    );
    station.wait::<LOCAL_POSITION_NED_DATA>(20.0, |at| at.vx > 4.5);
    let mut grounded = ready();
    let (result, _) = grounded.command(MavCmd::MAV_CMD_DO_CHANGE_SPEED, with(&[(1, 1.0), (2, 5.0)]));
    assert_eq!(result, MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
}

/// A series of photos is one in the vehicle's time, however fast that runs.
#[test]
fn photos_are_as_far_apart_as_they_are_asked_for_in_a_simulation_that_runs_faster() {
    let mut station = Station::new(&calm()).hurried(10).ready();
    station.order(MavCmd::MAV_CMD_IMAGE_START_CAPTURE, with(&[(2, 2.0), (3, 3.0)]));
    let mut photo = || {
        let wait = station.wait::<CAMERA_IMAGE_CAPTURED_DATA>(20.0, |_| true);
        wait.1.time_boot_ms
    };
    let times: [u32; 3] = core::array::from_fn(|_| photo());
    assert!((1990..=2010).contains(&(times[1] - times[0])), "{times:?}");
    assert!((1990..=2010).contains(&(times[2] - times[1])), "{times:?}");
}
