//! The command line: what may be asked for, and what is wrong with what was asked for.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use windhover_hil::elf::Elf;
use windhover_hil::flight::Plan;
use windhover_hil::parts::rc::Protocol;
use windhover_hil::rig::fault::Fault;
use windhover_hil::serve::Service;
use windhover_hil::trouble::{Slow, Trouble};
use windhover_model::sensor::gnss::GnssSite;
use windhover_model::sensor::suite::SensorSuite;
use windhover_model::{Conditions, Vehicle, mean_wind_from};
use windhover_sim::sensors::Sensors;
use windhover_sim::terminal::read_vehicle;
use windhover_sim::values::{Endpoint, Listening};

/// Where `cargo firmware` puts the firmware.
const FIRMWARE: &str = "target/thumbv7em-none-eabihf/firmware/windhover-firmware";

/// Fly the firmware, as it is flashed, on an emulated board: it boots, arms, holds commanded
/// attitudes, and disarms; or, with --udp or --tcp, ground stations fly it. Its log is written and
/// replayed on the desktop.
///
/// Ends with 0 when the firmware did nothing that it must not, the motors stand still in the end
/// (unless ground stations fly), and the replay of the log is equal bit for bit; with 1 otherwise;
/// with 2 when it could not fly.
#[derive(Debug, Parser)]
#[command(name = "windhover-hil", version)]
pub struct Cli {
    /// The firmware [default: what `cargo firmware` builds]
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Let ground stations fly it, on all sensors: it speaks to this address by UDP first
    /// [default: none, without an address 127.0.0.1:14550]
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:14550")]
    udp: Option<Endpoint>,
    /// Let ground stations fly it, on all sensors: it listens there by TCP, on this machine alone
    /// unless a host is given [default: none, without a port 5760]
    #[arg(long, value_name = "[HOST:]PORT", num_args = 0..=1, default_missing_value = "5760")]
    tcp: Option<Listening>,
    /// Virtual seconds in one of the clock where ground stations fly, up to 100; 0 for as many as there
    /// can be
    #[arg(long, value_name = "X", default_value = "1", value_parser = speed)]
    speed: f64,
    /// A file for what the board's flash keeps: parameters, calibrations and plans are found there at
    /// the next start
    #[arg(long, value_name = "FILE")]
    pub flash: Option<PathBuf>,
    /// How long attitudes are held, or ground stations may fly, in s of virtual time
    /// [default: 60, for ground stations 0: until Ctrl-C]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Vehicle: os4, x450, or a vehicle file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "os4")]
    pub vehicle: String,
    /// Mean wind in m/s and the direction in degrees that it comes from
    /// [default: 0,0, for ground stations 4.47,206.6]
    #[arg(long, value_name = "SPEED,FROM_DEG", value_parser = wind, allow_hyphen_values = true)]
    wind: Option<(f64, f64)>,
    /// Standard deviation of the gusts in m/s [default: 0, for ground stations 1]
    #[arg(long, value_name = "M_PER_S")]
    gust: Option<f64>,
    /// What is random follows from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// A parameter that is stored before the flight, as IMU_GYRO_RATEMAX=4000; may be repeated
    #[arg(long = "parameter", value_name = "NAME=VALUE", value_parser = parameter)]
    parameters: Vec<(String, f32)>,
    /// Fly on all sensors of the board, with the errors of real ones, as ground stations do; without,
    /// the inertial ones are ideal and nothing else is on the pins
    #[arg(long)]
    sensors: bool,
    /// A remote control's receiver among the sensors: crsf or sbus
    #[arg(long, value_name = "PROTOCOL", value_parser = protocol)]
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
    pub out: PathBuf,
    /// Print the figures as one JSON object, and nothing else, on stdout
    #[arg(long)]
    pub json: bool,
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

fn speed(text: &str) -> Result<f64, String> {
    match text.trim_end_matches(['x', '×']).parse() {
        Ok(speed) if (0.0..=100.0).contains(&speed) => Ok(speed),
        _ => Err("a number from 0 to 100 is wanted".into()),
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

/// How long attitudes are held where nothing else is said, in s.
const HELD: f64 = 60.0;

impl Cli {
    /// The firmware. The error is one line.
    pub fn elf(&self) -> Result<Arc<Elf>, String> {
        let file = self.elf.clone().unwrap_or_else(|| FIRMWARE.into());
        let elf =
            Elf::load(&file).map_err(|e| format!("{}: {e}; `cargo firmware` builds it", file.display()))?;
        Ok(Arc::new(elf))
    }

    /// For whom it flies; `None` where it is not for ground stations.
    pub fn service(&self) -> Option<Service> {
        let (udp, tcp) = (self.udp.map(|to| to.0), self.tcp.and_then(|at| at.0));
        (udp.is_some() || tcp.is_some()).then(|| Service {
            udp,
            tcp,
            speed: self.speed,
            seconds: self.seconds.filter(|seconds| *seconds > 0.0),
        })
    }

    /// What is flown. The error is one line.
    pub fn plan(&self) -> Result<Plan, String> {
        let served = self.service().is_some();
        let seconds = self.seconds.unwrap_or(if served { 0.0 } else { HELD });
        if !((1.0..=86_400.0).contains(&seconds) || served && seconds == 0.0) {
            return Err(format!("--seconds {seconds}: 1 to 86400 are possible"));
        }
        let mut plan = Plan::calm(read_vehicle(&self.vehicle)?, seconds);
        plan.conditions = self.conditions(served)?;
        let with_sensors = served || self.sensors;
        plan.rig.sensors = with_sensors.then(|| self.suite(&plan.vehicle));
        plan.rig.remote = self.remote;
        if !with_sensors && self.remote.is_some() {
            return Err("--remote needs --sensors".into());
        }
        if !with_sensors && self.faults.iter().any(|fault| fault.kind.is_of_sensors()) {
            return Err("faults of other than the inertial sensors and of I2C need --sensors".into());
        }
        plan.rig.faults = self.faults.clone();
        plan.rig.seed = self.seed;
        plan.rig.record_every = 0;
        plan.troubles = self.troubles.clone();
        plan.slow = self.slow_outer.map(|ms| Slow {
            most: ms * 1e-3,
            share: 1.0,
            seed: self.seed,
        });
        for (name, value) in &self.parameters {
            plan = plan.with_parameter(name, *value).ok_or_else(|| {
                format!("--parameter {name}={value}: no such parameter, or out of its range")
            })?;
        }
        Ok(plan)
    }

    /// Wind as it is by default in this case, but for what was asked for.
    fn conditions(&self, served: bool) -> Result<Conditions, String> {
        let mut conditions = if served {
            Conditions::reference()
        } else {
            Conditions::default()
        };
        conditions.pushes.clear();
        conditions.seed = self.seed;
        if let Some((speed, from)) = self.wind {
            conditions.wind = mean_wind_from(speed, from);
        }
        if let Some(gust) = self.gust {
            conditions.gust = gust;
        }
        conditions.validate().map_err(|e| format!("--{e}"))?;
        Ok(conditions)
    }

    /// All sensors, at the home of the mission for monitoring.
    fn suite(&self, vehicle: &Vehicle) -> SensorSuite {
        let mut parameters = self.parameters.iter();
        let rate = parameters.find(|(name, _)| name == "IMU_GYRO_RATEMAX");
        let rate = rate.map_or(1000, |(_, rate)| *rate as u32).max(1);
        let home = GnssSite::default().home;
        Sensors::default().suite(vehicle, home, rate, self.seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cli(words: &str) -> Cli {
        let words = std::iter::once("windhover-hil").chain(words.split_whitespace());
        Cli::try_parse_from(words).unwrap()
    }

    #[test]
    fn the_command_line_is_consistent() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn ground_stations_fly_where_they_are_asked_for() {
        assert!(cli("--seconds 5").service().is_none());
        assert!(cli("--tcp 0").service().is_none(), "none is none");
        let service = cli("--udp --tcp --speed 0").service().unwrap();
        assert_eq!(service.udp.unwrap().to_string(), "127.0.0.1:14550");
        assert_eq!(service.tcp.unwrap().to_string(), "127.0.0.1:5760");
        assert_eq!((service.speed, service.seconds), (0.0, None));
        let service = cli("--udp 127.0.0.1:9 --seconds 7").service().unwrap();
        assert_eq!((service.tcp, service.seconds), (None, Some(7.0)));
    }

    #[test]
    fn stations_have_sensors_and_wind_unless_told_otherwise() {
        let (alone, served) = (cli("").plan().unwrap(), cli("--udp").plan().unwrap());
        assert!(alone.rig.sensors.is_none() && served.rig.sensors.is_some());
        assert_eq!((alone.seconds, alone.conditions.gust), (60.0, 0.0));
        let reference = Conditions::reference();
        assert_eq!(served.conditions.wind, reference.wind);
        assert_eq!(served.conditions.gust, reference.gust);
        assert!(served.conditions.pushes.is_empty());
        let calm = cli("--udp --wind 0,0 --gust 0").plan().unwrap();
        assert_eq!(
            (calm.conditions.wind, calm.conditions.gust),
            (mean_wind_from(0.0, 0.0), 0.0)
        );
    }

    #[test]
    fn what_cannot_be_is_refused() {
        for (words, refusal) in [
            ("--seconds 0", "1 to 86400"),
            ("--remote crsf", "needs --sensors"),
            ("--fault baro-absent", "need --sensors"),
            ("--gust 51", "gust"),
            ("--parameter NO_SUCH=1", "no such parameter"),
        ] {
            let error = cli(words).plan().unwrap_err();
            assert!(error.contains(refusal), "{words}: {error}");
        }
        for words in [
            "--speed -1",
            "--speed 101",
            "--speed nan",
            "--udp here",
            "--wind 1",
        ] {
            let words = std::iter::once("windhover-hil").chain(words.split(' '));
            assert!(Cli::try_parse_from(words).is_err());
        }
    }
}
