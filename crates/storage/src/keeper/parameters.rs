//! Parameters: as groups through the ledger, or all of them anew.

use heapless::Vec;
use windhover_autopilot::Parameters;

use super::{Changes, Keeper, LATEST, Named, REST, View};
use crate::journal::Contents;
use crate::ledger::{self, GROUP, Ledger, Sums};
use crate::record::{self, Entry, Key, Task};

/// Where parameters stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The group is to be announced.
    Announce,
    /// This one of the group is to be written.
    Member(usize),
    /// Everything is to be forgotten.
    Clear,
    /// All are to be written, over damaged ones.
    Rewrite,
    /// This one is, of all.
    Each(usize),
    /// They are to be settled.
    Settle,
}

impl Keeper {
    pub(super) fn begin_group(&mut self, view: &View<'_>) {
        let since = |time: u64| view.time.saturating_sub(time);
        let Changes { last, first, .. } = self.changes;
        let rested = since(last) >= REST || first.is_some_and(|first| since(first) >= LATEST);
        let rested = rested || self.hurried;
        if self.step.is_some() || !rested {
            return;
        }
        let group: Vec<_, { GROUP }> = self.changed(view.parameters).take(GROUP).collect();
        if group.is_empty() {
            self.hurried = false;
        } else {
            self.contents.group = group;
            self.step = Some(Step::Announce);
        }
        self.changes.first = None;
    }

    pub(super) fn parameters(&mut self, step: Step, parameters: &Parameters) -> Option<Task> {
        self.named = Some(Named::Step);
        let entry = match step {
            Step::Clear => return Some(Task::Clear),
            Step::Announce => {
                let key = |index: u16| Key::Parameter(index.into()).number();
                let group = self.contents.group.iter();
                Ledger::Group(group.map(|(index, value)| (key(*index), *value)).collect()).entry()
            }
            Step::Member(member) => {
                let (index, value) = *self.contents.group.get(member)?;
                self.parameter(index.into(), value)
            }
            Step::Rewrite => Ledger::Rewriting.entry(),
            Step::Each(index) => self.parameter(index, parameters.get(index)?),
            Step::Settle => self.settled().entry(),
        };
        Some(Task::Store(entry))
    }

    fn settled(&self) -> Ledger {
        let mut heads = self.contents.heads.map(|head| head.sum());
        for (sum, is_damaged) in heads.iter_mut().zip(self.damaged) {
            if is_damaged {
                // It stays so, whatever else is settled.
                *sum = !*sum;
            }
        }
        Ledger::Settled(Sums::new(ledger::values(self.stored.into_iter()), heads))
    }

    fn parameter(&mut self, index: usize, value: f32) -> Entry {
        self.named = Some(Named::Parameter(index, value));
        record::parameter(index, value)
    }

    /// The step is done.
    pub(super) fn stepped(&mut self) {
        self.contents.is_new = false;
        self.step = match self.step {
            Some(Step::Announce) => Some(Step::Member(0)),
            Some(Step::Member(member)) if member + 1 < self.contents.group.len() => {
                Some(Step::Member(member + 1))
            }
            Some(Step::Member(_)) => Some(Step::Settle),
            Some(Step::Clear) => {
                self.may_clear = false;
                self.contents = Contents {
                    is_new: true,
                    ..Contents::default()
                };
                self.forced = [true; 3];
                self.writing = None;
                Some(Step::Rewrite)
            }
            Some(Step::Rewrite) => Some(Step::Each(0)),
            Some(Step::Each(index)) if index + 1 < Parameters::COUNT => Some(Step::Each(index + 1)),
            Some(Step::Each(_)) => Some(Step::Settle),
            Some(Step::Settle) | None => {
                if let Some(writing) = &mut self.writing {
                    writing.is_open = false;
                }
                None
            }
        };
    }
}
