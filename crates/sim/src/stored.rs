//! Plans as they are stored on board.

use windhover_autopilot::mission::{MissionItem, PlanKind, PlanMemory, Plans};

/// What is stored on board.
#[derive(Clone, Debug, Default)]
pub struct Stored {
    /// The mission.
    pub mission: Vec<MissionItem>,
    /// The fence.
    pub fence: Vec<MissionItem>,
    /// Rally points.
    pub rally: Vec<MissionItem>,
}

impl Stored {
    /// As the core reads it.
    pub fn plans(&self) -> Plans<'_> {
        Plans {
            mission: &self.mission,
            fence: &self.fence,
            rally: &self.rally,
        }
    }

    /// The same as a vehicle holds it, in the first slot of each kind. What is too much for it is
    /// left out: a mission that is refused for that is never flown.
    pub fn memory(&self) -> PlanMemory {
        let mut memory = PlanMemory::new();
        for (kind, items) in self.each() {
            for item in items {
                memory.push(kind, 0, *item);
            }
        }
        memory
    }

    /// Each plan with its kind.
    pub fn each(&self) -> [(PlanKind, &[MissionItem]); 3] {
        [
            (PlanKind::Mission, &self.mission),
            (PlanKind::Fence, &self.fence),
            (PlanKind::Rally, &self.rally),
        ]
    }
}
