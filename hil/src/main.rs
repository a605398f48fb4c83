//! The program `windhover-hil`: flies the firmware, as it is flashed, on an emulated board.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use windhover_hil::elf::Elf;
use windhover_hil::figures::Figures;
use windhover_hil::flight::{Flight, FlightError, Plan};
use windhover_hil::parts::rc::Protocol;
use windhover_hil::rig::fault::Fault;
use windhover_hil::trouble::{Slow, Trouble};
use windhover_model::sensor::gnss::GnssSite;
use windhover_model::sensor::suite::SensorSuite;
use windhover_model::{Conditions, Vehicle, mean_wind_from};
use windhover_sim::sensors::Sensors;
use windhover_sim::terminal::{FlightBar, read_vehicle};

/// Where `cargo firmware` puts the firmware.
const FIRMWARE: &str = "target/thumbv7em-none-eabihf/firmware/windhover-firmware";

/// Fly the firmware, as it is flashed, on an emulated board: it boots, arms, holds commanded
/// attitudes, and disarms. Its log is written and replayed on the desktop.
///
/// Ends with 0 when the firmware did nothing that it must not, the motors stand still in the end,
/// and the replay of the log is equal bit for bit; with 1 otherwise; with 2 when it could not fly.
#[derive(Debug, Parser)]
#[command(name = "windhover-hil", version)]
struct Cli {
    /// The firmware [default: what `cargo firmware` builds]
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// How long attitudes are held, in s of virtual time
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    seconds: f64,
    /// Vehicle: os4, x450, or a vehicle file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "os4")]
    vehicle: String,
    /// Mean wind in m/s and the direction in degrees that it comes from
    #[arg(long, value_name = "SPEED,FROM_DEG", default_value = "0,0", value_parser = wind, allow_hyphen_values = true)]
    wind: (f64, f64),
    /// Standard deviation of the gusts in m/s
    #[arg(long, value_name = "M_PER_S", default_value_t = 0.0)]
    gust: f64,
    /// What is random follows from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// A parameter that is stored before the flight, as IMU_GYRO_RATEMAX=4000; may be repeated
    #[arg(long = "parameter", value_name = "NAME=VALUE", value_parser = parameter)]
    parameters: Vec<(String, f32)>,
    /// Fly on all sensors of the board, with the errors of real ones; without, the inertial ones are
    /// ideal and nothing else is on the pins
    #[arg(long)]
    sensors: bool,
    /// A remote control's receiver among the sensors: crsf or sbus
    #[arg(long, value_name = "PROTOCOL", value_parser = protocol, requires = "sensors")]
    remote: Option<Protocol>,
    /// A fault on the pins, as imu-unplugged@5+0.3 or data-ready-random; may be repeated
    #[arg(long = "fault", value_name = "NAME[@START[+DURATION]]")]
    faults: Vec<Fault>,
    /// Trouble inside the processor, as outer-spins@8 or panics@5; may be repeated
    #[arg(long = "trouble", value_name = "NAME@START")]
    troubles: Vec<Trouble>,
    /// Slow the outer step by up to so many ms each time
    #[arg(long, value_name = "MS")]
    slow_outer: Option<f64>,
    /// Write the flight's log there
    #[arg(long, value_name = "FILE.ulg", default_value = "target/hil.ulg")]
    out: PathBuf,
    /// Print the figures as one JSON object, and nothing else, on stdout
    #[arg(long)]
    json: bool,
}

fn wind(text: &str) -> Result<(f64, f64), String> {
    let numbers = text
        .split_once(',')
        .map(|(speed, from)| (speed.parse(), from.parse()));
    match numbers {
        Some((Ok(speed), Ok(from))) if (0.0..=50.0).contains(&speed) && f64::is_finite(from) => {
            Ok((speed, from))
        }
        _ => Err("two numbers are wanted: speed in m/s, 0 to 50, and direction in degrees".into()),
    }
}

fn parameter(text: &str) -> Result<(String, f32), String> {
    let (name, value) = text.split_once('=').ok_or("NAME=VALUE is wanted")?;
    let value = value.parse().map_err(|_| format!("{value} is no number"))?;
    Ok((name.into(), value))
}

fn protocol(text: &str) -> Result<Protocol, String> {
    match text {
        "crsf" => Ok(Protocol::Crsf),
        "sbus" => Ok(Protocol::Sbus),
        _ => Err("there are crsf and sbus".into()),
    }
}

fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(good) => ExitCode::from(u8::from(!good)),
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn plan(cli: &Cli) -> Result<Plan, String> {
    if !(1.0..=86_400.0).contains(&cli.seconds) {
        return Err(format!("--seconds {}: 1 to 86400 are possible", cli.seconds));
    }
    let mut plan = Plan::calm(read_vehicle(&cli.vehicle)?, cli.seconds);
    plan.conditions = Conditions {
        wind: mean_wind_from(cli.wind.0, cli.wind.1),
        gust: cli.gust,
        seed: cli.seed,
        ..plan.conditions
    };
    plan.rig.sensors = cli.sensors.then(|| sensors(&plan.vehicle, cli));
    plan.rig.remote = cli.remote;
    if !cli.sensors && cli.faults.iter().any(|fault| fault.kind.is_of_sensors()) {
        return Err("faults of other than the inertial sensors and of I2C need --sensors".into());
    }
    plan.rig.faults = cli.faults.clone();
    plan.rig.seed = cli.seed;
    plan.rig.record_every = 0;
    plan.troubles = cli.troubles.clone();
    plan.slow = cli.slow_outer.map(|ms| Slow {
        most: ms * 1e-3,
        share: 1.0,
        seed: cli.seed,
    });
    for (name, value) in &cli.parameters {
        plan = plan
            .with_parameter(name, *value)
            .ok_or_else(|| format!("--parameter {name}={value}: no such parameter, or out of its range"))?;
    }
    Ok(plan)
}

/// All sensors, at the home of the mission for monitoring.
fn sensors(vehicle: &Vehicle, cli: &Cli) -> SensorSuite {
    let rate = cli.parameters.iter().find(|(name, _)| name == "IMU_GYRO_RATEMAX");
    let rate = rate.map_or(1000, |(_, rate)| *rate as u32).max(1);
    let home = GnssSite::default().home;
    Sensors::default().suite(vehicle, home, rate, cli.seed)
}

/// Flies; whether all went well. The error is one line for the user.
fn run(cli: &Cli) -> Result<bool, String> {
    let plan = plan(cli)?;
    let file = cli.elf.clone().unwrap_or_else(|| FIRMWARE.into());
    let elf = Elf::load(&file).map_err(|e| format!("{}: {e}; `cargo firmware` builds it", file.display()))?;
    let mut flight = Flight::new(Arc::new(elf), &plan).map_err(|e| e.to_string())?;
    let begin = Instant::now();
    let bar = FlightBar::new(cli.json || !std::io::stderr().is_terminal());
    let flown = flight.fly(|share| bar.show(share));
    let wall = begin.elapsed().as_secs_f64();
    bar.finish();
    for line in &flight.lines {
        eprintln!("{line}");
    }
    let log = flight.flight_log();
    if let Some(folder) = cli.out.parent() {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    std::fs::write(&cli.out, &log).map_err(|e| format!("{}: {e}", cli.out.display()))?;
    let outcome = match flown {
        Ok(outcome) => outcome,
        Err(FlightError::Stop(stop)) => {
            eprintln!("the firmware did what it must not: {stop}");
            return Ok(false);
        }
        Err(error) => return Err(error.to_string()),
    };
    let figures = Figures::new(&mut flight, outcome, &log, wall);
    if cli.json {
        println!("{}", figures.json());
    } else {
        println!("{}log                   {}", figures.text(), cli.out.display());
    }
    Ok(figures.replays() && figures.outcome.stopped)
}
