//! Uploads and clearances that come while a plan is still on its way to the core: they wait for their
//! turn. So a client may clear and upload right after one another, as many do, even without waiting
//! for the answer.

use super::{MissionResult, MissionService, PlanKind, Surroundings, kinds};
use crate::frame::Address;

/// What waits at most; of one client.
pub(super) const TURNS: usize = 4;

/// After this time it is tried all the same, µs.
const PATIENCE: u64 = 500_000;

/// What a client wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wanted {
    /// To upload so many items.
    Upload(PlanKind, u16),
    /// To empty plans, by the code of their kind.
    Empty(u8),
}

impl Wanted {
    /// `MAV_MISSION_TYPE` as it was asked for.
    fn code(self) -> u8 {
        match self {
            Self::Upload(kind, _) => kind.code(),
            Self::Empty(code) => code,
        }
    }
}

/// Something that waits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    wanted: Wanted,
    from: Address,
    since: u64,
}

impl Turn {
    fn has_come(&self, around: &Surroundings<'_>) -> bool {
        let mut kinds = kinds(self.wanted.code()).iter();
        let late = around.now.saturating_sub(self.since) >= PATIENCE;
        late || !kinds.any(|kind| around.plans.is_settling(*kind))
    }
}

impl MissionService {
    /// Does what a client wants, at once or when its turn comes.
    pub(super) fn want(&mut self, wanted: Wanted, from: Address, around: &mut Surroundings<'_>) {
        let since = around.now;
        let turn = Turn { wanted, from, since };
        if self.turns.is_empty() && turn.has_come(around) {
            return self.perform(wanted, from, around);
        }
        // The same again: repeated by the network, or by a client that heard no answer.
        let is_known = |other: &Turn| (other.wanted, other.from) == (wanted, from);
        let is_others = self.turns.iter().any(|other| other.from != from);
        if !self.turns.back().is_some_and(is_known) && (is_others || self.turns.push_back(turn).is_err()) {
            around.ack(from, wanted.code(), MissionResult::Denied);
        }
    }

    /// Does what waited, as far as its turn has come.
    pub(super) fn take_turns(&mut self, around: &mut Surroundings<'_>) {
        while let Some(turn) = self.turns.front().copied()
            && turn.has_come(around)
        {
            self.turns.pop_front();
            self.perform(turn.wanted, turn.from, around);
        }
    }

    fn perform(&mut self, wanted: Wanted, from: Address, around: &mut Surroundings<'_>) {
        match wanted {
            Wanted::Upload(kind, count) => self.upload(kind, count, from, around),
            Wanted::Empty(code) => self.empty(code, from, around),
        }
    }
}
