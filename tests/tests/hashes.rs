//! Debug and release builds, and all machines, fly the same bits: each must give the hashes below.
//!
//! This file is compiled in every profile that tests are run in (`cargo test`, `cargo test
//! --release`). A change of gains, equations or missions changes the hashes: then the test prints
//! the new table; put it here in the commit of that change. A build, a compiler or a machine that
//! gives other hashes with the same sources is an error, never a reason to change the table.

use rayon::prelude::*;
use windhover_autopilot::Preset;
use windhover_model::{Integrator, ModelKind};
use windhover_sim::closed_loop::Disruption;
use windhover_sim::flight::Setup;
use windhover_sim::sensors::Sensors;
use windhover_tests::plan::short;
use windhover_tests::{monitoring, recorded, setup, write};

#[rustfmt::skip]
const HASHES: &[(&str, &str)] = &[
    ("os4 paper simple 1000 Hz", "4b1cad92ba3f3adc"),
    ("os4 paper simple 4000 Hz", "86c5e3200bbb18cf"),
    ("os4 paper paper 1000 Hz", "19df59fdb191c3e5"),
    ("os4 paper paper 4000 Hz", "8d41925fe3fb57e6"),
    ("os4 paper rigid 1000 Hz", "773ae903850662b4"),
    ("os4 paper rigid 4000 Hz", "84edfc1d775665f3"),
    ("os4 windhover simple 1000 Hz", "82e0900ebc6258e9"),
    ("os4 windhover simple 4000 Hz", "fc95b94f0b1436dd"),
    ("os4 windhover paper 1000 Hz", "ae2b384b4e44ffcd"),
    ("os4 windhover paper 4000 Hz", "7a466cb8a102cd9b"),
    ("os4 windhover rigid 1000 Hz", "3af864a01c631e04"),
    ("os4 windhover rigid 4000 Hz", "aae48a642e8b69c8"),
    ("x450 paper simple 1000 Hz", "4c716eeef566056e"),
    ("x450 paper simple 4000 Hz", "7f0ca92318517366"),
    ("x450 paper paper 1000 Hz", "f2efeff6ddc8f67f"),
    ("x450 paper paper 4000 Hz", "fdb9629a6b23ed4f"),
    ("x450 paper rigid 1000 Hz", "56e015ecb0ffafdd"),
    ("x450 paper rigid 4000 Hz", "012fa00eabacebbe"),
    ("x450 windhover simple 1000 Hz", "a3a333fd77b84535"),
    ("x450 windhover simple 4000 Hz", "dfa1987716b6ce7e"),
    ("x450 windhover paper 1000 Hz", "04663be19c0b90d7"),
    ("x450 windhover paper 4000 Hz", "53ed5a6d7de00657"),
    ("x450 windhover rigid 1000 Hz", "92b36b1adabbc231"),
    ("x450 windhover rigid 4000 Hz", "0e246c618d4a435e"),
    ("rk4", "82eb350b209a21df"),
    ("disrupted 1000 Hz", "fdcb6b546a06ced7"),
    ("disrupted 4000 Hz", "1896349c36e5120d"),
    ("monitoring.plan", "dbc61f54f647882f"),
    ("os4 on sensors 1000 Hz", "78051426200b76f1"),
    ("os4 on sensors 4000 Hz", "d875dc3ab4516e64"),
    ("x450 on sensors 1000 Hz", "00c5f6ac56ca49f3"),
    ("x450 on sensors 4000 Hz", "91a82dfa7b28f200"),
];

fn disrupted(rate: u32) -> Setup {
    Setup {
        imu_rate: rate,
        disruption: Some(Disruption::new(5, 0.2, 6, 0.01, 6)),
        writes: vec![
            (12.0, write("POS_N_P", 7.0)),
            (14.0, write("RATE_TILT_P", f32::NAN)),
        ],
        ..setup("os4", Preset::Windhover, ModelKind::Rigid)
    }
}

/// The short mission with every vehicle, preset and model, at 1 and 4 kHz; and some others.
fn flights() -> Vec<(String, String)> {
    let mut wanted = vec![];
    for vehicle in ["os4", "x450"] {
        for (preset_name, preset) in [("paper", Preset::Paper), ("windhover", Preset::Windhover)] {
            for (model_name, model) in [
                ("simple", ModelKind::Simple),
                ("paper", ModelKind::Paper),
                ("rigid", ModelKind::Rigid),
            ] {
                for rate in [1000, 4000] {
                    let setup = Setup {
                        imu_rate: rate,
                        ..setup(vehicle, preset, model)
                    };
                    let name = format!("{vehicle} {preset_name} {model_name} {rate} Hz");
                    wanted.push((name, setup, short()));
                }
            }
        }
    }
    let reference = setup("os4", Preset::Windhover, ModelKind::Rigid);
    let by_rk4 = Setup {
        integrator: Integrator::Rk4,
        ..reference.clone()
    };
    wanted.push(("rk4".into(), by_rk4, short()));
    wanted.push(("disrupted 1000 Hz".into(), disrupted(1000), short()));
    wanted.push(("disrupted 4000 Hz".into(), disrupted(4000), short()));
    wanted.push(("monitoring.plan".into(), reference, monitoring()));
    for vehicle in ["os4", "x450"] {
        for rate in [1000, 4000] {
            let on_sensors = Setup {
                imu_rate: rate,
                sensors: Some(Sensors::default()),
                ..setup(vehicle, Preset::Windhover, ModelKind::Rigid)
            };
            wanted.push((format!("{vehicle} on sensors {rate} Hz"), on_sensors, short()));
        }
    }
    let fly = |(name, setup, mission)| {
        let figures = recorded(&setup, &mission).0.figures;
        assert!(figures.completed, "{name}: {}", figures.ended);
        (name, figures.motor_hash)
    };
    wanted.into_par_iter().map(fly).collect()
}

#[test]
fn every_build_flies_the_same_bits() {
    let flown = flights();
    let table: String = flown
        .iter()
        .map(|(name, hash)| format!("    (\"{name}\", \"{hash}\"),\n"))
        .collect();
    let equal = flown.len() == HASHES.len()
        && flown
            .iter()
            .zip(HASHES)
            .all(|(flown, table)| (flown.0.as_str(), flown.1.as_str()) == *table);
    assert!(equal, "hashes differ from the table; the new one:\n{table}");
}
