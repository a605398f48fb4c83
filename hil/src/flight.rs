//! A flight of the firmware on the emulated board: it boots, finds its attitude at rest, arms in the
//! mode for setpoints from outside, holds the attitudes that a pilot commands over the port for ground
//! stations, and is stopped.
//!
//! The pilot sees the truth and holds the height by thrust, so that the attitude is all that the
//! firmware is asked to hold.

use std::sync::Arc;

use mavlink::MessageData;
use windhover_autopilot::Parameters;
use windhover_flight_log::wire::MAGIC;
use windhover_math::{Euler, GRAVITY, Quaternion, asin, max};
use windhover_model::{Conditions, Truth, Vehicle};

use crate::board::Board;
use crate::elf::{Elf, ElfError};
use crate::log::{Line, Log, LogError};
use crate::machine::{Load, Machine, MachineError, Options, Stop};
use crate::pilot::{self, Pilot};
use crate::rig::{self, Rig};
use crate::time::SECOND;
use crate::trouble::{self, Slow, Trouble};

/// The machine with a vehicle on its pins.
pub type Vehicle405 = Machine<Board<Rig>>;

/// A new setpoint so often, in ticks of virtual time: 50 Hz.
const SETPOINT_PERIOD: u64 = SECOND / 50;

/// The firmware has booted and has samples so long after power-on or a restart, also where it
/// programs its option bytes or erases a sector first.
const READY: u64 = 2 * SECOND;

/// The pilot asks so long for the motors before he gives up: the vehicle takes the mode and arms once
/// it knows its attitude.
const PATIENCE: u64 = 8 * SECOND;

/// Between two requests to arm.
const ARM_PERIOD: u64 = SECOND / 5;

/// The emulated sensors need no calibration: they are said to have one.
const CALIBRATED: [&str; 2] = ["CAL_GYRO0_ID", "CAL_ACC0_ID"];

/// Each attitude is held so long, in s.
const HOLD: f64 = 5.0;

/// After a new attitude, the vehicle has so long to turn, in s.
const SETTLE: f64 = 2.5;

/// The height that the pilot holds, in m.
const HEIGHT: f64 = 20.0;

/// Roll, pitch and heading that are held in turn, in degrees.
const ATTITUDES: [[f32; 3]; 7] = [
    [0.0, 0.0, 0.0],
    [15.0, 0.0, 0.0],
    [-15.0, 0.0, 30.0],
    [0.0, 15.0, 60.0],
    [0.0, -15.0, -20.0],
    [12.0, 12.0, 0.0],
    [-20.0, 5.0, 45.0],
];

/// What a flight is made of.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Wind and gusts.
    pub conditions: Conditions,
    /// What hangs on the pins, and what goes wrong with it.
    pub rig: rig::Setup,
    /// Parameters that are stored before the flight: name and value.
    pub parameters: Vec<(String, f32)>,
    /// How long the attitudes are held, in s.
    pub seconds: f64,
    /// What goes wrong inside the processor.
    pub troubles: Vec<Trouble>,
    /// An outer step that is slowed.
    pub slow: Option<Slow>,
}

impl Plan {
    /// The reference vehicle without wind, at its defaults.
    pub fn calm(vehicle: Vehicle, seconds: f64) -> Self {
        Self {
            vehicle,
            conditions: Conditions::default(),
            rig: rig::Setup::default(),
            parameters: Vec::new(),
            seconds,
            troubles: Vec::new(),
            slow: None,
        }
    }

    /// Adds a parameter by its name; `None` if there is none of that name, or the value is refused.
    pub fn with_parameter(mut self, name: &str, value: f32) -> Option<Self> {
        let index = Parameters::find(name)?;
        Parameters::declaration(index)?.check(value).ok()?;
        self.parameters.push((name.into(), value));
        Some(self)
    }
}

/// How a flight came out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Largest angle between the attitude that was commanded and the true one, in rad, apart from
    /// the first seconds of each hold; `None` where none was commanded for so long.
    pub attitude_error: Option<f64>,
    /// Greatest height, in m.
    pub height: f64,
    /// Whether the motors stood still in the end.
    pub stopped: bool,
}

/// Why a flight could not be flown.
#[derive(Debug, thiserror::Error)]
pub enum FlightError {
    /// The machine could not be made.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// The firmware did what it must not.
    #[error(transparent)]
    Stop(#[from] Stop),
    /// The firmware has not what is to be held up.
    #[error(transparent)]
    Elf(#[from] ElfError),
    /// The firmware would not let its motors turn.
    #[error("the motors do not turn")]
    Unarmed,
    /// The firmware's messages cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// A board with the firmware and a vehicle, and what the firmware says.
pub struct Flight {
    /// The board.
    pub machine: Vehicle405,
    /// What the firmware said by defmt.
    pub lines: Vec<Line>,
    decoder: Option<Log>,
    pilot: Pilot,
    plan: Plan,
    troubles_done: usize,
    /// When the holds began.
    begin: u64,
    /// How the processor's time was spent until then.
    load_before: Load,
}

impl Flight {
    /// At power-on.
    ///
    /// # Errors
    /// When the program cannot be run.
    pub fn new(elf: Arc<Elf>, plan: &Plan) -> Result<Self, FlightError> {
        let world = rig::world(&plan.vehicle.plant, &plan.conditions);
        let board = Board::new(Rig::new(world, &plan.rig));
        let mut plan = plan.clone();
        plan.troubles.sort_by_key(|trouble| trouble.start);
        Ok(Self {
            decoder: Log::new(&elf)?,
            machine: Machine::new(board, elf, Options::default())?,
            lines: Vec::new(),
            pilot: Pilot::default(),
            plan,
            troubles_done: 0,
            begin: 0,
            load_before: Load::default(),
        })
    }

    /// Whether there is something to do before it flies.
    pub fn has_to_prepare(&self) -> bool {
        !self.plan.parameters.is_empty() || self.plan.slow.is_some()
    }

    /// Stores the plan's parameters, restarts the firmware with them, and waits until it is ready. A
    /// second time there is nothing left to do.
    ///
    /// # Errors
    /// What stopped the machine.
    pub fn prepare(&mut self) -> Result<(), FlightError> {
        self.run(READY)?;
        let parameters = std::mem::take(&mut self.plan.parameters);
        if !parameters.is_empty() {
            for (name, value) in parameters {
                self.send(&pilot::set(&name, value));
            }
            self.send(&pilot::restart());
            self.run(self.machine.now() + READY)?;
        }
        if let Some(slow) = self.plan.slow.take() {
            trouble::slow(&mut self.machine, &slow)?;
        }
        Ok(())
    }

    /// Asks for the mode and the motors until they turn, which the firmware refuses until it has
    /// stood still for long enough to know its attitude. Whether they do turn; then the holds begin,
    /// the first of them while the motors still idle.
    ///
    /// # Errors
    /// What stopped the machine.
    pub fn arm(&mut self) -> Result<bool, FlightError> {
        let asked = self.machine.now();
        for step in 1..=PATIENCE / SETPOINT_PERIOD {
            if self.turns() {
                break;
            }
            self.steer(0.0);
            if (step * SETPOINT_PERIOD).is_multiple_of(ARM_PERIOD) {
                self.ask_for_motors();
            }
            self.run(asked + step * SETPOINT_PERIOD)?;
        }
        self.begin_figures();
        Ok(self.turns())
    }

    /// What is said of the flight counts from now on.
    pub fn begin_figures(&mut self) {
        self.begin = self.machine.now();
        self.load_before = self.machine.load().clone();
    }

    /// Whether all motors stand still.
    pub fn stopped(&self) -> bool {
        !self.turns()
    }

    fn ask_for_motors(&mut self) {
        for name in CALIBRATED {
            self.send(&pilot::set(name, 1.0));
        }
        self.send(&pilot::offboard());
        self.send(&pilot::arm());
    }

    /// When the holds began, in s since power-on.
    pub fn begin(&self) -> f64 {
        self.begin as f64 / SECOND as f64
    }

    /// How the processor's time was spent since the holds began.
    pub fn load(&mut self) -> Load {
        self.machine.load().since(&self.load_before)
    }

    /// Whether any motor is commanded.
    fn turns(&self) -> bool {
        let commands = self.machine.bus().wiring.motor_commands();
        commands.iter().any(|command| command.unwrap_or(0) > 0)
    }

    /// Flies from power-on to disarmed. `progress` is told the share that is done.
    ///
    /// # Errors
    /// What stopped the machine.
    pub fn fly(&mut self, mut progress: impl FnMut(f64)) -> Result<Outcome, FlightError> {
        self.prepare()?;
        self.arm()?;
        let mut outcome = Outcome::default();
        let steps = (self.plan.seconds * 50.0) as u64;
        for step in 0..steps {
            let error = self.steer(step as f64 / 50.0);
            outcome.attitude_error = match (outcome.attitude_error, error) {
                (Some(largest), Some(error)) => Some(max(largest, error)),
                (largest, error) => largest.or(error),
            };
            self.run(self.begin + (step + 1) * SETPOINT_PERIOD)?;
            outcome.height = max(outcome.height, -self.truth().position.z);
            progress(step as f64 / steps as f64);
        }
        self.send(&pilot::stop());
        self.run(self.machine.now() + SECOND / 2)?;
        outcome.stopped = !self.turns();
        Ok(outcome)
    }

    /// Runs until this moment; what is to go wrong goes wrong at its time.
    ///
    /// # Errors
    /// What stopped the machine.
    pub fn run(&mut self, until: u64) -> Result<(), FlightError> {
        while let Some(trouble) = self.plan.troubles.get(self.troubles_done).copied()
            && trouble.start < until
        {
            self.troubles_done += 1;
            self.machine.run(trouble.start)?;
            trouble::befall(&mut self.machine, trouble.kind)?;
        }
        self.machine.run(until)?;
        let chunks = self.machine.take_log();
        if let Some(decoder) = &mut self.decoder {
            for (time, bytes) in &chunks {
                self.lines.extend(decoder.decode(*time, bytes));
            }
        }
        Ok(())
    }

    /// Sends a message to the port for ground stations.
    pub fn send<M: MessageData>(&mut self, message: &M) {
        let frame = self.pilot.frame(message);
        let now = self.machine.now();
        self.machine.bus().wiring.send(now, &frame);
    }

    /// The state of the world.
    pub fn truth(&self) -> Truth {
        self.machine.bus().wiring.world().truth()
    }

    /// The flight log of the last run of the firmware: what came since the last restart.
    pub fn flight_log(&self) -> Vec<u8> {
        let bus = self.machine.bus();
        let bytes = bus.wiring.log();
        let starts = bytes.windows(MAGIC.len()).rposition(|window| window == MAGIC);
        bytes[starts.unwrap_or(0)..].to_vec()
    }

    /// Sends the setpoint for this moment, in s since the holds began; how far the attitude is
    /// off, once it has settled.
    fn steer(&mut self, time: f64) -> Option<f64> {
        let truth = self.truth();
        let (attitude, held) = commanded(time);
        let thrust = thrust(self.plan.vehicle.plant.mass, &truth);
        self.send(&pilot::attitude(attitude, thrust));
        let settled = held > SETTLE && -truth.position.z > 0.5;
        settled.then(|| angle_between(attitude, truth.attitude))
    }
}

/// The attitude that is commanded at a time since the start of the holds, in s, and how long it
/// has been.
fn commanded(time: f64) -> (Quaternion, f64) {
    let index = (time / HOLD) as usize;
    let [roll, pitch, yaw] = ATTITUDES[index % ATTITUDES.len()].map(f32::to_radians);
    let attitude = Quaternion::from_euler(Euler { roll, pitch, yaw });
    (attitude, time - index as f64 * HOLD)
}

/// The thrust that holds the height at this attitude, in N.
fn thrust(mass: f64, truth: &Truth) -> f32 {
    let error = HEIGHT + truth.position.z;
    let climb = (0.6 * error).clamp(-2.0, 2.0);
    let up = f64::from(GRAVITY) + 2.0 * (climb + truth.velocity.z);
    max(mass * up / max(truth.attitude.down_axis().z, 0.5), 0.0) as f32
}

/// Angle between two attitudes, in rad.
fn angle_between(wanted: Quaternion, is: Quaternion<f64>) -> f64 {
    let [w, x, y, z] = [wanted.w, wanted.x, wanted.y, wanted.z].map(f64::from);
    let off = (Quaternion::new(w, x, y, z).conjugate() * is).shortest();
    // By the sine: its inverse is exact where the angle is small, as it should be.
    2.0 * f64::from(asin((off.x * off.x + off.y * off.y + off.z * off.z).sqrt() as f32))
}
