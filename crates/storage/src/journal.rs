//! The journal in three sectors of flash, by the crate `sequential-storage`: a record overrides
//! those before it that have the same key, and what is still valid is moved on before a sector is
//! erased.

use core::fmt;
use core::ops::Range;

use embedded_storage_async::nor_flash::NorFlash;
use heapless::Vec;
use sequential_storage::Error;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use windhover_autopilot::mission::{MissionItem, MissionSource, PlanKind, PlanMemory};
use windhover_autopilot::{MissionCommit, Parameters};
use windhover_flight_log::mission_crc;

use crate::ledger::{self, GROUP, Ledger};
use crate::record::{self, CHUNK_ITEMS, Entry, Head, KEY, KINDS, Key, Slot, Task, VALUE};
use crate::sectors::{Found, SECTORS, Sectors};

/// Something that was not opened or stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The range is not three whole sectors of a flash that is written by words.
    Range,
    /// The flash refuses.
    Flash,
    /// There is no room.
    Full,
    /// The journal makes no sense.
    Damaged,
}

/// What is stored and cannot be true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// The sectors hold something that is no journal, or cannot be read to its end.
    pub journal: bool,
    /// Parameters are missing or old: all are at their defaults.
    pub parameters: bool,
    /// So many parameters have values that this firmware refuses: they are at their defaults.
    pub refused: u16,
    /// Plans, by the number of their kind: there is none of that kind.
    pub plans: [bool; 3],
}

impl Damage {
    /// Whether something is damaged: the vehicle should not arm then.
    pub fn is_any(&self) -> bool {
        *self != Self::default()
    }
}

/// A sentence for people, as in `damaged in storage: parameters, mission`.
impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [mission, fence, rally] = self.plans;
        let parts = [
            (self.journal, "journal"),
            (self.parameters, "parameters"),
            (self.refused > 0, "values out of range"),
            (mission, "mission"),
            (fence, "fence"),
            (rally, "rally points"),
        ];
        f.write_str("damaged in storage:")?;
        let mut separator = " ";
        for (_, name) in parts.iter().filter(|(is_damaged, _)| *is_damaged) {
            write!(f, "{separator}{name}")?;
            separator = ", ";
        }
        Ok(())
    }
}

/// Where plans are kept while the vehicle is on: a start fills slot 0 of each kind.
pub trait PlanSink: MissionSource {
    /// Keeps an item in slot 0, whatever came before it; whether there was room.
    fn put(&mut self, kind: PlanKind, index: u16, item: &MissionItem) -> bool;
}

impl PlanSink for PlanMemory {
    fn put(&mut self, kind: PlanKind, index: u16, item: &MissionItem) -> bool {
        Self::put(self, kind, 0, index, *item)
    }
}

/// What a start finds.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// All parameters.
    pub parameters: Parameters,
    /// How many of them are stored.
    pub stored: u16,
    /// What lies in slot 0 of the [`PlanSink`] now, by the number of its kind; without items where
    /// there is no plan. To be committed to the core.
    pub plans: [MissionCommit; 3],
    /// What is damaged.
    pub damage: Damage,
    pub(crate) contents: Contents,
}

/// What lies in the journal besides values.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contents {
    /// Parameters of a group that was interrupted: indices and values.
    pub group: Vec<(u16, f32), GROUP>,
    /// Which plans are valid, by the number of their kind.
    pub heads: [Head; 3],
    /// The first record of a journal is a ledger; here there is none yet.
    pub is_new: bool,
    /// What is written was not settled, or by another firmware.
    pub unsettled: bool,
    /// Which chunks hold items, a bit each, by the number of their kind and by slot.
    pub used: [[u32; 2]; 3],
}

/// The journal in a part of a flash.
pub struct Journal<F: NorFlash> {
    map: MapStorage<u32, Sectors<F>, Cache<Uncached, Uncached, Uncached, u32>>,
    found: Found,
}

impl<F: NorFlash> Journal<F> {
    /// In `range` of the flash, in bytes from its start. Nothing is written.
    ///
    /// # Errors
    /// [`StoreError::Range`], and [`StoreError::Flash`] if it cannot be read.
    pub async fn open(flash: F, range: Range<u32>) -> Result<Self, StoreError> {
        let (sectors, found) = Sectors::open(flash, range).await?;
        let room = 0..Sectors::<F>::ROOM * SECTORS as u32;
        let config = MapConfig::try_new(room).map_err(|_| StoreError::Range)?;
        Ok(Self {
            map: MapStorage::new(sectors, config, Cache::new_uncached()),
            found,
        })
    }

    /// Reads everything that is stored; nothing is written. Blank flash holds nothing, and is not
    /// damaged.
    pub async fn load<M: PlanSink>(&mut self, plans: &mut M) -> Loaded {
        self.map.flash().set_read_only(true);
        let mut reading = Reading::default();
        let mut read = self.each(|key, value| reading.take(key, value)).await;
        if !reading.any && self.map.flash().holds_something().await {
            read = Err(StoreError::Damaged);
        }
        let mut loaded = reading.finish();
        let heads = loaded.contents.heads;
        if heads.iter().any(|head| head.count > 0) {
            let put = |key: Option<Key>, value: &[u8]| put_chunk(key, value, &heads, plans);
            read = read.and(self.each(put).await);
        }
        self.map.flash().set_read_only(false);
        loaded.damage.journal = read.is_err() || self.found == Found::Foreign;
        if loaded.damage.journal {
            loaded.damage.parameters |= self.found == Found::Journal;
        }
        if loaded.damage.parameters {
            (loaded.parameters, loaded.stored) = (Parameters::default(), 0);
            loaded.contents.group.clear();
        }
        for (((kind, head), commit), damage) in KINDS
            .into_iter()
            .zip(heads)
            .zip(&mut loaded.plans)
            .zip(&mut loaded.damage.plans)
        {
            *damage |= !is_whole(kind, &head, plans);
            if !*damage {
                (commit.count, commit.crc) = (head.count, head.crc);
            }
        }
        loaded
    }

    /// Does what a [`Keeper`](crate::Keeper) names. It may erase a sector, for which a
    /// microcontroller that runs from the same flash stands still for up to 0.8 s: never
    /// while motors may turn. What is refused or interrupted leaves what was stored before.
    ///
    /// # Errors
    /// [`StoreError::Flash`], [`StoreError::Full`], [`StoreError::Damaged`].
    pub async fn perform(&mut self, task: &Task) -> Result<(), StoreError> {
        match task {
            Task::Store(entry) => self.store(entry).await,
            Task::Clear => self.map.erase_all().await.map_err(|_| StoreError::Flash),
        }
    }

    async fn store(&mut self, entry: &Entry) -> Result<(), StoreError> {
        let mut buffer = [0; KEY + VALUE];
        let value: &[u8] = &entry.value;
        let stored = self.map.store_item(&mut buffer, &entry.key, &value).await;
        stored.map_err(|error| match error {
            Error::Storage { .. } => StoreError::Flash,
            Error::FullStorage => StoreError::Full,
            _ => StoreError::Damaged,
        })
    }

    /// Shows every record, the oldest first.
    async fn each(&mut self, mut visit: impl FnMut(Option<Key>, &[u8])) -> Result<(), StoreError> {
        let mut buffer = [0; KEY + VALUE];
        let damaged = |_| StoreError::Damaged;
        let mut records = self.map.fetch_all_items(&mut buffer).await.map_err(damaged)?;
        while let Some((key, value)) = records.next::<&[u8]>(&mut buffer).await.map_err(damaged)? {
            visit(Key::of(key), value);
        }
        Ok(())
    }
}

/// Keeps the items of a chunk, if it belongs to a valid plan.
fn put_chunk<M: PlanSink>(key: Option<Key>, value: &[u8], heads: &[Head; 3], plans: &mut M) {
    let Some(Key::Chunk(kind, slot, chunk)) = key else {
        return;
    };
    let valid = heads.get(usize::from(kind.code())).map(|head| head.slot);
    if valid != Some(slot) {
        return;
    }
    let first = u16::from(chunk) * CHUNK_ITEMS as u16;
    for (index, item) in (first..PlanMemory::capacity(kind)).zip(record::read_chunk(value).iter().flatten()) {
        plans.put(kind, index, item);
    }
}

/// Whether the items of a plan are what its head says.
fn is_whole<M: PlanSink>(kind: PlanKind, head: &Head, plans: &M) -> bool {
    let mut missing = head.count > PlanMemory::capacity(kind);
    let items = (0..head.count.min(PlanMemory::capacity(kind))).map_while(|index| {
        let item = plans.item(kind, 0, index);
        missing |= item.is_none();
        item
    });
    let crc = mission_crc(items);
    !missing && crc == head.crc
}

/// What was read so far.
struct Reading {
    values: [Option<f32>; Parameters::COUNT],
    ledger: Option<Ledger>,
    contents: Contents,
    /// There are records.
    any: bool,
    /// Something that nobody writes.
    strange: bool,
}

impl Default for Reading {
    fn default() -> Self {
        Self {
            values: [None; _],
            ledger: None,
            contents: Contents::default(),
            any: false,
            strange: false,
        }
    }
}

impl Reading {
    /// The newest record of a key is the last one.
    fn take(&mut self, key: Option<Key>, value: &[u8]) {
        self.any = true;
        match key {
            Some(Key::Parameter(index)) => {
                let value = record::read_parameter(value);
                self.strange |= value.is_none();
                if let Some(place) = self.values.get_mut(index) {
                    *place = value;
                }
            }
            Some(Key::Ledger) => {
                self.ledger = Ledger::read(value);
                self.strange |= self.ledger.is_none();
            }
            Some(Key::Head(kind)) => {
                let head = Head::read(value);
                self.strange |= head.is_none();
                if let Some(place) = self.contents.heads.get_mut(usize::from(kind.code())) {
                    *place = head.unwrap_or_default();
                }
            }
            Some(Key::Chunk(kind, slot, chunk)) => {
                self.contents.set_used(kind, slot, chunk, !value.is_empty())
            }
            // Another firmware's.
            None => {}
        }
    }

    fn finish(mut self) -> Loaded {
        let mut contents = self.contents;
        contents.is_new = self.ledger.is_none();
        let is_lost = contents.is_new && self.any;
        let ledger = self.ledger.unwrap_or(Ledger::Group(Vec::new()));
        contents.unsettled = !(contents.is_new || ledger.is_settled());
        if let Ledger::Group(group) = &ledger {
            for (key, value) in group {
                if let Some(Key::Parameter(index)) = Key::of(*key)
                    && let Some(place) = self.values.get_mut(index)
                {
                    *place = Some(*value);
                    // As long as the group that is read.
                    let _ = contents.group.push((index as u16, *value));
                }
            }
        }
        let mut parameters = Parameters::default();
        let (mut stored, mut refused) = (0, 0);
        for (index, value) in self.values.iter().enumerate() {
            if let Some(value) = value {
                stored += 1;
                refused += u16::from(parameters.set(index, *value).is_err());
            }
        }
        let values = ledger::values(ledger::all(&parameters));
        let heads = ledger.allows_heads(contents.heads.map(|head| head.sum()));
        Loaded {
            parameters,
            stored,
            plans: [MissionCommit::default(); 3],
            damage: Damage {
                parameters: is_lost || self.strange || !ledger.allows_values(values),
                refused,
                plans: heads.map(|is_allowed| is_lost || !is_allowed),
                ..Damage::default()
            },
            contents,
        }
    }
}

impl Contents {
    /// Notes whether a chunk holds items.
    pub fn set_used(&mut self, kind: PlanKind, slot: Slot, chunk: u8, is_used: bool) {
        let slots = self.used.get_mut(usize::from(kind.code()));
        let bits = slots.and_then(|slots| slots.get_mut(slot as usize));
        if let (Some(bits), Some(bit)) = (bits, 1u32.checked_shl(chunk.into())) {
            *bits = if is_used { *bits | bit } else { *bits & !bit };
        }
    }

    /// The first chunk with items in a slot that is not valid.
    pub fn unused(&self) -> Option<(PlanKind, Slot, u8)> {
        KINDS
            .into_iter()
            .zip(self.heads)
            .zip(&self.used)
            .find_map(|((kind, head), used)| {
                let slot = head.slot.other();
                let bits = used.get(slot as usize).copied().unwrap_or(0);
                (bits != 0).then_some((kind, slot, bits.trailing_zeros() as u8))
            })
    }
}
