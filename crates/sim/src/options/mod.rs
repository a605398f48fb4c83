//! The command line: what may be asked for, and what is wrong with what was asked for.

mod world;

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand};
use windhover_model::sensor::fault::{FaultName, SensorFault};
use windhover_sim::flight::{Setup, SetupError};
use windhover_sim::mission_file::{self, MissionFile};
use windhover_sim::reference;
use windhover_sim::sitl::Service;
use windhover_sim::values::{Endpoint, Listening, Place, Speed};

use world::{Pushes, WorldArgs};

pub use windhover_sim::values::Setting;
pub use world::Words;

/// The mission that is flown when none is named.
const DEFAULT_MISSION: &str = "missions/monitoring.plan";
const DEFAULT_MISSION_TEXT: &[u8] = include_bytes!("../../../../missions/monitoring.plan");

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
    /// Fly in real time for ground stations that connect by MAVLink, until stopped by Ctrl-C.
    Sitl(SitlArgs),
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
    #[command(flatten)]
    world: WorldArgs,
    /// Folder for flight.ulg, report.html and figures.json [default: flights/NAME_OF_THE_MISSION]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as one JSON object, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
}

/// Options of `windhover sitl`.
#[derive(Clone, Debug, Args)]
pub struct SitlArgs {
    /// Where a ground station listens by UDP
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:14550")]
    udp: Endpoint,
    /// Where to listen for ground stations by TCP: a port of this machine alone, or HOST:PORT;
    /// 0 for none
    #[arg(long, value_name = "[HOST:]PORT", default_value = "5760")]
    tcp: Listening,
    /// Simulated seconds in one of the clock, 0.1 to 100
    #[arg(long, value_name = "X", default_value = "1")]
    speed: Speed,
    /// Where the vehicle stands: latitude and longitude in degrees, metres above the sea
    #[arg(
        long,
        value_name = "LAT,LON,ALT",
        default_value = "47.3977418,8.5455938,488",
        allow_hyphen_values = true
    )]
    home: Place,
    /// Folder for flight.ulg and report.html
    #[arg(long, value_name = "DIR", default_value = "flights/sitl")]
    pub out: PathBuf,
    #[command(flatten)]
    world: WorldArgs,
}

impl SitlArgs {
    /// Where, how fast, and for whom.
    pub fn service(&self) -> Service {
        Service {
            home: self.home.0,
            udp: self.udp.0,
            tcp: self.tcp.0,
            speed: self.speed.0,
        }
    }

    /// The vehicle and its world. The error is one line.
    pub fn setup(&self) -> Result<Setup, String> {
        self.world.setup(Pushes::None)
    }

    /// What was asked for, in words.
    pub fn words(&self) -> Words {
        self.world.words()
    }
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

/// What the command line asks for.
pub enum Invocation {
    /// A flight.
    Fly(Fly),
    /// A flight for ground stations.
    Sitl(SitlArgs),
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
            Some(Sub::Sitl(sitl)) => Invocation::Sitl(sitl),
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
    /// What was asked for, in words.
    pub words: Words,
}

impl Request {
    /// One line for the user that names the file that is at fault.
    pub fn explain(&self, error: &SetupError) -> String {
        match error {
            SetupError::Mission { .. } | SetupError::Fence { .. } => {
                format!("{}: {error}", self.mission_name.display())
            }
            SetupError::Vehicle | SetupError::Parameter { .. } => self.words.explain(error),
        }
    }
}

impl Fly {
    /// Reads the files and checks the options. The error is one line.
    pub fn request(&self) -> Result<Request, String> {
        let setup = self.world.setup(Pushes::Reference)?;
        let (mission_name, mut mission) = self.mission()?;
        if self.world.is_simple() {
            hold_heading(&mut mission);
        }
        Ok(Request {
            setup,
            mission,
            mission_name,
            words: self.world.words(),
        })
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
