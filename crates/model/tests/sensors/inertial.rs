//! The inertial measurement unit.

use proptest::prelude::*;
use windhover_math::Vector3;
use windhover_model::imu::{ACCEL_SCALE, GYRO_SCALE};
use windhover_model::sensor::inertial::{Inertial, InertialErrors, TEMPERATURE_SCALE, TriadErrors};
use windhover_model::sensor::mounting::Mounting;
use windhover_model::{GRAVITY, Truth, ideal_counts};

use crate::{assert_deviation, at_rest, moments};

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// The reference with everything off but what `keep` puts back.
fn only(keep: impl Fn(&mut InertialErrors, &InertialErrors)) -> InertialErrors {
    let mut errors = InertialErrors::ideal();
    keep(&mut errors, &InertialErrors::default());
    errors
}

/// A truth with this force and rate.
fn moving(force: [f64; 3], rate: [f64; 3]) -> Truth {
    Truth {
        specific_force: Vector3::from(force),
        mean_rate: Vector3::from(rate),
        ..at_rest()
    }
}

proptest! {
    #[test]
    fn without_errors_the_counts_are_ideal(
        force in prop::array::uniform3(-200.0_f64..200.0),
        rate in prop::array::uniform3(-40.0_f64..40.0),
        speed in prop::array::uniform4(0.0_f64..1000.0),
        seed: u64,
    ) {
        for hz in [1000.0, 4000.0] {
            let mut part = Inertial::new(&InertialErrors::ideal(), hz, seed);
            let truth = Truth { rotor_speed: speed, ..moving(force, rate) };
            for _ in 0..3 {
                let (measured, ideal) = (part.sample(&truth), ideal_counts(&truth));
                prop_assert_eq!(measured.accel, ideal.accel);
                prop_assert_eq!(measured.gyro, ideal.gyro);
                prop_assert_eq!(measured.temperature, 0);
            }
        }
    }

    #[test]
    fn counts_are_held_at_the_ends(force in 157.0_f64..1e9, rate in 34.91_f64..1e9, seed: u64) {
        let mut part = Inertial::new(&InertialErrors::ideal(), 1000.0, seed);
        let high = part.sample(&moving([force; 3], [rate; 3]));
        let low = part.sample(&moving([-force; 3], [-rate; 3]));
        prop_assert_eq!((high.accel, high.gyro), ([i16::MAX; 3], [i16::MAX; 3]));
        prop_assert_eq!((low.accel, low.gyro), ([i16::MIN; 3], [i16::MIN; 3]));
    }
}

#[test]
fn noise_has_the_density_of_the_data_sheet() {
    for rate in [1000.0, 4000.0] {
        let reference = InertialErrors::reference(rate);
        let errors = only(|errors, _| {
            errors.accel.density = reference.accel.density;
            errors.accel.bandwidth = reference.accel.bandwidth;
            errors.gyro.density = reference.gyro.density;
            errors.gyro.bandwidth = reference.gyro.bandwidth;
        });
        let mut part = Inertial::new(&errors, rate, 5);
        // Means over 0.1 s: the filter passes them, so that their variance is D²/(2·0.1 s).
        let per_mean = (rate * 0.1) as usize;
        let mut means = [(); 6].map(|()| Vec::new());
        for _ in 0..4000 {
            let mut sum = [0.0; 6];
            for _ in 0..per_mean {
                // Off the grid of counts, so that rounding is like noise too.
                let m = part.sample(&moving([0.2, -0.3, -9.81], [0.01, 0.02, -0.03]));
                for (sum, count) in sum.iter_mut().zip(m.accel.iter().chain(&m.gyro)) {
                    *sum += f64::from(*count) / per_mean as f64;
                }
            }
            for (means, sum) in means.iter_mut().zip(sum) {
                means.push(sum);
            }
        }
        let accel = reference.accel.density.map(|d| d * ACCEL_SCALE);
        let gyro = reference.gyro.density.map(|d| d * GYRO_SCALE);
        for (means, density) in means.iter().zip(accel.into_iter().chain(gyro)) {
            let rounding = 1.0 / 12.0 / per_mean as f64;
            assert_deviation(means, (density * density / 0.2 + rounding).sqrt());
        }
    }
}

/// What parts of many seeds read after so many samples at `rate` Hz: the first axis of the
/// accelerometer in m/s² and of the gyroscope in rad/s.
fn parts(
    errors: &InertialErrors,
    rate: f64,
    samples: usize,
    seeds: u64,
    truth: &Truth,
) -> (Vec<f64>, Vec<f64>) {
    let read = |seed| {
        let mut part = Inertial::new(errors, rate, seed);
        let last = (0..samples).map(|_| part.sample(truth)).last().unwrap();
        (
            f64::from(last.accel[0]) / ACCEL_SCALE,
            f64::from(last.gyro[0]) / GYRO_SCALE,
        )
    };
    (0..seeds).map(read).unzip()
}

#[test]
fn biases_have_their_deviation() {
    let errors = only(|errors, reference| {
        errors.accel.bias = reference.accel.bias;
        errors.gyro.bias = reference.gyro.bias;
    });
    let (accel, gyro) = parts(&errors, 1.0, 1, 4000, &at_rest());
    assert_deviation(&accel, 5e-3 * GRAVITY);
    // Drawn apart: 4000 independent pairs have a correlation within four times 1/√4000 of 0.
    let products = accel.iter().zip(&gyro).map(|(accel, gyro)| accel * gyro);
    let correlation = products.sum::<f64>() / 4000.0 / (5e-3 * GRAVITY * 0.1 * DEGREE);
    assert!(correlation.abs() < 0.063, "{correlation}");
    // A count is 0.06 °/s: its rounding adds a twelfth of its square.
    let rounding = 1.0 / GYRO_SCALE / GYRO_SCALE / 12.0;
    let bias = 0.1 * DEGREE;
    assert_deviation(&gyro, (bias * bias + rounding).sqrt());
}

#[test]
fn biases_walk_as_the_root_of_time() {
    let errors = only(|errors, reference| {
        errors.accel.walk = reference.accel.walk;
        errors.gyro.walk = reference.gyro.walk;
    });
    for (rate, seconds) in [(1.0, 2500.0), (1.0, 10_000.0), (4.0, 2500.0)] {
        let samples = (rate * seconds) as usize + 1;
        let (accel, gyro) = parts(&errors, rate, samples, 600, &at_rest());
        let walked = f64::sqrt(seconds);
        let with_rounding =
            |deviation: f64, scale: f64| (deviation * deviation + 1.0 / scale / scale / 12.0).sqrt();
        assert_deviation(&accel, with_rounding(2e-4 * walked, ACCEL_SCALE));
        assert_deviation(&gyro, with_rounding(2e-5 * walked, GYRO_SCALE));
    }
}

#[test]
fn scale_and_misalignment_have_their_deviation() {
    let errors = only(|errors, reference| errors.accel.scale = reference.accel.scale);
    let (accel, _) = parts(&errors, 1.0, 1, 4000, &moving([100.0, 0.0, 0.0], [0.0; 3]));
    assert_deviation(&accel, 3e-3 * 100.0);
    let errors = only(|errors, reference| errors.accel.misalignment = reference.accel.misalignment);
    let (accel, _) = parts(&errors, 1.0, 1, 4000, &moving([0.0, 0.0, 100.0], [0.0; 3]));
    assert_deviation(&accel, 0.3 * DEGREE * 100.0);
}

#[test]
fn the_bias_follows_the_temperature() {
    let errors = only(|errors, reference| {
        errors.accel.per_kelvin = reference.accel.per_kelvin;
        errors.warming = reference.warming;
    });
    let (cold, _) = parts(&errors, 1.0, 1, 10, &at_rest());
    assert!(cold.iter().all(|force| force.abs() < 0.5 / ACCEL_SCALE));
    let (warm, _) = parts(&errors, 1.0, 3000, 4000, &at_rest());
    let rounding = 1.0 / ACCEL_SCALE / ACCEL_SCALE / 12.0;
    let wanted = 0.15e-3 * GRAVITY * 10.0;
    assert_deviation(&warm, (wanted * wanted + rounding).sqrt());
    let mut part = Inertial::new(&errors, 1.0, 1);
    let last = (0..=300).map(|_| part.sample(&at_rest())).last().unwrap();
    let wanted = 10.0 * (1.0 - libm::exp(-1.0)) * TEMPERATURE_SCALE;
    assert!((f64::from(last.temperature) - wanted).abs() <= 0.5);
}

/// RMS of the accelerometer's and the gyroscope's first axis, over parts and time.
fn vibration(rate: f64, speed: [f64; 4]) -> (f64, f64) {
    let errors = InertialErrors {
        warming: InertialErrors::ideal().warming,
        accel: TriadErrors {
            vibration: 3.0,
            bandwidth: Some(258.0),
            ..TriadErrors::IDEAL
        },
        gyro: TriadErrors {
            vibration: 0.03,
            bandwidth: Some(258.0),
            ..TriadErrors::IDEAL
        },
        ..InertialErrors::ideal()
    };
    let truth = Truth {
        rotor_speed: speed,
        ..at_rest()
    };
    let (mut accel, mut gyro) = (vec![], vec![]);
    for seed in 0..20 {
        let mut part = Inertial::new(&errors, rate, seed);
        for n in 0..10_000 {
            let measured = part.sample(&truth);
            if n > 100 {
                accel.push(f64::from(measured.accel[0]) / ACCEL_SCALE);
                gyro.push(f64::from(measured.gyro[0]) / GYRO_SCALE);
            }
        }
    }
    (moments(&accel).1.sqrt(), moments(&gyro).1.sqrt())
}

#[test]
fn vibration_has_its_amplitude_and_passes_the_filter() {
    let hover = 557.0;
    let apart = |speed: f64| [0.98, 0.99, 1.01, 1.02].map(|share| share * speed);
    for (rate, speed) in [(1000.0, hover), (4000.0, hover), (4000.0, 2.91 * hover)] {
        let hz = speed / core::f64::consts::TAU;
        let low_pass = 1.0 / (1.0 + libm::pow(hz / 258.0, 4.0)).sqrt();
        let wanted = libm::pow(speed / hover, 2.0) * low_pass;
        let (accel, gyro) = vibration(rate, apart(speed));
        assert!(
            (accel / 3.0 / wanted - 1.0).abs() < 0.02,
            "{rate} {speed} {accel}"
        );
        assert!((gyro / 0.03 / wanted - 1.0).abs() < 0.02, "{rate} {speed} {gyro}");
    }
    assert_eq!(
        vibration(1000.0, [0.0; 4]),
        (0.0, 0.0),
        "standing rotors shake nothing"
    );
}

#[test]
fn vibration_is_at_the_rotors_frequencies() {
    let errors = only(|errors, _| errors.accel.vibration = 3.0);
    let speed = [440.0, 500.0, 560.0, 620.0];
    let truth = Truth {
        rotor_speed: speed,
        ..at_rest()
    };
    let mut part = Inertial::new(&errors, 1000.0, 3);
    let values: Vec<f64> = (0..20_000)
        .map(|_| f64::from(part.sample(&truth).accel[1]) / ACCEL_SCALE)
        .collect();
    let amplitude = |omega: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (n, value) in values.iter().enumerate() {
            let (s, c) = libm::sincos(omega * n as f64 * 1e-3);
            re += value * c * 2.0 / values.len() as f64;
            im += value * s * 2.0 / values.len() as f64;
        }
        libm::hypot(re, im)
    };
    for omega in speed {
        // Imbalance: the square of the speed. 3 m/s² RMS are four tones with a peak of 3/√2.
        let wanted = 3.0 * core::f64::consts::FRAC_1_SQRT_2 * (omega / 557.0) * (omega / 557.0);
        assert!((amplitude(omega) / wanted - 1.0).abs() < 0.02, "{omega}");
        assert!(amplitude(omega + 30.0) < 0.02, "nothing between the tones");
    }
}

#[test]
fn the_filter_delays_the_motion() {
    let errors = only(|errors, _| errors.gyro.bandwidth = Some(258.0));
    let mut part = Inertial::new(&errors, 4000.0, 1);
    // A ramp comes out late by √2/(2π·258 Hz) = 0.872 ms.
    let (mut read, mut rate) = (0.0, 0.0);
    for n in 0..1000 {
        rate = f64::from(n) * 0.02;
        read = f64::from(part.sample(&moving([0.0; 3], [rate, 0.0, 0.0])).gyro[0]) / GYRO_SCALE;
    }
    let late = (rate - read) / (0.02 * 4000.0);
    assert!((late - 0.872e-3).abs() < 0.02e-3, "{late}");
}

#[test]
fn a_turned_part_reads_turned_counts() {
    let errors = only(|errors, _| errors.mounting = Mounting([[0, -1, 0], [1, 0, 0], [0, 0, 1]]));
    let mut part = Inertial::new(&errors, 1000.0, 1);
    let measured = part.sample(&moving([GRAVITY, 0.0, 0.0], [0.0, 10.0 * DEGREE, 0.0]));
    assert_eq!((measured.accel, measured.gyro), ([0, -2048, 0], [164, 0, 0]));
}

#[test]
fn equal_seeds_give_equal_counts() {
    let run = |seed| {
        let mut part = Inertial::new(&InertialErrors::default(), 1000.0, seed);
        let truth = Truth {
            rotor_speed: [500.0, 510.0, 520.0, 530.0],
            ..at_rest()
        };
        (0..1000).map(|_| part.sample(&truth)).collect::<Vec<_>>()
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
}
