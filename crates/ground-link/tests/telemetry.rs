//! What is told about the vehicle, how often, and what is answered besides.
#![allow(deprecated)]

mod common;

use common::*;
use mavlink::MessageData;
use mavlink::dialects::common::*;
use windhover_ground_link::frame::{MAX_FRAME, Writer};
use windhover_ground_link::telemetry::{Battery, Charge, Fix, Gnss, Health, Landed, Part};
use windhover_ground_link::{Config, Link, Mode, Photo, Severity, Signing, Telemetry};
use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

const PLACE: GlobalPosition = GlobalPosition {
    latitude: 473_977_418,
    longitude: -85_455_938,
    altitude: 518_250,
};

fn flying() -> Telemetry {
    Telemetry {
        attitude: Some(Quaternion::from_heading(-1.5)),
        rate: Vector3::new(0.1, -0.2, 0.3),
        position: Some(Vector3::new(1.0, -2.0, -30.25)),
        velocity: Some(Vector3::new(3.0, 4.0, -0.5)),
        global: Some(PLACE),
        home: Some(GlobalPosition {
            altitude: 488_000,
            ..PLACE
        }),
        gnss: Some(Gnss {
            fix: Fix::RtkFixed,
            satellites: 17,
            position: PLACE,
            speed: 5.0,
            course: Some(0.5),
            dilution: [Some(0.75), None],
            accuracy: [0.02, 0.03],
            speed_accuracy: 0.05,
        }),
        battery: Battery {
            voltage: Some(15.2),
            current: Some(12.5),
            consumed: Some(3600.0),
            remaining: Some(0.63),
            charge: Charge::Low,
        },
        mode: Mode::Mission,
        armed: true,
        landed: Landed::InAir,
        health: Health {
            gyro: Part::Good,
            accelerometer: Part::Good,
            compass: Part::Bad,
            can_arm: true,
            ..Health::default()
        },
        throttle: 0.42,
        motors: [0, 65_535, 32_768, 1],
        ..Telemetry::default()
    }
}

fn one<M: MessageData + Clone>(bench: &mut Bench) -> M {
    let request = long(
        MavCmd::MAV_CMD_REQUEST_MESSAGE,
        [M::ID as f32, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    );
    let seen = bench.ask(&request);
    assert_eq!(
        all::<COMMAND_ACK_DATA>(&seen)[0].result,
        MavResult::MAV_RESULT_ACCEPTED,
        "{}",
        M::NAME
    );
    all::<M>(&seen).last().expect("it was asked for").clone()
}

#[test]
fn a_heartbeat_every_second_says_what_px4_would_say() {
    let mut bench = Bench::new();
    let beats: Vec<HEARTBEAT_DATA> = all(&bench.run(10_000_000));
    assert_eq!(beats.len(), 10);
    let beat = &beats[0];
    assert_eq!(
        (beat.mavtype, beat.autopilot),
        (MavType::MAV_TYPE_QUADROTOR, MavAutopilot::MAV_AUTOPILOT_PX4)
    );
    assert!(
        beat.base_mode
            .contains(MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
    );
    assert!(!beat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED));
    assert_eq!(
        (beat.system_status, beat.mavlink_version),
        (MavState::MAV_STATE_STANDBY, 3)
    );
    bench.vehicle.telemetry = flying();
    let beats: Vec<HEARTBEAT_DATA> = all(&bench.run(STEP));
    assert_eq!(beats.len(), 1, "a change is told at once");
    assert!(
        beats[0]
            .base_mode
            .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED)
    );
    assert_eq!(beats[0].custom_mode, 4 << 16 | 4 << 24);
}

#[test]
fn numbers_are_in_the_units_of_their_messages() {
    let mut bench = Bench::new();
    bench.vehicle.telemetry = flying();
    let global: GLOBAL_POSITION_INT_DATA = one(&mut bench);
    assert_eq!(
        (global.lat, global.lon, global.alt),
        (473_977_418, -85_455_938, 518_250)
    );
    assert_eq!(
        (global.relative_alt, global.vx, global.vy, global.vz),
        (30_250, 300, 400, -50)
    );
    assert_eq!(global.hdg, 27_406, "-1.5 rad");
    let local: LOCAL_POSITION_NED_DATA = one(&mut bench);
    assert_eq!((local.x, local.y, local.z, local.vz), (1.0, -2.0, -30.25, -0.5));
    let attitude: ATTITUDE_DATA = one(&mut bench);
    assert!((attitude.yaw + 1.5).abs() < 1e-5 && attitude.yawspeed == 0.3);
    let quaternion: ATTITUDE_QUATERNION_DATA = one(&mut bench);
    assert!((quaternion.q1 - 0.75_f32.cos_for_tests()).abs() < 1e-5);
    let gps: GPS_RAW_INT_DATA = one(&mut bench);
    assert_eq!(
        (gps.fix_type, gps.satellites_visible),
        (GpsFixType::GPS_FIX_TYPE_RTK_FIXED, 17)
    );
    assert_eq!(
        (gps.eph, gps.epv, gps.vel, gps.h_acc, gps.vel_acc),
        (75, u16::MAX, 500, 20, 50)
    );
    let battery: BATTERY_STATUS_DATA = one(&mut bench);
    assert_eq!((battery.voltages[0], battery.voltages[1]), (15_200, u16::MAX));
    assert_eq!(
        (
            battery.current_battery,
            battery.battery_remaining,
            battery.current_consumed
        ),
        (1250, 63, 1000)
    );
    let hud: VFR_HUD_DATA = one(&mut bench);
    assert_eq!(
        (hud.groundspeed, hud.alt, hud.climb, hud.heading, hud.throttle),
        (5.0, 518.25, 0.5, 274, 42)
    );
    let servo: SERVO_OUTPUT_RAW_DATA = one(&mut bench);
    assert_eq!(
        (servo.servo1_raw, servo.servo2_raw, servo.servo3_raw),
        (1000, 2000, 1500)
    );
    let state: EXTENDED_SYS_STATE_DATA = one(&mut bench);
    assert_eq!(state.landed_state, MavLandedState::MAV_LANDED_STATE_IN_AIR);
    let home: HOME_POSITION_DATA = one(&mut bench);
    assert_eq!((home.latitude, home.altitude), (473_977_418, 488_000));
}

trait Cosine {
    fn cos_for_tests(self) -> f32;
}

impl Cosine for f32 {
    fn cos_for_tests(self) -> f32 {
        windhover_math::cos(self)
    }
}

#[test]
fn health_is_told_by_bits() {
    let mut bench = Bench::new();
    bench.vehicle.telemetry = flying();
    let status: SYS_STATUS_DATA = one(&mut bench);
    type Bit = MavSysStatusSensor;
    let (gyro, compass) = (
        Bit::MAV_SYS_STATUS_SENSOR_3D_GYRO,
        Bit::MAV_SYS_STATUS_SENSOR_3D_MAG,
    );
    let present = status.onboard_control_sensors_present;
    assert!(present.contains(gyro | compass) && !present.contains(Bit::MAV_SYS_STATUS_SENSOR_GPS));
    let health = status.onboard_control_sensors_health;
    assert!(health.contains(gyro | Bit::MAV_SYS_STATUS_PREARM_CHECK) && !health.contains(compass));
    assert_eq!((status.voltage_battery, status.battery_remaining), (15_200, 63));
}

#[test]
fn what_is_not_known_is_said_to_be_unknown_or_not_sent() {
    let mut bench = Bench::new();
    let seen = bench.run(5_000_000);
    assert!(all::<ATTITUDE_DATA>(&seen).is_empty() && all::<GLOBAL_POSITION_INT_DATA>(&seen).is_empty());
    let status = &all::<SYS_STATUS_DATA>(&seen)[0];
    assert_eq!(
        (
            status.voltage_battery,
            status.current_battery,
            status.battery_remaining
        ),
        (u16::MAX, -1, -1)
    );
    assert_eq!(
        all::<GPS_RAW_INT_DATA>(&seen)[0].fix_type,
        GpsFixType::GPS_FIX_TYPE_NO_GPS
    );
    let home = [242.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let result = bench.result(MavCmd::MAV_CMD_REQUEST_MESSAGE, home);
    assert_eq!(result, MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
}

#[test]
fn the_version_has_the_capabilities_that_clients_look_for() {
    let mut bench = Bench::with(Vehicle::with(Config {
        bandwidth: 1_000_000,
        uid: 77,
        version: *b"0.1.0-rc",
        ..Config::default()
    }));
    let version: AUTOPILOT_VERSION_DATA = one(&mut bench);
    type Bit = MavProtocolCapability;
    let needed = Bit::MAV_PROTOCOL_CAPABILITY_MISSION_INT
        | Bit::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | Bit::MAV_PROTOCOL_CAPABILITY_MAVLINK2
        | Bit::MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
        | Bit::MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
        | Bit::MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
        | Bit::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
        | Bit::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
        | Bit::MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION;
    let encoding = Bit::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE;
    assert_eq!(
        version.capabilities,
        needed | encoding,
        "nothing that is not kept"
    );
    assert_eq!(version.flight_sw_version, 0x0104_0100);
    assert_eq!((version.uid, &version.flight_custom_version), (77, b"0.1.0-rc"));
    let protocol: PROTOCOL_VERSION_DATA = one(&mut bench);
    assert_eq!((protocol.version, protocol.max_version), (200, 200));
    // Ours is not the one that clients are shown.
    let request = [148.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let seen = bench.ask(&long(MavCmd::MAV_CMD_REQUEST_MESSAGE, request));
    assert_eq!(texts(&seen), ["Windhover 0.1.0-rc"]);
}

#[test]
fn rates_are_set_told_and_taken_back() {
    let mut bench = Bench::new();
    bench.vehicle.telemetry = flying();
    let rate = |bench: &mut Bench| all::<ATTITUDE_DATA>(&bench.run(2_000_000)).len();
    let set = |bench: &mut Bench, interval: f32| {
        bench.result(
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
            [30.0, interval, 0.0, 0.0, 0.0, 0.0, 0.0],
        )
    };
    assert_eq!(rate(&mut bench), 20);
    assert_eq!(set(&mut bench, 20_000.0), MavResult::MAV_RESULT_ACCEPTED);
    assert!((98..=101).contains(&rate(&mut bench)));
    let asked = long(
        MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL,
        [30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    );
    assert_eq!(
        all::<MESSAGE_INTERVAL_DATA>(&bench.ask(&asked))[0].interval_us,
        20_000
    );
    set(&mut bench, -1.0);
    assert_eq!(rate(&mut bench), 0);
    assert_eq!(
        all::<MESSAGE_INTERVAL_DATA>(&bench.ask(&asked))[0].interval_us,
        -1
    );
    set(&mut bench, 0.0);
    assert!((19..=21).contains(&rate(&mut bench)));
    for (group, start, expected) in [(10, 0, 0..=0), (10, 1, 49..=51), (0, 0, 0..=0), (0, 1, 49..=51)] {
        bench.ask(&REQUEST_DATA_STREAM_DATA {
            req_message_rate: 25,
            target_system: 1,
            target_component: 1,
            start_stop: start,
            ..REQUEST_DATA_STREAM_DATA::DEFAULT
        });
        let frame = bench.station.raw(66, &[25, 0, 1, 1, group, start]);
        bench.bytes(&frame);
        assert!(expected.contains(&rate(&mut bench)), "group {group} {start}");
    }
    // Without a heartbeat every client would believe the vehicle lost.
    for interval in [-1.0, 5e6] {
        let beat = [0.0, interval, 0.0, 0.0, 0.0, 0.0, 0.0];
        let result = bench.result(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, beat);
        assert_eq!(result, MavResult::MAV_RESULT_DENIED);
    }
    assert_eq!(all::<HEARTBEAT_DATA>(&bench.run(3_000_000)).len(), 3);
    let none = [9_999.0, 1e5, 0.0, 0.0, 0.0, 0.0, 0.0];
    let result = bench.result(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, none);
    assert_eq!(result, MavResult::MAV_RESULT_UNSUPPORTED);
    for unknown in [435.0, 395.0, 397.0, 1e9, NAN, -5.0] {
        let result = bench.result(
            MavCmd::MAV_CMD_REQUEST_MESSAGE,
            [unknown, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        );
        // No number at all is number 0, the heartbeat.
        let expected = if unknown > 0.0 {
            MavResult::MAV_RESULT_UNSUPPORTED
        } else {
            MavResult::MAV_RESULT_ACCEPTED
        };
        assert_eq!(result, expected, "{unknown}");
    }
}

#[test]
fn pings_times_and_files_are_answered_at_once() {
    let mut bench = Bench::new();
    let ping = PING_DATA {
        time_usec: 77,
        seq: 3,
        target_system: 0,
        target_component: 0,
    };
    let pongs: Vec<PING_DATA> = all(&bench.ask(&ping));
    assert_eq!(
        (pongs.len(), pongs[0].time_usec, pongs[0].target_system),
        (1, 77, 255)
    );
    assert!(
        all::<PING_DATA>(&bench.ask(&pongs[0])).is_empty(),
        "an answer is not answered"
    );
    let now = bench.now as i64;
    let times: Vec<TIMESYNC_DATA> = all(&bench.ask(&TIMESYNC_DATA {
        ts1: 123,
        ..TIMESYNC_DATA::DEFAULT
    }));
    assert_eq!((times.len(), times[0].ts1, times[0].tc1), (1, 123, now * 1000));
    assert!(all::<TIMESYNC_DATA>(&bench.ask(&times[0])).is_empty());
    let mut open = FILE_TRANSFER_PROTOCOL_DATA {
        target_system: 1,
        target_component: 1,
        ..FILE_TRANSFER_PROTOCOL_DATA::DEFAULT
    };
    open.payload[..4].copy_from_slice(&[7, 1, 5, 4]);
    let answers: Vec<FILE_TRANSFER_PROTOCOL_DATA> = all(&bench.ask(&open));
    assert_eq!(answers.len(), 1);
    assert_eq!(answers[0].payload[..6], [8, 1, 5, 129, 1, 4]);
    assert_eq!(answers[0].payload[12], 7);
}

#[test]
fn text_and_photos_are_told() {
    let mut bench = Bench::new();
    bench.vehicle.telemetry = flying();
    bench
        .vehicle
        .link
        .say(Severity::Critical, format_args!("battery {} V", 10));
    let photo = Photo {
        index: 4,
        time: 900_000,
        position: PLACE,
        attitude: Quaternion::IDENTITY,
    };
    bench.vehicle.link.photo_taken(photo);
    bench.vehicle.telemetry.utc = Some(1_700_000_000_000_000);
    let now = bench.now;
    let seen = bench.run(STEP);
    assert_eq!(
        all::<SYSTEM_TIME_DATA>(&bench.run(2_000_000))[0].time_unix_usec,
        1_700_000_000_000_000
    );
    let lines: Vec<STATUSTEXT_DATA> = all(&seen);
    assert_eq!(
        (lines[0].severity, lines[0].text.to_str()),
        (MavSeverity::MAV_SEVERITY_CRITICAL, Ok("battery 10 V"))
    );
    let photos: Vec<CAMERA_IMAGE_CAPTURED_DATA> = all(&seen);
    assert_eq!(
        (photos.len(), photos[0].image_index, photos[0].relative_alt),
        (1, 4, 30_250)
    );
    assert_eq!(
        (photos[0].lat, photos[0].q[0], photos[0].time_boot_ms),
        (473_977_418, 1.0, 900)
    );
    let taken = 1_700_000_000_000_000 - (now - photo.time);
    assert_eq!((photos[0].time_utc, photos[0].camera_id), (taken, 1));
    assert_eq!(photos[0].capture_result, MavBool::MAV_BOOL_TRUE);
    // More than there is room for are counted.
    for index in 0..10 {
        bench.vehicle.link.photo_taken(Photo { index, ..photo });
    }
    let photos: Vec<CAMERA_IMAGE_CAPTURED_DATA> = all(&bench.run(STEP));
    let told: Vec<i32> = photos.iter().map(|photo| photo.image_index).collect();
    assert_eq!(told, [2, 3, 4, 5, 6, 7, 8, 9]);
    assert_eq!(bench.vehicle.link.counters().dropped.photos, 2);
}

#[test]
fn the_heartbeat_of_a_ground_station_is_noticed() {
    let mut bench = Bench::new();
    let mut beat = HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        ..HEARTBEAT_DATA::DEFAULT
    };
    bench.ask(&beat);
    assert_eq!(bench.vehicle.link.station_heard(), None);
    beat.mavtype = MavType::MAV_TYPE_GCS;
    let now = bench.now;
    bench.ask(&beat);
    assert_eq!(bench.vehicle.link.station_heard(), Some(now));
}

#[test]
fn with_a_key_the_link_signs_and_hears_only_those_who_have_it() {
    let mut bench = Bench::new();
    bench
        .vehicle
        .signing
        .set_key([9; 32], 36_000_000_000_000, bench.now);
    let command = long(
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    );
    assert!(all::<COMMAND_ACK_DATA>(&bench.ask(&command)).is_empty());
    assert!(bench.vehicle.orders.is_empty());
    assert_eq!(bench.vehicle.signing.refusals().unsigned, 1);
    let frames: Vec<_> = (0..200)
        .flat_map(|step| bench.vehicle.poll(bench.now + step * STEP))
        .collect();
    assert!(frames.iter().all(|frame| frame[2] == 1));
    bench.vehicle.signing.clear_key();
    assert_eq!(all::<COMMAND_ACK_DATA>(&bench.ask(&command)).len(), 1);
}

/// What was recorded on one channel must not act on another.
#[test]
fn a_signed_command_acts_once_on_all_channels_together() {
    let key = |signing: &mut Signing| signing.set_key([9; 32], 36_000_000_000_000, 0);
    let (mut theirs, mut bench) = (Signing::default(), Bench::new());
    key(&mut theirs);
    key(&mut bench.vehicle.signing);
    let mut payload = [0; 33];
    long(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [1.0; 7]).ser(mavlink::MavlinkVersion::V2, &mut payload);
    let mut frame = [0; MAX_FRAME];
    let mut writer = Writer::new(bench.station.address);
    let mut sign = |covered: &[u8]| theirs.sign(covered, 3, 0);
    let length = writer.write(&mut frame, COMMAND_LONG_DATA::ID, &payload, Some(&mut sign));
    let frame = &frame[..length.unwrap()];
    assert_eq!(all::<COMMAND_ACK_DATA>(&bench.bytes(frame)).len(), 1);
    bench.vehicle.link = Link::new(Config::default()); // another one, beside the first
    assert!(all::<COMMAND_ACK_DATA>(&bench.bytes(frame)).is_empty());
    assert_eq!(bench.vehicle.signing.refusals().replayed, 1);
}

#[test]
fn the_memory_of_a_link_is_bounded() {
    println!("a link takes {} bytes", size_of::<Link>());
    assert!(size_of::<Link>() < 6_000);
}

/// A simulation that runs ten times as fast tells ten times as often, and in its own time.
#[test]
fn streams_follow_the_vehicles_clock() {
    let mut vehicle = Vehicle::new();
    vehicle.telemetry = flying();
    let mut station = Station::new(255);
    let (mut heartbeats, mut last) = (0, 0);
    for now in (1..=2_000_000).step_by(4000) {
        vehicle.telemetry.time = Some(now * 10);
        let seen = station.read(&vehicle.poll(now));
        heartbeats += all::<HEARTBEAT_DATA>(&seen).len();
        if let Some(attitude) = all::<ATTITUDE_DATA>(&seen).last() {
            last = attitude.time_boot_ms;
        }
    }
    assert!((19..=21).contains(&heartbeats), "{heartbeats}");
    assert!((19_000..=20_000).contains(&last), "{last}");
}
