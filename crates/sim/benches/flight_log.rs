//! What the flight log costs, and how fast a log is replayed.
//!
//! Apart from the closed loop's benchmark, since a second recorder in one program would change how
//! the compiler arranges the first.

use std::path::Path;
use std::time::Instant;

use windhover_autopilot::{Command, Mode};
use windhover_flight_log::reader::Log;
use windhover_model::Vehicle;
use windhover_sim::closed_loop::{ClosedLoop, Recorder};
use windhover_sim::flight::{self, Setup};
use windhover_sim::flight_log::FlightLog;
use windhover_sim::mission_file;
use windhover_sim::replay::replay;

const MISSION: &[u8] = include_bytes!("../../../missions/monitoring.plan");
const STEPS: u32 = 150_000;
const RUNS: usize = 15;

fn main() {
    let setup = Setup::reference(Vehicle::named("os4").expect("a built-in vehicle"));
    let mission = mission_file::read_bytes(Path::new("monitoring.plan"), MISSION).expect("our own mission");
    let start = flight::ready(&setup, &mission).expect("our own mission and vehicle");
    let (parameters, home) = (*start.outer().parameters(), flight::home(&mission));
    let log = || FlightLog::new(&setup, &parameters, home, &mission.stored(), &[]);
    // In turn, so that a change of the machine's speed meets both.
    let mut shares: Vec<f64> = (0..RUNS)
        .map(|_| 1.0 - run(start.clone(), &mut log()) / run(start.clone(), &mut ()))
        .collect();
    shares.sort_by(f64::total_cmp);
    println!("the log costs {:.1} % of the speed", shares[RUNS / 2] * 100.0);
    let mut logged = log();
    run(start, &mut logged);
    let bytes = logged.finish(&[], &[]);
    let log = Log::open(&bytes).expect("our own log");
    let begin = Instant::now();
    let replayed = replay(&log).expect("our own log");
    assert_eq!(replayed.difference, None);
    let speed = replayed.seconds / begin.elapsed().as_secs_f64();
    println!("a log is replayed at {speed:.0} times real time");
}

/// Million steps per second over a mission's first minutes.
fn run<R: Recorder>(mut flown: ClosedLoop, recorder: &mut R) -> f64 {
    let start = Instant::now();
    for step in 0..STEPS {
        // The plans are taken in before the mission is chosen.
        if step == 8 {
            for command in [Command::Fly(Mode::Mission), Command::Arm] {
                flown.mailboxes.queues.command.push(command);
            }
        }
        flown.tick(recorder);
    }
    assert!(flown.world.crash().is_none());
    assert!(-flown.world.truth().position.z > 20.0, "it flies");
    f64::from(STEPS) / start.elapsed().as_secs_f64() / 1e6
}
