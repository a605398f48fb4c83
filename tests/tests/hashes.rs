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
    ("os4 paper simple 1000 Hz", "e69cff55ec40e76f"),
    ("os4 paper simple 4000 Hz", "d22d2e2d52de4c10"),
    ("os4 paper paper 1000 Hz", "93ffe453be41ce65"),
    ("os4 paper paper 4000 Hz", "7993d5a1c2bc60eb"),
    ("os4 paper rigid 1000 Hz", "78e665ac0448c8c7"),
    ("os4 paper rigid 4000 Hz", "6be4e46eb940702b"),
    ("os4 windhover simple 1000 Hz", "9f4eb7b698a2bfb6"),
    ("os4 windhover simple 4000 Hz", "229edc46a398b836"),
    ("os4 windhover paper 1000 Hz", "49be6ad58527fbf9"),
    ("os4 windhover paper 4000 Hz", "39d578c6996d662c"),
    ("os4 windhover rigid 1000 Hz", "32ccdfe8dc7bd54c"),
    ("os4 windhover rigid 4000 Hz", "a0c077f8220d1a8f"),
    ("x450 paper simple 1000 Hz", "dd9c391db41f7a31"),
    ("x450 paper simple 4000 Hz", "60d947a42a897ae3"),
    ("x450 paper paper 1000 Hz", "03309bda84413f1e"),
    ("x450 paper paper 4000 Hz", "07fe65d9a9506a74"),
    ("x450 paper rigid 1000 Hz", "f481ef20f6846381"),
    ("x450 paper rigid 4000 Hz", "5e5d29411b0a4e70"),
    ("x450 windhover simple 1000 Hz", "fc4a9cdef4572ee9"),
    ("x450 windhover simple 4000 Hz", "6645726933c2cc91"),
    ("x450 windhover paper 1000 Hz", "5a03ad42698a90a6"),
    ("x450 windhover paper 4000 Hz", "7a81b6e3367a569c"),
    ("x450 windhover rigid 1000 Hz", "239d0b74c07ac4cf"),
    ("x450 windhover rigid 4000 Hz", "5a6a8639f1fbad4f"),
    ("rk4", "2ba14086273a5719"),
    ("disrupted 1000 Hz", "e37348f57e910c6d"),
    ("disrupted 4000 Hz", "9ffdb54330a45c73"),
    ("monitoring.plan", "d3cac3beb6b291f3"),
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
