//! The plans on board: written by the ground link into the slot that is not in use, read by the outer
//! loop from the one that is. The lock is held for one item.

use windhover_autopilot::mission::{MissionItem, MissionSource, PlanKind, PlanMemory};
use windhover_flight_log::PlanItem;
use windhover_storage::PlanSink;
use windhover_vehicle_link::PlanMedium;

use crate::board::PLANS;
use crate::shared;

/// Does something under the lock.
fn with<R: Default>(act: impl FnOnce(&mut PlanMemory) -> R) -> R {
    PLANS.lock(|plans| {
        let memory = plans.try_borrow_mut();
        memory.map(|mut memory| act(&mut memory)).unwrap_or_default()
    })
}

/// The plans as the core and the ground link see them.
pub struct Shelf;

impl MissionSource for Shelf {
    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        with(|memory| memory.item(kind, slot, index))
    }
}

impl PlanMedium for Shelf {
    fn clear(&mut self, kind: PlanKind, slot: u8) {
        with(|memory| memory.clear(kind, slot));
    }

    fn push(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> bool {
        let taken = with(|memory| memory.push(kind, slot, *item));
        if taken {
            let item = PlanItem {
                kind,
                slot,
                index,
                item: *item,
            };
            shared::with(|shared| shared.log.plan_item(&item));
        }
        taken
    }
}

/// What is stored comes onto the shelf at the start.
impl PlanSink for Shelf {
    fn put(&mut self, kind: PlanKind, index: u16, item: &MissionItem) -> bool {
        with(|memory| memory.put(kind, 0, index, *item))
    }
}
