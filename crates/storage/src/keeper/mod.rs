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

mod parameters;
mod plans;

use windhover_autopilot::mission::{MissionSource, PlanKind};
use windhover_autopilot::{MissionCommit, Parameters};

use self::parameters::Step;
use self::plans::Writing;
use crate::journal::{Contents, Loaded, StoreError};
use crate::ledger;
use crate::record::{Slot, Task};

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
    /// Something was found damaged at the start.
    found_damage: bool,
    /// The journal is cleared if that is what it takes.
    may_clear: bool,
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
        for (to, from) in stored.iter_mut().zip(ledger::all(&loaded.parameters)) {
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
            found_damage: loaded.damage.is_any(),
            may_clear: false,
            forced: [false; 3],
            damaged: loaded.damage.plans,
            compared: loaded.plans,
            changes: Changes {
                sum: ledger::values(ledger::all(&loaded.parameters)),
                plans: loaded.plans,
                last: 0,
                first: None,
            },
            hurried: false,
            failures: 0,
            error: None,
        }
    }

    /// The parameters that were loaded are of no use: as where they are damaged, nothing is stored over
    /// them until a human says so.
    pub fn distrust(&mut self) {
        self.on_hold = true;
        self.found_damage = true;
        self.step = None;
    }

    /// A human wants parameters and plans to be stored as they are now. After damage, or where it has
    /// given up, all are written anew: into a journal that is cleared for it, if parameters are
    /// damaged or it does not work otherwise. Else it is [`Keeper::hurry`].
    pub fn accept(&mut self) {
        if self.found_damage || self.failures >= TRIES {
            self.may_clear = true;
            self.rewrite(self.on_hold);
            self.forced = self.damaged;
        }
        self.failures = 0;
        self.hurry();
    }

    /// All parameters are to be written, into the journal or a new one.
    fn rewrite(&mut self, clear: bool) {
        self.on_hold = false;
        self.step = Some(if clear { Step::Clear } else { Step::Rewrite });
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
        if let Some(step) = self.step {
            return self.parameters(step, view.parameters);
        }
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
            if self.failures >= TRIES && self.may_clear {
                self.failures = 0;
                self.may_clear = false;
                self.rewrite(true);
            }
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
        let sum = ledger::values(ledger::all(view.parameters));
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
        let values = ledger::all(parameters).zip(self.stored).zip(0..);
        values.filter_map(|((value, stored), index)| {
            (value.to_bits() != stored.to_bits()).then_some((index, value))
        })
    }
}
