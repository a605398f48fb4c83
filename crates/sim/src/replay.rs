//! Replay: the core again on a log's inputs, and every output compared bit for bit.

use windhover_autopilot::{
    Inner, InnerParameters, Mailboxes, MotorCommand, Outer, OuterResult, Parameters, Snapshot,
};
use windhover_flight_log::reader::{
    CoreSetup, Log, Period, Periods, PlanStore, Reason, SetupError, Step, difference,
};
use windhover_flight_log::{LoggerConfig, View, period_hash, result_hash};

/// The first output that replay did not repeat.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("tick {tick} ({time:.3} s): {topic}.{field} was {flown}, replayed {replayed}")]
pub struct Difference {
    /// The tick.
    pub tick: u32,
    /// Its time, s.
    pub time: f64,
    /// The topic that differs.
    pub topic: String,
    /// Its field.
    pub field: String,
    /// As flown.
    pub flown: String,
    /// As replayed.
    pub replayed: String,
}

/// How a replay came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Ticks that were replayed.
    pub ticks: u32,
    /// Motor commands that were compared.
    pub compared: u64,
    /// Flight time that they cover, s.
    pub seconds: f64,
    /// From which tick on inputs are missing; replay ends there.
    pub missing_from: Option<u32>,
    /// Why the log ends before it was finished, where it does.
    pub cut: Option<String>,
    /// The first difference.
    pub difference: Option<Difference>,
}

/// How commands would have differed with another parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Rotor commands that were compared: in flight in both.
    pub commands: u64,
    /// Those that differ.
    pub changed: u64,
    /// Root mean square of the difference, as a share of full command.
    pub rms: f64,
    /// Largest difference, as a share of full command.
    pub largest: f64,
    /// Time of the largest difference, s.
    pub largest_time: f64,
}

/// Why a log cannot be replayed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The header does not say what the core was made with.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// The parameters describe no vehicle that can fly.
    #[error("the logged parameters describe no vehicle that can fly")]
    Vehicle,
}

/// Replays a log and compares.
pub fn replay(log: &Log<'_>) -> Result<Replay, ReplayError> {
    let setup = CoreSetup::new(log)?;
    let mut core = Core::new(&setup, setup.parameters)?;
    let mut replay = Replay {
        ticks: 0,
        compared: 0,
        seconds: 0.0,
        missing_from: None,
        cut: None,
        difference: None,
    };
    let mut periods = log.periods();
    for step in periods.by_ref() {
        match step {
            Step::Gap { from, .. } => {
                replay.missing_from = Some(from);
                return Ok(replay);
            }
            Step::Period(period) => {
                let outputs = core.period(&period);
                replay.ticks = period.next_tick();
                replay.seconds = f64::from(replay.ticks) / f64::from(setup.inner.imu_rate);
                replay.compared += period.outputs().map_or(0, |(flown, _)| flown.len() as u64);
                replay.difference = core.compare(&period, &outputs);
                if replay.difference.is_some() {
                    return Ok(replay);
                }
            }
        }
    }
    replay.cut = cut(&periods);
    Ok(replay)
}

/// Replays a log's inputs with other `parameters` than were flown, open loop: the vehicle goes on
/// as it did, whatever it is told.
pub fn with_parameters(log: &Log<'_>, change: impl FnOnce(&mut Parameters)) -> Result<Change, ReplayError> {
    let setup = CoreSetup::new(log)?;
    let mut parameters = setup.parameters;
    change(&mut parameters);
    let mut core = Core::new(&setup, parameters)?;
    let mut sum = Change::default();
    let mut squares = 0.0;
    for step in log.periods() {
        let Step::Period(period) = step else {
            break;
        };
        let outputs = core.period(&period);
        let flown = period.outputs().map_or(&[][..], |(flown, _)| flown);
        for ((flown, replayed), input) in flown.iter().zip(&outputs.motors).zip(&period.ticks) {
            let (MotorCommand::Run(a), MotorCommand::Run(b)) = (flown, replayed) else {
                continue;
            };
            for (a, b) in a.iter().zip(b) {
                let off = f64::from(a.abs_diff(*b)) / 65_535.0;
                sum.commands += 1;
                sum.changed += u64::from(a != b);
                squares += off * off;
                if off > sum.largest {
                    sum.largest = off;
                    sum.largest_time = input.imu.time() as f64 * 1e-6;
                }
            }
        }
    }
    sum.rms = (squares / windhover_math::max(sum.commands, 1) as f64).sqrt();
    Ok(sum)
}

fn cut(periods: &Periods<'_>) -> Option<String> {
    let end = periods.end()?;
    (end.reason != Reason::Complete).then(|| format!("{} at byte {}", end.reason, end.offset))
}

/// What the core gave in one period.
struct Outputs {
    motors: Vec<MotorCommand>,
    hash: u32,
}

/// The core, driven by a log's periods.
struct Core {
    inner: Inner,
    outer: Outer,
    mailboxes: Mailboxes,
    plans: PlanStore,
    /// The outer step's last work, and its result until it is adopted.
    last: Option<(Snapshot, OuterResult)>,
    pending: Option<OuterResult>,
    thrust_max: f32,
}

impl Core {
    fn new(setup: &CoreSetup, parameters: Parameters) -> Result<Self, ReplayError> {
        let outer = Outer::new(parameters, &setup.outer).ok_or(ReplayError::Vehicle)?;
        let inner: InnerParameters = outer.inner_parameters();
        Ok(Self {
            inner: Inner::new(setup.inner, inner),
            outer,
            mailboxes: Mailboxes::default(),
            plans: setup.plans.clone(),
            last: None,
            pending: None,
            thrust_max: LoggerConfig::new(setup.inner, &setup.parameters).thrust_max,
        })
    }

    /// One period: the schedule follows the record.
    fn period(&mut self, period: &Period) -> Outputs {
        for item in &period.items {
            self.plans.put(item);
        }
        if period.record.adopted {
            self.mailboxes.result = self.pending.take();
        }
        if let Some(inputs) = &period.inputs {
            self.mailboxes.queues.refill(inputs);
        }
        let adopted = self.mailboxes.result.as_ref().map(result_hash);
        let mut motors = Vec::with_capacity(period.ticks.len());
        for input in &period.ticks {
            motors.push(self.inner.tick(input, &mut self.mailboxes).motors);
            if let Some(snapshot) = self.mailboxes.snapshot.take() {
                let result = self.outer.step(&snapshot, &self.plans);
                self.pending = Some(result.clone());
                self.last = Some((snapshot, result));
            }
        }
        let hash = period_hash(adopted, &motors);
        Outputs { motors, hash }
    }

    /// The first output of a period that is not as it was flown.
    fn compare(&self, period: &Period, outputs: &Outputs) -> Option<Difference> {
        let time = |n: usize| {
            period
                .ticks
                .get(n)
                .map_or(0.0, |input| input.imu.time() as f64 * 1e-6)
        };
        let differs = |n: usize, topic: &str, field: String, flown: String, replayed: String| Difference {
            tick: period.record.tick.wrapping_add(n as u32),
            time: time(n),
            topic: topic.into(),
            field,
            flown,
            replayed,
        };
        let (flown, hash) = period
            .outputs()
            .map_or((&[][..], None), |(flown, hash)| (flown, Some(hash)));
        for (n, (a, b)) in flown.iter().zip(&outputs.motors).enumerate() {
            if let Some((field, a, b)) = motor_difference(*a, *b) {
                return Some(differs(n, "motor_batch", field, a, b));
            }
        }
        for (at, view) in &period.views {
            if let Some(d) = self.view_difference(*at, view) {
                return Some(differs(0, d.topic, d.field, d.expected, d.found));
            }
        }
        match hash {
            Some(hash) if hash != outputs.hash => {
                let show = |hash: u32| format!("{hash:#010x}");
                Some(differs(
                    0,
                    "motor_batch",
                    "hash".into(),
                    show(hash),
                    show(outputs.hash),
                ))
            }
            _ => None,
        }
    }

    fn view_difference(&self, time: u64, view: &View) -> Option<windhover_flight_log::reader::Difference> {
        let (snapshot, result) = self.last.as_ref()?;
        if snapshot.time != time {
            return None;
        }
        let again = view.again(snapshot, result, self.thrust_max)?;
        difference(view, &again)
    }
}

/// Field and values in which two motor commands differ.
fn motor_difference(flown: MotorCommand, replayed: MotorCommand) -> Option<(String, String, String)> {
    if flown == replayed {
        return None;
    }
    if let (MotorCommand::Run(a), MotorCommand::Run(b)) = (flown, replayed) {
        let rotor = a.iter().zip(&b).position(|(a, b)| a != b)?;
        return Some((
            format!("rotor[{rotor}]"),
            a[rotor].to_string(),
            b[rotor].to_string(),
        ));
    }
    Some(("state".into(), format!("{flown:?}"), format!("{replayed:?}")))
}
