//! A flight as replay needs it: period by period, what went into the core and what came out.

use std::boxed::Box;
use std::string::String;
use std::vec::Vec;

use windhover_autopilot::{InnerInput, MotorCommand, OuterInputs, ScheduleRecord, Urgent};

use super::end::{End, Reason};
use super::entries::{Entries, Entry};
use crate::batch::{ImuBatch, MAX_K};
use crate::motors::MotorBatch;
use crate::plan::PlanItem;
use crate::topics;
use crate::views::View;

/// The most urgent commands, views and items that are kept for one period.
const MOST: usize = 1024;

/// Numbers of topics from which on nothing is needed for replay.
const FIRST_VIEW: u16 = 32;

/// One period of the outer step.
#[derive(Clone, Debug, PartialEq)]
pub struct Period {
    /// The boundary with which it begins.
    pub record: ScheduleRecord,
    /// The inputs of its ticks; fewer than K only at the end of a log.
    pub ticks: heapless::Vec<InnerInput, MAX_K>,
    /// What the boundary's snapshot froze; `None` when no snapshot was taken.
    pub inputs: Option<OuterInputs>,
    /// Items that were stored before it.
    pub items: Vec<PlanItem>,
    /// What the core gave; `None` when the log had no room for it.
    pub outputs: Option<MotorBatch>,
    /// Records for people with their times (µs), written since the period before.
    pub views: Vec<(u64, View)>,
}

impl Period {
    /// The motor command of each tick, and the hash of all outputs, where they were logged.
    pub fn outputs(&self) -> Option<(&[MotorCommand], u32)> {
        let outputs = self.outputs.as_ref()?;
        Some((outputs.commands(), outputs.hash))
    }

    /// The first tick after it.
    pub fn next_tick(&self) -> u32 {
        self.record.tick.wrapping_add(self.ticks.len() as u32)
    }
}

/// What comes next in a flight.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A period.
    Period(Box<Period>),
    /// Inputs are missing.
    Gap {
        /// From this tick on.
        from: u32,
        /// The first tick that is there again.
        until: u32,
    },
}

/// Iterates over a flight, period by period.
#[derive(Clone, Debug)]
pub struct Periods<'a> {
    entries: Entries<'a>,
    /// The period whose outputs may still follow.
    open: Option<Box<Period>>,
    /// What comes after it was handed out.
    next: Option<Step>,
    expected_tick: u32,
    inputs: Option<(u32, OuterInputs)>,
    urgents: Vec<(u32, Urgent)>,
    items: Vec<PlanItem>,
    views: Vec<(u64, View)>,
}

impl<'a> Periods<'a> {
    pub(super) fn new(entries: Entries<'a>) -> Self {
        Self {
            entries,
            open: None,
            next: None,
            expected_tick: 0,
            inputs: None,
            urgents: Vec::new(),
            items: Vec::new(),
            views: Vec::new(),
        }
    }

    /// Where and why it ended; `None` before the last period was taken.
    pub fn end(&self) -> Option<&End> {
        self.entries.end()
    }

    /// Records for people that came after the last period.
    pub fn last_views(&self) -> &[(u64, View)] {
        &self.views
    }

    /// Takes in one record; `Some` when something is complete.
    fn take(&mut self, entry: Entry<'a>) -> Result<Option<Step>, Reason> {
        match entry {
            Entry::Imu(batch) => return Ok(self.begin(&batch)),
            Entry::Motors { batch, .. } => self.outputs(batch),
            Entry::Urgent { tick, urgent } => keep(&mut self.urgents, (tick, urgent))?,
            Entry::Item(item) => keep(&mut self.items, item)?,
            Entry::Input { tick, input } => {
                if self.inputs.as_ref().is_none_or(|(at, _)| *at != tick) {
                    self.inputs = Some((tick, OuterInputs::default()));
                }
                if let Some((_, inputs)) = &mut self.inputs
                    && !input.put_into(inputs)
                {
                    return Err(Reason::TooMany('D'));
                }
            }
            Entry::View {
                view: View::Gap(gap), ..
            } => {
                self.expected_tick = gap.until;
                self.inputs = None;
                self.urgents.clear();
                let step = Step::Gap {
                    from: gap.from,
                    until: gap.until,
                };
                return Ok(Some(self.after_open(step)));
            }
            // People's records are no reason to stop; too many are left out.
            Entry::View { time, view } => {
                let _ = keep(&mut self.views, (time, view));
            }
            Entry::Mismatched(name) if topics::find(name).is_some_and(|topic| topic.id < FIRST_VIEW) => {
                return Err(Reason::Format(String::from(name)));
            }
            Entry::Text { .. } | Entry::Dropout(_) | Entry::Mismatched(_) | Entry::Foreign(..) => {}
        }
        Ok(None)
    }

    /// Hands out the open period first, where there is one.
    fn after_open(&mut self, step: Step) -> Step {
        match self.open.take() {
            Some(period) => {
                self.next = Some(step);
                Step::Period(period)
            }
            None => step,
        }
    }

    fn begin(&mut self, batch: &ImuBatch) -> Option<Step> {
        let record = batch.record;
        let inputs = self.inputs.take().filter(|(tick, _)| *tick == record.tick);
        let inputs = inputs.map(|(_, inputs)| inputs);
        let urgents = core::mem::take(&mut self.urgents);
        let ticks = (0..usize::from(batch.count))
            .filter_map(|n| batch.imu(n))
            .zip(0..)
            .map(|(imu, n)| {
                let tick = record.tick.wrapping_add(n);
                let urgent = urgents.iter().find(|(at, _)| *at == tick);
                InnerInput {
                    imu,
                    urgent: urgent.map(|(_, urgent)| *urgent),
                }
            });
        let period = Box::new(Period {
            record,
            ticks: ticks.collect(),
            inputs: record.snapshot_taken.then(|| inputs.unwrap_or_default()),
            items: core::mem::take(&mut self.items),
            outputs: None,
            views: core::mem::take(&mut self.views),
        });
        let from = core::mem::replace(&mut self.expected_tick, period.next_tick());
        if from == record.tick {
            return self.open.replace(period).map(Step::Period);
        }
        let gap = Step::Gap {
            from,
            until: record.tick,
        };
        let step = self.after_open(gap);
        self.open = Some(period);
        Some(step)
    }

    fn outputs(&mut self, batch: MotorBatch) {
        if let Some(period) = &mut self.open
            && period.record.tick as u16 == batch.tick
            && period.ticks.len() == usize::from(batch.count)
        {
            period.outputs = Some(batch);
        }
    }
}

fn keep<T>(list: &mut Vec<T>, one: T) -> Result<(), Reason> {
    if list.len() >= MOST {
        return Err(Reason::TooMany('D'));
    }
    list.push(one);
    Ok(())
}

impl Iterator for Periods<'_> {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        if let Some(step) = self.next.take() {
            return Some(step);
        }
        while let Some((offset, entry)) = self.entries.next_at() {
            match self.take(entry) {
                Ok(Some(step)) => return Some(step),
                Ok(None) => {}
                Err(reason) => self.entries.stop(offset, reason),
            }
        }
        self.open.take().map(Step::Period)
    }
}
