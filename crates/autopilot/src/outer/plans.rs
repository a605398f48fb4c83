//! Which plans are stored and valid: the mission, the fence, the rally points.

use windhover_math::Vector3;
use windhover_math::geodesy::LocalFrame;

use super::report::Why;
use crate::fence::{Fence, Rally, check_mission};
use crate::mission::nav::Chart;
use crate::mission::route::Stored;
use crate::mission::{MissionSource, PlanKind, check};
use crate::parameters::Parameters;
use crate::queue::MissionCommit;

/// The valid plans, and what follows from them.
#[derive(Clone, Debug, Default)]
pub struct Plans {
    /// The mission.
    pub mission: Option<Stored>,
    /// The fence, in the local frame.
    pub fence: Fence,
    /// The rally points, in the local frame.
    pub rally: Rally,
    /// Items of fence and rally points as stored: they wait for a local frame.
    stored: [Stored; 2],
    /// Whether they are compiled for the frame there is.
    compiled: bool,
    /// Whether they were refused when they were.
    pub invalid: bool,
}

impl Plans {
    /// Takes a plan that was committed, or says what is wrong with it. A mission that is refused is
    /// none; a fence that is refused leaves the one that was.
    pub fn commit<S: MissionSource + ?Sized>(
        &mut self,
        kind: PlanKind,
        commit: &MissionCommit,
        source: &S,
        frame: Option<&LocalFrame>,
        parameters: &Parameters,
    ) -> Result<(), Why> {
        let MissionCommit { slot, count, .. } = *commit;
        let stored = Stored { slot, count };
        match kind {
            PlanKind::Mission if count == 0 => self.mission = None,
            PlanKind::Mission => {
                let home = frame.map(LocalFrame::origin);
                let checked = check(source, stored, home, &parameters.mission);
                self.mission = checked.is_ok().then_some(stored);
                checked.map_err(|(index, refusal)| Why::Mission(index, refusal))?;
            }
            PlanKind::Fence => {
                crate::fence::check(source, slot, count).map_err(|(index, why)| Why::Fence(index, why))?;
                self.set(0, stored);
            }
            PlanKind::Rally => {
                Rally::check(source, slot, count).map_err(|(index, why)| Why::Fence(index, why))?;
                self.set(1, stored);
            }
        }
        Ok(())
    }

    fn set(&mut self, which: usize, stored: Stored) {
        if let Some(place) = self.stored.get_mut(which) {
            *place = stored;
        }
        self.compiled = false;
    }

    /// Brings fence and rally points into the local frame, once there is one.
    pub fn compile<S: MissionSource + ?Sized>(&mut self, source: &S, frame: &LocalFrame) {
        if self.compiled {
            return;
        }
        self.compiled = true;
        let [fence, rally] = self.stored;
        let fence = Fence::compile(source, fence.slot, fence.count, frame);
        let rally = Rally::compile(source, rally.slot, rally.count, frame);
        self.invalid = fence.is_err() || rally.is_err();
        if let (Ok(fence), Ok(rally)) = (fence, rally) {
            (self.fence, self.rally) = (fence, rally);
        }
    }

    /// Whether the mission can be flown from here: asked when it is to be started.
    pub fn check_mission<S: MissionSource + ?Sized>(
        &self,
        source: &S,
        frame: &LocalFrame,
        home: Vector3,
        parameters: &Parameters,
    ) -> Result<(), Why> {
        let Some(stored) = self.mission else {
            return Ok(());
        };
        let refused = |(index, refusal)| Why::Mission(index, refusal);
        // It may have been stored before there was a home.
        check(source, stored, Some(frame.origin()), &parameters.mission).map_err(refused)?;
        let chart = Chart {
            source,
            stored,
            frame,
            home,
            parameters: &parameters.mission,
        };
        check_mission(&chart, &self.fence, &self.rally, &parameters.fence).map_err(refused)
    }
}
