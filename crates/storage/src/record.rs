//! What lies in the journal: keys and values, between bytes and meaning.
//!
//! A key is a number of 32 bits. Those of parameters come from their names, so that a firmware
//! with other indices finds them again; those of the rest have the highest bit clear.
//!
//! | key | value |
//! |---|---|
//! | parameter | its value, an f32; 0 |
//! | ledger | what is being written, or sums: [`Ledger`](crate::ledger::Ledger) |
//! | head of a kind of plan | the slot of the journal that is valid, items, CRC-32 over them |
//! | chunk of a slot of a kind | up to [`CHUNK_ITEMS`] items of 32 bytes; empty: given back |
//!
//! No record is 8 bytes long: see [`sectors`](crate::sectors).

use heapless::Vec;
use windhover_autopilot::mission::{MissionItem, PlanKind};
use windhover_autopilot::{MissionCommit, Parameters};
use windhover_flight_log::Record;
use windhover_flight_log::wire::{Decoder, Encoder};

use crate::sum;

/// Every kind of plan, at the place of its number.
pub const KINDS: [PlanKind; 3] = [PlanKind::Mission, PlanKind::Fence, PlanKind::Rally];

/// Items in one chunk of a plan.
pub const CHUNK_ITEMS: usize = 8;

/// Bytes of an item, as the log has it.
const ITEM: usize = 32;

/// Bytes of a key.
pub const KEY: usize = 4;

/// The longest value.
pub const VALUE: usize = CHUNK_ITEMS * ITEM;

/// Something to be done in flash.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Task {
    /// Forget everything: the journal makes no sense.
    Clear,
    /// Write a record.
    Store(Entry),
}

/// One record of the journal. It is written whole, or the one before it stays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub(crate) key: u32,
    pub(crate) value: Vec<u8, VALUE>,
}

/// What a key stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A parameter of this firmware.
    Parameter(usize),
    /// The [`Ledger`](crate::ledger::Ledger).
    Ledger,
    /// Which slot of a kind of plan is valid.
    Head(PlanKind),
    /// Items of a kind of plan in a slot.
    Chunk(PlanKind, Slot, u8),
}

/// One of the two places of a plan in the journal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Slot {
    /// One.
    #[default]
    A,
    /// The other one.
    B,
}

impl Slot {
    /// The one that this is not.
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }

    fn from_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::A),
            1 => Some(Self::B),
            _ => None,
        }
    }
}

/// A parameter's key has this bit.
const PARAMETER: u32 = 0x8000_0000;

/// Keys of all parameters, by index.
pub const PARAMETER_KEYS: [u32; Parameters::COUNT] = {
    let mut keys = [0; Parameters::COUNT];
    let (mut index, mut group) = (0, 0);
    while group < Parameters::GROUPS.len() {
        let declarations = Parameters::GROUPS[group].declarations;
        let mut place = 0;
        while place < declarations.len() {
            keys[index] = PARAMETER | sum::bytes(sum::START, declarations[place].name.as_bytes());
            (index, place) = (index + 1, place + 1);
        }
        group += 1;
    }
    keys
};

const LEDGER: u8 = 3;
const HEAD: u8 = 2;
const CHUNK: u8 = 1;

impl Key {
    /// Its number. A parameter that does not exist has 0, which nothing else has.
    pub fn number(self) -> u32 {
        match self {
            Self::Parameter(index) => PARAMETER_KEYS.get(index).copied().unwrap_or(0),
            Self::Ledger => u32::from_be_bytes([LEDGER, 0, 0, 0]),
            Self::Head(kind) => u32::from_be_bytes([HEAD, kind.code(), 0, 0]),
            Self::Chunk(kind, slot, chunk) => u32::from_be_bytes([CHUNK, kind.code(), slot as u8, chunk]),
        }
    }

    /// The key with that number; `None` where this firmware has none.
    pub fn of(number: u32) -> Option<Self> {
        if number & PARAMETER != 0 {
            let index = PARAMETER_KEYS.iter().position(|known| *known == number)?;
            return Some(Self::Parameter(index));
        }
        let [tag, kind, slot, chunk] = number.to_be_bytes();
        let kind = PlanKind::from_code(kind)?;
        match (tag, slot, chunk) {
            (LEDGER, 0, 0) if kind.code() == 0 => Some(Self::Ledger),
            (HEAD, 0, 0) => Some(Self::Head(kind)),
            (CHUNK, slot, chunk) => Some(Self::Chunk(kind, Slot::from_code(slot)?, chunk)),
            _ => None,
        }
    }
}

/// A parameter's value.
pub fn parameter(index: usize, value: f32) -> Entry {
    entry(Key::Parameter(index), |out| {
        out.bytes(value.to_le_bytes());
        out.bytes([0; 4]);
    })
}

/// The value that [`parameter`] wrote.
pub fn read_parameter(value: &[u8]) -> Option<f32> {
    let (value, rest) = value.split_first_chunk()?;
    (rest == [0; 4]).then_some(f32::from_le_bytes(*value))
}

/// Which slot of a kind of plan is valid, and what is in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// The slot.
    pub slot: Slot,
    /// How many items; 0 is no plan.
    pub count: u16,
    /// CRC-32 over them.
    pub crc: u32,
}

impl Head {
    /// As it is written.
    pub fn entry(&self, kind: PlanKind) -> Entry {
        entry(Key::Head(kind), |out| {
            out.bytes([self.slot as u8, 0]);
            out.bytes(self.count.to_le_bytes());
            out.bytes(self.crc.to_le_bytes());
        })
    }

    /// As it was written; `None` for what nobody writes.
    pub fn read(value: &[u8]) -> Option<Self> {
        let mut from = Decoder::new(value);
        let [slot, _] = from.bytes()?;
        let head = Self {
            slot: Slot::from_code(slot)?,
            count: u16::from_le_bytes(from.bytes()?),
            crc: u32::from_le_bytes(from.bytes()?),
        };
        from.rest().is_empty().then_some(head)
    }

    /// What [`Ledger::allows_heads`] compares.
    pub fn sum(&self) -> u32 {
        let place = u32::from(self.count) << 8 | self.slot as u32;
        sum::word(sum::word(sum::START, place), self.crc)
    }

    /// Whether the plan that was committed is this one.
    pub fn holds(&self, commit: &MissionCommit) -> bool {
        self.count == commit.count && self.crc == commit.crc
    }
}

/// Items of a plan; none gives the chunk back.
pub fn chunk(kind: PlanKind, slot: Slot, chunk: u8, items: &[MissionItem]) -> Entry {
    entry(Key::Chunk(kind, slot, chunk), |out| {
        for item in items {
            item.put(out);
        }
    })
}

/// The items that [`chunk`] wrote; `None` for what nobody writes.
pub fn read_chunk(value: &[u8]) -> Option<Vec<MissionItem, CHUNK_ITEMS>> {
    let mut from = Decoder::new(value);
    let mut items = Vec::new();
    while !from.rest().is_empty() {
        items.push(MissionItem::get(&mut from)?).ok()?;
    }
    Some(items)
}

pub(crate) fn entry(key: Key, write: impl FnOnce(&mut Encoder<'_>)) -> Entry {
    let mut bytes = [0; VALUE];
    let mut out = Encoder::new(&mut bytes);
    write(&mut out);
    // Everything above fits: the bounds of chunks and groups are those of `VALUE`.
    let length = out.finish().unwrap_or(0);
    Entry {
        key: key.number(),
        value: bytes.iter().take(length).copied().collect(),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::ledger::{Ledger, Sums};

    /// Two parameters of one key would overwrite one another.
    #[test]
    fn every_key_is_of_one_thing_and_is_found_again() {
        let parameters = (0..Parameters::COUNT).map(Key::Parameter);
        let heads = KINDS.map(Key::Head);
        let chunks = KINDS.into_iter().flat_map(|kind| {
            [Slot::A, Slot::B]
                .into_iter()
                .flat_map(move |slot| (0..32).map(move |chunk| Key::Chunk(kind, slot, chunk)))
        });
        let keys: std::vec::Vec<_> = parameters
            .chain(heads)
            .chain([Key::Ledger])
            .chain(chunks)
            .collect();
        let numbers: std::collections::BTreeSet<_> = keys.iter().map(|key| key.number()).collect();
        assert_eq!(numbers.len(), keys.len());
        for key in keys {
            assert_eq!(Key::of(key.number()), Some(key));
        }
        assert_eq!(Key::of(0), None);
    }

    /// Else a record would be taken for the header of one, and hidden: its length is that of a header.
    #[test]
    fn no_record_is_as_long_as_a_header() {
        let head = Head::default();
        let mut lengths = std::vec![parameter(0, 1.0), head.entry(PlanKind::Rally)];
        for count in 0..=CHUNK_ITEMS {
            let items = std::vec![MissionItem { command: 16, frame: 3, autocontinue: true, params: [0.0; 4], x: 0, y: 0, z: 0.0 }; count];
            lengths.push(chunk(PlanKind::Fence, Slot::A, 0, &items));
        }
        for count in 0..=crate::ledger::GROUP {
            lengths.push(Ledger::Group((0..count).map(|_| (1, 1.0)).collect()).entry());
        }
        lengths.push(Ledger::Rewriting.entry());
        lengths.push(Ledger::Settled(Sums::new(0, [0; 3])).entry());
        for entry in lengths {
            assert_ne!(KEY + entry.value.len(), 8, "{entry:?}");
            assert!(entry.value.len() <= VALUE && entry.value.len().is_multiple_of(4));
        }
    }

    #[test]
    fn what_is_written_is_read_and_whatever_else_is_refused() {
        let head = Head {
            slot: Slot::B,
            count: 250,
            crc: 0x1234_5678,
        };
        let entry = head.entry(PlanKind::Fence);
        assert_eq!(Head::read(&entry.value), Some(head));
        assert_eq!(Head::read(&[2, 0, 1, 0, 0, 0, 0, 0]), None);
        assert_eq!(read_parameter(&parameter(3, -0.5).value), Some(-0.5));
        assert_eq!(read_parameter(&[0; 5]), None);
    }

    #[test]
    fn items_come_back_bit_for_bit() {
        let item = MissionItem {
            command: 54_321,
            frame: 200,
            autocontinue: true,
            params: [f32::from_bits(0x7fc1_2345), -0.0, f32::INFINITY, 1.5],
            x: i32::MIN,
            y: -1,
            z: f32::from_bits(0xffff_ffff),
        };
        for count in 0..=CHUNK_ITEMS {
            let written = chunk(PlanKind::Rally, Slot::A, 3, &[item; CHUNK_ITEMS][..count]);
            assert_eq!(written.value.len(), count * ITEM);
            let read = read_chunk(&written.value).unwrap();
            assert_eq!(chunk(PlanKind::Rally, Slot::A, 3, &read), written);
        }
        assert_eq!(read_chunk(&[0; 33]), None);
    }
}
