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
    ("os4 paper simple 1000 Hz", "0197330c1a4da4fc"),
    ("os4 paper simple 4000 Hz", "fec7f782b13eec05"),
    ("os4 paper paper 1000 Hz", "2aedcb4e616c95ef"),
    ("os4 paper paper 4000 Hz", "ce2ec340e3e60901"),
    ("os4 paper rigid 1000 Hz", "5141608278074699"),
    ("os4 paper rigid 4000 Hz", "b2975dc32cb66a20"),
    ("os4 windhover simple 1000 Hz", "a4a151c563e348e0"),
    ("os4 windhover simple 4000 Hz", "28e2a0083abbac1a"),
    ("os4 windhover paper 1000 Hz", "3fe2ebe69d73c3f3"),
    ("os4 windhover paper 4000 Hz", "bd5b2daeaa410c57"),
    ("os4 windhover rigid 1000 Hz", "c701018d9e1d83af"),
    ("os4 windhover rigid 4000 Hz", "67b98bcbc36d69fd"),
    ("x450 paper simple 1000 Hz", "eae45c308f848e59"),
    ("x450 paper simple 4000 Hz", "e139b93ee82c618c"),
    ("x450 paper paper 1000 Hz", "374d8b5dcbb3df02"),
    ("x450 paper paper 4000 Hz", "0ec011d7672d3acb"),
    ("x450 paper rigid 1000 Hz", "4c4d34a3bfa7bfac"),
    ("x450 paper rigid 4000 Hz", "ad7b2dcb88c7276c"),
    ("x450 windhover simple 1000 Hz", "66a4f74c8bb55fff"),
    ("x450 windhover simple 4000 Hz", "a0f9cd33a588525d"),
    ("x450 windhover paper 1000 Hz", "60f1b04b5ba945d5"),
    ("x450 windhover paper 4000 Hz", "a3d9203126e46f12"),
    ("x450 windhover rigid 1000 Hz", "1eee551b5d3ebe20"),
    ("x450 windhover rigid 4000 Hz", "32634f744291bbaf"),
    ("rk4", "7e17f4020bb5e25d"),
    ("disrupted 1000 Hz", "b0100387a2b7dd6b"),
    ("disrupted 4000 Hz", "fa2b729d5338a60d"),
    ("monitoring.plan", "0bf1a72b9802d619"),
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
