//! The battery's sensors.

use proptest::prelude::*;
use windhover_model::Truth;
use windhover_model::sensor::battery::{
    Battery, BatteryCounts, BatteryErrors, CURRENT_SCALE, Pack, VOLTAGE_SCALE,
};

use crate::{assert_deviation, at_rest};

fn drawing(power: f64, energy: f64) -> Truth {
    Truth {
        power,
        energy,
        ..at_rest()
    }
}

proptest! {
    #[test]
    fn voltage_and_current_give_the_power(charge in 0.0_f64..1.0, power in 0.0_f64..2000.0) {
        let pack = Pack::default();
        let (voltage, current) = pack.under_load(charge, power);
        prop_assert!((voltage * current - power).abs() < 1e-9 * power + 1e-9);
        prop_assert!((voltage + current * pack.resistance - pack.open_circuit(charge)).abs() < 1e-9);
    }
}

#[test]
fn the_open_circuit_voltage_rises_with_the_charge() {
    let pack = Pack::default();
    let volts: Vec<f64> = (-10..=1010)
        .map(|n| pack.open_circuit(f64::from(n) * 1e-3))
        .collect();
    assert!(volts.windows(2).all(|pair| pair[0] <= pair[1]));
    assert_eq!(
        (pack.open_circuit(0.0), pack.open_circuit(1.0)),
        (4.0 * 3.27, 4.0 * 4.20)
    );
    assert!(
        (pack.open_circuit(0.525) - 4.0 * 3.845).abs() < 1e-9,
        "between two points"
    );
}

#[test]
fn more_than_the_battery_has_halves_its_voltage() {
    let pack = Pack::default();
    let (voltage, current) = pack.under_load(1.0, 1e9);
    assert_eq!((voltage, current), (8.4, 8.4 / 0.020));
    let ideal = Pack {
        resistance: 0.0,
        ..pack
    };
    assert_eq!(ideal.under_load(1.0, 168.0), (16.8, 10.0));
}

#[test]
fn counts_are_those_of_the_boards_dividers() {
    // 16.8 V / 11 of 3.3 V, and 10 A / 25 of 3.3 V, in 4095 counts.
    let pack = Pack {
        resistance: 0.0,
        avionics: 0.0,
        ..Pack::default()
    };
    let mut battery = Battery::new(&pack, &BatteryErrors::ideal(), 1);
    let counts = battery.measure(&drawing(168.0, 0.0), 0);
    assert_eq!(
        counts,
        BatteryCounts {
            voltage: 1895,
            current: 496
        }
    );
    assert!((VOLTAGE_SCALE - 112.81).abs() < 0.01 && (CURRENT_SCALE - 49.64).abs() < 0.01);
    // 90 A are more than the ADC can show.
    assert_eq!(battery.measure(&drawing(90.0 * 16.8, 0.0), 0).current, 4095);
}

#[test]
fn charge_is_what_was_drawn_at_any_rate() {
    let after_half = |period_us: u64| {
        let mut battery = Battery::new(&Pack::default(), &BatteryErrors::ideal(), 1);
        let mut counts = BatteryCounts::default();
        for time in (0..=1_200_000_000_u64).step_by(period_us as usize) {
            counts = battery.measure(&drawing(145.0, 145.0 * time as f64 * 1e-6), time);
        }
        (battery.charge(), counts)
    };
    // 150 W at about 15.4 V for 20 minutes are 3.25 A·h of 5.
    let (charge, counts) = after_half(100_000);
    assert!((charge - 0.35).abs() < 0.02, "{charge}");
    let volts = f64::from(counts.voltage) / VOLTAGE_SCALE;
    assert!(
        (volts - (4.0 * 3.79 - 150.0 / 15.0 * 0.020)).abs() < 0.1,
        "{volts}"
    );
    let (coarse, _) = after_half(1_000_000);
    assert!((charge - coarse).abs() < 1e-4);
}

#[test]
fn an_empty_battery_stays_at_its_end() {
    let mut battery = Battery::new(&Pack::default(), &BatteryErrors::ideal(), 1);
    battery.measure(&drawing(0.0, 0.0), 0);
    battery.measure(&drawing(0.0, 1e9), 1_000_000);
    assert_eq!(battery.charge(), 0.0);
}

#[test]
fn errors_have_their_deviation() {
    let errors = BatteryErrors {
        noise: 0.0,
        ..BatteryErrors::default()
    };
    let truth = drawing(500.0, 0.0);
    let (volts, amperes) = Pack::default().under_load(1.0, 505.0);
    let counts: Vec<BatteryCounts> = (0..4000)
        .map(|seed| Battery::new(&Pack::default(), &errors, seed).measure(&truth, 0))
        .collect();
    let voltage: Vec<f64> = counts
        .iter()
        .map(|c| f64::from(c.voltage) / VOLTAGE_SCALE)
        .collect();
    let current: Vec<f64> = counts
        .iter()
        .map(|c| f64::from(c.current) / CURRENT_SCALE)
        .collect();
    assert_deviation(&voltage, 0.01 * volts);
    assert_deviation(&current, libm::hypot(0.03 * amperes, 0.2));
    let noise = BatteryErrors {
        noise: 2.0,
        ..BatteryErrors::ideal()
    };
    let mut battery = Battery::new(&Pack::default(), &noise, 1);
    let voltage: Vec<f64> = (0..4000)
        .map(|_| f64::from(battery.measure(&truth, 0).voltage))
        .collect();
    assert_deviation(&voltage, (4.0_f64 + 1.0 / 12.0).sqrt());
}
