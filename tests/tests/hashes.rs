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
    ("os4 paper simple 1000 Hz", "6f2f09bcea33a054"),
    ("os4 paper simple 4000 Hz", "2d740e859276e676"),
    ("os4 paper paper 1000 Hz", "043a42f87397ae03"),
    ("os4 paper paper 4000 Hz", "ab7bef7dc16d65b4"),
    ("os4 paper rigid 1000 Hz", "b93bb01aa4ffcb43"),
    ("os4 paper rigid 4000 Hz", "354631fd6fdd7589"),
    ("os4 windhover simple 1000 Hz", "d0f9194b85c0f55d"),
    ("os4 windhover simple 4000 Hz", "d190f1ec8d9c1c99"),
    ("os4 windhover paper 1000 Hz", "c84d4018d30f395e"),
    ("os4 windhover paper 4000 Hz", "cbc5f187ef518f79"),
    ("os4 windhover rigid 1000 Hz", "bb6eb229379704b1"),
    ("os4 windhover rigid 4000 Hz", "23ff821271f8588d"),
    ("x450 paper simple 1000 Hz", "dd1a95eb90a79d1f"),
    ("x450 paper simple 4000 Hz", "75fa55503b4e0711"),
    ("x450 paper paper 1000 Hz", "c188e31fba3c095e"),
    ("x450 paper paper 4000 Hz", "85d56d6a0bb4130b"),
    ("x450 paper rigid 1000 Hz", "ab383ce97a9c5088"),
    ("x450 paper rigid 4000 Hz", "7665c710b2d118c8"),
    ("x450 windhover simple 1000 Hz", "4050d3d7e1778a23"),
    ("x450 windhover simple 4000 Hz", "a3cfdd06e2c37a7d"),
    ("x450 windhover paper 1000 Hz", "b2ec9fa9c9bf72fb"),
    ("x450 windhover paper 4000 Hz", "a2e974e7188bdf32"),
    ("x450 windhover rigid 1000 Hz", "dc10f0cca0a31637"),
    ("x450 windhover rigid 4000 Hz", "326c3e7abcea0ccb"),
    ("rk4", "d770736b27e5b65f"),
    ("disrupted 1000 Hz", "1b86981f8a259983"),
    ("disrupted 4000 Hz", "b39f4b485af29b09"),
    ("monitoring.plan", "58d84d1caf9627a5"),
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
