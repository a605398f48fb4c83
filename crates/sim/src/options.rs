//! The command line: what may be asked for, and what is wrong with what was asked for.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};
use windhover_autopilot::{Parameters, Preset};
use windhover_math::Vector3;
use windhover_model::sensor::fault::{FaultName, SensorFault};
use windhover_model::{Conditions, Integrator, ModelKind, Payload, Push, mean_wind_from};
use windhover_sim::flight::{Setup, SetupError};
use windhover_sim::mission_file::{self, MissionFile};
use windhover_sim::reference;
use windhover_sim::sensors::{Receiver, Sensors};
use windhover_sim::terminal::read_vehicle;

/// The mission that is flown when none is named.
const DEFAULT_MISSION: &str = "missions/monitoring.plan";
const DEFAULT_MISSION_TEXT: &[u8] = include_bytes!("../../../missions/monitoring.plan");

/// Autopilot for quadcopters that fly waypoint missions for monitoring, on the desktop.
///
/// Without a command, flies missions/monitoring.plan in the reference conditions.
#[derive(Debug, Parser)]
#[command(name = "windhover", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Sub>,
    #[command(flatten)]
    fly: Fly,
}

#[derive(Debug, Subcommand)]
enum Sub {
    /// Fly a mission in a simulated world, print its figures, write its log and a report.
    Fly(Fly),
    /// Run the core on a log's inputs again and compare every output bit for bit.
    Replay(Replay),
    /// Make the report of a flight from its log.
    Report(ReportArgs),
    /// List the faults that sensors can have, for `fly --fault`.
    Faults,
    /// List parameters with range, default and meaning, for `fly --set` and vehicle files.
    Parameters(ParameterArgs),
    /// List what the vehicle watches in flight, and what it does about it.
    Failsafes(PageArgs),
}

/// Options of `windhover fly`.
#[derive(Clone, Debug, Args)]
pub struct Fly {
    /// Mission file: QGroundControl's .plan or a waypoint file (QGC WPL 110)
    /// [default: missions/monitoring.plan]
    file: Option<PathBuf>,
    /// Vehicle: os4, x450, or a vehicle file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "os4")]
    vehicle: String,
    /// Position control: the paper's gains in a plain cascade, or ours with feed-forward and
    /// disturbance observer
    #[arg(long, default_value = "windhover")]
    preset: PresetName,
    /// Mean wind in m/s and the direction in degrees that it comes from
    #[arg(
        long,
        value_name = "SPEED,FROM_DEG",
        default_value = "4.47,206.6",
        allow_hyphen_values = true
    )]
    wind: Numbers<2>,
    /// Standard deviation of the gusts in m/s
    #[arg(
        long,
        value_name = "M_PER_S",
        default_value_t = 1.0,
        allow_hyphen_values = true
    )]
    gust: f64,
    /// A push: from T seconds on, a force north, east, down in N, for so many seconds; may be
    /// repeated, and takes the place of the default ones [default: 30,4,0,0,0.5 and 60,0,4,0,0.5]
    #[arg(long, value_name = "T,FN,FE,FD,SECONDS", allow_hyphen_values = true)]
    push: Vec<Numbers<5>>,
    /// Payload in kg that the controllers do not know of
    #[arg(long, value_name = "KG", default_value_t = 0.0, allow_hyphen_values = true)]
    payload: f64,
    /// Equations of motion: simple is eq. (1) of the paper, paper is eq. (8), rigid a full rigid
    /// body
    #[arg(long, default_value = "rigid")]
    model: ModelName,
    /// Tell the vehicle its true state, instead of letting it fly on its sensors; always so with
    /// simple and paper
    #[arg(long)]
    truth: bool,
    /// Satellite receiver: standard errs by metres, rtk by centimetres
    #[arg(long, default_value = "standard")]
    gnss: ReceiverName,
    /// A fault of a sensor, from T seconds on, for so many seconds or to the end; may be repeated.
    /// `windhover faults` lists the names
    #[arg(long, value_name = "NAME@T[,FOR]", conflicts_with = "truth")]
    fault: Vec<SensorFault>,
    /// A pilot holds a remote control, sticks at rest: from then on its loss is a failsafe
    /// (`--fault rc-dropout@60`)
    #[arg(long, conflicts_with = "truth")]
    rc: bool,
    /// Charge of the battery at the start in percent [default: 100]
    #[arg(
        long,
        value_name = "PERCENT",
        conflicts_with = "truth",
        allow_hyphen_values = true
    )]
    battery: Option<Percent>,
    /// A parameter's value, over the vehicle file and the preset; may be repeated.
    /// `windhover parameters` lists the names
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<Setting>,
    /// Everything random follows from it
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    seed: u64,
    /// Folder for flight.ulg, report.html and figures.json [default: flights/NAME_OF_THE_MISSION]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as one JSON object, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

/// Options of `windhover replay`.
#[derive(Clone, Debug, Args)]
pub struct Replay {
    /// The log
    #[arg(value_name = "FLIGHT.ulg")]
    pub log: PathBuf,
    /// Replay with another value of a parameter instead, and tell how the motor commands would
    /// have differed while the vehicle moved as it did (open loop); may be repeated
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub with: Vec<Setting>,
}

/// Options of `windhover report`.
#[derive(Clone, Debug, Args)]
pub struct ReportArgs {
    /// The log
    #[arg(value_name = "FLIGHT.ulg")]
    pub log: PathBuf,
    /// Where the page goes [default: beside the log, with the ending .html]
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
}

/// Options of `windhover parameters`.
#[derive(Clone, Debug, Args)]
pub struct ParameterArgs {
    /// Only parameters in whose names one of these stands
    #[arg(value_name = "NAME", conflicts_with = "markdown")]
    names: Vec<String>,
    #[command(flatten)]
    page: PageArgs,
}

/// Options of the commands that list a table.
#[derive(Clone, Copy, Debug, Args)]
pub struct PageArgs {
    /// Print the page of the documentation instead
    #[arg(long)]
    markdown: bool,
}

/// A parameter and its value.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Index in the table.
    pub index: usize,
    /// Its name.
    pub name: &'static str,
    /// The value, inside the range.
    pub value: f32,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("NAME=VALUE is wanted")?;
        let (index, declaration) = Parameters::declarations()
            .enumerate()
            .find(|(_, declaration)| declaration.name == name)
            .ok_or_else(|| reference::unknown(name))?;
        let value: f32 = value
            .parse()
            .map_err(|_| format!("{name}: '{value}' is not a number"))?;
        declaration
            .check(value)
            .map_err(|refusal| format!("{name}: {refusal}"))?;
        let name = declaration.name;
        Ok(Self { index, name, value })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.name, self.value)
    }
}

/// A share in percent, 0 to 100.
#[derive(Clone, Copy, Debug)]
struct Percent(f64);

impl FromStr for Percent {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.trim_end_matches('%').trim();
        match number.parse::<f64>() {
            Ok(percent) if (0.0..=100.0).contains(&percent) => Ok(Self(percent)),
            Ok(percent) if !percent.is_nan() => Err(format!("{percent} % is outside 0 to 100")),
            _ => Err(format!("'{text}' is not a number")),
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PresetName {
    Paper,
    Windhover,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ReceiverName {
    Standard,
    Rtk,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ModelName {
    Simple,
    Paper,
    Rigid,
}

/// Numbers with commas between them, all finite.
#[derive(Clone, Copy, Debug)]
struct Numbers<const N: usize>([f64; N]);

impl<const N: usize> FromStr for Numbers<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, String> = text
            .split(',')
            .map(|part| match part.trim().parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(format!("'{part}' is not a finite number")),
            })
            .collect();
        let numbers = numbers?;
        let count = numbers.len();
        numbers
            .try_into()
            .map(Self)
            .map_err(|_| format!("{N} numbers with commas between them are wanted, not {count}"))
    }
}

/// What the command line asks for.
pub enum Invocation {
    /// A flight.
    Fly(Fly),
    /// A log, again.
    Replay(Replay),
    /// A log, as a page.
    Report(ReportArgs),
    /// Help, version, or what is wrong.
    Say {
        /// The text.
        text: String,
        /// The exit code.
        code: u8,
    },
}

/// Reads the command line.
pub fn parse() -> Invocation {
    match Cli::try_parse() {
        Ok(cli) => match cli.command {
            None => Invocation::Fly(cli.fly),
            Some(Sub::Fly(fly)) => Invocation::Fly(fly),
            Some(Sub::Replay(replay)) => Invocation::Replay(replay),
            Some(Sub::Report(report)) => Invocation::Report(report),
            Some(Sub::Faults) => Invocation::say(faults()),
            Some(Sub::Parameters(asked)) if asked.page.markdown => {
                Invocation::say(reference::parameters_page())
            }
            Some(Sub::Parameters(asked)) => match reference::parameters(&asked.names) {
                Ok(text) => Invocation::say(text),
                Err(message) => Invocation::refuse(format!("error: {message}")),
            },
            Some(Sub::Failsafes(asked)) if asked.markdown => Invocation::say(reference::failsafes_page()),
            Some(Sub::Failsafes(_)) => Invocation::say(reference::failsafes()),
        },
        Err(error) if !error.use_stderr() => Invocation::say(error.to_string()),
        Err(error) => Invocation::refuse(one_line(&error.to_string())),
    }
}

impl Invocation {
    fn say(text: String) -> Self {
        Self::Say { text, code: 0 }
    }

    fn refuse(text: String) -> Self {
        Self::Say { text, code: 2 }
    }
}

/// One line a fault.
fn faults() -> String {
    let all = SensorFault::all();
    let width = all.iter().map(|fault| fault.name.len()).max().unwrap_or(0);
    let line = |fault: &FaultName| format!("{:width$}  {}\n", fault.name, fault.text);
    all.iter().map(line).collect()
}

/// Clap's message without the usage below it.
fn one_line(message: &str) -> String {
    let told = message
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:"));
    let told: Vec<&str> = told
        .filter(|line| !line.is_empty() && !line.starts_with("For more"))
        .collect();
    format!("{}; see --help", told.join("; "))
}

/// A flight as asked for, with everything read that it needs.
pub struct Request {
    /// What is flown, by what, where.
    pub setup: Setup,
    /// The mission.
    pub mission: MissionFile,
    /// The mission's file as the user named it.
    pub mission_name: PathBuf,
    vehicle_name: String,
    /// Parameters that were set on the command line, as they were asked for.
    pub set: Vec<String>,
    /// Words for the report: which model, preset and so on.
    pub model: String,
    /// Name of the preset.
    pub preset: String,
}

impl Request {
    /// One line for the user that names the file that is at fault.
    pub fn explain(&self, error: &SetupError) -> String {
        match error {
            SetupError::Mission { .. } | SetupError::Fence { .. } => {
                format!("{}: {error}", self.mission_name.display())
            }
            SetupError::Vehicle if !self.set.is_empty() => {
                format!("{}, --set {}: {error}", self.vehicle_name, self.set.join(", "))
            }
            SetupError::Parameter { .. } | SetupError::Vehicle => format!("{}: {error}", self.vehicle_name),
        }
    }
}

impl Fly {
    /// Reads the files and checks the options. The error is one line.
    pub fn request(&self) -> Result<Request, String> {
        let conditions = self.conditions()?;
        let mut vehicle = read_vehicle(&self.vehicle)?;
        for setting in &self.set {
            let value = f64::from(setting.value);
            vehicle.parameters.insert(setting.name.to_owned(), value);
        }
        let (mission_name, mut mission) = self.mission()?;
        if matches!(self.model, ModelName::Simple) {
            hold_heading(&mut mission);
        }
        Ok(Request {
            setup: Setup {
                vehicle,
                preset: match self.preset {
                    PresetName::Paper => Preset::Paper,
                    PresetName::Windhover => Preset::Windhover,
                },
                model: match self.model {
                    ModelName::Simple => ModelKind::Simple,
                    ModelName::Paper => ModelKind::Paper,
                    ModelName::Rigid => ModelKind::Rigid,
                },
                integrator: Integrator::SemiImplicitEuler,
                conditions,
                imu_rate: 1000,
                disruption: None,
                sensors: self.sensors()?,
                writes: Vec::new(),
            },
            mission,
            mission_name,
            vehicle_name: self.vehicle.clone(),
            set: self.set.iter().map(Setting::to_string).collect(),
            model: format!("{:?}", self.model).to_lowercase(),
            preset: format!("{:?}", self.preset).to_lowercase(),
        })
    }

    /// The sensors, where it is flown on such.
    fn sensors(&self) -> Result<Option<Sensors>, String> {
        let rigid = matches!(self.model, ModelName::Rigid);
        let of_sensors = [
            ("--fault", !self.fault.is_empty()),
            ("--rc", self.rc),
            ("--battery", self.battery.is_some()),
        ];
        if let Some((option, _)) = of_sensors.iter().find(|(_, is)| *is && !rigid) {
            return Err(format!(
                "{option}: the models simple and paper are flown on the truth, not on sensors"
            ));
        }
        Ok((rigid && !self.truth).then(|| Sensors {
            receiver: match self.gnss {
                ReceiverName::Standard => Receiver::Standard,
                ReceiverName::Rtk => Receiver::Rtk,
            },
            faults: self.fault.clone(),
            errors: None,
            remote: self.rc,
            charge: self.battery.map(|Percent(percent)| percent * 0.01),
        }))
    }

    fn conditions(&self) -> Result<Conditions, String> {
        let Numbers([speed, from]) = self.wind;
        if speed < 0.0 {
            return Err(format!("--wind: a speed of {speed} m/s; must be 0 or more"));
        }
        let mut conditions = Conditions {
            wind: mean_wind_from(speed, from),
            gust: self.gust,
            payload: Payload::new(self.payload).map_err(|e| format!("--payload: {e}"))?,
            seed: self.seed,
            ..Conditions::reference()
        };
        if !self.push.is_empty() {
            let push = |Numbers([start, n, e, d, duration]): &Numbers<5>| Push {
                start: *start,
                force: Vector3::new(*n, *e, *d),
                duration: *duration,
            };
            conditions.pushes = self.push.iter().map(push).collect();
        }
        conditions.validate().map_err(|e| format!("--{e}"))?;
        Ok(conditions)
    }

    fn mission(&self) -> Result<(PathBuf, MissionFile), String> {
        let default = Path::new(DEFAULT_MISSION);
        let (name, read) = match &self.file {
            Some(file) => (file.as_path(), mission_file::read(file)),
            None => (default, mission_file::read_bytes(default, DEFAULT_MISSION_TEXT)),
        };
        Ok((name.to_path_buf(), read.map_err(|e| e.to_string())?))
    }

    /// Where the report goes.
    pub fn folder(&self, mission: &Path) -> PathBuf {
        let stem = mission.file_stem().unwrap_or("flight".as_ref());
        self.out
            .clone()
            .unwrap_or_else(|| Path::new("flights").join(stem))
    }
}

/// Equation (1) has no heading: the mission's headings are left out.
fn hold_heading(mission: &mut MissionFile) {
    let waypoint = windhover_autopilot::mission::action::command::NAV_WAYPOINT;
    let mut left_out = false;
    for item in mission.items.iter_mut().filter(|item| item.command == waypoint) {
        left_out |= !item.params[3].is_nan();
        item.params[3] = f32::NAN;
    }
    if left_out {
        mission
            .notes
            .push("model simple has no heading: the mission's headings are left out".into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn numbers_are_told_apart() {
        assert!("1,2".parse::<Numbers<2>>().is_ok());
        for wrong in ["1", "1,2,3", "1,nan", "1,inf", "a,b", ""] {
            assert!(wrong.parse::<Numbers<2>>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn percentages_are_0_to_100() {
        for (text, percent) in [("0", 0.0), ("15.5", 15.5), ("100%", 100.0)] {
            assert_eq!(text.parse::<Percent>().unwrap().0, percent);
        }
        for wrong in ["-1", "101", "1e9", "inf"] {
            let refusal = wrong.parse::<Percent>().unwrap_err();
            assert!(refusal.contains("outside 0 to 100"), "{refusal}");
        }
        for wrong in ["", "full", "nan"] {
            let refusal = wrong.parse::<Percent>().unwrap_err();
            assert!(refusal.contains("is not a number"), "{refusal}");
        }
    }

    #[test]
    fn settings_are_inside_their_ranges() {
        let setting: Setting = "NAV_RCL_ACT=3".parse().unwrap();
        assert_eq!((setting.name, setting.value), ("NAV_RCL_ACT", 3.0));
        for (wrong, words) in [
            ("NAV_RCL_ACT", "NAME=VALUE is wanted"),
            ("NAV_RCL_ACT=", "'' is not a number"),
            ("NAV_RCL_ACT=nan", "the range is 0 to 6"),
            ("NAV_RCL_ACT=7", "NAV_RCL_ACT: the range is 0 to 6"),
            ("SPEED=7", "there is no parameter SPEED; `windhover parameters`"),
        ] {
            let refusal = wrong.parse::<Setting>().unwrap_err();
            assert!(refusal.contains(words), "{refusal}");
        }
    }

    #[test]
    fn errors_are_one_line() {
        let error = Cli::try_parse_from(["windhover", "fly", "--wind", "x"])
            .unwrap_err()
            .to_string();
        let line = one_line(&error);
        assert!(
            line.starts_with("error: ") && !line.contains('\n') && line.contains("--wind"),
            "{line}"
        );
    }
}
