//! Equal seeds give equal bits: twice, and whatever the number of threads.

use rayon::prelude::*;
use windhover_autopilot::{MotorCommand, Preset};
use windhover_model::ModelKind;
use windhover_sim::closed_loop::Disruption;
use windhover_sim::flight::{Flight, Setup};
use windhover_sim::recording::Recording;
use windhover_tests::plan::short;
use windhover_tests::{monitoring, recorded, seeded, setup};

fn reference() -> Setup {
    setup("os4", Preset::Windhover, ModelKind::Rigid)
}

/// Everything that two flights have in common if they are equal, to the last bit.
fn assert_equal(a: &(Flight, Recording), b: &(Flight, Recording)) {
    assert_eq!(a.1.motors(), b.1.motors(), "motor commands");
    assert_eq!(a.0.figures, b.0.figures, "figures");
    assert_eq!(a.0.positions, b.0.positions, "true positions");
    assert_eq!(a.0.simulated.to_bits(), b.0.simulated.to_bits(), "time");
}

#[test]
fn a_flight_flown_twice_is_the_same_flight() {
    let mission = monitoring();
    let (first, second) = (recorded(&reference(), &mission), recorded(&reference(), &mission));
    assert_equal(&first, &second);
}

/// Late results and missing samples are drawn from the seed too.
#[test]
fn a_disrupted_flight_flown_twice_is_the_same_flight() {
    let disrupted = Setup {
        disruption: Some(Disruption::new(9, 0.2, 4, 0.01, 5)),
        ..reference()
    };
    assert_equal(&recorded(&disrupted, &short()), &recorded(&disrupted, &short()));
}

/// The seed reaches the gusts, and the gusts reach the motors.
#[test]
fn another_seed_is_another_flight() {
    let hashes: Vec<String> = (1..=8)
        .into_par_iter()
        .map(|seed| {
            recorded(&seeded(&reference(), seed), &short())
                .0
                .figures
                .motor_hash
        })
        .collect();
    for (n, hash) in hashes.iter().enumerate() {
        assert!(!hashes[..n].contains(hash), "seed {} repeats a flight", n + 1);
    }
}

/// Pools of 1, 2 and 4 threads fly the same flights.
#[test]
fn the_number_of_threads_does_not_matter() {
    let missions: Vec<(u64, Preset)> = (1..=6)
        .flat_map(|seed| [(seed, Preset::Windhover), (seed, Preset::Paper)])
        .collect();
    let fly = |threads: usize| -> Vec<Vec<MotorCommand>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let flights = missions.par_iter().map(|&(seed, preset)| {
                let setup = seeded(&setup("x450", preset, ModelKind::Rigid), seed);
                recorded(&setup, &short()).1.motors().to_vec()
            });
            flights.collect()
        })
    };
    let one = fly(1);
    assert!(
        one.iter().all(|motors| motors.len() > 10_000),
        "flights, not nothing"
    );
    assert_eq!(one, fly(2), "two threads");
    assert_eq!(one, fly(4), "four threads");
}

/// The hash in the figures is the hash of what was recorded: it hashes nothing else.
#[test]
fn the_hash_is_that_of_the_recorded_motor_commands() {
    let (flight, recording) = recorded(&reference(), &short());
    let mut hash = windhover_sim::figures::MotorHash::default();
    recording.motors().iter().for_each(|&command| hash.add(command));
    assert_eq!(flight.figures.motor_hash, hash.to_string());
}
