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
    ("os4 windhover simple 1000 Hz", "e6a1a59ec6788182"),
    ("os4 windhover simple 4000 Hz", "17e32888d66908dd"),
    ("os4 windhover paper 1000 Hz", "80bc7d98355e6e12"),
    ("os4 windhover paper 4000 Hz", "c7f0279b6737041c"),
    ("os4 windhover rigid 1000 Hz", "75341fac6e29545d"),
    ("os4 windhover rigid 4000 Hz", "d14143e33dee7c28"),
    ("x450 paper simple 1000 Hz", "eae45c308f848e59"),
    ("x450 paper simple 4000 Hz", "e139b93ee82c618c"),
    ("x450 paper paper 1000 Hz", "374d8b5dcbb3df02"),
    ("x450 paper paper 4000 Hz", "0ec011d7672d3acb"),
    ("x450 paper rigid 1000 Hz", "4c4d34a3bfa7bfac"),
    ("x450 paper rigid 4000 Hz", "ad7b2dcb88c7276c"),
    ("x450 windhover simple 1000 Hz", "5341b4b1951c491e"),
    ("x450 windhover simple 4000 Hz", "316b468d518d646d"),
    ("x450 windhover paper 1000 Hz", "49e305ff810d4cf6"),
    ("x450 windhover paper 4000 Hz", "ceb92030fde3e469"),
    ("x450 windhover rigid 1000 Hz", "3ad79c027741454b"),
    ("x450 windhover rigid 4000 Hz", "f6297dd3066cd3e2"),
    ("rk4", "68b47218a0414329"),
    ("disrupted 1000 Hz", "433f19d475e6c101"),
    ("disrupted 4000 Hz", "c4a5bbc17d06f526"),
    ("monitoring.plan", "58c88c3537a80bec"),
    ("os4 on sensors 1000 Hz", "fb0d1a9cc44ba575"),
    ("os4 on sensors 4000 Hz", "d8e249dd41a0a302"),
    ("x450 on sensors 1000 Hz", "f04f6f719ba02da7"),
    ("x450 on sensors 4000 Hz", "fd60a8ffbf536357"),
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
