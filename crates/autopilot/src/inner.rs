//! The inner step: from one sample to four motor commands, a thousand or more times a second.
//!
//! At each tick, in this order: the sample and the latch of urgent commands; at a boundary, the
//! outer result that waits; predictor, gyro filter, attitude control, mixer; at a boundary, the
//! snapshot for the outer step. This order and [`crate::schedule`] are what replay repeats.
//!
//! Motors turn only while two independent things allow it: the adopted outer result says so, and
//! the inner step's own latch is open. Kill, disarm and 20 ms without a sample close the latch in
//! their tick; it opens only after the outer step has seen that and has itself disarmed.

use windhover_control::attitude::{AttitudeController, AttitudeEstimate, AttitudeGains};
use windhover_control::mixer::{FULL_COMMAND, Mixed, Mixer, Wrench};
use windhover_control::pid::low_pass_share;
use windhover_control::position::AttitudeSetpoint;
use windhover_estimator::AttitudePredictor;
use windhover_math::{GRAVITY, Quaternion, Vector3, max, min};

use crate::gyro_filter::{FilterParameters, GyroFilter, Rotors};
use crate::io::{Imu, Increments, InnerInput, MotorCommand, ScheduleRecord, Urgent};
use crate::outer::OuterResult;
use crate::parameters::Parameters;
use crate::plausible::{self, AccelWatch};
use crate::queue::{OuterInputs, Queues};
use crate::schedule::{OUTER_RATE, Schedule};
use crate::sensing::{BoardRotation, CalibrationParameters, Inertial, SensingBorder};

/// Without a sample for so long, the motors stop, µs.
const IMU_TIMEOUT: u64 = 20_000;

/// What is fixed when the core is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerConfig {
    /// Samples per second: a multiple of [`OUTER_RATE`].
    pub imu_rate: u32,
    /// How the sensor sits in the vehicle.
    pub rotation: BoardRotation,
}

impl InnerConfig {
    /// Ticks between two boundaries.
    pub fn k(&self) -> u32 {
        (self.imu_rate / OUTER_RATE).max(1)
    }
}

/// The parameters of the inner step, in the form in which it uses them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerParameters {
    gains: AttitudeGains,
    mixer: Mixer,
    calibration: CalibrationParameters,
    filter: FilterParameters,
    idle: u16,
    rotors: Rotors,
    weight: f32,
}

impl InnerParameters {
    /// From the table; `None` when the vehicle that it describes cannot fly.
    pub fn new(parameters: &Parameters) -> Option<Self> {
        Some(Self {
            gains: AttitudeGains::new(&parameters.attitude, parameters.vehicle.inertia()),
            mixer: Mixer::new(&parameters.vehicle, parameters.motor.idle, parameters.motor.curve)?,
            calibration: parameters.calibration,
            filter: parameters.filter,
            idle: (parameters.motor.idle * FULL_COMMAND) as u16,
            rotors: Rotors {
                speed_max: parameters.vehicle.rotor_speed_max,
                lag: parameters.vehicle.rotor_lag,
            },
            weight: parameters.vehicle.mass * GRAVITY,
        })
    }

    /// Thrust that lets a level vehicle sink slowly, N.
    pub fn descent_thrust(&self) -> f32 {
        crate::mode::descend::THRUST * self.weight
    }
}

/// Whether the motors may turn, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotorState {
    /// They may not.
    #[default]
    Disarmed,
    /// On the ground, all at idle.
    Idle,
    /// As control wants.
    Run,
    /// Disarmed, one of them for a test.
    Test {
        /// Which, in the core's order.
        rotor: u8,
        /// Its command: 65535 is the full one.
        command: u16,
    },
}

/// Why the inner step stopped the motors by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// An urgent command.
    Commanded(Urgent),
    /// No sample for 20 ms.
    ImuMissing,
}

/// What the outer step works on: everything it sees of one period.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The tick of the boundary.
    pub tick: u32,
    /// Its time, µs since start.
    pub time: u64,
    /// Measurements since the last snapshot.
    pub increments: Increments,
    /// Whether the inner step keeps the motors stopped.
    pub stopped: Option<Stop>,
    /// What had arrived in the queues.
    pub inputs: OuterInputs,
}

/// What one tick gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickOutput {
    /// For the motors, now.
    pub motors: MotorCommand,
    /// At a boundary: what was done there.
    pub record: Option<ScheduleRecord>,
}

/// All that passes between the inner step and the rest.
#[derive(Clone, Debug, Default)]
pub struct Mailboxes {
    /// Inputs of the outer step, from wherever they come.
    pub queues: Queues,
    /// From the inner to the outer step: its next work. Filled at a boundary where the outer step
    /// was idle; whoever runs the outer step empties it.
    pub snapshot: Option<Snapshot>,
    /// From the outer to the inner step: what it made of the snapshot. Emptied at a boundary.
    pub result: Option<OuterResult>,
}

/// The inner step with its memory.
#[derive(Clone, Debug)]
pub struct Inner {
    config: InnerConfig,
    /// Nominal time between two ticks, s.
    period: f32,
    parameters: InnerParameters,
    sensing: SensingBorder,
    schedule: Schedule,
    predictor: AttitudePredictor,
    filter: GyroFilter,
    controller: AttitudeController,
    setpoint: AttitudeSetpoint,
    /// Time since the setpoint's snapshot, s.
    setpoint_age: f32,
    motors: MotorState,
    landed: bool,
    stopped: Option<Stop>,
    /// Tick at which the motors were stopped.
    stop_tick: u32,
    descending: bool,
    time: u64,
    sample_time: u64,
    inertial: Inertial,
    accel: AccelWatch,
    /// Whether the accelerometer shows something that can be true.
    sees_force: bool,
    torque_shortfall: Vector3,
    /// What commands are multiplied by while the battery sags.
    gain: f32,
    rotor_thrust: f32,
    increments: Increments,
}

impl Inner {
    /// Disarmed and level, before its first tick.
    pub fn new(config: InnerConfig, parameters: InnerParameters) -> Self {
        Self {
            config,
            period: 1.0 / config.imu_rate as f32,
            sensing: SensingBorder::new(&config.rotation, &parameters.calibration),
            parameters,
            schedule: Schedule::new(config.k()),
            predictor: AttitudePredictor::default(),
            filter: GyroFilter::new(&parameters.filter, &parameters.rotors, config.imu_rate as f32),
            controller: AttitudeController::default(),
            setpoint: AttitudeSetpoint {
                attitude: Quaternion::IDENTITY,
                rate: Vector3::zeros(),
                thrust: 0.0,
            },
            setpoint_age: 0.0,
            motors: MotorState::Disarmed,
            landed: true,
            stopped: None,
            stop_tick: 0,
            descending: false,
            time: 0,
            sample_time: 0,
            inertial: Inertial::default(),
            accel: AccelWatch::new(config.imu_rate),
            sees_force: true,
            torque_shortfall: Vector3::zeros(),
            gain: 1.0,
            rotor_thrust: 0.0,
            increments: Increments::default(),
        }
    }

    /// The schedule: which tick comes, and whether it is a boundary.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Attitude as predicted at the last tick.
    pub fn attitude(&self) -> Quaternion {
        self.predictor.attitude()
    }

    /// Body rate as attitude control saw it at the last tick, FRD, rad/s: filtered, without bias.
    pub fn rate(&self) -> Vector3 {
        self.filter.rate()
    }

    /// One tick. A result that waits is adopted at a boundary only; where a snapshot is taken it
    /// is put into its mailbox, which is empty then, since the last one has come back as a result.
    ///
    /// Never a part of its caller: it keeps the optimisation of this crate, and can be counted.
    #[inline(never)]
    pub fn tick(&mut self, input: &InnerInput, mailboxes: &mut Mailboxes) -> TickOutput {
        let (is_sampled, dt) = self.sample(&input.imu);
        self.latch(input);
        let mut adopted = false;
        if self.schedule.at_boundary()
            && let Some(result) = &mailboxes.result
        {
            self.adopt(result);
            adopted = true;
            mailboxes.result = None;
        }
        let tick = self.schedule.tick();
        let record = self.schedule.advance(adopted);
        self.watch_outer();
        let motors = self.step(is_sampled, dt);
        if record.is_some_and(|record| record.snapshot_taken) {
            mailboxes.snapshot = Some(self.snapshot(tick, &mut mailboxes.queues));
        }
        TickOutput { motors, record }
    }

    /// Takes in a sample, or the lack of one; whether there was one, and the time since the last
    /// tick in s.
    #[inline]
    fn sample(&mut self, imu: &Imu) -> (bool, f32) {
        // A time that runs backwards is no time at all.
        let elapsed = imu.time().saturating_sub(self.time).min(1_000_000) as u32 as f32 * 1e-6;
        let dt = max(0.25 * self.period, min(4.0 * self.period, elapsed));
        self.time = imu.time();
        match imu {
            Imu::Sample { counts, time } if plausible::has_rate(counts) => {
                self.inertial = self.sensing.convert(counts);
                self.sample_time = *time;
                self.sees_force =
                    self.accel.look(counts) || (!self.is_flying() && plausible::has_force(counts));
                (true, dt)
            }
            // The vehicle turns on as it did.
            _ => {
                self.increments.missing = self.increments.missing.saturating_add(1);
                (false, dt)
            }
        }
    }

    /// Whether the motors hold the vehicle in the air.
    #[inline]
    fn is_flying(&self) -> bool {
        self.motors == MotorState::Run && !self.landed
    }

    /// Closes the latch where something urgent says so.
    #[inline]
    fn latch(&mut self, input: &InnerInput) {
        let silent = self.time.wrapping_sub(self.sample_time) > IMU_TIMEOUT;
        let reason = match input.urgent {
            Some(urgent) => Stop::Commanded(urgent),
            None if silent => Stop::ImuMissing,
            None => return,
        };
        self.stopped = Some(reason);
        self.stop_tick = self.schedule.tick();
        self.motors = MotorState::Disarmed;
    }

    /// Takes on an outer result, whole.
    #[inline(never)]
    fn adopt(&mut self, result: &OuterResult) {
        if let Some(parameters) = result.parameters {
            self.controller.retune(&self.parameters.gains, &parameters.gains);
            self.sensing = SensingBorder::new(&self.config.rotation, &parameters.calibration);
            let rate = self.config.imu_rate as f32;
            self.filter.retune(&parameters.filter, &parameters.rotors, rate);
            self.parameters = parameters;
            self.parameters.mixer.set_gain(self.gain);
        }
        if result.motor_gain != self.gain {
            self.gain = result.motor_gain;
            self.parameters.mixer.set_gain(self.gain);
        }
        self.predictor.adopt(result.attitude, result.gyro_bias);
        self.setpoint = result.setpoint;
        self.setpoint_age = 0.0;
        self.descending = false;
        self.landed = result.landed;
        // The latch opens when the outer step has disarmed after it had seen the stop.
        let seen = result.tick.wrapping_sub(self.stop_tick) as i32 >= 0;
        if seen && result.motors == MotorState::Disarmed {
            self.stopped = None;
        }
        self.motors = match self.stopped {
            None => result.motors,
            Some(_) => MotorState::Disarmed,
        };
    }

    /// After 100 ms without a result: level, and slowly down.
    #[inline]
    fn watch_outer(&mut self) {
        if self.schedule.is_outer_silent() && !self.descending {
            self.descending = true;
            self.setpoint = AttitudeSetpoint {
                attitude: Quaternion::from_heading(self.predictor.attitude().heading()),
                rate: Vector3::zeros(),
                thrust: self.parameters.descent_thrust(),
            };
        }
    }

    /// Predictor, gyro filter, attitude control and mixer. Without a new sample, control goes on
    /// with the last filtered rate.
    #[inline]
    fn step(&mut self, is_sampled: bool, dt: f32) -> MotorCommand {
        self.predictor.predict(self.inertial.rate, dt);
        if is_sampled {
            self.filter.step(self.predictor.rate());
        }
        let force = if self.sees_force {
            self.inertial.specific_force
        } else {
            self.reckoned_force()
        };
        let force = self.predictor.since_mark().rotate(force);
        self.setpoint_age += dt;
        let command = match self.motors {
            MotorState::Disarmed => self.at_rest(MotorCommand::Disarmed),
            MotorState::Idle => self.at_rest(MotorCommand::Idle(self.parameters.idle)),
            MotorState::Run => self.run(dt),
            MotorState::Test { rotor, command } => self.test(rotor, command),
        };
        self.filter.follow(&command);
        self.increments.velocity += force * dt;
        self.increments.duration += dt;
        self.increments.ticks = self.increments.ticks.saturating_add(1);
        self.increments.thrust += self.rotor_thrust * dt;
        command
    }

    /// The specific force that the rotors should make, for an accelerometer that shows none.
    #[cold]
    fn reckoned_force(&mut self) -> Vector3 {
        self.increments.blind = self.increments.blind.saturating_add(1);
        let per_mass = GRAVITY / self.parameters.weight;
        Vector3::new(0.0, 0.0, -self.rotor_thrust * per_mass)
    }

    fn at_rest(&mut self, command: MotorCommand) -> MotorCommand {
        self.controller.reset_integrals();
        self.torque_shortfall = Vector3::zeros();
        self.rotor_thrust = 0.0;
        command
    }

    /// One motor of a vehicle that stands; not without somebody who ends it.
    #[cold]
    fn test(&mut self, rotor: u8, command: u16) -> MotorCommand {
        if !self.landed || self.schedule.is_outer_silent() {
            self.motors = MotorState::Disarmed;
            return self.at_rest(MotorCommand::Disarmed);
        }
        let turned = |index: usize| if index == usize::from(rotor) { command } else { 0 };
        self.at_rest(MotorCommand::Run(core::array::from_fn(turned)))
    }

    #[inline]
    fn run(&mut self, dt: f32) -> MotorCommand {
        let estimate = AttitudeEstimate {
            attitude: self.predictor.attitude(),
            rate: self.filter.rate(),
        };
        let age = if self.descending { 0.0 } else { self.setpoint_age };
        let torque = self.controller.step(
            &self.parameters.gains,
            &self.setpoint,
            age,
            &estimate,
            self.torque_shortfall,
            dt,
        );
        let demand = Wrench {
            thrust: self.setpoint.thrust,
            torque,
        };
        let mixed = self.parameters.mixer.mix(&demand, self.landed);
        self.account(&demand, &mixed, dt);
        MotorCommand::Run(mixed.command)
    }

    /// Keeps what the mixer changed, and what thrust the rotors should have by now.
    #[inline]
    fn account(&mut self, demand: &Wrench, mixed: &Mixed, dt: f32) {
        self.torque_shortfall = mixed.applied.torque - demand.torque;
        let share = low_pass_share(self.parameters.rotors.lag, dt);
        self.rotor_thrust += (mixed.applied.thrust - self.rotor_thrust) * share;
        self.increments.thrust_shortfall += (mixed.applied.thrust - demand.thrust) * dt;
        self.increments.saturated = self
            .increments
            .saturated
            .saturating_add(u16::from(mixed.saturated));
    }

    /// Freezes what has come together since the last snapshot.
    #[inline(never)]
    fn snapshot(&mut self, tick: u32, queues: &mut Queues) -> Snapshot {
        let next = Increments {
            gyro_bias: self.predictor.bias(),
            ..Increments::default()
        };
        let increments = core::mem::replace(&mut self.increments, next);
        let increments = Increments {
            rotation: self.predictor.mark(),
            clipped: if self.inertial.is_clipped() {
                increments.ticks
            } else {
                0
            },
            ..increments
        };
        Snapshot {
            tick,
            time: self.time,
            increments,
            stopped: self.stopped,
            inputs: queues.freeze(),
        }
    }
}
