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
use windhover_tests::plan::short;
use windhover_tests::{monitoring, recorded, setup, write};

#[rustfmt::skip]
const HASHES: &[(&str, &str)] = &[
    ("os4 paper simple 1000 Hz", "8f33ed8c0f55bd02"),
    ("os4 paper simple 4000 Hz", "9d64760383572cac"),
    ("os4 paper paper 1000 Hz", "44a7b272dbb48fe9"),
    ("os4 paper paper 4000 Hz", "2555934c69d728eb"),
    ("os4 paper rigid 1000 Hz", "c475fd010592ee26"),
    ("os4 paper rigid 4000 Hz", "1925773def7567b0"),
    ("os4 windhover simple 1000 Hz", "cb268e6e4e2e98a6"),
    ("os4 windhover simple 4000 Hz", "c1757cd9478604aa"),
    ("os4 windhover paper 1000 Hz", "96080c721c9600f0"),
    ("os4 windhover paper 4000 Hz", "9ad5a6ee17bd55c2"),
    ("os4 windhover rigid 1000 Hz", "daaea375b447155f"),
    ("os4 windhover rigid 4000 Hz", "92d180bc443e125a"),
    ("x450 paper simple 1000 Hz", "f9c6dd4449793ab9"),
    ("x450 paper simple 4000 Hz", "fe4cec29901d2fbc"),
    ("x450 paper paper 1000 Hz", "14f223c472007e01"),
    ("x450 paper paper 4000 Hz", "4a3472b295deda6c"),
    ("x450 paper rigid 1000 Hz", "93899511722f58fd"),
    ("x450 paper rigid 4000 Hz", "75c6c0c0fc803dcb"),
    ("x450 windhover simple 1000 Hz", "d86d627e499bc20a"),
    ("x450 windhover simple 4000 Hz", "d4093afa4709129a"),
    ("x450 windhover paper 1000 Hz", "dcc4f6389e1db24d"),
    ("x450 windhover paper 4000 Hz", "a644eb3f82a110f6"),
    ("x450 windhover rigid 1000 Hz", "9e6fc90d5e4c573d"),
    ("x450 windhover rigid 4000 Hz", "b5e13b6c964d2a9c"),
    ("rk4", "23355ed3672987f8"),
    ("disrupted 1000 Hz", "0c56b6ae7fface8a"),
    ("disrupted 4000 Hz", "4ef264037058d734"),
    ("monitoring.plan", "34829d4b9a9fa337"),
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
