//! A vehicle of which the optimiser knows nothing, in as few bytes as can be: what it has of its
//! own counts as the link's.

use core::hint::black_box;

use windhover_autopilot::MissionCommit;
use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::text::Plain;
use windhover_ground_link::{MissionResult, ParameterTable, PlanKind, PlanRefusal, PlanStore};
use windhover_parameters::Declaration;

/// Some parameters.
pub struct Table;

impl ParameterTable for Table {
    fn count(&self) -> u16 {
        black_box(200)
    }

    fn declaration(&self, _: u16) -> Option<&'static Declaration> {
        black_box(None)
    }

    fn value(&self, _: u16) -> Option<f32> {
        black_box(None)
    }
}

/// Some plans.
pub struct Plans;

impl PlanStore for Plans {
    fn committed(&self, _: PlanKind) -> MissionCommit {
        black_box(MissionCommit {
            slot: 0,
            count: 0,
            crc: 0,
        })
    }

    fn item(&self, _: PlanKind, _: u8, _: u16) -> Option<MissionItem> {
        black_box(None)
    }

    fn capacity(&self, _: PlanKind) -> u16 {
        black_box(250)
    }

    fn check(&self, _: PlanKind, _: u16, _: &MissionItem) -> Result<(), PlanRefusal> {
        let result = black_box(MissionResult::Invalid);
        Err(PlanRefusal::new(
            result,
            format_args!("{}", Plain(black_box("why"))),
        ))
    }

    fn is_settling(&self, kind: PlanKind) -> bool {
        black_box(kind == PlanKind::Fence)
    }

    fn begin(&mut self, _: PlanKind, _: u16) -> Result<u8, PlanRefusal> {
        black_box(Ok(0))
    }

    fn write(&mut self, _: PlanKind, _: u8, _: u16, _: &MissionItem) -> Result<(), PlanRefusal> {
        black_box(Ok(()))
    }

    fn commit(&mut self, _: PlanKind, _: MissionCommit) -> Result<(), PlanRefusal> {
        black_box(Ok(()))
    }

    fn abort(&mut self, _: PlanKind) {}
}
