//! Who decides: whether the motors may turn, which mode flies, and which failsafe acts.
//!
//! A small state and one pure step, so that all of it can be explored (`explore`). Time is not in
//! here: timers are cut into "before" and "after" outside, in [`crate::watch`], and come in as
//! [`Facts`]. The failsafes are the rows of a table, [`row`]; what they do is ordered, [`action`].
//!
//! Rules, in the order in which a step applies them:
//!
//! 1. Motors that the inner step has stopped: disarmed.
//! 2. On the ground or in flight, as the detector says.
//! 3. A mode that is done hands over to the next one.
//! 4. The worst row that is active acts, unless the operator has overridden it; a mode that does as
//!    much already is not interrupted; a row that is over lets the interrupted mode resume if its
//!    line says so.
//! 5. A mode whose entry conditions are gone falls back: to level flight, then to a level descent;
//!    it goes on when they are back, where no failsafe has acted meanwhile.
//! 6. Time on the ground: disarmed.

pub mod action;
#[cfg(test)]
mod explore;
pub mod parameters;
pub mod row;

use crate::mode::{Mode, ModeSet};
pub use action::Action;
pub use parameters::SafetyParameters;
pub use row::{Actions, Override, Row, RowSet};

/// Where a vehicle is between two flights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Motors may not turn.
    #[default]
    Disarmed,
    /// Motors turn; the vehicle has not left the ground.
    Armed,
    /// In flight.
    Flying,
    /// On the ground again.
    Landed,
}

impl Phase {
    /// All of them, in their order.
    pub const ALL: [Self; 4] = [Self::Disarmed, Self::Armed, Self::Flying, Self::Landed];
}

/// What a step is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// The inner step keeps the motors stopped.
    pub stopped: bool,
    /// The vehicle has left the ground.
    pub airborne: bool,
    /// It has stood on the ground for so long that it is to disarm.
    pub disarm_due: bool,
    /// The modes whose entry conditions hold.
    pub available: ModeSet,
    /// The mode that flies is done, and this one follows.
    pub next: Option<Mode>,
    /// The rows whose condition has lasted.
    pub active: RowSet,
    /// Those of them that have become so since the last step.
    pub rising: RowSet,
}

/// What an operator may ask for, as far as it changes this state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Let the motors turn; whether something speaks against it.
    Arm {
        /// Something does.
        blocked: bool,
    },
    /// Let the motors turn, whatever speaks against it.
    ForceArm,
    /// Stop the motors of a vehicle on the ground.
    Disarm,
    /// Fly in this mode.
    Fly(Mode),
}

/// Why an order is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Denied {
    /// The inner step keeps the motors stopped.
    Stopped,
    /// There are blockers.
    Blocked,
    /// The vehicle is in flight.
    InFlight,
    /// The vehicle is on the ground.
    OnGround,
    /// The entry conditions of the mode do not hold.
    Unavailable(Mode),
    /// This failsafe acts, and does not yield.
    Failsafe(Row),
}

/// The state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Supervisor {
    phase: Phase,
    mode: Mode,
    acting: Option<Row>,
    /// The worst action that the operator has overridden since anything was active.
    overridden: Action,
    /// The mode that was interrupted.
    interrupted: Option<Mode>,
}

impl Supervisor {
    /// Where the vehicle is between two flights.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The mode that flies, or will when the vehicle is armed.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The failsafe that acts.
    pub fn acting(&self) -> Option<Row> {
        self.acting
    }

    /// The mode that goes on when the failsafe is over.
    pub fn interrupted(&self) -> Option<Mode> {
        self.interrupted
    }

    /// Motors off. The next flight begins in hold.
    fn disarm(&mut self) {
        *self = Self::default();
    }

    /// One step, by the rules above.
    pub fn step(&mut self, facts: &Facts, actions: &Actions) {
        if facts.stopped {
            let named = if self.phase == Phase::Disarmed {
                self.acting
            } else {
                facts.active.contains(Row::ImuMissing).then_some(Row::ImuMissing)
            };
            self.disarm();
            // It is named, though nothing is left to be done.
            self.acting = named;
        }
        if self.phase == Phase::Disarmed {
            return;
        }
        match (self.phase, facts.airborne) {
            (Phase::Flying, false) => {
                self.phase = Phase::Landed;
                // What was interrupted in the air is over.
                self.interrupted = None;
            }
            (_, true) => self.phase = Phase::Flying,
            _ => {}
        }
        if let Some(next) = facts.next {
            self.mode = next;
        }
        self.watch(facts, actions);
        if self.phase == Phase::Disarmed {
            return;
        }
        self.carry_out(actions);
        self.come_back(facts.available, actions);
        self.fall_back(facts.available, actions);
        if facts.disarm_due && self.phase != Phase::Flying {
            self.disarm();
        }
    }

    /// Lets the worst row act.
    fn watch(&mut self, facts: &Facts, actions: &Actions) {
        let on_ground = self.phase != Phase::Flying;
        let active = if on_ground {
            facts.active.and(row::ON_GROUND)
        } else {
            facts.active
        };
        if facts.active.is_empty() {
            self.overridden = Action::None;
        }
        let worst = actions.worst(self.not_overridden(active, facts.rising, actions));
        match (self.acting, worst) {
            (Some(acting), Some(worst)) if active.contains(acting) => {
                if actions.of(worst) > actions.of(acting) {
                    self.begin(worst, actions);
                }
            }
            (Some(acting), _) if active.contains(acting) => {}
            // What acted is over, and something less is left.
            (Some(acting), Some(worst)) => {
                if actions.of(worst) < Action::Hold {
                    self.end(acting, facts.available);
                }
                self.act(worst, actions);
            }
            (Some(acting), None) => self.end(acting, facts.available),
            (None, Some(worst)) => self.begin(worst, actions),
            (None, None) => {}
        }
    }

    /// The rows that may act: all but those that the operator has overridden.
    fn not_overridden(&self, active: RowSet, rising: RowSet, actions: &Actions) -> RowSet {
        if self.overridden == Action::None {
            return active;
        }
        active.iter().fold(RowSet::default(), |set, row| {
            let free = rising.contains(row)
                || actions.of(row) > self.overridden
                || (row.watched().yields_to == Override::Nobody && self.phase == Phase::Flying);
            set.with(row, free)
        })
    }

    fn begin(&mut self, row: Row, actions: &Actions) {
        let before = self.acting.map_or(Action::None, |acting| actions.of(acting));
        if before < Action::Hold
            && actions.of(row) >= Action::Hold
            && self.interrupted.is_none()
            && self.phase == Phase::Flying
        {
            self.interrupted = Some(self.mode);
        }
        self.act(row, actions);
    }

    fn act(&mut self, row: Row, actions: &Actions) {
        self.acting = Some(row);
        let action = actions.of(row);
        if action == Action::Terminate || (action >= Action::Hold && self.phase != Phase::Flying) {
            self.disarm();
            // It is named, though nothing is left to be done.
            self.acting = Some(row);
        }
    }

    /// The mode is one that does at least what the row that acts asks for: also when that could not
    /// be done until now.
    fn carry_out(&mut self, actions: &Actions) {
        if self.phase != Phase::Flying {
            return;
        }
        let action = self.acting.map_or(Action::None, |row| actions.of(row));
        if let Some(mode) = action.mode().filter(|_| action > Action::of(self.mode)) {
            self.mode = mode;
        }
    }

    /// What acted is over, and nothing else is active.
    fn end(&mut self, acting: Row, available: ModeSet) {
        self.acting = None;
        if let Some(mode) = self.interrupted.take()
            && acting.watched().resumes
            && available.contains(mode)
            && self.phase == Phase::Flying
        {
            self.mode = mode;
        }
    }

    /// Whether a failsafe flies, and not the operator's mode.
    fn is_interrupting(&self, actions: &Actions) -> bool {
        self.acting.is_some_and(|row| actions.of(row) >= Action::Hold)
    }

    /// A mode that fell back goes on as soon as it can, unless a failsafe has it.
    fn come_back(&mut self, available: ModeSet, actions: &Actions) {
        if !self.is_interrupting(actions)
            && let Some(mode) = self.interrupted.take_if(|mode| available.contains(*mode))
        {
            self.mode = mode;
        }
    }

    /// Level flight, and then a level descent, for modes whose entry conditions are gone.
    fn fall_back(&mut self, available: ModeSet, actions: &Actions) {
        if available.contains(self.mode) {
            return;
        }
        let flying = self.phase == Phase::Flying;
        if flying && !self.is_interrupting(actions) && self.interrupted.is_none() {
            self.interrupted = Some(self.mode);
        }
        let landing = matches!(self.mode, Mode::Land | Mode::Descend | Mode::Altitude);
        self.mode = if !landing && available.contains(Mode::Altitude) {
            Mode::Altitude
        } else {
            Mode::Descend
        };
    }

    /// Takes an order, or says why not.
    pub fn order(&mut self, order: Order, facts: &Facts, actions: &Actions) -> Result<(), Denied> {
        match order {
            Order::Arm { .. } | Order::ForceArm if facts.stopped => Err(Denied::Stopped),
            Order::Arm { .. } | Order::ForceArm if self.phase != Phase::Disarmed => Ok(()),
            Order::Arm { blocked: true } => Err(Denied::Blocked),
            Order::Arm { .. } | Order::ForceArm => {
                // Whoever arms knows what is wrong already: only what comes then acts.
                *self = Self {
                    phase: Phase::Armed,
                    mode: self.mode,
                    overridden: actions
                        .worst(facts.active)
                        .map_or(Action::None, |row| actions.of(row)),
                    ..Self::default()
                };
                Ok(())
            }
            Order::Disarm if self.phase == Phase::Flying => Err(Denied::InFlight),
            Order::Disarm => {
                self.disarm();
                Ok(())
            }
            Order::Fly(mode) => self.fly(mode, facts, actions),
        }
    }

    fn fly(&mut self, mode: Mode, facts: &Facts, actions: &Actions) -> Result<(), Denied> {
        let flying = self.phase == Phase::Flying;
        if facts.stopped {
            return Err(Denied::Stopped);
        }
        if let Some(row) = self.acting
            && actions.of(row) >= Action::Hold
            && self.phase != Phase::Disarmed
        {
            let yields = match row.watched().yields_to {
                Override::Operator => true,
                Override::Pilot => mode.is_manual(),
                Override::Nobody => false,
            };
            if !yields {
                return Err(Denied::Failsafe(row));
            }
        }
        // Down is always to be had: level, where the place is not known.
        let lands = mode == Mode::Land && flying && !facts.available.contains(mode);
        let mode = if lands { Mode::Descend } else { mode };
        match mode {
            Mode::Takeoff if flying => return Err(Denied::InFlight),
            Mode::Land | Mode::Return | Mode::Descend if !flying => return Err(Denied::OnGround),
            _ if !facts.available.contains(mode) => return Err(Denied::Unavailable(mode)),
            _ => {}
        }
        if let Some(row) = self.acting.take_if(|row| actions.of(*row) >= Action::Hold) {
            self.overridden = self.overridden.max(actions.of(row));
        }
        self.interrupted = None;
        self.mode = mode;
        if self.phase == Phase::Landed {
            self.phase = Phase::Armed;
        }
        Ok(())
    }
}
