//! The vehicle and its world, as `fly` and `sitl` are told of them.

use clap::{Args, ValueEnum};
use windhover_autopilot::Preset;
use windhover_math::Vector3;
use windhover_model::sensor::fault::SensorFault;
use windhover_model::{Conditions, Integrator, ModelKind, Payload, Push, mean_wind_from};
use windhover_sim::flight::{Setup, SetupError};
use windhover_sim::sensors::{Receiver, Sensors};
use windhover_sim::terminal::read_vehicle;
use windhover_sim::values::{Numbers, Percent, Setting};

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

/// Options about the vehicle and its world.
#[derive(Clone, Debug, Args)]
pub struct WorldArgs {
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
    /// repeated, and takes the place of the default ones [default of fly: 30,4,0,0,0.5 and 60,0,4,0,0.5; of sitl:
    /// none]
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
}

/// Pushes where none are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pushes {
    /// Those of the reference conditions.
    Reference,
    /// None.
    None,
}

impl WorldArgs {
    /// Reads the vehicle and checks the options. The error is one line.
    pub fn setup(&self, pushes: Pushes) -> Result<Setup, String> {
        let conditions = self.conditions(pushes)?;
        let mut vehicle = read_vehicle(&self.vehicle)?;
        for setting in &self.set {
            let value = f64::from(setting.value);
            vehicle.parameters.insert(setting.name.to_owned(), value);
        }
        Ok(Setup {
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
        })
    }

    /// Words for the report.
    pub fn words(&self) -> Words {
        Words {
            vehicle: self.vehicle.clone(),
            model: format!("{:?}", self.model).to_lowercase(),
            preset: format!("{:?}", self.preset).to_lowercase(),
            set: self.set.iter().map(Setting::to_string).collect(),
        }
    }

    /// Whether the model has no heading.
    pub fn is_simple(&self) -> bool {
        matches!(self.model, ModelName::Simple)
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
            own_declination: false,
        }))
    }

    fn conditions(&self, pushes: Pushes) -> Result<Conditions, String> {
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
        if pushes == Pushes::None {
            conditions.pushes.clear();
        }
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
}

/// What was asked for, in words.
#[derive(Clone, Debug)]
pub struct Words {
    /// The vehicle by its name, or its file.
    pub vehicle: String,
    /// Which equations of motion.
    pub model: String,
    /// Which position control.
    pub preset: String,
    /// Parameters that were set on the command line.
    pub set: Vec<String>,
}

impl Words {
    /// One line for the user about what keeps a vehicle from flying.
    pub fn explain(&self, error: &SetupError) -> String {
        match error {
            SetupError::Vehicle if !self.set.is_empty() => {
                format!("{}, --set {}: {error}", self.vehicle, self.set.join(", "))
            }
            _ => format!("{}: {error}", self.vehicle),
        }
    }
}
