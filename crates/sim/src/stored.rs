//! Plans as they are stored on board.

use windhover_autopilot::mission::{MissionItem, PlanKind, Plans};

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

    /// Each plan with its kind.
    pub fn each(&self) -> [(PlanKind, &[MissionItem]); 3] {
        [
            (PlanKind::Mission, &self.mission),
            (PlanKind::Fence, &self.fence),
            (PlanKind::Rally, &self.rally),
        ]
    }
}
