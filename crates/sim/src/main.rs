//! The program `windhover`: flies missions on the desktop.

mod again;
mod options;
mod output;
mod station;

use std::io::IsTerminal;
use std::process::ExitCode;
use std::time::Instant;

use windhover_sim::flight::{self, Flight};
use windhover_sim::flight_log::FlightLog;
use windhover_sim::terminal::FlightBar;

use options::{Fly, Invocation};

fn main() -> ExitCode {
    let outcome = match options::parse() {
        Invocation::Fly(fly) => run(&fly),
        Invocation::Sitl(sitl) => station::run(&sitl),
        Invocation::Replay(replay) => again::replay(&replay),
        Invocation::Report(report) => output::report(&report.log, report.out.as_deref()).map(|to| {
            println!("report: {}", to.display());
            true
        }),
        Invocation::Say { text, code } => {
            if code == 0 {
                print!("{text}");
            } else {
                eprintln!("{text}");
            }
            return ExitCode::from(code);
        }
    };
    match outcome {
        Ok(good) => ExitCode::from(u8::from(!good)),
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

/// Flies one mission; whether it was completed. The error is one line for the user.
fn run(fly: &Fly) -> Result<bool, String> {
    let request = fly.request()?;
    let (setup, mission) = (&request.setup, &request.mission);
    let loaded = flight::closed_loop(setup, mission).map_err(|e| request.explain(&e))?;
    let mut log = FlightLog::new(
        setup,
        loaded.outer().parameters(),
        flight::home(mission),
        &mission.stored(),
        &output::conditions(&request),
    );
    let quiet = fly.json || !std::io::stderr().is_terminal();
    let bar = FlightBar::new(quiet);
    let start = Instant::now();
    let flown = flight::fly(setup, mission, &mut log, &mut |share| {
        bar.show(share);
    });
    let wall = start.elapsed().as_secs_f64();
    bar.finish();
    let mut flown: Flight = flown.map_err(|e| request.explain(&e))?;
    flown.figures.speed_factor = flown.simulated / windhover_math::max(wall, 1e-9);
    flown.figures.log_bytes_per_s = log.rate(flown.simulated);
    let files = output::write(fly, &request, &flown, log)?;
    if fly.json {
        println!("{}", output::json(&flown.figures));
    } else {
        print!("{}", output::text(&request, &flown, &files));
    }
    Ok(flown.figures.completed)
}
