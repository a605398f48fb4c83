//! Plans: chunk by chunk into the slot that is not valid, then the head.

use heapless::Vec;
use windhover_autopilot::MissionCommit;
use windhover_autopilot::mission::{MissionItem, MissionSource, PlanKind, PlanMemory};
use windhover_flight_log::crc32;

use super::parameters::Step;
use super::{Keeper, Named, View};
use crate::journal::StoreError;
use crate::ledger::Ledger;
use crate::record::{self, CHUNK_ITEMS, Head, KINDS, Slot, Task};

/// A plan that is being written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Writing {
    pub(super) kind: PlanKind,
    pub(super) commit: MissionCommit,
    pub(super) slot: Slot,
    /// How many chunks are written.
    pub(super) chunks: u8,
    /// CRC-32 over their items.
    pub(super) crc: u32,
    /// The ledger is open for the head.
    pub(super) is_open: bool,
}

impl Keeper {
    pub(super) fn begin_plan(&mut self, view: &View<'_>) {
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
                if self.contents.is_new {
                    self.step = Some(Step::Settle);
                    return;
                }
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

    pub(super) fn plan<S: MissionSource + ?Sized>(&mut self, writing: &Writing, source: &S) -> Option<Task> {
        let Writing {
            kind,
            commit,
            slot,
            chunks,
            crc,
            is_open,
        } = *writing;
        if commit.count > PlanMemory::capacity(kind) {
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
    pub(super) fn written(&mut self) {
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

    pub(super) fn give_back(&mut self) -> Option<Task> {
        let (kind, slot, chunk) = self.contents.unused()?;
        self.named = Some(Named::GivenBack(kind, slot, chunk));
        Some(Task::Store(record::chunk(kind, slot, chunk, &[])))
    }
}
