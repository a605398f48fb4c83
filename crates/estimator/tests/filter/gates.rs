//! Outliers, silence, resets, refusals.

use windhover_estimator::gate::Policy;
use windhover_estimator::measurement::{
    BarometricHeight, ExternalPose, GnssPosition, GnssVelocity, Heading, MagneticField,
};
use windhover_estimator::{Filter, Health, InertialIncrements, Refusal, Sensor, Verdict};
use windhover_math::{Quaternion, Vector3};

use crate::flight::{Flight, Manoeuvre, STEP};
use crate::oracle::narrow;

fn settled(seed: u64) -> Flight {
    let mut flight = Flight::new(seed, Manoeuvre::Hover, 120_000);
    for _ in 0..5000 {
        flight.step();
    }
    flight
}

fn position(flight: &Flight, away: f32) -> GnssPosition {
    GnssPosition {
        time: flight.time,
        position: flight.filter.state().position + Vector3::new(away, 0.0, 0.0),
        horizontal_deviation: 0.5,
        vertical_deviation: 1.0,
    }
}

#[test]
fn outliers_are_rejected_counted_and_change_nothing() {
    let mut flight = settled(1);
    let before = flight.filter.clone();
    let report = flight
        .filter
        .fuse_gnss_position(&position(&flight, 20.0))
        .unwrap();
    assert_eq!(report.verdict, Verdict::Rejected);
    assert_eq!(report.step, None);
    assert!(report.tests[0].ratio() > 25.0 && report.tests[1].ratio() < 1e-3);
    assert_eq!(flight.filter.state(), before.state());
    assert_eq!(flight.filter.covariance(), before.covariance());
    let (was, is) = (
        before.monitor(Sensor::GnssPosition),
        flight.filter.monitor(Sensor::GnssPosition),
    );
    assert_eq!(
        (is.accepted, is.rejected, is.consecutive),
        (was.accepted, was.rejected + 1, 1)
    );
    assert!(matches!(
        flight.filter.health(Sensor::GnssPosition),
        Health::Degraded { .. }
    ));
    let report = flight.filter.fuse_gnss_position(&position(&flight, 0.3)).unwrap();
    assert_eq!(report.verdict, Verdict::Accepted);
    assert_eq!(flight.filter.monitor(Sensor::GnssPosition).consecutive, 0);
    assert_eq!(
        flight.filter.health(Sensor::GnssPosition),
        Health::Good { age: 0 }
    );
}

#[test]
fn a_receiver_that_insists_is_given_in_to_and_the_step_is_told() {
    let mut flight = settled(2);
    let patience = Policy::of(Sensor::GnssPosition).patience;
    let place = flight.filter.state().position;
    let measured = position(&flight, 20.0);
    for n in 1..=patience {
        let report = flight.filter.fuse_gnss_position(&measured).unwrap();
        if n < patience {
            assert_eq!(report.verdict, Verdict::Rejected);
            continue;
        }
        assert_eq!(report.verdict, Verdict::Reset);
        let step = report.step.unwrap();
        assert!((step.position.x - 20.0).abs() < 1e-4);
        assert_eq!(step.velocity, Vector3::zeros());
        assert!((flight.filter.state().position - place - step.position).amax() < 1e-5);
    }
    let accuracy = flight.filter.accuracy();
    assert!(
        (accuracy.horizontal - std::f32::consts::FRAC_1_SQRT_2).abs() < 0.01,
        "{accuracy:?}"
    );
    let again = flight.filter.fuse_gnss_position(&measured).unwrap();
    assert_eq!(again.verdict, Verdict::Accepted);
}

#[test]
fn a_barometer_that_insists_moves_its_datum_while_another_height_is_believed() {
    let mut flight = settled(3);
    let patience = Policy::of(Sensor::Barometer).patience;
    let down = flight.filter.state().position.z;
    for with_gnss in [true, false] {
        if !with_gnss {
            flight.gnss = false;
            flight.filter.fuse_gnss_height(&position(&flight, 0.0)).unwrap();
            for _ in 0..2000 {
                flight.step();
            }
        }
        let height = flight.filter.datum().unwrap().height - flight.filter.state().position.z + 5.0;
        let mut last = None;
        for _ in 0..patience {
            let measured = BarometricHeight {
                time: flight.time,
                height,
                deviation: 0.1,
            };
            if with_gnss {
                flight.filter.fuse_gnss_height(&position(&flight, 0.0)).unwrap();
            }
            last = Some(flight.filter.fuse_barometer(&measured).unwrap());
        }
        let last = last.unwrap();
        assert_eq!(last.verdict, Verdict::Reset);
        let step = last.step.unwrap().position.z;
        if with_gnss {
            assert_eq!(step, 0.0);
            assert!((flight.filter.state().position.z - down).abs() < 0.2);
        } else {
            assert!((step + 5.0).abs() < 1e-3, "{step}");
        }
    }
}

#[test]
fn a_compass_that_insists_turns_the_heading() {
    let mut flight = settled(4);
    let patience = Policy::of(Sensor::Compass).patience;
    let heading = flight.filter.state().attitude.heading();
    let wrong = Quaternion::from_heading(heading + 2.0);
    let mut last = None;
    for _ in 0..patience {
        let measured = MagneticField {
            time: flight.time,
            field: wrong.inverse_rotate(Vector3::new(20.0, 0.0, 40.0)),
            deviation: 0.8,
            declination: 0.0,
        };
        last = Some(flight.filter.fuse_compass(&measured).unwrap());
    }
    let last = last.unwrap();
    assert_eq!(last.verdict, Verdict::Reset);
    assert!((last.step.unwrap().attitude.heading() - 2.0).abs() < 0.05);
    let turned = windhover_math::wrap_pi(flight.filter.state().attitude.heading() - heading);
    assert!((turned - 2.0).abs() < 0.05, "{turned}");
}

#[test]
fn half_a_minute_without_receiver_keeps_attitude_and_height() {
    let mut worst = Vec::new();
    for seed in 1..=20 {
        let mut flight = settled(100 + seed);
        flight.gnss = false;
        for _ in 0..7500 {
            flight.step();
            let e = flight.errors();
            assert!(e[6].abs() < 0.02 && e[7].abs() < 0.02 && e[8].abs() < 0.03, "{e}");
            assert!(e[2].abs() < 0.3, "{e}");
        }
        assert!(matches!(
            flight.filter.health(Sensor::GnssPosition),
            Health::Lost { .. }
        ));
        let e = flight.errors();
        worst.push(libm::hypot(e[0], e[1]));
        flight.gnss = true;
        let before = *flight.filter.state();
        let report = flight
            .filter
            .fuse_gnss_position(&GnssPosition {
                time: flight.time,
                position: narrow(flight.truth.position),
                horizontal_deviation: 0.5,
                vertical_deviation: 1.0,
            })
            .unwrap();
        // It returns: taken in or set, the step is told.
        let step = report.step.unwrap();
        assert!((flight.filter.state().position - before.position - step.position).amax() < 1e-4);
        assert!((flight.filter.state().velocity - before.velocity - step.velocity).amax() < 1e-4);
    }
    worst.sort_by(f64::total_cmp);
    println!(
        "position error after 30 s: median {:.2} m, worst {:.2} m",
        worst[10], worst[19]
    );
    assert!(worst[10] < 8.0, "{worst:?}");
}

#[test]
fn after_a_shock_the_receiver_levels_the_vehicle_again() {
    let mut flight = Flight::new(7, Manoeuvre::Lively, 120_000);
    for _ in 0..5000 {
        flight.step();
    }
    // As by clipping: the truth is suddenly 15° from what the filter believes.
    let shock = Quaternion::from_rotation_vector(Vector3::new(0.2, -0.15, 0.3));
    flight.truth.attitude = shock * flight.truth.attitude;
    flight.filter.realign(0.35, 0.6).unwrap();
    for _ in 0..5000 {
        flight.step();
    }
    let e = flight.errors();
    assert!(e[6].abs() < 0.02 && e[7].abs() < 0.02 && e[8].abs() < 0.04, "{e}");
}

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
