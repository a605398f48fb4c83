//! What hangs on the pins in a flight: sensors, motors, serial lines, and the world in which the
//! vehicle flies.
//!
//! - [`wires`]: which part is where on a board; `pins`: what goes over them.
//! - `setup`: what a flight is made of.
//! - [`motors`]: the speed controllers; [`serial`]: the other ends of serial ports.
//! - `sensors`: what hangs on it besides the inertial sensors; `babble`: a line gone mad.
//! - [`fault`]: faults by name and time; [`record`]: what a flight leaves behind.
//!
//! The world moves at the samples of the inertial sensors, with the mean of what the motors were
//! told since the last one; without samples, in steps of [`IDLE_STEP`]. All is deterministic.

mod babble;
pub mod fault;
pub mod motors;
mod pins;
pub mod record;
mod sensors;
pub mod serial;
mod setup;
pub mod wires;

use windhover_model::sensor::icm42688p::{Event, Icm42688p, Measurement, Misuse};
use windhover_model::sensor::rc::CHANNELS;
use windhover_model::vehicle::Plant;
use windhover_model::{Conditions, ImuCounts, Integrator, ModelKind, Truth, World, ideal_counts};

use crate::board::{Format, Inputs, Usart};
use crate::parts::Misuse as PartMisuse;
use crate::time::{MICROSECOND, NEVER, SECOND};
use babble::Babble;
use fault::{Action, Socket};
use motors::Motors;
pub use record::Record;
use record::Sample;
use sensors::Sensors;
use serial::Port;
pub use setup::Setup;
pub use wires::{Mounting, Wires};

/// The world's step while there are no samples: longer than their period, so that a sample comes
/// first.
pub const IDLE_STEP: u64 = 1250 * MICROSECOND;

/// What the thermometer reads: 35 °C.
const TEMPERATURE: i16 = 1325;

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
    sensors: Option<Box<Sensors>>,
    motors: Motors,
    world: World,
    log: Vec<u8>,
    commands: Port,
    babble: Babble,
    faults: Vec<(u64, Action)>,
    /// Faults that have come to pass.
    faults_done: usize,
    /// Up to when everything has happened.
    now: u64,
    /// When the world moved last.
    step: u64,
    samples: u64,
    /// The last sample.
    counts: ImuCounts,
    record_every: u64,
    record: Record,
    /// What the processor has not been told yet.
    inputs: Inputs,
    /// Levels of I2C's clock and data that it was told last.
    lines: [bool; 2],
}

impl Rig {
    /// A vehicle in a world, as [`world`] makes it, its power just coming on.
    pub fn new(world: World, setup: &Setup) -> Self {
        Self {
            wires: setup.wires,
            imu: Icm42688p::new(MICROSECOND).with_clock_error(setup.imu_clock_ppm),
            sensors: setup.sensors.clone().map(|suite| {
                let sensors = Sensors::new(suite, setup.gnss, setup.remote);
                Box::new(sensors)
            }),
            motors: Motors::new(setup.wires.motors),
            world,
            log: Vec::new(),
            commands: Port::new(Format::plain(setup.wires.commands_baud)),
            babble: Babble::new(setup.seed),
            faults: fault::schedule(&setup.faults, setup.seed),
            faults_done: 0,
            now: 0,
            step: 0,
            samples: 0,
            counts: ImuCounts::default(),
            record_every: setup.record_every,
            record: Record::default(),
            // Both lines of I2C are pulled up.
            inputs: Inputs {
                levels: setup.wires.i2c.map(|pin| (pin, true)).into(),
                received: Vec::new(),
            },
            lines: [true; 2],
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

    /// Takes what was recorded.
    pub fn take_record(&mut self) -> Record {
        std::mem::take(&mut self.record)
    }

    /// Takes the bytes that the firmware sent to the log since this was done last.
    pub fn take_log(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.log)
    }

    /// The other end of the command port, which is the ground link's.
    pub fn ground_port(&mut self) -> &mut Port {
        &mut self.commands
    }

    /// Sends bytes to the command port, from `now` on or behind those that are on their way.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        self.commands.send(now, bytes);
    }

    /// What the firmware sent to the command port: time in ticks, and byte.
    pub fn answers(&self) -> &[(u64, u8)] {
        self.commands.received()
    }

    /// Takes what the firmware sent to the command port since this was done last.
    pub fn take_answers(&mut self) -> Vec<(u64, u8)> {
        self.commands.take_received()
    }

    /// Moves the pilot's sticks and switches, −1 to 1, where there are sensors.
    pub fn set_sticks(&mut self, sticks: [f64; CHANNELS]) {
        if let Some(sensors) = &mut self.sensors {
            sensors.set_sticks(sticks);
        }
    }

    /// What the firmware did to barometer and compass against their data sheets.
    pub fn part_misuse(&self) -> Vec<PartMisuse> {
        self.sensors
            .as_ref()
            .map_or(Vec::new(), |sensors| sensors.misuse())
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
                let frame = frame.filter(|_| !self.babble.covers(port));
                self.inputs.received.extend(frame.map(|frame| (port, frame)));
            } else if self.babble.next_event() <= next {
                self.inputs.received.extend(self.babble.advance(next));
            } else if self.sensors_next() <= next {
                self.advance_sensors(next);
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
            .min(self.babble.next_event())
            .min(self.sensors_next())
            .min(self.imu.next_event())
            .min(self.step + IDLE_STEP)
    }

    fn next_fault(&self) -> u64 {
        let next = self.faults.get(self.faults_done);
        next.map_or(NEVER, |(time, _)| *time)
    }

    fn sensors_next(&self) -> u64 {
        self.sensors
            .as_ref()
            .map_or(NEVER, |sensors| sensors.next_event())
    }

    fn advance_sensors(&mut self, now: u64) {
        let Some(sensors) = &mut self.sensors else {
            return;
        };
        let before = self.inputs.received.len();
        sensors.advance(now, &self.world, &self.wires, &mut self.inputs);
        let mut heard = self.inputs.received.split_off(before);
        heard.retain(|(port, _)| !self.babble.covers(*port));
        self.inputs.received.append(&mut heard);
    }

    /// The next fault comes to pass.
    fn fail(&mut self) {
        let (time, action) = self.faults[self.faults_done];
        self.faults_done += 1;
        match action {
            Action::Plug(Socket::Imu, true) => self.imu.plug(time),
            Action::Plug(Socket::Imu, false) => self.imu.unplug(time),
            Action::Plug(socket, plugged) => {
                if let Some(sensors) = &mut self.sensors {
                    sensors.plug(time, socket, plugged);
                }
            }
            Action::Hold(line, held) => {
                if let Some(sensors) = &mut self.sensors {
                    sensors.bus.short(line, held);
                }
                self.tell_lines();
            }
            Action::Babble(port, true) => {
                let format = self.format(port);
                self.babble.begin(time, port, format);
            }
            Action::Babble(port, false) => self.babble.end(port),
            Action::Reset => self.imu.reset(time),
            Action::Line(line) => self.imu.set_data_line(line),
            Action::Ready(connected) => self.imu.connect_int1(time, connected),
        }
    }

    /// How the other end of a port speaks, where there is one.
    fn format(&self, port: Usart) -> Format {
        let sensors = self.sensors.as_ref();
        let format = sensors.and_then(|sensors| sensors.format(port, &self.wires));
        format.unwrap_or(self.commands.format())
    }

    /// I2C's lines, where they changed.
    fn tell_lines(&mut self) {
        let Some(sensors) = &self.sensors else {
            return;
        };
        let lines = sensors.bus.lines();
        for (n, pin) in self.wires.i2c.into_iter().enumerate() {
            if lines[n] != self.lines[n] {
                self.inputs.levels.push((pin, lines[n]));
            }
        }
        self.lines = lines;
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
        let counts = self.measure(time, &truth);
        let mounting = self.wires.mounting;
        self.imu.put(&Measurement {
            accel: mounting.to_part(counts.accel),
            gyro: mounting.to_part(counts.gyro),
            temperature: TEMPERATURE,
        });
        self.counts = counts;
        self.samples += 1;
        if self.record_every > 0 && self.samples.is_multiple_of(self.record_every) {
            self.record.samples.push(Sample { time, truth, counts });
        }
    }

    /// Counts along the body's axes; of a sensor that gives none, the last.
    fn measure(&mut self, time: u64, truth: &Truth) -> ImuCounts {
        let Some(sensors) = &mut self.sensors else {
            return ideal_counts(truth);
        };
        let measured = sensors.inertial(time, &self.world);
        measured.map_or(self.counts, |measured| ImuCounts {
            accel: measured.accel,
            gyro: measured.gyro,
        })
    }

    /// Moves the world up to a time.
    fn move_world(&mut self, time: u64) {
        // The world counts whole nanoseconds: from the start, so that nothing adds up.
        let nanoseconds = |ticks: u64| (u128::from(ticks) * 1_000_000_000 / u128::from(SECOND)) as u64;
        let length = nanoseconds(time) - nanoseconds(self.step);
        let command = self.motors.take_step(time);
        self.step = time;
        self.world.step(length as f64 / 1e9, command);
        if let Some(sensors) = &mut self.sensors {
            sensors.moved(time);
        }
    }
}

#[cfg(test)]
mod tests;
