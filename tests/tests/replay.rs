//! Replay: a core that is fed the recorded inputs gives the recorded motor commands, however the
//! schedule was disturbed; and it needs every one of them.

use rayon::prelude::*;
use windhover_autopilot::{
    Imu, InnerInput, MotorCommand, OuterResult, Preset, ScheduleRecord, Snapshot, Urgent,
};
use windhover_math::Vector3;
use windhover_model::{ModelKind, Truth};
use windhover_sim::closed_loop::Recorder;
use windhover_sim::flight::{self, Setup};
use windhover_sim::recording::{Difference, Recording};
use windhover_tests::plan::short;
use windhover_tests::random::random_setup;
use windhover_tests::{recorded, setup, write};

/// `recorded` replays. The flights must have been disturbed, or this would show nothing.
#[test]
fn disturbed_flights_replay_equal() {
    let totals: Vec<Disturbances> = (1..=40u64)
        .into_par_iter()
        .map(|seed| {
            let setup = random_setup(seed);
            let (flight, _) = recorded(&setup, &short());
            let figures = &flight.figures;
            assert!(figures.completed, "seed {seed}: {}", figures.ended);
            let refused = flight.events.iter().filter(|e| e.text.contains("refused"));
            assert_eq!(refused.count(), 2, "seed {seed}: two writes are wrong");
            let mut disturbances = Disturbances::default();
            flight::fly(&setup, &short(), &mut disturbances, &mut |_| {}).unwrap();
            disturbances
        })
        .collect();
    let sum = |of: fn(&Disturbances) -> u64| totals.iter().map(of).sum::<u64>();
    assert!(sum(|d| d.missed_boundaries) > 1000, "outer results were late");
    assert!(sum(|d| d.missing_samples) > 1000, "samples were missing");
    assert_eq!(sum(|d| d.writes), 40 * 9, "every write arrived");
}

/// Counts what disturbs a flight.
#[derive(Default)]
struct Disturbances {
    missed_boundaries: u64,
    missing_samples: u64,
    writes: u64,
}

impl Recorder for Disturbances {
    fn tick(&mut self, _: &Truth, input: &InnerInput, _: MotorCommand, record: Option<ScheduleRecord>) {
        self.missed_boundaries += u64::from(record.is_some_and(|record| !record.snapshot_taken));
        self.missing_samples += u64::from(matches!(input.imu, Imu::Missing { .. }));
    }

    fn outer(&mut self, _: &Truth, snapshot: &Snapshot, _: &OuterResult) {
        self.writes += snapshot.inputs.parameter.len() as u64;
    }
}

/// What is changed in the record, at one moment in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Forgery {
    Nothing,
    Gyro,
    Accelerometer,
    Time,
    Missing,
    Kill,
    LateResult,
    Estimate,
    NoEstimate,
    NoCommand,
    NoWrite,
}

/// Records a flight, but for one input that it forges.
struct Forger {
    recording: Recording,
    forgery: Forgery,
    tick: u64,
    done: bool,
}

/// In cruise, well before the parameter write.
const AT: u64 = 8000;

impl Recorder for Forger {
    fn tick(
        &mut self,
        truth: &Truth,
        input: &InnerInput,
        motors: MotorCommand,
        record: Option<ScheduleRecord>,
    ) {
        let (mut input, mut record) = (*input, record);
        if self.tick >= AT && !self.done {
            self.done = self.forge_tick(&mut input, &mut record);
        }
        self.tick += 1;
        self.recording.tick(truth, &input, motors, record);
    }

    fn outer(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        let mut snapshot = snapshot.clone();
        if !self.done {
            self.done = self.forge_snapshot(&mut snapshot);
        }
        self.recording.outer(truth, &snapshot, result);
    }
}

impl Forger {
    /// Whether the forgery was done.
    fn forge_tick(&self, input: &mut InnerInput, record: &mut Option<ScheduleRecord>) -> bool {
        match (self.forgery, &mut input.imu, record) {
            (Forgery::Gyro, Imu::Sample { counts, .. }, _) => counts.gyro[0] += 8,
            (Forgery::Accelerometer, Imu::Sample { counts, .. }, _) => counts.accel[1] += 40,
            (Forgery::Time, Imu::Sample { time, .. }, _) => *time += 500,
            (Forgery::Missing, imu, _) => *imu = Imu::Missing { time: imu.time() },
            (Forgery::Kill, ..) => input.urgent = Some(Urgent::Kill),
            (Forgery::LateResult, _, Some(record)) => record.adopted = false,
            _ => return false,
        }
        true
    }

    fn forge_snapshot(&self, snapshot: &mut Snapshot) -> bool {
        let inputs = &mut snapshot.inputs;
        let later = self.tick >= AT;
        match self.forgery {
            Forgery::Estimate if later && !inputs.external.is_empty() => {
                inputs.external[0].position += Vector3::new(0.0, 0.01, 0.0);
            }
            Forgery::NoEstimate if later && !inputs.external.is_empty() => inputs.external.clear(),
            Forgery::NoCommand if !inputs.command.is_empty() => inputs.command.clear(),
            Forgery::NoWrite if !inputs.parameter.is_empty() => inputs.parameter.clear(),
            _ => return false,
        }
        true
    }
}

fn replay_forged(forgery: Forgery) -> Result<(), Difference> {
    let setup = Setup {
        writes: vec![(12.0, write("POS_N_P", 6.0))],
        ..setup("os4", Preset::Windhover, ModelKind::Rigid)
    };
    let mission = short();
    let mut forger = Forger {
        recording: Recording::default(),
        forgery,
        tick: 0,
        done: false,
    };
    flight::fly(&setup, &mission, &mut forger, &mut |_| {}).unwrap();
    assert_eq!(forger.done, forgery != Forgery::Nothing, "{forgery:?}");
    let outer = setup.outer(flight::home(&mission)).unwrap();
    forger
        .recording
        .replay(setup.inner_config(), outer, &mission.stored())
}

/// One input of many thousands is enough to tell the flights apart, so equality means something.
#[test]
fn a_record_with_one_forged_input_does_not_replay() {
    assert_eq!(replay_forged(Forgery::Nothing), Ok(()));
    let forgeries = [
        Forgery::Gyro,
        Forgery::Accelerometer,
        Forgery::Time,
        Forgery::Missing,
        Forgery::Kill,
        Forgery::LateResult,
        Forgery::Estimate,
        Forgery::NoEstimate,
        Forgery::NoCommand,
        Forgery::NoWrite,
    ];
    forgeries.into_par_iter().for_each(|forgery| {
        let Err(difference) = replay_forged(forgery) else {
            panic!("{forgery:?} makes no difference");
        };
        let late = forgery != Forgery::NoCommand;
        assert!(
            difference.tick as u64 >= if late { AT } else { 1 },
            "{forgery:?}: {difference:?}"
        );
    });
}
