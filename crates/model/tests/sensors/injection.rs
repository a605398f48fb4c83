//! Faults at work: their windows, and what they do.

use windhover_model::imu::{ACCEL_SCALE, GYRO_SCALE};
use windhover_model::sensor::battery::VOLTAGE_SCALE;
use windhover_model::sensor::fault::{FaultSensor, SensorFault};
use windhover_model::sensor::suite::{Fitting, Readings, SensorErrors};
use windhover_model::{GRAVITY, sensor::barometer::atmosphere};

use crate::suite::flight;
use crate::{assert_deviation, moments};

pub fn fault(text: &str) -> SensorFault {
    text.parse().unwrap()
}

/// A flight of 4 s with real sensors.
fn with(faults: &[SensorFault]) -> Vec<Readings> {
    flight(&Fitting::default(), &SensorErrors::default(), faults, 4)
}

/// A flight of 4 s with sensors without errors.
fn exact(faults: &[SensorFault]) -> Vec<Readings> {
    flight(&Fitting::default(), &SensorErrors::ideal(), faults, 4)
}

/// The readings without those of one sensor.
fn without(sensor: FaultSensor, mut readings: Readings) -> Readings {
    match sensor {
        FaultSensor::Imu => readings.imu = None,
        FaultSensor::Gyro => readings.imu.iter_mut().for_each(|imu| imu.gyro = [0; 3]),
        FaultSensor::Accel => readings.imu.iter_mut().for_each(|imu| imu.accel = [0; 3]),
        FaultSensor::Barometer => readings.barometer = None,
        FaultSensor::Compass => readings.compass = None,
        FaultSensor::Gnss => readings.gnss = None,
        FaultSensor::Battery => readings.battery = None,
        FaultSensor::Rc => readings.rc = None,
    }
    readings
}

#[test]
fn every_fault_acts_in_its_window_on_its_sensor_only() {
    let healthy = with(&[]);
    for name in SensorFault::all() {
        let fault = fault(&format!("{}@1.5,1.25", name.name));
        let faulty = with(&[fault]);
        let mut differing = 0;
        for (ms, (healthy, faulty)) in healthy.iter().zip(&faulty).enumerate() {
            if (1500..2750).contains(&ms) {
                differing += usize::from(healthy != faulty);
                assert_eq!(
                    without(fault.sensor, *healthy),
                    without(fault.sensor, *faulty),
                    "{fault} at {ms} ms"
                );
            } else {
                assert_eq!(healthy, faulty, "{fault} at {ms} ms");
            }
        }
        assert!(differing > 0, "{fault} does nothing");
    }
}

#[test]
fn the_first_and_the_last_sample_of_the_window_are_hit() {
    let healthy = with(&[]);
    for name in ["gyro-bias-step", "accel-noise", "imu-dropout", "gyro-dropout"] {
        let faulty = with(&[fault(&format!("{name}@1.5,1.25"))]);
        let hit = |ms: usize| healthy[ms] != faulty[ms];
        let around = [hit(1499), hit(1500), hit(2749), hit(2750)];
        assert_eq!(around, [false, true, true, false], "{name}");
    }
}

#[test]
fn without_for_a_fault_stays() {
    let faulty = with(&[fault("baro-dropout@2")]);
    assert!(faulty[..2000].iter().any(|r| r.barometer.is_some()));
    assert!(faulty[2000..].iter().all(|r| r.barometer.is_none()));
}

#[test]
fn dropout_and_freeze_are_what_they_say() {
    let healthy = with(&[]);
    let dropped = with(&[fault("gyro-dropout@1,1"), fault("imu-dropout@2,1")]);
    assert_eq!(dropped[1500].imu.unwrap().gyro, [i16::MIN; 3]);
    assert_eq!(dropped[1500].imu.unwrap().accel, healthy[1500].imu.unwrap().accel);
    assert_eq!(dropped[2500].imu, None);

    let frozen = with(&[fault("imu-freeze@1,1"), fault("gnss-freeze@2,1")]);
    for readings in &frozen[1000..2000] {
        assert_eq!(readings.imu, healthy[999].imu);
    }
    let last = healthy[..2000].iter().rev().find_map(|r| r.gnss).unwrap();
    for (frozen, healthy) in frozen[2000..3000].iter().zip(&healthy[2000..]) {
        let (Some(message), Some(fresh)) = (frozen.gnss, healthy.gnss) else {
            continue;
        };
        assert_eq!(
            (message.latitude, message.velocity),
            (last.latitude, last.velocity)
        );
        assert_eq!(message.time_of_week, fresh.time_of_week, "its clock goes on");
    }
}

/// Of every sensor, what differs between a flight with the fault from 1 s on and one without.
fn differences(text: &str, number: impl Fn(&Readings) -> Option<f64>) -> Vec<f64> {
    let (healthy, faulty) = (exact(&[]), exact(&[fault(text)]));
    let differ = |(healthy, faulty): (&Readings, &Readings)| Some(number(faulty)? - number(healthy)?);
    healthy
        .iter()
        .zip(&faulty)
        .skip(1000)
        .filter_map(differ)
        .collect()
}

#[test]
fn bias_steps_have_their_magnitude() {
    let steps = |text: &str, number: fn(&Readings) -> Option<f64>, wanted: f64, bound: f64| {
        let found = differences(text, number);
        assert!(found.len() > 20);
        assert!(
            found.iter().all(|step| (step - wanted).abs() <= bound),
            "{text}: {wanted}, {found:?}"
        );
    };
    steps(
        "gyro-bias-step@1",
        |r| Some(f64::from(r.imu?.gyro[1])),
        0.035 * GYRO_SCALE,
        0.5,
    );
    steps(
        "accel-bias-step@1",
        |r| Some(f64::from(r.imu?.accel[2])),
        0.5 * ACCEL_SCALE,
        0.5,
    );
    steps(
        "compass-bias-step@1",
        |r| Some(f64::from(r.compass?[0])),
        66.0,
        1.0,
    );
    steps(
        "gnss-bias-step@1",
        |r| Some(f64::from(r.gnss?.height_msl)),
        10_000.0,
        0.5,
    );
    // 10 m are 899 units of latitude, at 11.12 mm each.
    steps(
        "gnss-bias-step@1",
        |r| Some(f64::from(r.gnss?.latitude)),
        899.5,
        1.0,
    );
    steps(
        "battery-bias-step@1",
        |r| Some(f64::from(r.battery?.voltage)),
        -VOLTAGE_SCALE,
        0.5,
    );
    steps("rc-bias-step@1", |r| Some(f64::from(r.rc?[3])), 0.2 * 819.5, 0.5);
    // 5 m more height are 5ρg Pa less.
    let formula = Fitting::default().formula;
    let (_, _, density) = atmosphere(500.0);
    let pascal = |r: &Readings| {
        r.barometer
            .map(|raw| formula.pressure(raw.pressure, raw.temperature))
    };
    for step in differences("baro-bias-step@1", pascal) {
        assert!((step / (-5.0 * density * GRAVITY) - 1.0).abs() < 0.01, "{step}");
    }
}

#[test]
fn spikes_come_once_a_second_in_turn() {
    let found = differences("gyro-spike@1", |r| Some(f64::from(r.imu?.gyro[0])));
    let spikes: Vec<(usize, f64)> = found.into_iter().enumerate().filter(|(_, v)| *v != 0.0).collect();
    let wanted = 3.0 * GYRO_SCALE;
    assert_eq!(spikes.len(), 3);
    for (n, (at, size)) in spikes.into_iter().enumerate() {
        assert_eq!(at, 1000 * n);
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        assert!((size - sign * wanted).abs() <= 1.0, "{size}");
    }
}

#[test]
fn noise_has_its_magnitude() {
    let found = differences("accel-noise@1", |r| Some(f64::from(r.imu?.accel[1])));
    assert_deviation(&found, 2.0 * ACCEL_SCALE);
    assert!(moments(&found).0.abs() < 4.0 * 2.0 * ACCEL_SCALE / (found.len() as f64).sqrt());
}

#[test]
fn two_noises_are_apart() {
    let noisy = exact(&[fault("gyro-noise@0"), fault("accel-noise@0")]);
    let still = exact(&[]);
    let products = noisy.iter().zip(&still).map(|(noisy, still)| {
        let (noisy, still) = (noisy.imu.unwrap(), still.imu.unwrap());
        let gyro = f64::from(noisy.gyro[0] - still.gyro[0]) / (0.1 * GYRO_SCALE);
        gyro * f64::from(noisy.accel[0] - still.accel[0]) / (2.0 * ACCEL_SCALE)
    });
    // The correlation of 4000 independent pairs is within four times 1/√4000 of 0.
    let correlation = products.sum::<f64>() / noisy.len() as f64;
    assert!(correlation.abs() < 0.063, "{correlation}");
}

#[test]
fn a_wrong_scale_is_a_factor() {
    let healthy = exact(&[]);
    let faulty = exact(&[
        fault("gyro-wrong-scale@1"),
        fault("gnss-wrong-scale@1"),
        fault("rc-wrong-scale@1"),
    ]);
    let gyro = |all: &[Readings]| f64::from(all[2000].imu.unwrap().gyro[2]);
    assert!((gyro(&faulty) - 1.1 * gyro(&healthy)).abs() <= 0.5);
    // The vehicle climbs at 2 m/s: 1.5 times as fast, from where it was.
    let height = |ms: usize| faulty[ms].gnss.unwrap().height_msl;
    assert_eq!(height(1000), healthy[1000].gnss.unwrap().height_msl, "no jump");
    assert_eq!(height(3000) - height(1000), 6000);
    assert_eq!(faulty[3000].gnss.unwrap().velocity[2], -3000);
    let stick = |all: &[Readings]| f64::from(all[2013].rc.unwrap()[0]) - 992.0;
    assert!((stick(&faulty) - 0.5 * stick(&healthy)).abs() <= 1.0);
}

#[test]
fn faulty_counts_stay_in_their_range() {
    for name in SensorFault::all() {
        for magnitude in [1e12, -1e12, f64::NAN] {
            let fault = SensorFault {
                magnitude,
                ..fault(&format!("{}@1", name.name))
            };
            for readings in with(&[fault]) {
                let barometer = readings.barometer.unwrap_or_default().pressure;
                assert!((-(1 << 23)..1 << 23).contains(&barometer));
                let battery = readings.battery.unwrap_or_default();
                assert!(battery.voltage <= 4095 && battery.current <= 4095);
                let rc = readings.rc.unwrap_or([992; 16]);
                assert!(rc.iter().all(|channel| *channel <= 2047));
            }
        }
    }
}
