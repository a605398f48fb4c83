//! What the core has told since it was last asked.

use core::ops::DerefMut;

use heapless::Deque;
use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::schedule::OUTER_RATE;
use windhover_autopilot::{
    Command, CompassSample, GnssSample, Imu, ImuCounts, MotorCommand, OuterReport, OuterResult,
    ParameterWrite, RcFrame, Refused, ScheduleRecord, Snapshot, Why,
};
use windhover_math::{Quaternion, Vector3};

/// Room for answers: a link asks for four commands and four parameters at a time, and others may too.
const OUTCOMES: usize = 16;

/// Room for what happens in some ten outer steps.
const HAPPENED: usize = 8;

/// Room for samples of the inertial sensors: one an outer period.
const SAMPLES: usize = 16;

/// A sample stands for an outer period, s.
pub(crate) const SAMPLE_PERIOD: f32 = 1.0 / OUTER_RATE as f32;

/// Room for samples of the compass.
const COMPASS: usize = 8;

/// What the core made of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// A command, and why it was refused if it was.
    Command(Command, Option<Why>),
    /// A write to the parameter table, and why it was refused if it was.
    Parameter(ParameterWrite, Option<windhover_parameters::Refusal>),
}

/// Something that happened in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Happened {
    /// What.
    pub event: MissionEvent,
    /// When, µs since start.
    pub time: u64,
    /// Where the vehicle believed to be, NED, m from the origin.
    pub position: Vector3,
    /// Its attitude, body to world.
    pub attitude: Quaternion,
}

/// What the core has told: filled by whoever runs its steps, taken by whoever serves the links.
#[derive(Clone, Debug, Default)]
pub struct Told {
    report: Option<OuterReport>,
    /// µs since start.
    pub(crate) time: u64,
    /// Body rates, FRD, rad/s: the mean of the last outer period.
    pub(crate) rate: Vector3,
    /// Thrust that is asked for, N.
    pub(crate) thrust: f32,
    /// What the motors were told last, in the core's order.
    pub(crate) motors: [u16; 4],
    pub(crate) gnss: Option<GnssSample>,
    samples: Deque<ImuCounts, SAMPLES>,
    compass: Deque<CompassSample, COMPASS>,
    radio: Option<(u64, RcFrame)>,
    outcomes: Deque<Outcome, OUTCOMES>,
    happened: Deque<Happened, HAPPENED>,
    dropped: u32,
}

impl Told {
    /// One outer step.
    pub fn outer(&mut self, snapshot: &Snapshot, result: &OuterResult) {
        let increments = &snapshot.increments;
        if increments.duration > 0.0 {
            let turn = increments.rotation.shortest();
            self.rate = Vector3::new(turn.x, turn.y, turn.z) * (2.0 / increments.duration);
        }
        self.time = snapshot.time;
        self.thrust = result.setpoint.thrust;
        if let Some(gnss) = snapshot.inputs.gnss.last() {
            self.gnss = Some(*gnss);
        }
        for sample in &snapshot.inputs.compass {
            keep_newest(&mut self.compass, *sample);
        }
        if let Some(frame) = snapshot.inputs.rc.last() {
            self.radio = Some((snapshot.time, *frame));
        }
        self.settle(snapshot, &result.report);
        let estimate = &result.report.estimate;
        for event in &result.report.events {
            let happened = Happened {
                event: *event,
                time: snapshot.time,
                position: estimate.position,
                attitude: estimate.attitude,
            };
            self.count(|told| told.happened.push_back(happened).is_err());
        }
        let report = self.report.insert(result.report.clone());
        report.events.clear();
        report.refusals.clear();
    }

    /// One tick.
    #[inline]
    pub fn tick(&mut self, imu: &Imu, motors: MotorCommand, record: Option<ScheduleRecord>) {
        if record.is_none() {
            return;
        }
        self.motors = motors.rotors().unwrap_or_default();
        if let Imu::Sample { counts, .. } = imu {
            keep_newest(&mut self.samples, *counts);
        }
    }

    /// What was refused names what it was; all else of the inputs was done.
    fn settle(&mut self, snapshot: &Snapshot, report: &OuterReport) {
        let inputs = &snapshot.inputs;
        let mut refusals: [_; 10] = core::array::from_fn(|index| report.refusals.get(index));
        for write in &inputs.parameter {
            let refused = take_out(&mut refusals, |refused| match refused {
                Refused::Parameter(of, refusal) if of == write => Some(*refusal),
                _ => None,
            });
            self.outcome(Outcome::Parameter(*write, refused));
        }
        for command in &inputs.command {
            let refused = take_out(&mut refusals, |refused| match refused {
                Refused::Command(of, why) if of == command => Some(*why),
                _ => None,
            });
            self.outcome(Outcome::Command(*command, refused));
        }
    }

    fn outcome(&mut self, outcome: Outcome) {
        self.count(|told| told.outcomes.push_back(outcome).is_err());
    }

    fn count(&mut self, drops: impl FnOnce(&mut Self) -> bool) {
        if drops(self) {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Hands over all since the last time, in exchange for what was handed over then; the state stays as
    /// it is. The two change places: nothing large is moved, so that interrupts may be off meanwhile.
    pub fn take<P: DerefMut<Target = Self>>(telling: &mut P, taken: &mut P) {
        core::mem::swap(telling, taken);
        telling.begin_after(taken);
    }

    fn begin_after(&mut self, taken: &Self) {
        self.report = None;
        self.samples.clear();
        self.compass.clear();
        self.outcomes.clear();
        self.happened.clear();
        (self.time, self.rate, self.thrust) = (taken.time, taken.rate, taken.thrust);
        (self.motors, self.gnss, self.radio) = (taken.motors, taken.gnss, taken.radio);
        self.dropped = taken.dropped;
    }

    /// The last report, without its events and refusals; `None` where there was no step.
    pub fn report(&self) -> Option<&OuterReport> {
        self.report.as_ref()
    }

    /// Samples of the inertial sensors, one of each outer period, in order.
    pub(crate) fn samples(&self) -> impl Iterator<Item = &ImuCounts> {
        self.samples.iter()
    }

    /// Samples of the compass, in order.
    pub(crate) fn compass(&self) -> impl Iterator<Item = &CompassSample> {
        self.compass.iter()
    }

    /// The remote control's last frame, and when it came, µs.
    pub(crate) fn radio(&self) -> Option<(u64, RcFrame)> {
        self.radio
    }

    /// What became of inputs, in order.
    pub fn outcomes(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes.iter()
    }

    /// What happened in flight, in order.
    pub fn happened(&self) -> impl Iterator<Item = &Happened> {
        self.happened.iter()
    }

    /// How much found no room since start.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }
}

/// Samples of which the newest count: the oldest one makes room.
fn keep_newest<T, const CAPACITY: usize>(queue: &mut Deque<T, CAPACITY>, item: T) {
    if queue.is_full() {
        queue.pop_front();
    }
    let _ = queue.push_back(item);
}

/// Takes out the first one that fits.
fn take_out<T>(refusals: &mut [Option<&Refused>], fits: impl Fn(&Refused) -> Option<T>) -> Option<T> {
    refusals.iter_mut().find_map(|place| {
        let found = fits((*place)?)?;
        *place = None;
        Some(found)
    })
}
