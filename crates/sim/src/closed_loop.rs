//! The core and the world, tick by tick: what the firmware does with interrupts and tasks.

use windhover_autopilot::mission::PlanMemory;
use windhover_autopilot::{
    ExternalEstimate, Imu, ImuCounts, Inner, InnerConfig, InnerInput, Mailboxes, MotorCommand, Outer,
    OuterResult, ScheduleRecord, Snapshot, Urgent,
};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{Quaternion, Vector3};
use windhover_model::random::Random;
use windhover_model::{Truth, World};

use crate::sensors::Sensing;
use crate::stored::Stored;

/// Ways in which a real board disturbs the schedule, drawn at random from a seed.
#[derive(Clone, Debug)]
pub struct Disruption {
    random: Random,
    /// Chance that an outer result is late.
    pub late: f64,
    /// By at most so many boundaries.
    pub late_most: u32,
    /// Chance that samples go missing, each tick.
    pub missing: f64,
    /// At most so many in a row.
    pub missing_most: u32,
    missing_left: u32,
}

impl Disruption {
    /// Disruptions that follow from `seed`.
    pub fn new(seed: u64, late: f64, late_most: u32, missing: f64, missing_most: u32) -> Self {
        Self {
            random: Random::new(seed, 77),
            late,
            late_most,
            missing,
            missing_most,
            missing_left: 0,
        }
    }

    fn lateness(&mut self) -> u32 {
        if self.random.uniform() < self.late {
            1 + (self.random.uniform() * f64::from(self.late_most)) as u32
        } else {
            0
        }
    }

    fn is_missing(&mut self) -> bool {
        if self.missing_left > 0 {
            self.missing_left -= 1;
            return true;
        }
        let begins = self.random.uniform() < self.missing;
        if begins {
            self.missing_left = (self.random.uniform() * f64::from(self.missing_most)) as u32;
        }
        begins
    }
}

/// Sees everything that goes into the core and comes out of it, with the truth behind it.
pub trait Recorder {
    /// One tick.
    fn tick(
        &mut self,
        truth: &Truth,
        input: &InnerInput,
        motors: MotorCommand,
        record: Option<ScheduleRecord>,
    );
    /// One outer step: what it worked on and what it made of it.
    fn outer(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult);
}

/// Records nothing.
impl Recorder for () {
    #[inline(always)]
    fn tick(&mut self, _: &Truth, _: &InnerInput, _: MotorCommand, _: Option<ScheduleRecord>) {}
    #[inline(always)]
    fn outer(&mut self, _: &Truth, _: &Snapshot, _: &OuterResult) {}
}

/// Both record.
impl<A: Recorder, B: Recorder> Recorder for (&mut A, &mut B) {
    fn tick(
        &mut self,
        truth: &Truth,
        input: &InnerInput,
        motors: MotorCommand,
        record: Option<ScheduleRecord>,
    ) {
        self.0.tick(truth, input, motors, record);
        self.1.tick(truth, input, motors, record);
    }
    fn outer(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        self.0.outer(truth, snapshot, result);
        self.1.outer(truth, snapshot, result);
    }
}

/// Word from outside comes so often, as from motion capture; inertial increments carry the
/// estimate on in between.
const EXTERNAL_PERIOD_US: u64 = 20_000;

/// Where the core's estimate comes from.
#[derive(Clone, Debug)]
enum Source {
    /// The truth, as word from outside.
    Truth,
    /// Sensors.
    Sensors(Box<Sensing>),
}

/// A vehicle in its world, flown by the core.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    /// The world.
    pub world: World,
    /// What passes between the steps; whoever stands outside puts inputs into its queues.
    pub mailboxes: Mailboxes,
    /// The next tick's urgent command.
    pub urgent: Option<Urgent>,
    /// A rotor that stands still, whatever it is told, in the core's order.
    pub dead_rotor: Option<usize>,
    /// The plans on board.
    pub plans: PlanMemory,
    /// The next outer result is late by so many boundaries.
    pub delay: u32,
    config: InnerConfig,
    inner: Inner,
    outer: Outer,
    /// A result that is not ready yet, and how many boundaries it is still late.
    late: Option<(OuterResult, u32)>,
    disruption: Option<Disruption>,
    source: Source,
    home: GlobalPosition,
    /// From the world's origin to the core's, m: a receiver that errs puts the core's elsewhere.
    /// Heights count from the ground in both.
    origin: Option<Vector3<f64>>,
    period: f64,
    period_us: u64,
    time_us: u64,
    next_external_us: u64,
}

impl ClosedLoop {
    /// The core `outer` in `world`, which lies at `home`, with the plans that are stored on board.
    pub fn new(
        world: World,
        config: InnerConfig,
        outer: Outer,
        stored: &Stored,
        home: GlobalPosition,
    ) -> Self {
        Self {
            world,
            mailboxes: Mailboxes::default(),
            urgent: None,
            dead_rotor: None,
            delay: 0,
            config,
            inner: Inner::new(config, outer.inner_parameters()),
            outer,
            plans: stored.memory(),
            late: None,
            disruption: None,
            source: Source::Truth,
            home,
            origin: None,
            period: 1.0 / f64::from(config.imu_rate),
            period_us: 1_000_000 / u64::from(config.imu_rate),
            time_us: 0,
            next_external_us: 0,
        }
    }

    /// The same, with results that come late and samples that are missing.
    pub fn disrupted(mut self, disruption: Disruption) -> Self {
        self.disruption = Some(disruption);
        self
    }

    /// The same on sensors.
    pub fn sensing(mut self, sensing: Sensing) -> Self {
        self.source = Source::Sensors(Box::new(sensing));
        self
    }

    /// The outer step, for its parameters and its state.
    pub fn outer(&self) -> &Outer {
        &self.outer
    }

    /// The sensors, if it flies on such.
    pub fn sensing_mut(&mut self) -> Option<&mut Sensing> {
        match &mut self.source {
            Source::Sensors(sensing) => Some(sensing),
            Source::Truth => None,
        }
    }

    /// What the inner step was made with.
    pub fn inner_config(&self) -> &InnerConfig {
        &self.config
    }

    /// One tick: the core on a sample of the world, then the world under the core's command.
    #[inline]
    pub fn tick<R: Recorder>(&mut self, recorder: &mut R) {
        let mut truth = self.world.truth();
        let input = self.input(&truth);
        self.release();
        if matches!(self.source, Source::Truth) {
            self.tell(&truth);
        } else {
            self.find_origin(&mut truth);
        }
        let output = self.inner.tick(&input, &mut self.mailboxes);
        recorder.tick(&truth, &input, output.motors, output.record);
        if let Some(snapshot) = &self.mailboxes.snapshot {
            let result = self.outer.step(snapshot, &self.plans);
            let result = self.mailboxes.result.insert(result);
            recorder.outer(&truth, snapshot, result);
            self.mailboxes.snapshot = None;
            self.hold_back();
        }
        let mut rotors = output.motors.rotors();
        if let (Some(rotors), Some(dead)) = (&mut rotors, self.dead_rotor) {
            rotors[dead] = 0;
        }
        self.world.step(self.period, rotors);
        self.time_us += self.period_us;
    }

    /// Word from outside, when it is due and taken in.
    #[inline]
    fn tell(&mut self, truth: &Truth) {
        let schedule = self.inner.schedule();
        let taken = schedule.at_boundary() && (self.mailboxes.result.is_some() || !schedule.is_busy());
        if taken && self.time_us >= self.next_external_us {
            self.next_external_us = self.time_us + EXTERNAL_PERIOD_US;
            self.mailboxes.queues.external.push(external(truth));
        }
    }

    /// What is recorded of the truth counts from the core's origin, as all else that is recorded.
    fn find_origin(&mut self, truth: &mut Truth) {
        if self.origin.is_none()
            && let Some(frame) = self.outer.estimation().frame()
        {
            let away = LocalFrame::new(self.home).to_local(frame.origin());
            self.origin = Some(Vector3::new(f64::from(away.x), f64::from(away.y), 0.0));
        }
        truth.position -= self.origin.unwrap_or_default();
    }

    #[inline]
    fn input(&mut self, truth: &Truth) -> InnerInput {
        let measured = match &mut self.source {
            Source::Truth => Some(counts(truth)),
            Source::Sensors(sensing) => sensing.advance(truth, self.time_us, &mut self.mailboxes.queues),
        };
        let missing = self.disruption.as_mut().is_some_and(Disruption::is_missing);
        let imu = match measured.filter(|_| !missing) {
            // The time-out tick comes half a period later than the sample would have.
            None => Imu::Missing {
                time: self.time_us + self.period_us / 2,
            },
            Some(counts) => Imu::Sample {
                counts,
                time: self.time_us,
            },
        };
        InnerInput {
            imu,
            urgent: self.urgent.take(),
        }
    }

    /// Holds the result back where it is to be late.
    #[inline]
    fn hold_back(&mut self) {
        let boundaries = self.disruption.as_mut().map_or(0, Disruption::lateness);
        let boundaries = boundaries + core::mem::take(&mut self.delay);
        if boundaries > 0 {
            self.late = self.mailboxes.result.take().map(|result| (result, boundaries));
        }
    }

    #[inline]
    fn release(&mut self) {
        if self.late.is_none() || !self.inner.schedule().at_boundary() {
            return;
        }
        if let Some((result, boundaries)) = self.late.take() {
            if boundaries == 0 {
                self.mailboxes.result = Some(result);
            } else {
                self.late = Some((result, boundaries - 1));
            }
        }
    }
}

#[inline]
fn counts(truth: &Truth) -> ImuCounts {
    let ideal = windhover_model::imu::ideal_counts(truth);
    ImuCounts {
        accel: ideal.accel,
        gyro: ideal.gyro,
    }
}

fn narrow(v: &Vector3<f64>) -> Vector3 {
    Vector3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// The truth as an estimate from outside.
fn external(truth: &Truth) -> ExternalEstimate {
    let q = &truth.attitude;
    ExternalEstimate {
        position: narrow(&truth.position),
        velocity: narrow(&truth.velocity),
        attitude: Quaternion::new(q.w as f32, q.x as f32, q.y as f32, q.z as f32),
    }
}
