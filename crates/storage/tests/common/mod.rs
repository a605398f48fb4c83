//! What the tests share: flash that can stop anywhere, plans in memory, and a vehicle that keeps
//! what it has.
#![allow(dead_code, reason = "each test uses a part of it")]

pub mod nor;

use embassy_futures::block_on;
use windhover_autopilot::mission::{MissionItem, PlanKind, PlanMemory};
use windhover_autopilot::{MissionCommit, Parameters};
use windhover_flight_log::mission_crc;
use windhover_storage::{Journal, Keeper, Loaded, StoreError, View};

use nor::{Nor, SECTOR, SECTORS};

pub const KINDS: [PlanKind; 3] = [PlanKind::Mission, PlanKind::Fence, PlanKind::Rally];

/// A row of numbers that is the same each time (SplitMix64).
#[derive(Clone)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }
}

/// An item whose every field depends on the seed: all bits of all fields occur.
pub fn item(seed: u64) -> MissionItem {
    let mut random = Random(seed);
    let mut bits = || random.next() as u32;
    MissionItem {
        command: bits() as u16,
        frame: bits() as u8,
        autocontinue: bits() & 1 == 1,
        params: [bits(), bits(), bits(), bits()].map(f32::from_bits),
        x: bits() as i32,
        y: bits() as i32,
        z: f32::from_bits(bits()),
    }
}

pub fn plan(seed: u64, count: usize) -> Vec<MissionItem> {
    (0..count as u64).map(|index| item(seed << 32 | index)).collect()
}

/// What has to outlast power; comparable, as plans may hold what is no number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    pub parameters: Parameters,
    /// Count and CRC by kind.
    pub plans: [(u16, u32); 3],
}

/// The vehicle, as far as it stores.
pub struct Vehicle<'a> {
    pub journal: Journal<&'a mut Nor>,
    pub keeper: Keeper,
    pub loaded: Loaded,
    pub memory: PlanMemory,
    pub parameters: Parameters,
    pub plans: [MissionCommit; 3],
    pub time: u64,
    pub armed: bool,
}

pub fn open(nor: &mut Nor) -> Journal<&mut Nor> {
    let range = 0..(SECTORS * SECTOR) as u32;
    block_on(Journal::open(nor, range)).expect("three whole sectors")
}

impl<'a> Vehicle<'a> {
    /// Starts from what the flash holds.
    pub fn start(nor: &'a mut Nor) -> Self {
        let mut journal = open(nor);
        let mut memory = PlanMemory::new();
        let loaded = block_on(journal.load(&mut memory));
        Self {
            journal,
            keeper: Keeper::new(&loaded),
            parameters: loaded.parameters,
            plans: loaded.plans,
            loaded,
            memory,
            time: 0,
            armed: false,
        }
    }

    /// What it has.
    pub fn state(&self) -> State {
        State {
            parameters: self.parameters,
            plans: self.plans.map(|commit| (commit.count, commit.crc)),
        }
    }

    pub fn set(&mut self, index: usize, value: f32) {
        self.parameters.set(index, value).expect("a value that is taken");
    }

    /// A plan is uploaded and committed.
    pub fn upload(&mut self, kind: PlanKind, items: &[MissionItem]) {
        let place = usize::from(kind.code());
        let slot = 1 - self.plans[place].slot;
        self.memory.clear(kind, slot);
        for item in items {
            self.memory.push(kind, slot, *item);
        }
        self.plans[place] = MissionCommit {
            slot,
            count: items.len() as u16,
            crc: mission_crc(items.iter().copied()),
        };
    }

    pub fn view(&self) -> View<'_> {
        View {
            time: self.time,
            armed: self.armed,
            parameters: &self.parameters,
            plans: self.plans,
        }
    }

    /// One task, if there is one; how it went.
    pub fn step(&mut self) -> Option<Result<(), StoreError>> {
        let view = View {
            time: self.time,
            armed: self.armed,
            parameters: &self.parameters,
            plans: self.plans,
        };
        let task = self.keeper.next(&view, &self.memory)?;
        let outcome = block_on(self.journal.perform(&task));
        self.keeper.done(outcome);
        Some(outcome)
    }

    /// Until everything is stored: what changes now has rested a second later.
    pub fn settle(&mut self) -> Result<(), StoreError> {
        for _ in 0..2 {
            while let Some(outcome) = self.step() {
                outcome?;
            }
            self.time += 1_000_000;
        }
        assert!(!self.keeper.is_behind(&self.view()), "nothing is left to do");
        Ok(())
    }
}

/// What a start from this flash finds, and whether it is sound.
pub fn load(nor: &mut Nor) -> (State, Loaded) {
    let vehicle = Vehicle::start(nor);
    (vehicle.state(), vehicle.loaded)
}
