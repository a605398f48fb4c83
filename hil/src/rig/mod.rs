//! What hangs on the pins in a flight: inertial sensors, motors, serial lines, and the world in
//! which the vehicle flies.
//!
//! - [`wires`]: which part is where on a board.
//! - [`motors`]: the speed controllers; [`serial`]: the other ends of serial ports.
//! - [`fault`]: faults by name and time; [`record`]: what a flight leaves behind.
//!
//! The world moves at the samples of the inertial sensors, with the mean of what the motors were
//! told since the last one; without samples, in steps of [`IDLE_STEP`]. All is deterministic.

pub mod fault;
pub mod motors;
pub mod record;
pub mod serial;
pub mod wires;

use windhover_model::sensor::icm42688p::{Event, Icm42688p, Measurement, Misuse};
use windhover_model::vehicle::Plant;
use windhover_model::{Conditions, Integrator, ModelKind, World, ideal_counts};

use crate::board::{Format, Frame, Inputs, Pin, PwmPulse, Usart, Wiring};
use crate::time::{MICROSECOND, SECOND};
use fault::{Action, Fault};
use motors::Motors;
pub use record::Record;
use record::Sample;
use serial::Port;
pub use wires::{Mounting, Wires};

/// The world's step while there are no samples: longer than their period, so that a sample comes
/// first.
pub const IDLE_STEP: u64 = 1250 * MICROSECOND;

/// What the thermometer reads: 35 °C.
const TEMPERATURE: i16 = 1325;

/// What a flight is made of, besides the world.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The board's wires.
    pub wires: Wires,
    /// How much faster the sensors' oscillator is than it should be, in millionths.
    pub imu_clock_ppm: i32,
    /// What goes wrong.
    pub faults: Vec<Fault>,
    /// What is random about the faults follows from it.
    pub seed: u64,
    /// Every how many samples one is recorded; 0 for none.
    pub record_every: u64,
}

impl Default for Setup {
    /// The reference board, a perfect oscillator, no faults, every sample recorded.
    fn default() -> Self {
        Self {
            wires: Wires::SPEEDYBEE_F405_V4,
            imu_clock_ppm: 0,
            faults: Vec::new(),
            seed: 1,
            record_every: 1,
        }
    }
}

/// The world of a flight on the emulated board: a rigid body, whose motors act on the frames
/// that the firmware's timers make, in place of those of `conditions`.
pub fn world(plant: &Plant, conditions: &Conditions) -> World {
    let conditions = Conditions {
        pwm_hz: None,
        ..conditions.clone()
    };
    World::new(
        plant,
        ModelKind::Rigid,
        Integrator::SemiImplicitEuler,
        &conditions,
    )
}

/// Everything on the other side of the pins.
#[derive(Clone, Debug)]
pub struct Rig {
    wires: Wires,
    imu: Icm42688p,
    motors: Motors,
    world: World,
    log: Vec<u8>,
    commands: Port,
    faults: Vec<(u64, Action)>,
    /// Faults that have come to pass.
    faults_done: usize,
    /// Up to when everything has happened.
    now: u64,
    /// When the world moved last.
    step: u64,
    samples: u64,
    record_every: u64,
    record: Record,
    /// What the processor has not been told yet.
    inputs: Inputs,
}

impl Rig {
    /// A vehicle in a world, as [`world`] makes it, its power just coming on.
    pub fn new(world: World, setup: &Setup) -> Self {
        Self {
            wires: setup.wires,
            imu: Icm42688p::new(MICROSECOND).with_clock_error(setup.imu_clock_ppm),
            motors: Motors::new(setup.wires.motors),
            world,
            log: Vec::new(),
            commands: Port::new(Format::plain(setup.wires.commands_baud)),
            faults: fault::schedule(&setup.faults, setup.seed),
            faults_done: 0,
            now: 0,
            step: 0,
            samples: 0,
            record_every: setup.record_every,
            record: Record::default(),
            inputs: Inputs::default(),
        }
    }

    /// The vehicle's world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What was recorded so far.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The bytes that the firmware sent to the log.
    pub fn log(&self) -> &[u8] {
        &self.log
    }

    /// Sends bytes to the command port, from `now` on or behind those that are on their way.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        self.commands.send(now, bytes);
    }

    /// What the firmware sent to the command port: time in ticks, and byte.
    pub fn answers(&self) -> &[(u64, u8)] {
        self.commands.received()
    }

    /// What the motors' controllers are told, in the core's rotor order.
    pub fn motor_commands(&self) -> [Option<u16>; 4] {
        self.motors.commands()
    }

    /// What the firmware did to the inertial sensors against their data sheet.
    pub fn imu_misuse(&self) -> &[Misuse] {
        self.imu.misuse()
    }

    /// Lets everything happen that is due by `now`, in the order of time.
    fn run(&mut self, now: u64) {
        loop {
            let next = self.next_change();
            if next > now {
                break;
            }
            self.now = self.now.max(next);
            if self.next_fault() <= next {
                self.fail();
            } else if self.motors.next_event() <= next {
                let change = self.motors.advance(next);
                self.record.pulses.extend(change);
            } else if self.commands.next_event() <= next {
                let frame = self.commands.advance(next);
                let port = self.wires.commands;
                self.inputs.received.extend(frame.map(|frame| (port, frame)));
            } else if self.imu.next_event() <= next {
                self.imu_event(next);
            } else {
                self.move_world(next);
            }
        }
        self.now = self.now.max(now);
    }

    /// When something will next happen by itself.
    fn next_change(&self) -> u64 {
        self.next_fault()
            .min(self.motors.next_event())
            .min(self.commands.next_event())
            .min(self.imu.next_event())
            .min(self.step + IDLE_STEP)
    }

    fn next_fault(&self) -> u64 {
        let next = self.faults.get(self.faults_done);
        next.map_or(crate::time::NEVER, |(time, _)| *time)
    }

    /// The next fault comes to pass.
    fn fail(&mut self) {
        let (time, action) = self.faults[self.faults_done];
        self.faults_done += 1;
        match action {
            Action::Unplug => self.imu.unplug(time),
            Action::Plug => self.imu.plug(time),
            Action::Reset => self.imu.reset(time),
            Action::Line(line) => self.imu.set_data_line(line),
            Action::Ready(connected) => self.imu.connect_int1(time, connected),
        }
    }

    fn imu_event(&mut self, now: u64) {
        match self.imu.advance(now) {
            Some(Event::Sample { time }) => self.sample(time),
            Some(Event::Int1 { time, level }) => {
                self.inputs.levels.push((self.wires.imu_ready, level));
                if level {
                    self.record.data_ready.push(time);
                }
            }
            None => {}
        }
    }

    /// The sensors take a sample.
    fn sample(&mut self, time: u64) {
        self.move_world(time);
        let truth = self.world.truth();
        let counts = ideal_counts(&truth);
        let mounting = self.wires.mounting;
        self.imu.put(&Measurement {
            accel: mounting.to_part(counts.accel),
            gyro: mounting.to_part(counts.gyro),
            temperature: TEMPERATURE,
        });
        self.samples += 1;
        if self.record_every > 0 && self.samples.is_multiple_of(self.record_every) {
            self.record.samples.push(Sample { time, truth, counts });
        }
    }

    /// Moves the world up to a time.
    fn move_world(&mut self, time: u64) {
        // The world counts whole nanoseconds: from the start, so that nothing adds up.
        let nanoseconds = |ticks: u64| (u128::from(ticks) * 1_000_000_000 / u128::from(SECOND)) as u64;
        let length = nanoseconds(time) - nanoseconds(self.step);
        let command = self.motors.take_step(time);
        self.step = time;
        self.world.step(length as f64 / 1e9, command);
    }
}

impl Wiring for Rig {
    fn spi(&mut self, now: u64, mosi: u8) -> u8 {
        self.run(now);
        self.imu.exchange(self.now, mosi)
    }

    fn output(&mut self, now: u64, pin: Pin, level: bool) {
        self.run(now);
        if pin == self.wires.imu_select {
            if level {
                self.imu.deselect();
            } else {
                self.imu.select();
            }
        }
    }

    fn pwm(&mut self, now: u64, pin: Pin, pulse: PwmPulse) {
        self.run(now);
        let change = self.motors.pulse(self.now, pin, pulse);
        self.record.pulses.extend(change);
    }

    /// The controllers notice it when the next pulses do not come.
    fn pwm_stopped(&mut self, now: u64, _: Pin) {
        self.run(now);
    }

    fn transmitted(&mut self, now: u64, port: Usart, frame: Frame) {
        self.run(now);
        if port == self.wires.log {
            self.log.push(frame.data as u8);
        } else if port == self.wires.commands {
            self.commands.receive(now, frame);
        }
    }

    fn next_event(&self) -> u64 {
        let told = self.inputs.levels.is_empty() && self.inputs.received.is_empty();
        if told { self.next_change() } else { self.now }
    }

    fn advance(&mut self, now: u64, inputs: &mut Inputs) {
        self.run(now);
        inputs.levels.append(&mut self.inputs.levels);
        inputs.received.append(&mut self.inputs.received);
    }
}

#[cfg(test)]
mod tests;
