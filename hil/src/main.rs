//! The program `windhover-hil`: flies the firmware, as it is flashed, on an emulated board.

mod options;

use std::io::IsTerminal;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use windhover_hil::figures::Figures;
use windhover_hil::flight::{Flight, FlightError};
use windhover_hil::serve::logs::Logs;
use windhover_hil::serve::memory::Memory;
use windhover_hil::serve::{Ended, Service, serve};
use windhover_sim::sitl::net::Net;
use windhover_sim::terminal::{FlightBar, say, until_interrupted};

use options::Cli;

fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(good) => ExitCode::from(u8::from(!good)),
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

/// Flies; whether all went well. The error is one line for the user.
fn run(cli: &Cli) -> Result<bool, String> {
    let plan = cli.plan()?;
    let mut flight = Flight::new(cli.elf()?, &plan).map_err(|e| e.to_string())?;
    let memory = match &cli.flash {
        Some(file) => Some(Memory::load(file, &mut flight.machine)?),
        None => None,
    };
    match cli.service() {
        Some(service) => run_served(cli, &service, flight, memory),
        None => run_alone(cli, flight, memory),
    }
}

/// The flight by itself.
fn run_alone(cli: &Cli, mut flight: Flight, memory: Option<Memory>) -> Result<bool, String> {
    let begin = Instant::now();
    let bar = FlightBar::new(cli.json || !std::io::stderr().is_terminal());
    let flown = flight.fly(|share| bar.show(share));
    let wall = begin.elapsed().as_secs_f64();
    bar.finish();
    for line in &flight.lines {
        eprintln!("{line}");
    }
    if let Some(mut memory) = memory {
        memory.store(&flight.machine)?;
    }
    let log = flight.flight_log();
    let mut logs = Logs::create(&cli.out)?;
    logs.write(&log)?;
    logs.finish()?;
    let outcome = match flown {
        Ok(outcome) => outcome,
        Err(FlightError::Stop(stop)) => {
            eprintln!("the firmware did what it must not: {stop}");
            return Ok(false);
        }
        Err(error) => return Err(error.to_string()),
    };
    let figures = Figures::new(&mut flight, outcome, &log, wall);
    show(cli, &figures);
    Ok(figures.replays() && figures.outcome.stopped)
}

/// The flight of ground stations.
fn run_served(
    cli: &Cli,
    service: &Service,
    mut flight: Flight,
    mut memory: Option<Memory>,
) -> Result<bool, String> {
    // Whoever reads the first line may connect at once.
    let mut net = Net::open(service.udp, service.tcp)?;
    let stop = until_interrupted()?;
    let mut logs = Logs::create(&cli.out)?;
    let begin = Instant::now();
    if flight.has_to_prepare() {
        flight.prepare().map_err(|e| e.to_string())?;
        // Nobody was there to hear it.
        flight.machine.bus().wiring.take_answers();
    }
    greet(cli, service);
    let ended = serve(
        &mut flight,
        &mut net,
        service,
        &mut logs,
        memory.as_mut(),
        &stop,
        &mut |line| eprintln!("{line}"),
    )?;
    let wall = begin.elapsed().as_secs_f64();
    tell_end(&ended, &logs);
    let earlier = logs.finish()?;
    for log in earlier {
        eprintln!("log of an earlier start: {}", log.display());
    }
    let log = std::fs::read(&cli.out).map_err(|e| format!("{}: {e}", cli.out.display()))?;
    let figures = Figures::new(&mut flight, ended.outcome, &log, wall);
    show(cli, &figures);
    Ok(ended.well && behaves(&flight) && figures.replays())
}

/// One line when stations may come; on stdout, unless only figures are to be there.
fn greet(cli: &Cli, service: &Service) {
    let name = |address: Option<std::net::SocketAddr>| address.map_or("none".into(), |to| to.to_string());
    let line = format!(
        "windhover-hil: {} on the emulated board, UDP to {}, TCP at {}, speed {}, Ctrl-C ends it",
        cli.vehicle,
        name(service.udp),
        name(service.tcp),
        service.speed
    );
    if cli.json {
        eprintln!("{line}");
    } else {
        say(&line);
    }
}

fn tell_end(ended: &Ended, logs: &Logs) {
    let counts = &ended.counts;
    eprintln!("{}", ended.why);
    eprintln!(
        "to the board {} packets and frames, {} more lost; from it {} frames, {} not taken by a station; \
         {} bytes of no frame; {} logs not kept",
        counts.up, counts.lost, counts.down, ended.untaken, counts.noise, logs.dropped
    );
}

/// So much that was done against a data sheet is told.
const SHOWN: usize = 20;

/// Whether the firmware used its sensors as their data sheets say; what it did otherwise is told.
fn behaves(flight: &Flight) -> bool {
    let bus = flight.machine.bus();
    let imu = bus.wiring.imu_misuse().iter().map(|misuse| format!("{misuse:?}"));
    let parts = bus.wiring.part_misuse();
    let parts = parts.iter().map(|misuse| format!("{misuse:?}"));
    let all: Vec<String> = imu.chain(parts).collect();
    for misuse in all.iter().take(SHOWN) {
        eprintln!("against the data sheet: {misuse}");
    }
    all.is_empty()
}

/// The figures, for people or for programs.
fn show(cli: &Cli, figures: &Figures) {
    if cli.json {
        println!("{}", figures.json());
    } else {
        say(&format!(
            "{}log                   {}",
            figures.text(),
            cli.out.display()
        ));
    }
}
