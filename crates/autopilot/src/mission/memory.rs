//! Plans in memory: of each kind two slots, one in use and one for the next upload.

use heapless::Vec;

use super::{MAX_ITEMS, MissionItem, MissionSource, PlanKind};
use crate::fence::{MAX_RALLY, MAX_VERTICES};

/// The plans that a vehicle holds.
#[derive(Clone, Debug, Default)]
pub struct PlanMemory {
    mission: [Vec<MissionItem, MAX_ITEMS>; 2],
    fence: [Vec<MissionItem, MAX_VERTICES>; 2],
    rally: [Vec<MissionItem, MAX_RALLY>; 2],
}

impl PlanMemory {
    /// Nothing stored.
    pub const fn new() -> Self {
        Self {
            mission: [Vec::new(), Vec::new()],
            fence: [Vec::new(), Vec::new()],
            rally: [Vec::new(), Vec::new()],
        }
    }

    /// How many items of a kind there is room for.
    pub const fn capacity(kind: PlanKind) -> u16 {
        let most = match kind {
            PlanKind::Mission => MAX_ITEMS,
            PlanKind::Fence => MAX_VERTICES,
            PlanKind::Rally => MAX_RALLY,
        };
        most as u16
    }

    /// Empties a slot; not the one in use. There are slots 0 and 1.
    pub fn clear(&mut self, kind: PlanKind, slot: u8) {
        let slot = usize::from(slot);
        match kind {
            PlanKind::Mission => self.mission.get_mut(slot).map(Vec::clear),
            PlanKind::Fence => self.fence.get_mut(slot).map(Vec::clear),
            PlanKind::Rally => self.rally.get_mut(slot).map(Vec::clear),
        };
    }

    /// Puts an item at the end of a slot; whether there was room.
    pub fn push(&mut self, kind: PlanKind, slot: u8, item: MissionItem) -> bool {
        let slot = usize::from(slot);
        let pushed = match kind {
            PlanKind::Mission => self.mission.get_mut(slot).map(|items| items.push(item)),
            PlanKind::Fence => self.fence.get_mut(slot).map(|items| items.push(item)),
            PlanKind::Rally => self.rally.get_mut(slot).map(|items| items.push(item)),
        };
        pushed.is_some_and(|pushed| pushed.is_ok())
    }

    /// Puts an item at its place in a slot; whether there was room. Places before it that were empty
    /// hold the same item until theirs comes.
    pub fn put(&mut self, kind: PlanKind, slot: u8, index: u16, item: MissionItem) -> bool {
        let (slot, index) = (usize::from(slot), usize::from(index));
        match kind {
            PlanKind::Mission => put(&mut self.mission, slot, index, item),
            PlanKind::Fence => put(&mut self.fence, slot, index, item),
            PlanKind::Rally => put(&mut self.rally, slot, index, item),
        }
    }

    /// What a slot holds, in order.
    pub fn items(&self, kind: PlanKind, slot: u8) -> &[MissionItem] {
        let slot = usize::from(slot);
        let items = match kind {
            PlanKind::Mission => self.mission.get(slot).map(Vec::as_slice),
            PlanKind::Fence => self.fence.get(slot).map(Vec::as_slice),
            PlanKind::Rally => self.rally.get(slot).map(Vec::as_slice),
        };
        items.unwrap_or_default()
    }
}

fn put<const N: usize>(
    slots: &mut [Vec<MissionItem, N>; 2],
    slot: usize,
    index: usize,
    item: MissionItem,
) -> bool {
    let Some(items) = slots.get_mut(slot) else {
        return false;
    };
    if index >= items.len() && items.resize(index + 1, item).is_err() {
        return false;
    }
    items.get_mut(index).map(|place| *place = item).is_some()
}

impl MissionSource for PlanMemory {
    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        self.items(kind, slot).get(usize::from(index)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(number: usize) -> MissionItem {
        MissionItem {
            command: 16,
            frame: 3,
            autocontinue: true,
            params: [0.0; 4],
            x: number as i32,
            y: 0,
            z: 0.0,
        }
    }

    /// As they come out of storage.
    #[test]
    fn items_may_come_in_any_order() {
        let mut memory = PlanMemory::new();
        let most = usize::from(PlanMemory::capacity(PlanKind::Fence));
        for number in (0..most).map(|number| number * 5 % most) {
            assert!(memory.put(PlanKind::Fence, 1, number as u16, item(number)));
        }
        assert!(
            memory
                .items(PlanKind::Fence, 1)
                .iter()
                .copied()
                .eq((0..most).map(item))
        );
        assert!(!memory.put(PlanKind::Fence, 1, most as u16, item(most)));
        assert!(!memory.put(PlanKind::Fence, 2, 0, item(0)), "there are two slots");
        assert!(memory.items(PlanKind::Fence, 0).is_empty());
    }

    #[test]
    fn slots_are_apart_and_end_where_they_are_full() {
        let mut memory = PlanMemory::new();
        for (kind, slot) in [
            (PlanKind::Mission, 0),
            (PlanKind::Mission, 1),
            (PlanKind::Fence, 1),
            (PlanKind::Rally, 0),
        ] {
            let most = usize::from(PlanMemory::capacity(kind));
            for number in 0..most {
                assert!(memory.push(kind, slot, item(number)));
            }
            assert!(!memory.push(kind, slot, item(most)));
            let last = (most - 1) as u16;
            assert_eq!(memory.item(kind, slot, last), Some(item(most - 1)));
            assert_eq!(memory.item(kind, slot, last + 1), None);
        }
        memory.clear(PlanKind::Mission, 0);
        assert!(memory.items(PlanKind::Mission, 0).is_empty());
        assert_eq!(memory.items(PlanKind::Mission, 1).len(), MAX_ITEMS);
        assert!(memory.items(PlanKind::Fence, 0).is_empty());
        assert!(!memory.push(PlanKind::Rally, 2, item(0)), "there are two slots");
    }
}
