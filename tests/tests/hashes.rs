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
    ("os4 paper simple 1000 Hz", "6abce8116f440544"),
    ("os4 paper simple 4000 Hz", "abdfe8cd5c3d7c5f"),
    ("os4 paper paper 1000 Hz", "99f52100b667a803"),
    ("os4 paper paper 4000 Hz", "05605a7a4ae7dc5b"),
    ("os4 paper rigid 1000 Hz", "d9ea69c1c719d019"),
    ("os4 paper rigid 4000 Hz", "1cadda03e9fdd6b0"),
    ("os4 windhover simple 1000 Hz", "430960521d26842e"),
    ("os4 windhover simple 4000 Hz", "2418365da3d0c063"),
    ("os4 windhover paper 1000 Hz", "fff2d24cbf14ca10"),
    ("os4 windhover paper 4000 Hz", "3212f4f493971bd4"),
    ("os4 windhover rigid 1000 Hz", "0e7cd9e9d309d314"),
    ("os4 windhover rigid 4000 Hz", "499e9158470fc26e"),
    ("x450 paper simple 1000 Hz", "52938178cfc07d51"),
    ("x450 paper simple 4000 Hz", "d29d069b46b9f6d5"),
    ("x450 paper paper 1000 Hz", "cb7478255f7a25de"),
    ("x450 paper paper 4000 Hz", "e884a92ce0da49af"),
    ("x450 paper rigid 1000 Hz", "b3e7b1128cd587a4"),
    ("x450 paper rigid 4000 Hz", "6fd211eb8408d503"),
    ("x450 windhover simple 1000 Hz", "45946e16a35e241a"),
    ("x450 windhover simple 4000 Hz", "79110c2355216030"),
    ("x450 windhover paper 1000 Hz", "1faba857e4016b43"),
    ("x450 windhover paper 4000 Hz", "0d099411241069ae"),
    ("x450 windhover rigid 1000 Hz", "4389ff46f034e42a"),
    ("x450 windhover rigid 4000 Hz", "a83fc3f5c27d628a"),
    ("rk4", "9252a4a73b2dfa67"),
    ("disrupted 1000 Hz", "23ba305e420e14b3"),
    ("disrupted 4000 Hz", "b78405517e7f5446"),
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
