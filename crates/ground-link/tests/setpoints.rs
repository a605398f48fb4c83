//! Offboard setpoints, sticks and channels: typed, and only the newest of each.
#![allow(deprecated)]

mod common;

use common::*;
use mavlink::dialects::common::*;
use windhover_autopilot::mission::action::Altitude;
use windhover_ground_link::setpoints::{Channel, LocalFrame, Motion, Setpoint, Sticks};
use windhover_ground_link::{Ground, Request};
use windhover_math::Quaternion;

#[test]
fn setpoints_and_sticks_come_out_typed_and_only_the_newest() {
    let mut bench = Bench::new();
    bench.vehicle.takes = false;
    let mut target = SET_POSITION_TARGET_LOCAL_NED_DATA {
        x: 1.0,
        y: NAN,
        vz: -2.0,
        yaw: 0.5,
        type_mask: PositionTargetTypemask::from_bits_retain(0b1001_1111_1000),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
    };
    for x in [1.0, 2.0, 3.0] {
        target.x = x;
        bench.ask(&target);
    }
    let frame = bench.station.frame(&MANUAL_CONTROL_DATA {
        x: 500,
        y: i16::MAX,
        z: 250,
        r: -2000,
        target: 1,
        ..MANUAL_CONTROL_DATA::DEFAULT
    });
    bench.vehicle.takes = true;
    bench.bytes(&frame);
    let requests = bench.vehicle.requests();
    assert_eq!(requests.len(), 2);
    let Request::Offboard(Setpoint::Local {
        frame,
        position,
        motion,
    }) = requests[0]
    else {
        panic!("{requests:?}")
    };
    assert_eq!((frame, position), (LocalFrame::Ned, [Some(3.0), None, Some(0.0)]));
    assert_eq!(
        (motion.velocity, motion.acceleration, motion.heading),
        ([None; 3], [None; 3], Some(0.5))
    );
    let Request::Sticks(sticks) = requests[1] else {
        panic!("{requests:?}")
    };
    assert_eq!((sticks.pitch, sticks.roll), (Some(0.5), None));
    assert_eq!((sticks.throttle, sticks.yaw), (Some(0.25), Some(-1.0)));
}

#[test]
fn attitude_targets_global_targets_and_channels_are_understood() {
    let mut bench = Bench::new();
    bench.ask(&SET_ATTITUDE_TARGET_DATA {
        q: [2.0_f32.sqrt_for_tests(), 0.0, 0.0, 0.0],
        thrust: 1.5,
        body_roll_rate: 0.1,
        type_mask: AttitudeTargetTypemask::from_bits_retain(0b0000_0110),
        target_system: 1,
        target_component: 1,
        ..SET_ATTITUDE_TARGET_DATA::DEFAULT
    });
    bench.ask(&SET_POSITION_TARGET_GLOBAL_INT_DATA {
        lat_int: 1,
        lon_int: 2,
        alt: 30.0,
        type_mask: PositionTargetTypemask::from_bits_retain(0b1111_1111_1000),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        ..SET_POSITION_TARGET_GLOBAL_INT_DATA::DEFAULT
    });
    bench.ask(&RC_CHANNELS_OVERRIDE_DATA {
        chan1_raw: 1500,
        chan2_raw: u16::MAX,
        target_system: 1,
        target_component: 1,
        chan9_raw: 1600,
        chan10_raw: 0xfffe,
        ..RC_CHANNELS_OVERRIDE_DATA::DEFAULT
    });
    let requests = bench.vehicle.requests();
    let Request::Offboard(Setpoint::Attitude {
        attitude,
        rate,
        thrust,
    }) = requests[0]
    else {
        panic!("{requests:?}")
    };
    assert_eq!(
        (attitude, rate, thrust),
        (None, [Some(0.1), None, None], Some(1.0)),
        "of norm 2: no rotation"
    );
    let Request::Offboard(Setpoint::Global { ground, motion, .. }) = requests[1] else {
        panic!("{requests:?}")
    };
    assert_eq!(
        (ground.map(|ground| ground.longitude), motion.heading),
        (Some(2), None)
    );
    let Request::Channels(channels) = requests[2] else {
        panic!("{requests:?}")
    };
    let channels = channels.channels;
    assert_eq!(
        channels[..3],
        [Channel::Pulse(1500), Channel::Keep, Channel::Release]
    );
    assert_eq!(
        channels[8..11],
        [Channel::Pulse(1600), Channel::Release, Channel::Keep]
    );
}

/// Nothing is masked, and every field has a number of its own, so that a wrong place shows.
#[test]
fn every_number_of_a_local_target_has_its_place() {
    let mut bench = Bench::new();
    bench.ask(&SET_POSITION_TARGET_LOCAL_NED_DATA {
        time_boot_ms: 99,
        x: 1.0,
        y: 2.0,
        z: 3.0,
        vx: 4.0,
        vy: 5.0,
        vz: 6.0,
        afx: 7.0,
        afy: 8.0,
        afz: 9.0,
        yaw: 0.5,
        yaw_rate: 0.25,
        type_mask: PositionTargetTypemask::empty(),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_OFFSET_NED,
    });
    let setpoint = Setpoint::Local {
        frame: LocalFrame::OffsetNed,
        position: [1.0, 2.0, 3.0].map(Some),
        motion: MOTION,
    };
    assert_eq!(bench.vehicle.requests(), [Request::Offboard(setpoint)]);
}

#[test]
fn every_number_of_a_global_target_has_its_place() {
    let mut bench = Bench::new();
    bench.ask(&SET_POSITION_TARGET_GLOBAL_INT_DATA {
        time_boot_ms: 99,
        lat_int: 473_977_418,
        lon_int: 85_455_938,
        alt: 30.0,
        vx: 4.0,
        vy: 5.0,
        vz: 6.0,
        afx: 7.0,
        afy: 8.0,
        afz: 9.0,
        yaw: 0.5,
        yaw_rate: 0.25,
        type_mask: PositionTargetTypemask::empty(),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
    });
    let setpoint = Setpoint::Global {
        ground: Some(Ground {
            latitude: 473_977_418,
            longitude: 85_455_938,
        }),
        altitude: Some(Altitude::Home(30.0)),
        motion: MOTION,
    };
    assert_eq!(bench.vehicle.requests(), [Request::Offboard(setpoint)]);
}

/// What both targets of a position say about the rest.
const MOTION: Motion = Motion {
    velocity: [Some(4.0), Some(5.0), Some(6.0)],
    acceleration: [Some(7.0), Some(8.0), Some(9.0)],
    heading: Some(0.5),
    heading_rate: Some(0.25),
};

#[test]
fn every_number_of_an_attitude_target_has_its_place() {
    let mut bench = Bench::new();
    bench.ask(&SET_ATTITUDE_TARGET_DATA {
        time_boot_ms: 99,
        q: [0.8, 0.4, -0.4, 0.2],
        body_roll_rate: 0.1,
        body_pitch_rate: 0.2,
        body_yaw_rate: 0.3,
        thrust: 0.6,
        type_mask: AttitudeTargetTypemask::empty(),
        target_system: 1,
        target_component: 1,
        ..SET_ATTITUDE_TARGET_DATA::DEFAULT
    });
    let setpoint = Setpoint::Attitude {
        attitude: Some(Quaternion::new(0.8, 0.4, -0.4, 0.2).normalized()),
        rate: [0.1, 0.2, 0.3].map(Some),
        thrust: Some(0.6),
    };
    assert_eq!(bench.vehicle.requests(), [Request::Offboard(setpoint)]);
}

#[test]
fn every_number_of_a_game_pad_has_its_place() {
    let mut bench = Bench::new();
    bench.ask(&MANUAL_CONTROL_DATA {
        x: 500,
        y: -250,
        z: 125,
        r: -1000,
        buttons: 0xa55b,
        target: 1,
        ..MANUAL_CONTROL_DATA::DEFAULT
    });
    let sticks = Sticks {
        pitch: Some(0.5),
        roll: Some(-0.25),
        throttle: Some(0.125),
        yaw: Some(-1.0),
        buttons: 0xa55b,
    };
    assert_eq!(bench.vehicle.requests(), [Request::Sticks(sticks)]);
}

trait Root {
    fn sqrt_for_tests(self) -> f32;
}

impl Root for f32 {
    fn sqrt_for_tests(self) -> f32 {
        windhover_math::sqrt(self)
    }
}
