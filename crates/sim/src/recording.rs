//! A flight's record in memory, and its replay: the same inputs give the same motor commands.

use windhover_autopilot::{
    Inner, InnerConfig, InnerInput, Mailboxes, MotorCommand, Outer, OuterInputs, OuterResult, ScheduleRecord,
    Snapshot,
};
use windhover_model::Truth;

use crate::closed_loop::Recorder;
use crate::stored::Stored;

/// Everything that the core consumed, and what it commanded.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    inputs: Vec<InnerInput>,
    motors: Vec<MotorCommand>,
    boundaries: Vec<ScheduleRecord>,
    frozen: Vec<OuterInputs>,
}

impl Recorder for Recording {
    fn tick(&mut self, _: &Truth, input: &InnerInput, motors: MotorCommand, record: Option<ScheduleRecord>) {
        self.inputs.push(*input);
        self.motors.push(motors);
        self.boundaries.extend(record);
    }

    fn outer(&mut self, _: &Truth, snapshot: &Snapshot, _: &OuterResult) {
        self.frozen.push(snapshot.inputs.clone());
    }
}

/// The first difference between a flight and its replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// The tick.
    pub tick: usize,
    /// What was commanded in flight.
    pub flown: MotorCommand,
    /// What replay commands.
    pub replayed: MotorCommand,
}

impl Recording {
    /// How many ticks there are.
    pub fn ticks(&self) -> usize {
        self.inputs.len()
    }

    /// What the motors were told, tick by tick.
    pub fn motors(&self) -> &[MotorCommand] {
        &self.motors
    }

    /// Runs a core that is as new on the recorded inputs. Its schedule follows the records: a
    /// result is adopted where it was adopted in flight.
    pub fn replay(&self, config: InnerConfig, mut outer: Outer, stored: &Stored) -> Result<(), Difference> {
        let mut inner = Inner::new(config, outer.inner_parameters());
        let mut mailboxes = Mailboxes::default();
        let (mut boundaries, mut frozen) = (self.boundaries.iter(), self.frozen.iter());
        let mut result = None;
        for (tick, (input, &flown)) in self.inputs.iter().zip(&self.motors).enumerate() {
            if inner.schedule().at_boundary() {
                let record = boundaries.next().copied();
                if record.is_some_and(|record| record.adopted) {
                    mailboxes.result = result.take();
                }
                if record.is_some_and(|record| record.snapshot_taken)
                    && let Some(inputs) = frozen.next()
                {
                    mailboxes.queues.refill(inputs);
                }
            }
            let output = inner.tick(input, &mut mailboxes);
            if output.motors != flown {
                return Err(Difference {
                    tick,
                    flown,
                    replayed: output.motors,
                });
            }
            if let Some(snapshot) = mailboxes.snapshot.take() {
                result = Some(outer.step(&snapshot, &stored.plans()));
            }
        }
        Ok(())
    }
}
