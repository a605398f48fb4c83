//! Tests of the battery, most of them against a pack that drains.

use proptest::prelude::*;
use windhover_parameters::Group;

use super::*;

/// Time between two samples, µs.
const STEP: u32 = 100_000;

/// V of a cell at rest at 0, 5, …, 100 % of its charge: the table of `windhover-model`.
const CELL: [f32; 21] = [
    3.27, 3.61, 3.69, 3.71, 3.73, 3.75, 3.77, 3.79, 3.80, 3.82, 3.84, 3.85, 3.87, 3.91, 3.95, 3.98, 4.02,
    4.08, 4.11, 4.15, 4.20,
];

/// Four cells of 5 A·h and 5 mΩ, and what is wrong with the measurement.
struct Pack {
    charge: f32,
    resistance: f32,
    voltage_scale: f32,
    current_scale: f32,
    time: u64,
}

impl Pack {
    fn at(charge: f32) -> Self {
        Self {
            charge,
            resistance: 0.02,
            voltage_scale: 1.0,
            current_scale: 1.0,
            time: 0,
        }
    }

    fn open_circuit(&self) -> f32 {
        let place = self.charge.clamp(0.0, 1.0) * 20.0;
        let below = core::cmp::min(place as usize, 19);
        4.0 * (CELL[below] + (place - below as f32) * (CELL[below + 1] - CELL[below]))
    }

    fn draw(&mut self, current: f32) -> BatterySample {
        self.time += u64::from(STEP);
        self.charge -= current * 0.1 / 18_000.0;
        let voltage = self.open_circuit() - self.resistance * current;
        sample(
            self.time,
            voltage * self.voltage_scale,
            current * self.current_scale,
        )
    }
}

fn sample(time: u64, voltage: f32, current: f32) -> BatterySample {
    BatterySample {
        time,
        voltage: (voltage / 11.0 / 3.3 * 4095.0 + 0.5) as u16,
        current: (current / 25.0 / 3.3 * 4095.0 + 0.5) as u16,
    }
}

/// Draws for so many seconds.
fn run(battery: &mut Battery, pack: &mut Pack, parameters: &BatteryParameters, current: f32, seconds: u32) {
    for _ in 0..seconds * 10 {
        battery.step(&[pack.draw(current)], parameters, STEP);
    }
}

/// The true charge when low, critical and emergency are first said, at a hover of 15 A with a
/// climb of 40 A and 3 s every minute until little is left.
fn discharge(mut pack: Pack, parameters: &BatteryParameters) -> [f32; 3] {
    let mut battery = Battery::default();
    let mut found = [0.0; 3];
    for step in 0_u32.. {
        let climb = step % 600 >= 570 && pack.charge > 0.4;
        battery.step(&[pack.draw(if climb { 40.0 } else { 15.0 })], parameters, STEP);
        for (place, level) in found
            .iter_mut()
            .zip([Charge::Low, Charge::Critical, Charge::Emergency])
        {
            if *place == 0.0 && battery.charge() >= level {
                *place = pack.charge;
            }
        }
        if pack.charge <= 0.0 {
            break;
        }
    }
    found
}

fn voltage_alone() -> BatteryParameters {
    BatteryParameters {
        capacity: -1.0,
        ..Default::default()
    }
}

/// A level that comes late is a vehicle that falls; one that comes far too early is a flight that is cut
/// short, and so is one that a climb brings.
#[test]
fn levels_come_at_their_charge_or_a_little_before() {
    for parameters in [BatteryParameters::default(), voltage_alone()] {
        let found = discharge(Pack::at(1.0), &parameters);
        for (place, level) in found.into_iter().zip([0.25, 0.12, 0.06]) {
            assert!((-0.03..=0.10).contains(&(place - level)), "{found:?}");
        }
    }
}

/// With the errors of cheap parts a full battery is still not low too late, nor much too early: the
/// count helps where the voltage reads high. It cannot help a battery that was half full at the start:
/// there a hundredth of the voltage is a fifth of the charge. A battery that holds less than it says
/// is caught by its voltage; the count alone would be far too late.
#[test]
fn low_is_not_late_with_errors_of_the_parts() {
    for (voltage_scale, current_scale) in [(1.01, 1.03), (1.01, 0.97), (0.99, 1.03), (0.99, 0.97)] {
        for charge in [1.0, 0.5] {
            let pack = Pack {
                voltage_scale,
                current_scale,
                ..Pack::at(charge)
            };
            let [low, ..] = discharge(pack, &BatteryParameters::default());
            let late = if charge < 1.0 { -0.10 } else { -0.03 };
            let off = low - 0.25;
            assert!(
                (late..=0.12).contains(&off),
                "{voltage_scale} {current_scale} {charge}: {low}"
            );
        }
    }
    let overstated = BatteryParameters {
        capacity: 7000.0,
        ..Default::default()
    };
    let [low, ..] = discharge(Pack::at(1.0), &overstated);
    assert!((-0.03..=0.10).contains(&(low - 0.25)), "{low}");
}

/// A climb must not bring a level, though the resistance is half as large again as is set.
#[test]
fn a_load_step_makes_no_level_with_a_wrong_resistance() {
    let parameters = voltage_alone();
    let mut pack = Pack {
        resistance: 0.03,
        ..Pack::at(0.46)
    };
    let mut battery = Battery::default();
    let mut least = 1.0;
    run(&mut battery, &mut pack, &parameters, 15.0, 20);
    for current in [40.0; 30].into_iter().chain([15.0; 100]) {
        battery.step(&[pack.draw(current)], &parameters, STEP);
        least = min(battery.remaining().unwrap(), least);
        assert_eq!(battery.charge(), Charge::Enough);
    }
    assert!(least < parameters.low, "the test tests nothing: {least}");
}

/// A level that came and went with every gust would be a failsafe that came and went.
#[test]
fn a_level_is_left_only_with_clearly_more() {
    let parameters = voltage_alone();
    let mut battery = Battery::default();
    let mut pack = Pack::at(0.24);
    let mut at = |charge, seconds| {
        pack.charge = charge;
        run(&mut battery, &mut pack, &parameters, 0.0, seconds);
        battery.charge()
    };
    assert_eq!(at(0.40, 2), Charge::Enough);
    assert_eq!(at(0.20, 20), Charge::Low);
    assert_eq!(at(0.29, 60), Charge::Low);
    assert_eq!(at(0.35, 20), Charge::Enough);
    assert_eq!(at(0.02, 20), Charge::Emergency);
    assert_eq!(at(0.10, 60), Charge::Emergency);
    assert_eq!(at(0.30, 60), Charge::Low);
}

/// A deep sag that has only begun must not be an emergency at once because it was low for long enough.
#[test]
fn a_level_must_itself_last() {
    let parameters = voltage_alone();
    let mut battery = Battery::default();
    run(&mut battery, &mut Pack::at(0.40), &parameters, 0.0, 10);
    let mut pack = Pack {
        time: 10_000_000,
        ..Pack::at(0.0)
    };
    while battery.charge() == Charge::Enough {
        run(&mut battery, &mut pack, &parameters, 0.0, 1);
    }
    assert!(battery.remaining().unwrap() < parameters.emergency);
    assert_eq!(battery.charge(), Charge::Low);
    run(&mut battery, &mut pack, &parameters, 0.0, 5);
    assert_eq!(battery.charge(), Charge::Emergency);
}

/// Without a sensor nothing is known, which is not the same as a battery that never was; and what was
/// drawn during the silence is not forgotten.
#[test]
fn a_silent_sensor_is_unknown_and_not_forgotten() {
    let parameters = BatteryParameters::default();
    let mut battery = Battery::default();
    battery.step(&[], &parameters, 60_000_000);
    assert!(!battery.was_seen() && battery.charge() == Charge::Unknown);
    let mut pack = Pack::at(1.0);
    run(&mut battery, &mut pack, &parameters, 10.0, 60);
    battery.step(&[], &parameters, 2_000_000);
    assert_eq!(battery.charge(), Charge::Enough);
    battery.step(&[], &parameters, 1);
    assert!(battery.was_seen() && battery.charge() == Charge::Unknown);
    let said = (
        battery.voltage(),
        battery.current(),
        battery.open_circuit(),
        battery.remaining(),
    );
    assert_eq!(said, (None, None, None, None));
    assert_eq!(battery.seconds_left(0.0), None);
    pack.time += 59_900_000;
    battery.step(&[pack.draw(10.0)], &parameters, STEP);
    assert_eq!(battery.charge(), Charge::Enough);
    assert!((battery.drawn() - 1200.0).abs() < 3.0, "{}", battery.drawn());
}

/// An hour of little current at a high rate: a sum of floats would lose a part of it.
#[test]
fn little_by_little_adds_up() {
    let parameters = BatteryParameters::default();
    let mut battery = Battery::default();
    let first = sample(0, 16.0, 0.3);
    let amperes = f32::from(first.current) * ADC_SCALE * parameters.per_volt;
    for n in 0..=900_000_u64 {
        battery.step(
            &[BatterySample {
                time: n * 4000,
                ..first
            }],
            &parameters,
            4000,
        );
    }
    let share = battery.drawn() / (amperes * 3600.0);
    assert!((share - 1.0).abs() < 2e-3, "{share}");
}

/// All counts: what cannot be is refused and counted, and moves nothing.
#[test]
fn impossible_samples_are_refused() {
    let parameters = BatteryParameters::default();
    let mut battery = Battery::default();
    battery.step(&[sample(1, 16.0, 10.0)], &parameters, STEP);
    for count in 0..=u16::MAX {
        let mut after = battery;
        let voltage = f32::from(count) * ADC_SCALE * 11.0;
        let good = count < 4095 && (4.0..=20.0).contains(&voltage);
        let new = BatterySample {
            time: 2,
            voltage: count,
            current: 0,
        };
        after.step(&[new], &parameters, 0);
        assert_eq!(after.refused() == 0, good, "{count} counts of voltage");
        assert_eq!(after.measured == battery.measured, !good);
        let mut after = battery;
        let new = BatterySample {
            current: count,
            ..sample(2, 16.0, 0.0)
        };
        after.step(&[new], &parameters, 0);
        assert_eq!(after.refused() == 0, count < 4095, "{count} counts of current");
    }
    // a sample twice, or one from before
    battery.step(&[sample(1, 16.0, 10.0), sample(0, 16.0, 10.0)], &parameters, STEP);
    assert_eq!(battery.refused(), 2);
}

/// How far the vehicle gets home hangs on it: charge over current, and a take-off shows within half a
/// minute.
#[test]
fn time_left_is_charge_over_current() {
    let parameters = BatteryParameters::default();
    let mut battery = Battery::default();
    let mut pack = Pack::at(1.0);
    run(&mut battery, &mut pack, &parameters, 0.0, 60);
    assert_eq!(battery.seconds_left(0.0), None);
    run(&mut battery, &mut pack, &parameters, 15.0, 30);
    let truth = |pack: &Pack, reserve| (pack.charge - reserve) * 18_000.0 / 15.0;
    let left = battery.seconds_left(0.2).unwrap();
    assert!((1.0..1.2).contains(&(left / truth(&pack, 0.2))), "{left}");
    run(&mut battery, &mut pack, &parameters, 15.0, 60);
    let left = battery.seconds_left(0.2).unwrap();
    assert!((left / truth(&pack, 0.2) - 1.0).abs() < 0.02, "{left}");
    assert_eq!(battery.seconds_left(1.0), Some(0.0));
    assert_eq!(battery.seconds_left(f32::NAN), Some(0.0));
    battery.step(&[pack.draw(15.0)], &voltage_alone(), STEP);
    assert_eq!(battery.seconds_left(0.0), None);
}

/// A pack of three cells does not leave the ground below 10.5 V.
#[test]
fn a_flat_pack_blocks_arming() {
    let parameters = BatteryParameters {
        cells: 3.0,
        ..Default::default()
    };
    for (voltage, blocks) in [(10.3, true), (10.45, true), (10.55, false), (12.6, false)] {
        let mut battery = Battery::default();
        assert!(!battery.is_too_low_to_arm(&parameters));
        battery.step(&[sample(0, voltage, 0.5)], &parameters, STEP);
        assert_eq!(battery.is_too_low_to_arm(&parameters), blocks, "{voltage}");
    }
}

/// Without a battery to watch nothing is known and nothing blocks.
#[test]
fn no_cells_no_battery() {
    let parameters = BatteryParameters {
        cells: 0.0,
        ..Default::default()
    };
    let mut battery = Battery::default();
    run(&mut battery, &mut Pack::at(0.5), &parameters, 15.0, 5);
    assert_eq!(battery, Battery::default());
    assert!(!battery.is_too_low_to_arm(&parameters));
}

proptest! {
    /// Any samples at any parameters that can be set: a share is a share, and a level is known exactly
    /// while a share is.
    #[test]
    fn what_is_known_is_a_share(
        shares in prop::collection::vec(0.0_f32..=1.0, BatteryParameters::DECLARATIONS.len()),
        inputs in prop::collection::vec((any::<u16>(), 0_u16..4100, 0_u64..3_000_000), 1..50),
    ) {
        let mut parameters = BatteryParameters::default();
        for (index, (d, share)) in BatteryParameters::DECLARATIONS.iter().zip(shares).enumerate() {
            *parameters.get_mut(index).unwrap() = (d.min + share * (d.max - d.min)).clamp(d.min, d.max);
        }
        let mut battery = Battery::default();
        let mut time = 0;
        for (voltage, current, dt) in inputs {
            time += dt;
            battery.step(&[BatterySample { time, voltage, current }], &parameters, dt as u32);
            prop_assert!(battery.remaining().is_none_or(|share| (0.0..=1.0).contains(&share)));
            prop_assert_eq!(battery.remaining().is_none(), battery.charge() == Charge::Unknown);
            prop_assert!(battery.seconds_left(0.1).is_none_or(|left| left.is_finite() && left >= 0.0));
        }
    }
}
