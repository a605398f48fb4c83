//! All sensors together.

use windhover_math::{Quaternion, Vector3};
use windhover_model::sensor::compass::CompassPart;
use windhover_model::sensor::fault::SensorFault;
use windhover_model::sensor::inertial::InertialErrors;
use windhover_model::sensor::rate::Rate;
use windhover_model::sensor::suite::{Fitting, Readings, SensorErrors, SensorSuite};
use windhover_model::{GRAVITY, Truth, ideal_counts};

use crate::at_rest;

/// A motion in which every sensor sees something change all the time.
pub fn moving(time: u64) -> Truth {
    let t = time as f64 * 1e-6;
    let (s, c) = libm::sincos(2.0 * t);
    Truth {
        time: t,
        position: Vector3::new(5.0 * t, 3.0 * s, -10.0 - 2.0 * t),
        velocity: Vector3::new(5.0, 6.0 * c, -2.0),
        attitude: Quaternion::from_heading(0.5 * t),
        mean_rate: Vector3::new(0.3 * s, 0.2 * c, 0.5),
        specific_force: Vector3::new(s, c, -GRAVITY + s),
        rotor_speed: [540.0, 550.0, 560.0, 570.0],
        power: 200.0 + 50.0 * s,
        energy: 200.0 * t,
        ..at_rest()
    }
}

/// A flight of so many seconds in steps of 1 ms, with sticks that move.
pub fn flight(
    fitting: &Fitting,
    errors: &SensorErrors,
    faults: &[SensorFault],
    seconds: u64,
) -> Vec<Readings> {
    let mut suite = SensorSuite::new(fitting, errors, faults, 11);
    (0..seconds * 1000)
        .map(|ms| {
            let time = ms * 1000;
            suite.set_sticks([0.5 * libm::sin(time as f64 * 1e-6); 16]);
            suite.advance(&moving(time), time)
        })
        .collect()
}

#[test]
fn each_sensor_comes_at_its_rate() {
    let all = flight(&Fitting::default(), &SensorErrors::ideal(), &[], 10);
    let times = |is: fn(&Readings) -> bool| {
        let due: Vec<usize> = (0..all.len()).filter(|&n| is(&all[n])).collect();
        let first = due[0];
        let period = due[1] - first;
        assert!(due.windows(2).all(|pair| pair[1] - pair[0] == period));
        (due.len(), first, period)
    };
    assert_eq!(times(|r| r.imu.is_some()), (10_000, 0, 1));
    assert_eq!(times(|r| r.barometer.is_some()), (500, 3, 20));
    assert_eq!(times(|r| r.compass.is_some()), (500, 7, 20));
    assert_eq!(times(|r| r.gnss.is_some()), (100, 0, 100));
    assert_eq!(times(|r| r.battery.is_some()), (100, 11, 100));
    assert_eq!(times(|r| r.rc.is_some()), (500, 13, 20));
}

#[test]
fn messages_of_the_receiver_come_late() {
    let all = flight(&Fitting::default(), &SensorErrors::default(), &[], 3);
    let mut seen = 0;
    for (ms, readings) in all.iter().enumerate() {
        if let Some(message) = readings.gnss {
            assert_eq!(ms, 120 + 100 * seen, "measured at whole tenths, 120 ms late");
            assert_eq!(message.time_of_week as usize, 302_400_000 + 100 * seen);
            seen += 1;
        }
    }
    assert_eq!(seen, 29);
}

#[test]
fn ideal_sensors_are_ideal() {
    for (ms, readings) in flight(&Fitting::default(), &SensorErrors::ideal(), &[], 2)
        .iter()
        .enumerate()
    {
        let truth = moving(ms as u64 * 1000);
        let (imu, ideal) = (readings.imu.unwrap(), ideal_counts(&truth));
        assert_eq!((imu.accel, imu.gyro), (ideal.accel, ideal.gyro));
        if let Some(message) = readings.gnss {
            let height = 488_000 + libm::rint(-truth.position.z * 1e3) as i32;
            assert!((message.height_msl - height).abs() <= 1);
            assert_eq!(message.velocity[0], 5000);
        }
    }
}

#[test]
fn equal_seeds_give_equal_readings() {
    let (fitting, errors) = (Fitting::default(), SensorErrors::default());
    let run = || flight(&fitting, &errors, &[], 2);
    assert_eq!(run(), run());
}

#[test]
fn what_one_sensor_is_changes_no_other() {
    let errors = SensorErrors::default();
    let reference = flight(&Fitting::default(), &errors, &[], 3);
    let mut other = Fitting {
        compass: CompassPart::Qmc5883l8G,
        ..Fitting::default()
    };
    other.rates.compass = Rate {
        period: 5000,
        phase: 1000,
    };
    let changed = flight(&other, &errors, &[], 3);
    assert_ne!(reference, changed);
    let without_compass = |all: Vec<Readings>| -> Vec<Readings> {
        all.into_iter().map(|r| Readings { compass: None, ..r }).collect()
    };
    assert_eq!(without_compass(reference), without_compass(changed));
}

#[test]
fn moments_missed_are_not_made_up_for() {
    let mut suite = SensorSuite::new(&Fitting::default(), &SensorErrors::ideal(), &[], 1);
    let due = |r: Readings| [r.barometer.is_some(), r.compass.is_some(), r.battery.is_some()];
    assert_eq!(due(suite.advance(&at_rest(), 1_000_000)), [true; 3]);
    assert_eq!(due(suite.advance(&at_rest(), 1_001_000)), [false; 3]);
    assert_eq!(due(suite.advance(&at_rest(), 1_003_000)), [true, false, false]);
}

#[test]
fn the_reference_follows_rate_and_vehicle() {
    let errors = SensorErrors::reference(4000.0, 225.6);
    assert_eq!(errors.inertial.vibration_speed, 225.6);
    assert_eq!(errors.inertial.gyro.bandwidth, Some(997.0));
    assert_eq!(SensorErrors::reference(1000.0, 557.0), SensorErrors::default());
    assert_eq!(errors.inertial.accel, InertialErrors::default().accel);
}

#[test]
fn at_4_khz_the_unit_comes_every_step() {
    let mut fitting = Fitting::default();
    fitting.rates.imu.period = 250;
    let mut suite = SensorSuite::new(&fitting, &SensorErrors::reference(4000.0, 557.0), &[], 1);
    let all: Vec<Readings> = (0..4000)
        .map(|n| suite.advance(&moving(n * 250), n * 250))
        .collect();
    assert!(all.iter().all(|r| r.imu.is_some()));
    assert_eq!(all.iter().filter(|r| r.barometer.is_some()).count(), 50);
}

/// Parts with oscillators of their own are asked one by one: they read what a suite reads that is
/// asked at its rates.
#[test]
fn sensors_asked_one_by_one_read_the_same() {
    let (fitting, errors) = (Fitting::default(), SensorErrors::default());
    let faults = ["baro-freeze@0.5,0.5", "gnss-bias-step@1", "gyro-dropout@1.5"]
        .map(|text| text.parse::<SensorFault>().unwrap());
    let mut suite = SensorSuite::new(&fitting, &errors, &faults, 11);
    for (ms, readings) in flight(&fitting, &errors, &faults, 2).iter().enumerate() {
        let (ms, time) = (ms as u64, ms as u64 * 1000);
        let truth = moving(time);
        suite.set_sticks([0.5 * libm::sin(time as f64 * 1e-6); 16]);
        let due = |period: u64, phase: u64| ms >= phase && (ms - phase).is_multiple_of(period);
        let mut one_by_one = Readings {
            imu: suite.measure_imu(&truth, time),
            ..Readings::default()
        };
        if due(20, 3) {
            one_by_one.barometer = suite.measure_barometer(&truth, time);
        }
        if due(20, 7) {
            one_by_one.compass = suite.measure_compass(&truth, time);
        }
        if due(100, 0) {
            suite.measure_gnss(&truth, time);
        }
        one_by_one.gnss = suite.receive_gnss(time);
        if due(100, 11) {
            one_by_one.battery = suite.measure_battery(&truth, time);
        }
        if due(20, 13) {
            one_by_one.rc = suite.measure_rc(time);
        }
        assert_eq!(one_by_one, *readings, "{ms} ms");
    }
}
