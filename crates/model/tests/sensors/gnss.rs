//! The satellite receiver.

use proptest::prelude::*;
use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_model::Truth;
use windhover_model::sensor::gnss::{Gnss, GnssErrors, GnssSite};
use windhover_model::sensor::nav_pvt::NavPvt;

use crate::{assert_deviation, at_rest};

const PERIOD_US: u64 = 100_000;

/// Measures `n` times a period apart, and takes each message at once.
fn messages(errors: GnssErrors, seed: u64, n: u64, truth: &Truth) -> Vec<NavPvt> {
    let errors = GnssErrors {
        latency_us: 0,
        ..errors
    };
    let mut receiver = Gnss::new(&errors, GnssSite::default(), PERIOD_US, seed);
    (0..n)
        .map(|n| {
            receiver.measure(truth, n * PERIOD_US);
            receiver.receive(n * PERIOD_US).expect("it is due")
        })
        .collect()
}

/// North, east, down in m, at millimetres: a unit of latitude is 11 mm.
fn local(message: &NavPvt) -> Vector3<f64> {
    LocalFrame::new(GnssSite::default().home)
        .to_local(GlobalPosition {
            latitude: message.latitude,
            longitude: message.longitude,
            altitude: message.height_msl,
        })
        .map(f64::from)
}

#[test]
fn position_errors_have_their_deviation() {
    for errors in [GnssErrors::standard(), GnssErrors::rtk()] {
        let (mut north, mut east, mut down) = (vec![], vec![], vec![]);
        for seed in 0..4000 {
            // The third message: slow noise is stationary from the first on.
            let at = local(messages(errors, seed, 3, &at_rest()).last().unwrap());
            north.push(at.x);
            east.push(at.y);
            down.push(at.z);
        }
        let total =
            |slow: f64, white: f64, unit: f64| (slow * slow + white * white + unit * unit / 12.0).sqrt();
        assert_deviation(&north, total(errors.horizontal, errors.horizontal_white, 0.0111));
        assert_deviation(&east, total(errors.horizontal, errors.horizontal_white, 0.0075));
        assert_deviation(&down, total(errors.vertical, errors.vertical_white, 0.001));
    }
}

#[test]
fn the_white_error_is_what_differs_between_messages() {
    let errors = GnssErrors::standard();
    let mut differences = vec![];
    for seed in 0..4000 {
        let two = messages(errors, seed, 2, &at_rest());
        differences.push(local(&two[1]).y - local(&two[0]).y);
    }
    // Two white errors, and what the slow one moves in 0.1 s of its 100 s.
    let moved = 2.0 * 1.5 * 1.5 * (1.0 - libm::exp(-1e-3));
    assert_deviation(&differences, (2.0 * 0.3 * 0.3 + moved).sqrt());
}

#[test]
fn the_slow_error_has_its_time_constant() {
    let errors = GnssErrors {
        horizontal_white: 0.0,
        ..GnssErrors::standard()
    };
    let (mut sums, mut differences) = (vec![], vec![]);
    for seed in 0..3000 {
        let all = messages(errors, seed, 501, &at_rest());
        let (first, last) = (local(&all[0]).x, local(&all[500]).x);
        sums.push(first + last);
        differences.push(last - first);
    }
    // After 50 s the correlation is e^(−0.5).
    let correlation = libm::exp(-0.5);
    assert_deviation(&sums, 1.5 * (2.0 * (1.0 + correlation)).sqrt());
    assert_deviation(&differences, 1.5 * (2.0 * (1.0 - correlation)).sqrt());
}

#[test]
fn velocity_errors_are_white_with_their_deviation() {
    let truth = Truth {
        velocity: Vector3::new(2.0, -1.0, 0.5),
        ..at_rest()
    };
    let all = messages(GnssErrors::standard(), 3, 8000, &truth);
    for (axis, wanted) in [2.0, -1.0, 0.5].into_iter().enumerate() {
        let errors: Vec<f64> = all
            .iter()
            .map(|m| f64::from(m.velocity[axis]) * 1e-3 - wanted)
            .collect();
        assert_deviation(&errors, 0.05);
        let steps: Vec<f64> = errors.chunks_exact(2).map(|pair| pair[1] - pair[0]).collect();
        assert_deviation(&steps, 0.05 * core::f64::consts::SQRT_2);
    }
}

#[test]
fn a_message_is_late_by_exactly_its_latency() {
    let errors = GnssErrors {
        latency_us: 120_000,
        ..GnssErrors::ideal()
    };
    let mut receiver = Gnss::new(&errors, GnssSite::default(), PERIOD_US, 1);
    let mut received = 0;
    for time in (0..3_000_000).step_by(250) {
        let truth = Truth {
            position: Vector3::new(0.0, 0.0, -(time as f64) * 1e-3),
            ..at_rest()
        };
        if time % PERIOD_US == 0 {
            receiver.measure(&truth, time);
        }
        if let Some(message) = receiver.receive(time) {
            received += 1;
            let measured = time - 120_000;
            assert_eq!(measured % PERIOD_US, 0);
            assert_eq!(u64::from(message.time_of_week), 302_400_000 + measured / 1000);
            assert_eq!(i64::from(message.height_msl), 488_000 + measured as i64);
            assert_eq!(message.height, message.height_msl + 47_300);
        }
    }
    assert_eq!((received, receiver.lost()), (29, 0));
}

#[test]
fn messages_that_nobody_takes_are_lost_oldest_first() {
    let mut receiver = Gnss::new(&GnssErrors::ideal(), GnssSite::default(), PERIOD_US, 1);
    for n in 0..40 {
        receiver.measure(&at_rest(), n * PERIOD_US);
    }
    assert_eq!(receiver.lost(), 8);
    let first = receiver.receive(u64::MAX).unwrap();
    assert_eq!(first.time_of_week, 302_400_800);
    assert_eq!(core::iter::from_fn(|| receiver.receive(u64::MAX)).count(), 31);
}

#[test]
fn the_receiver_declares_its_own_errors() {
    let message = |errors| messages(errors, 1, 1, &at_rest())[0];
    let standard = message(GnssErrors::standard());
    assert_eq!((standard.fix_type, standard.flags), (3, 0x01));
    // √2·√(1.5² + 0.3²), √(2.5² + 0.5²), √3·0.05
    assert_eq!(standard.horizontal_accuracy, 2163);
    assert_eq!(standard.vertical_accuracy, 2550);
    assert_eq!(standard.speed_accuracy, 87);
    let rtk = message(GnssErrors::rtk());
    assert_eq!(
        (rtk.flags, rtk.horizontal_accuracy, rtk.vertical_accuracy),
        (0x83, 28, 20)
    );
}

#[test]
fn heading_and_speed_follow_the_motion() {
    let motion = |north: f64, east: f64| {
        let velocity = Vector3::new(north, east, 1.0);
        let truth = Truth {
            velocity,
            ..at_rest()
        };
        let message = messages(GnssErrors::ideal(), 1, 1, &truth)[0];
        (message.heading_of_motion, message.ground_speed)
    };
    assert_eq!(motion(1.0, 0.0), (0, 1000));
    assert_eq!(motion(0.0, 2.0), (9_000_000, 2000));
    assert_eq!(motion(-3.0, 0.0), (18_000_000, 3000));
    assert_eq!(motion(3.0, -4.0), (30_686_990, 5000));
}

#[test]
fn equal_seeds_give_equal_messages() {
    let run = |seed| messages(GnssErrors::standard(), seed, 50, &at_rest());
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn the_week_begins_anew() {
    let site = GnssSite {
        time_of_week: 604_799_900,
        ..GnssSite::default()
    };
    let mut receiver = Gnss::new(&GnssErrors::ideal(), site, PERIOD_US, 1);
    receiver.measure(&at_rest(), 150_000);
    assert_eq!(receiver.receive(150_000).unwrap().time_of_week, 50);
}

proptest! {
    #[test]
    fn without_errors_the_position_is_the_truth(
        north in -2000.0_f64..2000.0,
        east in -2000.0_f64..2000.0,
        down in -200.0_f64..50.0,
    ) {
        let position = Vector3::new(north, east, down);
        let truth = Truth { position, ..at_rest() };
        let error = local(&messages(GnssErrors::ideal(), 1, 1, &truth)[0]) - position;
        // Half a unit of latitude, half a millimetre, and single precision.
        prop_assert!(error.x.abs() < 7e-3 && error.y.abs() < 7e-3 && error.z.abs() < 7e-4, "{}", error);
    }
}
