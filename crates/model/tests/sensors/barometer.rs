//! The barometer.

use proptest::prelude::*;
use windhover_math::Vector3;
use windhover_model::sensor::barometer::{Barometer, BarometerCounts, BarometerErrors, atmosphere};
use windhover_model::sensor::spl06::{Coefficients, Formula, Oversampling};
use windhover_model::{GRAVITY, Truth};

use crate::{assert_deviation, at_rest, moments};

const PERIOD_US: u64 = 20_000;
const HOME: f64 = 488.0;

/// Each with its kP and kT (data sheet: compensation scale factors).
const OVERSAMPLING: [(Oversampling, f64); 8] = [
    (Oversampling::X1, 524_288.0),
    (Oversampling::X2, 1_572_864.0),
    (Oversampling::X4, 3_670_016.0),
    (Oversampling::X8, 7_864_320.0),
    (Oversampling::X16, 253_952.0),
    (Oversampling::X32, 516_096.0),
    (Oversampling::X64, 1_040_384.0),
    (Oversampling::X128, 2_088_960.0),
];

/// The formula as a driver writes it, from the data sheet, apart from the model's.
fn compensate(raw: BarometerCounts, k_p: f64, k_t: f64) -> (f64, f64) {
    let c = Coefficients::default();
    let p = f64::from(raw.pressure) / k_p;
    let t = f64::from(raw.temperature) / k_t;
    let pressure = f64::from(c.c00)
        + f64::from(c.c10) * p
        + f64::from(c.c20) * p * p
        + f64::from(c.c30) * p * p * p
        + f64::from(c.c01) * t
        + f64::from(c.c11) * t * p
        + f64::from(c.c21) * t * p * p;
    (pressure, f64::from(c.c0) * 0.5 + f64::from(c.c1) * t)
}

/// Height in m above the origin of a result with eight and one samples: the standard atmosphere
/// inverted.
fn height(raw: BarometerCounts) -> f64 {
    let (pressure, _) = compensate(raw, 7_864_320.0, 524_288.0);
    let ratio = libm::pow(pressure / 101_325.0, 287.052_87 * 0.0065 / GRAVITY);
    288.15 / 0.0065 * (1.0 - ratio) - HOME
}

fn part(errors: &BarometerErrors, seed: u64) -> Barometer {
    Barometer::new(errors, Formula::default(), HOME, PERIOD_US, seed)
}

proptest! {
    #[test]
    fn the_data_sheets_formula_gives_the_pressure_back(
        pascal in 30_000.0_f64..110_000.0,
        celsius in -40.0_f64..85.0,
        pressure in 0..8_usize,
        temperature in 0..8_usize,
    ) {
        let ((pressure, k_p), (temperature, k_t)) = (OVERSAMPLING[pressure], OVERSAMPLING[temperature]);
        let formula = Formula { pressure, temperature, ..Formula::default() };
        let raw_temperature = formula.raw_temperature(celsius);
        let raw = BarometerCounts {
            pressure: formula.raw_pressure(pascal, raw_temperature),
            temperature: raw_temperature,
        };
        let (p, t) = compensate(raw, k_p, k_t);
        // Half a count of each, with the steepest slope in the part's range.
        prop_assert!((p - pascal).abs() <= 0.6 * 80_000.0 / k_p, "{} Pa", p - pascal);
        prop_assert!((t - celsius).abs() <= 0.51 * 261.0 / k_t, "{} K", t - celsius);
        prop_assert!((formula.pressure(raw.pressure, raw.temperature) - p).abs() < 1e-6);
        prop_assert!((formula.temperature(raw.temperature) - t).abs() < 1e-9);
    }

    #[test]
    fn without_errors_the_height_is_the_truth(down in -500.0_f64..100.0, speed in -20.0_f64..20.0) {
        let truth = Truth {
            position: Vector3::new(0.0, 0.0, down),
            velocity: Vector3::new(speed, 0.0, 0.0),
            ..at_rest()
        };
        let found = height(part(&BarometerErrors::ideal(), 1).measure(&truth));
        prop_assert!((found + down).abs() < 1e-3, "{} at {}", found, -down);
    }
}

#[test]
fn the_atmosphere_is_the_standards() {
    // ISO 2533, tables 5: heights in geopotential metres.
    for (height, kelvin, pascal, density) in [
        (0.0, 288.15, 101_325.0, 1.225),
        (1000.0, 281.65, 89_874.6, 1.111_64),
        (5000.0, 255.65, 54_019.9, 0.736_116),
    ] {
        let (t, p, d) = atmosphere(height);
        assert!((t - kelvin).abs() < 1e-9);
        assert!((p - pascal).abs() < 0.1, "{p}");
        assert!((d - density).abs() < 1e-5, "{d}");
    }
}

#[test]
fn noise_has_its_deviation_and_is_white() {
    let errors = BarometerErrors {
        noise: 0.1,
        ..BarometerErrors::ideal()
    };
    let mut part = part(&errors, 1);
    let heights: Vec<f64> = (0..8000).map(|_| height(part.measure(&at_rest()))).collect();
    assert_deviation(&heights, 0.1);
    assert!(moments(&heights).0.abs() < 4.0 * 0.1 / 8000.0_f64.sqrt());
    let steps: Vec<f64> = heights.chunks_exact(2).map(|pair| pair[1] - pair[0]).collect();
    assert_deviation(&steps, 0.1 * core::f64::consts::SQRT_2);
}

#[test]
fn drift_grows_as_the_root_of_time() {
    let errors = BarometerErrors {
        drift_per_hour: 0.3,
        ..BarometerErrors::ideal()
    };
    let (mut quarter, mut hour) = (vec![], vec![]);
    for seed in 0..4000 {
        // A result every ten seconds.
        let mut part = Barometer::new(&errors, Formula::default(), HOME, 10_000_000, seed);
        for n in 0..=360 {
            let found = part.measure(&at_rest());
            if n == 90 {
                quarter.push(height(found));
            }
            if n == 360 {
                hour.push(height(found));
            }
        }
    }
    assert_deviation(&quarter, 0.15);
    assert_deviation(&hour, 0.3);
}

#[test]
fn dammed_up_air_lowers_the_height() {
    let errors = BarometerErrors {
        pressure_coefficient: 0.10,
        ..BarometerErrors::ideal()
    };
    let in_wind = |velocity: [f64; 3], wind: [f64; 3]| {
        let truth = Truth {
            velocity: Vector3::from(velocity),
            wind: Vector3::from(wind),
            ..at_rest()
        };
        height(part(&errors, 1).measure(&truth))
    };
    // 0.10 · ½ρv² / (ρg) = 0.10 · 100/(2·9.81) m
    let wanted = -0.10 * 100.0 / (2.0 * GRAVITY);
    assert!((in_wind([10.0, 0.0, 0.0], [0.0; 3]) - wanted).abs() < 1e-3);
    assert!((in_wind([0.0; 3], [6.0, -8.0, 0.0]) - wanted).abs() < 1e-3);
    assert!(
        in_wind([4.0, 2.0, 0.0], [4.0, 2.0, 0.0]).abs() < 1e-3,
        "with the wind"
    );
}

#[test]
fn the_part_is_warmer_than_the_air() {
    let mut part = part(&BarometerErrors::default(), 1);
    let raw = part.measure(&at_rest());
    let (_, celsius) = compensate(raw, 7_864_320.0, 524_288.0);
    assert!((celsius - (15.0 - 0.0065 * HOME + 15.0)).abs() < 1e-3);
    assert_eq!(part.formula(), &Formula::default());
}

#[test]
fn raw_counts_stay_in_24_bits() {
    for pressure in OVERSAMPLING.map(|(o, _)| o) {
        let formula = Formula {
            pressure,
            ..Formula::default()
        };
        for pascal in [-1e9, 0.0, 1e9, f64::NAN] {
            let raw = formula.raw_pressure(pascal, formula.raw_temperature(25.0));
            assert!((-(1 << 23)..1 << 23).contains(&raw), "{raw}");
        }
        assert!((-(1 << 23)..1 << 23).contains(&formula.raw_temperature(1e9)));
    }
}

#[test]
fn the_slope_is_that_of_the_formula() {
    let formula = Formula::default();
    let t = formula.raw_temperature(25.0);
    let p = formula.raw_pressure(95_000.0, t);
    let step = formula.pressure(p + 1000, t) - formula.pressure(p - 1000, t);
    assert!((formula.pascal_per_count(p, t) / (step / 2000.0) - 1.0).abs() < 1e-6);
}

#[test]
fn equal_seeds_give_equal_counts() {
    let run = |seed| {
        let mut part = part(&BarometerErrors::default(), seed);
        (0..100).map(|_| part.measure(&at_rest())).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}
