//! What is to be stored next: a machine without flash, clock or interrupts.
//!
//! It compares what the core has with what is stored, and names one task at a time:
//!
//! - Parameters that changed are stored as a group once they have rested for [`REST`], so that a
//!   calibration, which sets several, is stored whole. The group is announced in the ledger,
//!   written, and settled: at any moment a start finds all of it or nothing.
//! - A plan that was committed is written chunk by chunk into the slot that is not valid. Its head
//!   makes it valid, if the items had the CRC that they were committed with; the ledger is open
//!   meanwhile. Then the chunks of the other slot are given back.
//!
//! Nothing is named while the vehicle is armed. What fails is tried [`TRIES`] times, then again
//! only after something changed or the vehicle was armed: a full or broken flash is not worn out.
//!
//! Where parameters were found damaged, nothing is stored until [`Keeper::accept`]: else a restart
//! would arm with defaults that nobody has looked at.

use heapless::Vec;
use windhover_autopilot::mission::{MissionItem, MissionSource, PlanKind};
use windhover_autopilot::{MissionCommit, Parameters};
use windhover_flight_log::crc32;

use crate::capacity;
use crate::journal::{Contents, Loaded, StoreError};
use crate::record::{self, CHUNK_ITEMS, Entry, Head, KINDS, Key, Ledger, Slot, Sums, Task};

/// Parameters are stored when they have not changed for so long, µs.
pub const REST: u64 = 500_000;

/// They are stored after so long at the latest, µs.
pub const LATEST: u64 = 5_000_000;

/// So many failures in a row, and it is left.
pub const TRIES: u32 = 3;

/// What the core has now.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Time since start, µs.
    pub time: u64,
    /// Whether motors may turn.
    pub armed: bool,
    /// All parameters.
    pub parameters: &'a Parameters,
    /// The plans in use, by the number of their kind.
    pub plans: [MissionCommit; 3],
}

/// Where parameters stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
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

/// A plan that is being written.
#[derive(Clone, Copy, Debug)]
struct Writing {
    kind: PlanKind,
    commit: MissionCommit,
    slot: Slot,
    /// How many chunks are written.
    chunks: u8,
    /// CRC-32 over their items.
    crc: u32,
    /// The ledger is open for the head.
    is_open: bool,
}

/// What was named last, and is not done yet.
#[derive(Clone, Copy, Debug)]
enum Named {
    /// The step of the parameters.
    Step,
    /// A parameter of it.
    Parameter(usize, f32),
    /// The next chunk of the plan that is being written; with it the CRC is this.
    Chunk(u32),
    /// The ledger, for the head of that plan.
    Open,
    /// The head of that plan.
    Head,
    /// A chunk is given back.
    GivenBack(PlanKind, Slot, u8),
}

/// See the [module](self).
#[derive(Clone, Debug)]
pub struct Keeper {
    contents: Contents,
    /// Values in the journal; NaN where it is not known.
    stored: [f32; Parameters::COUNT],
    step: Option<Step>,
    writing: Option<Writing>,
    named: Option<Named>,
    /// Parameters are damaged, and nobody has accepted the ones that there are now.
    on_hold: bool,
    /// The journal cannot be read: it has to be cleared first.
    unreadable: bool,
    /// Parameters have values that are refused.
    refused: bool,
    /// Plans that are written even if they are as they were.
    forced: [bool; 3],
    damaged: [bool; 3],
    /// The plans in use when they were last compared.
    compared: [MissionCommit; 3],
    changes: Changes,
    hurried: bool,
    failures: u32,
    error: Option<StoreError>,
}

/// When what is seen changed.
#[derive(Clone, Copy, Debug)]
struct Changes {
    /// Sum over parameters.
    sum: u32,
    plans: [MissionCommit; 3],
    last: u64,
    /// The first change since parameters were last stored.
    first: Option<u64>,
}

impl Keeper {
    /// After a start that found this.
    pub fn new(loaded: &Loaded) -> Self {
        let mut stored = [f32::NAN; Parameters::COUNT];
        for (to, from) in stored.iter_mut().zip(record::all(&loaded.parameters)) {
            *to = from;
        }
        let contents = loaded.contents.clone();
        let on_hold = loaded.damage.parameters;
        let step = match (on_hold, contents.group.is_empty(), contents.unsettled) {
            (false, false, _) => Some(Step::Member(0)),
            (false, true, true) => Some(Step::Settle),
            _ => None,
        };
        Self {
            contents,
            stored,
            step,
            writing: None,
            named: None,
            on_hold,
            unreadable: on_hold && loaded.damage.journal,
            refused: loaded.damage.refused > 0,
            forced: [false; 3],
            damaged: loaded.damage.plans,
            compared: loaded.plans,
            changes: Changes {
                sum: record::values(record::all(&loaded.parameters)),
                plans: loaded.plans,
                last: 0,
                first: None,
            },
            hurried: false,
            failures: 0,
            error: None,
        }
    }

    /// A human has looked at parameters and plans, after they were found damaged, and they are to be
    /// stored as they are now. Without damage it is [`Keeper::hurry`].
    pub fn accept(&mut self) {
        if self.on_hold || self.refused {
            (self.on_hold, self.refused) = (false, false);
            self.step = Some(if self.unreadable {
                Step::Clear
            } else {
                Step::Rewrite
            });
        }
        self.forced = self.damaged;
        self.failures = 0;
        self.hurry();
    }

    /// Parameters need not rest this time: a restart follows, or somebody asked to store them.
    pub fn hurry(&mut self) {
        self.hurried = true;
    }

    /// Why it has given up until something changes, if it has.
    pub fn given_up(&self) -> Option<StoreError> {
        self.error.filter(|_| self.failures >= TRIES)
    }

    /// Whether something is not stored that will be as soon as it may.
    pub fn is_behind(&self, view: &View<'_>) -> bool {
        let parameters = self.changed(view.parameters).next().is_some();
        let plans = view.plans != self.compared || self.forced.contains(&true);
        let under_way = self.step.is_some() || self.writing.is_some();
        under_way || !self.on_hold && (parameters || plans || self.contents.unused().is_some())
    }

    /// What is to be done now, if anything. The same again until [`Keeper::done`] has said how it
    /// went.
    pub fn next<S: MissionSource + ?Sized>(&mut self, view: &View<'_>, source: &S) -> Option<Task> {
        self.named = None;
        if view.armed {
            self.failures = 0;
            return None;
        }
        self.look(view);
        if self.failures >= TRIES || self.on_hold {
            return None;
        }
        self.begin_group(view);
        if let Some(step) = self.step {
            return self.parameters(step, view.parameters);
        }
        self.begin_plan(view);
        if let Some(writing) = self.writing {
            return self.plan(&writing, source);
        }
        self.give_back()
    }

    /// What [`Keeper::next`] named is done, or not.
    pub fn done(&mut self, outcome: Result<(), StoreError>) {
        let Some(named) = self.named.take() else { return };
        if let Err(error) = outcome {
            self.failures += 1;
            self.error = Some(error);
            return;
        }
        self.failures = 0;
        match named {
            Named::Step => self.stepped(),
            Named::Parameter(index, value) => {
                if let Some(stored) = self.stored.get_mut(index) {
                    *stored = value;
                }
                self.stepped();
            }
            Named::Chunk(crc) => {
                if let Some(writing) = &mut self.writing {
                    writing.chunks += 1;
                    writing.crc = crc;
                }
            }
            Named::Open => {
                if let Some(writing) = &mut self.writing {
                    writing.is_open = true;
                }
            }
            Named::Head => self.written(),
            Named::GivenBack(kind, slot, chunk) => self.contents.set_used(kind, slot, chunk, false),
        }
    }

    fn give_up(&mut self, error: StoreError) -> Option<Task> {
        self.failures = TRIES;
        self.error = Some(error);
        None
    }

    /// Notes when what there is has changed.
    fn look(&mut self, view: &View<'_>) {
        let sum = record::values(record::all(view.parameters));
        let changes = &mut self.changes;
        if sum != changes.sum {
            changes.sum = sum;
            changes.last = view.time;
            changes.first = changes.first.or(Some(view.time));
            self.failures = 0;
        }
        if view.plans != changes.plans {
            changes.plans = view.plans;
            self.failures = 0;
        }
    }

    /// Parameters with values that are not stored: index and value.
    fn changed(&self, parameters: &Parameters) -> impl Iterator<Item = (u16, f32)> {
        let values = record::all(parameters).zip(self.stored).zip(0..);
        values.filter_map(|((value, stored), index)| {
            (value.to_bits() != stored.to_bits()).then_some((index, value))
        })
    }
}

/// Parameters.
impl Keeper {
    fn begin_group(&mut self, view: &View<'_>) {
        let since = |time: u64| view.time.saturating_sub(time);
        let Changes { last, first, .. } = self.changes;
        let rested = since(last) >= REST || first.is_some_and(|first| since(first) >= LATEST);
        let rested = rested || self.hurried;
        if self.step.is_some() || !rested {
            return;
        }
        let group: Vec<_, { record::GROUP }> = self.changed(view.parameters).take(record::GROUP).collect();
        if group.is_empty() {
            self.hurried = false;
        } else {
            self.contents.group = group;
            self.step = Some(Step::Announce);
        }
        self.changes.first = None;
    }

    fn parameters(&mut self, step: Step, parameters: &Parameters) -> Option<Task> {
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
        Ledger::Settled(Sums::new(record::values(self.stored.into_iter()), heads))
    }

    fn parameter(&mut self, index: usize, value: f32) -> Entry {
        self.named = Some(Named::Parameter(index, value));
        record::parameter(index, value)
    }

    /// The step is done.
    fn stepped(&mut self) {
        self.step = match self.step {
            Some(Step::Announce) => Some(Step::Member(0)),
            Some(Step::Member(member)) if member + 1 < self.contents.group.len() => {
                Some(Step::Member(member + 1))
            }
            Some(Step::Member(_)) => Some(Step::Settle),
            Some(Step::Clear) => {
                self.unreadable = false;
                self.contents = Contents::default();
                self.forced = [true; 3];
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

/// Plans.
impl Keeper {
    fn begin_plan(&mut self, view: &View<'_>) {
        if let Some(writing) = self.writing
            && view.plans.get(usize::from(writing.kind.code())) != Some(&writing.commit)
        {
            // It is no longer in use; what was written of it is given back.
            self.writing = None;
            if writing.is_open {
                self.step = Some(Step::Settle);
            }
        }
        if self.writing.is_some() || self.contents.unused().is_some() {
            return;
        }
        for (place, (kind, commit)) in KINDS.into_iter().zip(view.plans).enumerate() {
            let head = self.contents.heads.get(place).copied().unwrap_or_default();
            let flag = |flags: &[bool; 3]| flags.get(place) == Some(&true);
            let must = flag(&self.forced) || flag(&self.damaged) && self.compared.get(place) != Some(&commit);
            if must || !flag(&self.damaged) && !head.holds(&commit) {
                self.writing = Some(Writing {
                    kind,
                    commit,
                    slot: head.slot.other(),
                    chunks: 0,
                    crc: 0,
                    is_open: false,
                });
                return;
            }
            if let Some(compared) = self.compared.get_mut(place) {
                *compared = commit;
            }
        }
    }

    fn plan<S: MissionSource + ?Sized>(&mut self, writing: &Writing, source: &S) -> Option<Task> {
        let Writing {
            kind,
            commit,
            slot,
            chunks,
            crc,
            is_open,
        } = *writing;
        if commit.count > capacity(kind) {
            return self.give_up(StoreError::Full);
        }
        let first = u16::from(chunks) * CHUNK_ITEMS as u16;
        if first >= commit.count {
            if crc != commit.crc {
                // The memory does not hold what was committed.
                self.writing = None;
                return self.give_up(StoreError::Damaged);
            }
            if !is_open {
                self.named = Some(Named::Open);
                return Some(Task::Store(Ledger::Group(Vec::new()).entry()));
            }
            self.named = Some(Named::Head);
            return Some(Task::Store(Self::head(writing).entry(kind)));
        }
        let items: Vec<MissionItem, CHUNK_ITEMS> = (first..commit.count)
            .take(CHUNK_ITEMS)
            .map_while(|index| source.item(kind, commit.slot, index))
            .collect();
        let entry = record::chunk(kind, slot, chunks, &items);
        self.named = Some(Named::Chunk(crc32(crc, &entry.value)));
        // Whatever becomes of it: there may be items.
        self.contents.set_used(kind, slot, chunks, true);
        Some(Task::Store(entry))
    }

    fn head(writing: &Writing) -> Head {
        Head {
            slot: writing.slot,
            count: writing.commit.count,
            crc: writing.commit.crc,
        }
    }

    /// The plan is valid.
    fn written(&mut self) {
        let Some(writing) = self.writing.take() else {
            return;
        };
        self.step = Some(Step::Settle);
        let place = usize::from(writing.kind.code());
        if let Some(head) = self.contents.heads.get_mut(place) {
            *head = Self::head(&writing);
        }
        if let Some(compared) = self.compared.get_mut(place) {
            *compared = writing.commit;
        }
        for flags in [&mut self.forced, &mut self.damaged] {
            if let Some(flag) = flags.get_mut(place) {
                *flag = false;
            }
        }
    }

    fn give_back(&mut self) -> Option<Task> {
        let (kind, slot, chunk) = self.contents.unused()?;
        self.named = Some(Named::GivenBack(kind, slot, chunk));
        Some(Task::Store(record::chunk(kind, slot, chunk, &[])))
    }
}
