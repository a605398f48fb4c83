//! Plans: staged beside the one in use, and committed whole when the core has taken them.

use crate::refusal::of_item;
use windhover_autopilot::fence::{self, Rally};
use windhover_autopilot::mission::route::Stored;
use windhover_autopilot::mission::{MissionItem, MissionSource, PlanMemory, check};
use windhover_autopilot::{MissionCommit, Mode, OuterReport, Parameters, Phase};
use windhover_ground_link::{MissionResult, PlanKind, PlanRefusal, PlanStore};

/// Where items are kept: of each kind two slots.
pub trait PlanMedium: MissionSource {
    /// Empties a slot.
    fn clear(&mut self, kind: PlanKind, slot: u8);
    /// Puts an item at the end of a slot; whether there was room.
    fn push(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> bool;
}

impl PlanMedium for PlanMemory {
    fn clear(&mut self, kind: PlanKind, slot: u8) {
        Self::clear(self, kind, slot);
    }

    fn push(&mut self, kind: PlanKind, slot: u8, _index: u16, item: &MissionItem) -> bool {
        Self::push(self, kind, slot, *item)
    }
}

/// How far the core has followed with a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Handing {
    /// It has the one in use.
    #[default]
    Done,
    /// It is to be told.
    Due,
    /// It was told.
    Asked,
}

/// One kind of plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Kept {
    /// The one in use.
    now: MissionCommit,
    /// The one before: in use again if the core does not take the new one.
    before: MissionCommit,
    handing: Handing,
    staging: bool,
}

/// Which plans are in use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanState {
    kept: [Kept; 3],
}

impl PlanState {
    pub fn new(plans: [MissionCommit; 3]) -> Self {
        Self {
            kept: plans.map(|now| Kept {
                now,
                before: now,
                ..Kept::default()
            }),
        }
    }

    fn of(&self, kind: PlanKind) -> &Kept {
        let [mission, fence, rally] = &self.kept;
        match kind {
            PlanKind::Mission => mission,
            PlanKind::Fence => fence,
            PlanKind::Rally => rally,
        }
    }

    fn of_mut(&mut self, kind: PlanKind) -> &mut Kept {
        let [mission, fence, rally] = &mut self.kept;
        match kind {
            PlanKind::Mission => mission,
            PlanKind::Fence => fence,
            PlanKind::Rally => rally,
        }
    }

    pub fn committed(&self, kind: PlanKind) -> MissionCommit {
        self.of(kind).now
    }

    /// What the core is to be told of next, once.
    pub fn next_commit(&mut self, kind: PlanKind) -> Option<MissionCommit> {
        let kept = self.of_mut(kind);
        (kept.handing == Handing::Due).then(|| {
            kept.handing = Handing::Asked;
            kept.now
        })
    }

    /// What the core made of it.
    pub fn answered(&mut self, kind: PlanKind, commit: &MissionCommit, taken: bool) {
        let kept = self.of_mut(kind);
        if kept.handing == Handing::Asked && kept.now == *commit {
            kept.handing = Handing::Done;
            if !taken {
                kept.now = kept.before;
            }
        }
    }
}

/// The store that links see.
pub struct Plans<'a> {
    pub state: &'a mut PlanState,
    pub medium: &'a mut dyn PlanMedium,
    pub report: &'a OuterReport,
    pub parameters: &'a Parameters,
}

impl Plans<'_> {
    /// A mission that is being flown, or that a failsafe has interrupted, stays.
    fn is_flown(&self, kind: PlanKind) -> bool {
        let report = self.report;
        kind == PlanKind::Mission
            && report.phase != Phase::Disarmed
            && (report.mode == Mode::Mission || (report.failsafe.is_some() && report.mission.begun))
    }

    fn check_whole(&self, kind: PlanKind, commit: &MissionCommit) -> Result<(), PlanRefusal> {
        let MissionCommit { slot, count, .. } = *commit;
        let of_fence = |(index, refusal): (u16, fence::FenceRefusal)| {
            PlanRefusal::new(MissionResult::Invalid, format_args!("item {index}: {refusal}"))
        };
        match kind {
            PlanKind::Mission if count == 0 => Ok(()),
            PlanKind::Mission => {
                let stored = Stored { slot, count };
                let home = self.report.origin;
                check(&*self.medium, stored, home, &self.parameters.mission)
                    .map_err(|(index, refusal)| of_item(index, &refusal))
            }
            PlanKind::Fence => fence::check(&*self.medium, slot, count).map_err(of_fence),
            PlanKind::Rally => Rally::check(&*self.medium, slot, count).map_err(of_fence),
        }
    }
}

impl PlanStore for Plans<'_> {
    fn committed(&self, kind: PlanKind) -> MissionCommit {
        self.state.committed(kind)
    }

    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        self.medium.item(kind, slot, index)
    }

    fn capacity(&self, kind: PlanKind) -> u16 {
        PlanMemory::capacity(kind)
    }

    fn check(&self, kind: PlanKind, index: u16, item: &MissionItem) -> Result<(), PlanRefusal> {
        match kind {
            PlanKind::Mission => windhover_autopilot::mission::action::interpret(item)
                .map(|_| ())
                .map_err(|refusal| of_item(index, &refusal)),
            // Shapes are several items: looked at when all are there.
            PlanKind::Fence | PlanKind::Rally => Ok(()),
        }
    }

    fn is_settling(&self, kind: PlanKind) -> bool {
        self.state.of(kind).handing != Handing::Done
    }

    fn begin(&mut self, kind: PlanKind, _count: u16) -> Result<u8, PlanRefusal> {
        if self.is_flown(kind) {
            return Err(flown());
        }
        let kept = self.state.of_mut(kind);
        if kept.staging || kept.handing != Handing::Done {
            return Err(PlanRefusal::new(
                MissionResult::Denied,
                format_args!("another upload is under way"),
            ));
        }
        kept.staging = true;
        let slot = 1 - kept.now.slot.min(1);
        self.medium.clear(kind, slot);
        Ok(slot)
    }

    fn write(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> Result<(), PlanRefusal> {
        if self.medium.push(kind, slot, index, item) {
            Ok(())
        } else {
            Err(PlanRefusal::new(
                MissionResult::NoSpace,
                format_args!("no room for more items"),
            ))
        }
    }

    fn commit(&mut self, kind: PlanKind, commit: MissionCommit) -> Result<(), PlanRefusal> {
        if self.is_flown(kind) {
            return Err(flown());
        }
        self.check_whole(kind, &commit)?;
        let kept = self.state.of_mut(kind);
        *kept = Kept {
            now: commit,
            before: kept.now,
            handing: Handing::Due,
            staging: false,
        };
        Ok(())
    }

    fn abort(&mut self, kind: PlanKind) {
        self.state.of_mut(kind).staging = false;
    }
}

fn flown() -> PlanRefusal {
    PlanRefusal::new(
        MissionResult::Denied,
        format_args!("the mission is being flown: hold or land first"),
    )
}
