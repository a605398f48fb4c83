//! The core flown by attitude setpoints on an inertial sensor that rotors shake.
//!
//! Position and attitude come in true from outside, at every outer step: what is seen in the motor
//! commands besides the setpoints is the gyro's.

use windhover_autopilot::{Command, Imu, ImuCounts, Inner, InnerInput, Mailboxes, Mode, MotorCommand, Outer};
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{Euler, GRAVITY, Quaternion, Vector3};
use windhover_model::World;
use windhover_model::sensor::inertial::{Inertial, InertialErrors};
use windhover_sim::flight::Setup;

use crate::bench::{SPOOL_UP, estimate};

/// A vehicle on the way up.
pub struct Shaken {
    world: World,
    sensor: Inertial,
    inner: Inner,
    outer: Outer,
    mailboxes: Mailboxes,
    weight: f32,
    setpoint: AttitudeSetpoint,
    period_us: u64,
    time_us: u64,
}

impl Shaken {
    /// This setup with the errors of its inertial sensor, in the air and a second after take-off.
    pub fn new(setup: &Setup, errors: &InertialErrors) -> Self {
        let outer = setup.outer(Default::default()).expect("a vehicle that flies");
        let weight = (setup.vehicle.plant.mass * f64::from(GRAVITY)) as f32;
        let mut shaken = Self {
            world: setup.world(),
            sensor: Inertial::new(errors, f64::from(setup.imu_rate), setup.conditions.seed),
            inner: Inner::new(setup.inner_config(), outer.inner_parameters()),
            outer,
            mailboxes: Mailboxes::default(),
            weight,
            setpoint: AttitudeSetpoint {
                attitude: Quaternion::IDENTITY,
                rate: Vector3::zeros(),
                thrust: 0.0,
            },
            period_us: 1_000_000 / u64::from(setup.imu_rate),
            time_us: 0,
        };
        shaken.take_off();
        shaken
    }

    /// The reference conditions' sensor in this setup, with rotors that hover at their speed.
    pub fn errors(setup: &Setup) -> InertialErrors {
        InertialErrors {
            vibration_speed: setup.vehicle.plant.hover_speed(),
            ..InertialErrors::reference(f64::from(setup.imu_rate))
        }
    }

    fn take_off(&mut self) {
        self.steer(0.0, 1.2);
        self.fly(0.1);
        self.mailboxes.queues.command.push(Command::Fly(Mode::Offboard));
        self.mailboxes.queues.command.push(Command::Arm);
        self.fly(0.1 + SPOOL_UP);
        self.fly(1.0);
        self.steer(0.0, 1.02);
        self.fly(1.0);
    }

    /// From now on this roll (rad) and thrust as a share of the weight.
    pub fn steer(&mut self, roll: f32, lift: f32) {
        self.setpoint.attitude = Quaternion::from_euler(Euler {
            roll,
            pitch: 0.0,
            yaw: 0.0,
        });
        self.setpoint.thrust = lift * self.weight;
    }

    /// Flies for so many seconds; the motor command and the true roll (rad) of each tick.
    pub fn fly(&mut self, seconds: f64) -> Vec<(MotorCommand, f64)> {
        let ticks = (seconds * 1e6) as u64 / self.period_us;
        (0..ticks).map(|_| self.tick()).collect()
    }

    fn tick(&mut self) -> (MotorCommand, f64) {
        let truth = self.world.truth();
        let measured = self.sensor.sample(&truth);
        let counts = ImuCounts {
            accel: measured.accel,
            gyro: measured.gyro,
        };
        let input = InnerInput {
            imu: Imu::Sample {
                counts,
                time: self.time_us,
            },
            urgent: None,
        };
        if self.inner.schedule().at_boundary() {
            self.mailboxes.queues.external.push(estimate(&truth));
            self.mailboxes.queues.attitude.push(self.setpoint);
        }
        let motors = self.inner.tick(&input, &mut self.mailboxes).motors;
        if let Some(snapshot) = self.mailboxes.snapshot.take() {
            self.mailboxes.result = Some(self.outer.step(&snapshot, [].as_slice()));
        }
        self.world.step(self.period_us as f64 * 1e-6, motors.rotors());
        self.time_us += self.period_us;
        (motors, truth.attitude.to_euler().roll)
    }
}

/// RMS of the change of rotor commands from tick to tick, as a share of full command.
pub fn roughness(flown: &[(MotorCommand, f64)]) -> f64 {
    let commands: Vec<[u16; 4]> = flown
        .iter()
        .map(|(motors, _)| motors.rotors().expect("motors turn"))
        .collect();
    let steps = commands.windows(2).flat_map(|pair| {
        let (before, after) = (pair[0], pair[1]);
        (0..4).map(move |n| (f64::from(after[n]) - f64::from(before[n])) / 65535.0)
    });
    let (count, sum) = steps.fold((0, 0.0), |(count, sum), step| (count + 1, sum + step * step));
    (sum / f64::from(count)).sqrt()
}

/// How far beyond `wanted` the roll (rad) went, as a share of it.
pub fn overshoot(flown: &[(MotorCommand, f64)], wanted: f64) -> f64 {
    let most = flown.iter().map(|&(_, roll)| roll).fold(0.0, windhover_math::max);
    most / wanted - 1.0
}
