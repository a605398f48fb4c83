//! The core and a world driven by hand: samples that stay out, results that are held back,
//! commands at any tick.

use windhover_autopilot::mission::PlanKind;
use windhover_autopilot::{
    Command, ExternalEstimate, Imu, ImuCounts, Inner, InnerInput, Mailboxes, MissionCommit, Mode,
    MotorCommand, Outer, OuterResult, Urgent,
};
use windhover_math::{Quaternion, Vector3};
use windhover_model::{Truth, World, ideal_counts};
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file::MissionFile;
use windhover_sim::stored::Stored;

use crate::trace::Step;

/// Armed for so long, the motors have spooled up, s.
pub const SPOOL_UP: f64 = 1.1;

/// A vehicle on the test bench.
pub struct Bench {
    /// The world.
    pub world: World,
    /// The inner step.
    pub inner: Inner,
    /// The outer step.
    pub outer: Outer,
    /// What passes between the two, and the queues of the outer step's inputs.
    pub mailboxes: Mailboxes,
    /// The next tick's urgent command.
    pub urgent: Option<Urgent>,
    /// Whether the IMU gives samples.
    pub imu_alive: bool,
    /// Whether results of the outer step reach the inner one.
    pub outer_alive: bool,
    /// Whether the truth comes in as an estimate from outside.
    pub estimate_alive: bool,
    /// Every motor command so far.
    pub motors: Vec<MotorCommand>,
    /// Every outer step so far.
    pub steps: Vec<Step>,
    stored: Stored,
    held_back: Option<OuterResult>,
    period_us: u64,
    time_us: u64,
}

impl Bench {
    /// This setup with a mission in its storage: disarmed, nothing commanded.
    pub fn new(setup: &Setup, mission: &MissionFile) -> Self {
        let outer = setup.outer(flight::home(mission)).expect("a vehicle that flies");
        Self {
            world: setup.world(),
            inner: Inner::new(setup.inner_config(), outer.inner_parameters()),
            outer,
            mailboxes: Mailboxes::default(),
            urgent: None,
            imu_alive: true,
            outer_alive: true,
            estimate_alive: true,
            motors: Vec::new(),
            steps: Vec::new(),
            stored: mission.stored(),
            held_back: None,
            period_us: 1_000_000 / u64::from(setup.imu_rate),
            time_us: 0,
        }
    }

    /// Commits the mission, arms, starts it when the motors have spooled up, and flies it for so
    /// many seconds.
    pub fn in_mission(setup: &Setup, mission: &MissionFile, seconds: f64) -> Self {
        let mut bench = Self::new(setup, mission);
        bench.command(bench.commit());
        bench.command(Command::Arm);
        bench.run(SPOOL_UP);
        bench.command(Command::Fly(Mode::Mission));
        bench.run(seconds);
        bench
    }

    /// The commit of the stored mission.
    pub fn commit(&self) -> Command {
        let commit = MissionCommit {
            slot: 0,
            count: self.stored.mission.len() as u16,
            crc: 0,
        };
        Command::Commit(PlanKind::Mission, commit)
    }

    /// Puts a command into its queue.
    pub fn command(&mut self, command: Command) {
        self.mailboxes.queues.command.push(command);
    }

    /// Runs for so many seconds.
    pub fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds * 1e6) as u64 / self.period_us {
            self.tick();
        }
    }

    /// One tick.
    pub fn tick(&mut self) -> MotorCommand {
        let truth = self.world.truth();
        let imu = if self.imu_alive {
            let counts = ideal_counts(&truth);
            let counts = ImuCounts {
                accel: counts.accel,
                gyro: counts.gyro,
            };
            Imu::Sample {
                counts,
                time: self.time_us,
            }
        } else {
            Imu::Missing { time: self.time_us }
        };
        let input = InnerInput {
            imu,
            urgent: self.urgent.take(),
        };
        if self.estimate_alive
            && self.inner.schedule().at_boundary()
            && self.mailboxes.queues.external.is_empty()
        {
            self.mailboxes.queues.external.push(estimate(&truth));
        }
        if self.outer_alive && self.held_back.is_some() {
            self.mailboxes.result = self.held_back.take();
        } else if !self.outer_alive && self.mailboxes.result.is_some() {
            self.held_back = self.mailboxes.result.take();
        }
        let output = self.inner.tick(&input, &mut self.mailboxes);
        if let Some(snapshot) = self.mailboxes.snapshot.take() {
            let result = self.outer.step(&snapshot, &self.stored.plans());
            self.steps.push(Step::new(&truth, &result));
            self.mailboxes.result = Some(result);
        }
        self.world
            .step(self.period_us as f64 * 1e-6, output.motors.rotors());
        self.time_us += self.period_us;
        self.motors.push(output.motors);
        output.motors
    }

    /// The last motor command.
    pub fn last(&self) -> MotorCommand {
        *self.motors.last().expect("at least one tick")
    }

    /// The last outer step.
    pub fn last_step(&self) -> &Step {
        self.steps.last().expect("at least one outer step")
    }

    /// Height above the ground, m.
    pub fn height(&self) -> f64 {
        -self.world.truth().position.z
    }
}

/// The truth as an estimate from outside.
pub fn estimate(truth: &Truth) -> ExternalEstimate {
    let narrow = |v: &Vector3<f64>| Vector3::new(v.x as f32, v.y as f32, v.z as f32);
    let q = &truth.attitude;
    ExternalEstimate {
        position: narrow(&truth.position),
        velocity: narrow(&truth.velocity),
        attitude: Quaternion::new(q.w as f32, q.x as f32, q.y as f32, q.z as f32),
    }
}
