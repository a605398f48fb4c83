//! How fast a flight is simulated: core and world together, on one core of this machine.
//!
//! One step is one tick: world, ideal IMU, inner loop at 1 kHz, and every fourth time the outer
//! loop. Beside it stand figures of other programs, measured for comparison elsewhere.

use std::path::Path;
use std::time::Instant;

use windhover_model::{Integrator, ModelKind, Vehicle};
use windhover_sim::closed_loop::ClosedLoop;
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file;

const MISSION: &[u8] = include_bytes!("../../../missions/monitoring.plan");
const STEPS: u32 = 150_000;
const RUNS: usize = 15;

/// Closed-loop simulation by others, one core, steps per second.
const PEERS: &[(&str, &str)] = &[
    (
        "Crazyflie's PID in C + rigid body, semi-implicit Euler 1 kHz, gcc -O3",
        "6.5 million",
    ),
    ("l2f with policy, one vehicle", "51 thousand"),
    ("crazyflow (JAX), Mellinger, one vehicle", "15.8 to 281 thousand"),
    ("PyFlyt", "7 thousand"),
    ("rotorpy, SE3", "0.5 to 0.9 thousand"),
];

fn main() {
    println!("closed loop, million steps per second (median of {RUNS} runs; best)");
    for (integrator, name) in [
        (Integrator::SemiImplicitEuler, "semi-implicit Euler"),
        (Integrator::Rk4, "Runge-Kutta 4"),
    ] {
        for (model, model_name) in [(ModelKind::Rigid, "rigid"), (ModelKind::Paper, "paper")] {
            let setup = Setup {
                integrator,
                model,
                ..Setup::reference(vehicle())
            };
            let (median, best) = measure(&setup);
            println!("  {model_name:6} {name:20} {median:6.2}  {best:6.2}");
        }
    }
    println!("others, steps per second:");
    for (name, figure) in PEERS {
        println!("  {name}: {figure}");
    }
}

fn vehicle() -> Vehicle {
    Vehicle::named("os4").expect("a built-in vehicle")
}

/// Median and best of million steps per second over a mission's first minutes.
fn measure(setup: &Setup) -> (f64, f64) {
    let mission = mission_file::read_bytes(Path::new("monitoring.plan"), MISSION).expect("our own mission");
    let start = flight::under_way(setup, &mission).expect("our own mission and vehicle");
    let mut rates: Vec<f64> = (0..RUNS).map(|_| run(start.clone())).collect();
    rates.sort_by(f64::total_cmp);
    (rates[RUNS / 2], rates[RUNS - 1])
}

fn run(mut flown: ClosedLoop) -> f64 {
    let start = Instant::now();
    for _ in 0..STEPS {
        flown.tick(&mut ());
    }
    assert!(flown.world.crash().is_none());
    assert!(-flown.world.truth().position.z > 20.0, "it flies");
    f64::from(STEPS) / start.elapsed().as_secs_f64() / 1e6
}
