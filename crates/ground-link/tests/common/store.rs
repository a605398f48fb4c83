//! Plans in memory that check what the link promises.

use windhover_autopilot::MissionCommit;
use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::{MissionResult, PlanKind, PlanRefusal, PlanStore};

use super::REFUSED_COMMAND;

/// Plans in memory, with two slots each.
#[derive(Clone, Default)]
pub struct Store {
    slots: [[Vec<MissionItem>; 2]; 3],
    active: [MissionCommit; 3],
    staged: [bool; 3],
    pub commits: u32,
    pub refuse_commit: bool,
    /// What was committed is still on its way to the core.
    pub is_settling: bool,
}

impl Store {
    pub fn items(&self, kind: PlanKind) -> &[MissionItem] {
        let at = usize::from(kind.code());
        &self.slots[at][usize::from(self.active[at].slot)]
    }

    /// Bits of all plans in use.
    pub fn bits(&self) -> Vec<Vec<String>> {
        PlanKind::EACH
            .map(|kind| self.items(kind).iter().map(bits).collect())
            .into()
    }
}

/// An item as text in which NaNs can be compared.
pub fn bits(item: &MissionItem) -> String {
    let params = item.params.map(f32::to_bits);
    let z = item.z.to_bits();
    let MissionItem {
        command,
        frame,
        autocontinue,
        x,
        y,
        ..
    } = item;
    format!("{command} {frame} {autocontinue} {params:x?} {x} {y} {z:x}")
}

impl PlanStore for Store {
    fn committed(&self, kind: PlanKind) -> MissionCommit {
        self.active[usize::from(kind.code())]
    }

    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        let slots = &self.slots[usize::from(kind.code())];
        slots[usize::from(slot)].get(usize::from(index)).copied()
    }

    fn capacity(&self, _kind: PlanKind) -> u16 {
        256
    }

    fn check(&self, _kind: PlanKind, index: u16, item: &MissionItem) -> Result<(), PlanRefusal> {
        if item.command == REFUSED_COMMAND {
            let reason = format_args!("item {index}: this is not flown");
            return Err(PlanRefusal::new(MissionResult::Unsupported, reason));
        }
        Ok(())
    }

    fn is_settling(&self, _kind: PlanKind) -> bool {
        self.is_settling
    }

    fn begin(&mut self, kind: PlanKind, _count: u16) -> Result<u8, PlanRefusal> {
        let at = usize::from(kind.code());
        assert!(!self.staged[at], "an upload begins before the last one ended");
        self.staged[at] = true;
        let slot = 1 - self.active[at].slot;
        self.slots[at][usize::from(slot)].clear();
        Ok(slot)
    }

    fn write(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> Result<(), PlanRefusal> {
        let at = usize::from(kind.code());
        assert!(self.staged[at] && slot != self.active[at].slot);
        let items = &mut self.slots[at][usize::from(slot)];
        assert_eq!(items.len(), usize::from(index), "items come in order");
        items.push(*item);
        Ok(())
    }

    fn commit(&mut self, kind: PlanKind, commit: MissionCommit) -> Result<(), PlanRefusal> {
        let at = usize::from(kind.code());
        if self.refuse_commit {
            return Err(PlanRefusal::new(MissionResult::Denied, format_args!("in flight")));
        }
        let items = &self.slots[at][usize::from(commit.slot)];
        assert_eq!(items.len(), usize::from(commit.count), "committed whole");
        assert_eq!(
            commit.crc,
            windhover_flight_log::crc::mission_crc(items.iter().copied())
        );
        self.staged[at] = false;
        self.active[at] = commit;
        self.commits += 1;
        Ok(())
    }

    fn abort(&mut self, kind: PlanKind) {
        self.staged[usize::from(kind.code())] = false;
    }
}
