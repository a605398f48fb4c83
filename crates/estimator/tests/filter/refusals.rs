//! What does not get in.

use windhover_estimator::measurement::{
    BarometricHeight, ExternalPose, GnssPosition, GnssVelocity, Heading, MagneticField,
};
use windhover_estimator::{Filter, InertialIncrements, Refusal, Sensor};
use windhover_math::{Quaternion, Vector3};

use crate::flight::STEP;
use crate::gates::{position, settled};

#[test]
fn nothing_that_is_not_a_number_gets_in() {
    let flight = settled(5);
    let time = flight.time;
    let spoil = |try_it: &dyn Fn(&mut Filter, f32) -> Result<(), Refusal>| {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            let mut filter = flight.filter.clone();
            let refused = try_it(&mut filter, bad).unwrap_err();
            let expected = if bad.is_finite() {
                Refusal::OutOfRange
            } else {
                Refusal::NotFinite
            };
            assert_eq!(refused, expected);
            assert_eq!(filter.state(), flight.filter.state());
            assert_eq!(filter.covariance(), flight.filter.covariance());
        }
    };
    let position = GnssPosition {
        time,
        position: Vector3::zeros(),
        horizontal_deviation: 1.0,
        vertical_deviation: 1.0,
    };
    for i in 0..4 {
        spoil(&|filter, bad| {
            let mut m = position;
            if i < 3 {
                m.position[i] = bad
            } else {
                m.horizontal_deviation = bad
            }
            filter.fuse_gnss_position(&m).map(drop)
        });
        spoil(&|filter, bad| {
            let mut m = position;
            if i < 3 {
                m.position[i] = bad
            } else {
                m.vertical_deviation = bad
            }
            filter.fuse_gnss_height(&m).map(drop)
        });
        spoil(&|filter, bad| {
            let mut m = GnssVelocity {
                time,
                velocity: Vector3::zeros(),
                deviation: 0.1,
            };
            if i < 3 {
                m.velocity[i] = bad
            } else {
                m.deviation = bad
            }
            filter.fuse_gnss_velocity(&m).map(drop)
        });
    }
    for i in 0..5 {
        spoil(&|filter, bad| {
            let mut m = MagneticField {
                repeats: 1.0,
                time,
                field: Vector3::new(20.0, 0.0, 40.0),
                deviation: 1.0,
                declination: 0.0,
            };
            match i {
                0..3 => m.field[i] = bad,
                3 => m.deviation = bad,
                _ => m.declination = bad,
            }
            filter.fuse_compass(&m).map(drop)
        });
    }
    for i in 0..2 {
        spoil(&|filter, bad| {
            let mut m = BarometricHeight {
                time,
                height: 0.0,
                deviation: 0.1,
            };
            *(if i == 0 { &mut m.height } else { &mut m.deviation }) = bad;
            filter.fuse_barometer(&m).map(drop)
        });
        spoil(&|filter, bad| {
            let mut m = Heading {
                time,
                heading: 0.0,
                deviation: 0.1,
            };
            *(if i == 0 { &mut m.heading } else { &mut m.deviation }) = bad;
            filter.fuse_heading(&m).map(drop)
        });
    }
    for i in 0..13 {
        spoil(&|filter, bad| {
            let mut m = ExternalPose {
                time,
                position: Vector3::zeros(),
                velocity: Vector3::zeros(),
                attitude: Quaternion::IDENTITY,
                position_deviation: 0.1,
                velocity_deviation: 0.1,
                attitude_deviation: 0.1,
            };
            let q = &mut m.attitude;
            match i {
                0..3 => m.position[i] = bad,
                3..6 => m.velocity[i - 3] = bad,
                6..10 => *[&mut q.w, &mut q.x, &mut q.y, &mut q.z][i - 6] = bad,
                10 => m.position_deviation = bad,
                11 => m.velocity_deviation = bad,
                _ => m.attitude_deviation = bad,
            }
            filter.fuse_pose(&m).map(drop)
        });
    }
    for i in 0..11 {
        let spoiled = |bad: f32| {
            let mut m = InertialIncrements {
                rotation: Quaternion::IDENTITY,
                gyro_bias: Vector3::zeros(),
                velocity: Vector3::new(0.0, 0.0, -0.039),
                duration: 0.004,
            };
            let q = &mut m.rotation;
            match i {
                0..3 => m.velocity[i] = bad,
                3..6 => m.gyro_bias[i - 3] = bad,
                6..10 => *[&mut q.w, &mut q.x, &mut q.y, &mut q.z][i - 6] = bad,
                _ => m.duration = bad,
            }
            m
        };
        spoil(&|filter, bad| filter.predict(&spoiled(bad), time + STEP));
        spoil(&|filter, bad| filter.fuse_gravity(&spoiled(bad), 0.1).map(drop));
        spoil(&|filter, bad| filter.fuse_rest(&spoiled(bad), 0.1, 0.1).map(drop));
    }
}

#[test]
fn what_is_too_old_or_still_to_come_is_refused_and_counted() {
    let mut flight = settled(6);
    let mut measured = position(&flight, 0.0);
    measured.time = flight.time - 1_000_000;
    assert_eq!(flight.filter.fuse_gnss_position(&measured), Err(Refusal::TooOld));
    measured.time = flight.time + 1;
    assert_eq!(flight.filter.fuse_gnss_position(&measured), Err(Refusal::Ahead));
    assert_eq!(flight.filter.monitor(Sensor::GnssPosition).refused, 2);
    measured.time = flight.time - 300_000;
    assert!(flight.filter.fuse_gnss_position(&measured).is_ok());
    let vertical = MagneticField {
        repeats: 1.0,
        time: flight.time,
        field: flight
            .filter
            .state()
            .attitude
            .inverse_rotate(Vector3::new(0.1, 0.0, 40.0)),
        deviation: 1.0,
        declination: 0.0,
    };
    assert_eq!(flight.filter.fuse_compass(&vertical), Err(Refusal::Blind));
}
