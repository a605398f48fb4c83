//! A flight of the firmware on the emulated board: it boots, arms, holds the attitudes that a
//! pilot commands over the command port, and disarms.
//!
//! The pilot sees the truth and holds the height by thrust, so that the attitude is all that the
//! firmware is asked to hold.

use std::sync::Arc;

use windhover_autopilot::{Command, Urgent};
use windhover_bench_port::{FRAME, Request};
use windhover_control::position::AttitudeSetpoint;
use windhover_flight_log::Input;
use windhover_math::{GRAVITY, Quaternion, Vector3};
use windhover_model::{Conditions, Truth, Vehicle};

use crate::board::Board;
use crate::elf::Elf;
use crate::machine::{Machine, MachineError, Options, Stop};
use crate::rig::{self, Rig};
use crate::time::SECOND;

/// The machine with a vehicle on its pins.
pub type Vehicle405 = Machine<Board<Rig>>;

/// A new setpoint so often, in ticks of virtual time: 50 Hz.
const SETPOINT_PERIOD: u64 = SECOND / 50;

/// The firmware has booted and has samples by then.
const READY: u64 = SECOND;

/// Each attitude is held so long, in s.
const HOLD: f64 = 4.0;

/// After a new attitude, the vehicle has so long to turn, in s.
const SETTLE: f64 = 1.5;

/// The height that the pilot holds, in m.
const HEIGHT: f64 = 20.0;

/// Roll, pitch and heading that are held in turn, in degrees.
const ATTITUDES: [[f32; 3]; 7] = [
    [0.0, 0.0, 0.0],
    [15.0, 0.0, 0.0],
    [-15.0, 0.0, 30.0],
    [0.0, 15.0, 60.0],
    [0.0, -15.0, -45.0],
    [12.0, 12.0, 0.0],
    [-20.0, 5.0, 90.0],
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
    /// How long the attitudes are held, in s.
    pub seconds: f64,
}

/// How a flight came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Largest angle between the attitude that was commanded and the true one, in rad, apart from
    /// the first [`SETTLE`] seconds of each hold.
    pub attitude_error: f64,
    /// Greatest height, in m.
    pub height: f64,
    /// Whether the motors turned in flight.
    pub flew: bool,
    /// Whether the motors stood still in the end.
    pub stopped: bool,
}

/// A machine at power-on, with a vehicle.
pub fn machine(elf: Arc<Elf>, plan: &Plan) -> Result<Vehicle405, MachineError> {
    let world = rig::world(&plan.vehicle.plant, &plan.conditions);
    let board = Board::new(Rig::new(world, &plan.rig));
    Machine::new(board, elf, Options::default())
}

/// The attitude that is commanded at a time since the start of the holds, in s, and how long it
/// has been.
fn commanded(time: f64) -> (Quaternion, f64) {
    let index = (time / HOLD) as usize;
    let [roll, pitch, heading] = ATTITUDES[index % ATTITUDES.len()].map(f32::to_radians);
    let attitude = Quaternion::from_euler(windhover_math::Euler {
        roll,
        pitch,
        yaw: heading,
    });
    (attitude, time - index as f64 * HOLD)
}

/// The thrust that holds the height at this attitude, in N.
fn thrust(mass: f64, truth: &Truth) -> f32 {
    let error = HEIGHT + truth.position.z;
    let climb = (0.6 * error).clamp(-2.0, 2.0);
    let up = f64::from(GRAVITY) + 2.0 * (climb + truth.velocity.z);
    (mass * up / truth.attitude.down_axis().z.max(0.5)).max(0.0) as f32
}

fn send(machine: &Vehicle405, request: Request) {
    let mut frame = [0; FRAME];
    let length = request.encode(&mut frame).expect("a frame holds every request");
    let now = machine.now();
    machine.bus().wiring.send(now, &frame[..length]);
}

/// Sends a setpoint for this moment; how far the attitude is off, once it has settled.
fn steer(machine: &Vehicle405, mass: f64, time: f64) -> Option<f64> {
    let truth = machine.bus().wiring.world().truth();
    let (attitude, held) = commanded(time);
    let setpoint = AttitudeSetpoint {
        attitude,
        rate: Vector3::zeros(),
        thrust: thrust(mass, &truth),
    };
    send(machine, Request::Input(Input::Attitude(setpoint)));
    let wanted = Quaternion::new(
        f64::from(attitude.w),
        f64::from(attitude.x),
        f64::from(attitude.y),
        f64::from(attitude.z),
    );
    let off = (wanted.conjugate() * truth.attitude).shortest();
    let angle = 2.0 * off.w.clamp(-1.0, 1.0).acos();
    (held > SETTLE && -truth.position.z > 0.5).then_some(angle)
}

/// Flies a plan from power-on to disarmed.
///
/// # Errors
/// What stopped the machine.
pub fn fly(machine: &mut Vehicle405, plan: &Plan, mut progress: impl FnMut(f64)) -> Result<Outcome, Stop> {
    let mass = plan.vehicle.plant.mass;
    let mut outcome = Outcome::default();
    machine.run(READY)?;
    let steps = (plan.seconds * 50.0) as u64;
    for step in 0..steps {
        let time = step as f64 / 50.0;
        if let Some(error) = steer(machine, mass, time) {
            outcome.attitude_error = outcome.attitude_error.max(error);
        }
        match step {
            5 => send(machine, Request::Input(Input::Command(Command::Arm))),
            10 => send(machine, Request::Input(Input::Command(Command::StartAttitude))),
            _ => {}
        }
        machine.run(READY + (step + 1) * SETPOINT_PERIOD)?;
        let bus = machine.bus();
        let truth = bus.wiring.world().truth();
        outcome.height = outcome.height.max(-truth.position.z);
        outcome.flew |= -truth.position.z > 1.0;
        progress(time);
    }
    send(machine, Request::Urgent(Urgent::Disarm));
    machine.run(machine.now() + SECOND / 2)?;
    outcome.stopped = machine
        .bus()
        .wiring
        .motor_commands()
        .iter()
        .all(|command| command.unwrap_or(0) == 0);
    Ok(outcome)
}
