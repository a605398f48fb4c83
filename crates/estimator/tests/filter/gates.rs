//! Outliers, silence, resets, refusals.

use windhover_estimator::gate::Policy;
use windhover_estimator::measurement::{BarometricHeight, GnssPosition, MagneticField};
use windhover_estimator::{Health, Report, Sensor, Verdict};
use windhover_math::{Quaternion, Vector3};

use crate::flight::{Flight, Manoeuvre};
use crate::oracle::narrow;

pub fn settled(seed: u64) -> Flight {
    let mut flight = Flight::new(seed, Manoeuvre::Hover, 120_000);
    for _ in 0..5000 {
        flight.step();
    }
    flight
}

pub fn position(flight: &Flight, away: f32) -> GnssPosition {
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
        (accuracy.horizontal - 0.5 * windhover_math::sqrt(2.0)).abs() < 0.01,
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

/// A compass that shows a heading off by 2 rad, as often as it takes: its last report, and how
/// far the heading has turned.
fn insist(flight: &mut Flight) -> (Report<1>, f32) {
    let heading = flight.filter.state().attitude.heading();
    let wrong = Quaternion::from_heading(heading + 2.0);
    let mut last = None;
    for _ in 0..Policy::of(Sensor::Compass).patience {
        let measured = MagneticField {
            repeats: 1.0,
            time: flight.time,
            field: wrong.inverse_rotate(Vector3::new(20.0, 0.0, 40.0)),
            deviation: 0.8,
            declination: 0.0,
        };
        last = Some(flight.filter.fuse_compass(&measured).unwrap());
    }
    let turned = windhover_math::wrap_pi(flight.filter.state().attitude.heading() - heading);
    (last.unwrap(), turned)
}

#[test]
fn a_compass_that_insists_turns_a_heading_that_is_not_sure() {
    let mut flight = settled(4);
    flight.filter.realign(0.01, 0.35).unwrap();
    let (last, turned) = insist(&mut flight);
    assert_eq!(last.verdict, Verdict::Reset);
    assert!((last.step.unwrap().attitude.heading() - 2.0).abs() < 0.05);
    assert!((turned - 2.0).abs() < 0.05, "{turned}");
}

#[test]
fn a_compass_that_insists_does_not_turn_a_heading_that_is_sure() {
    let mut flight = settled(4);
    let (last, turned) = insist(&mut flight);
    assert_eq!((last.verdict, turned), (Verdict::Rejected, 0.0));
    let monitor = flight.filter.monitor(Sensor::Compass);
    assert_eq!(monitor.consecutive, Policy::of(Sensor::Compass).patience);
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
