//! The record that guards what others write.

use heapless::Vec;
use windhover_autopilot::Parameters;
use windhover_flight_log::wire::Decoder;

use crate::record::{Entry, Key, entry};
use crate::sum;

/// Most parameters of one group: with two words before them they fill a value.
pub const GROUP: usize = 31;

/// Sum over names, ranges and defaults: another table's values have another sum without harm.
const TABLE: u32 = {
    let (mut sum, mut group) = (sum::START, 0);
    while group < Parameters::GROUPS.len() {
        let declarations = Parameters::GROUPS[group].declarations;
        let mut place = 0;
        while place < declarations.len() {
            let declaration = &declarations[place];
            sum = sum::bytes(sum, declaration.name.as_bytes());
            sum = sum::word(sum, declaration.min.to_bits());
            sum = sum::word(sum, declaration.max.to_bits());
            sum = sum::word(sum, declaration.default.to_bits());
            place += 1;
        }
        group += 1;
    }
    sum
};

/// Guards what is written by several records. Parameters that are to change together are announced
/// here, written one by one, and settled here: when power fails in between, the next start does the
/// rest. What was settled must be there at the next start, or it is damaged.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Ledger {
    /// These parameters are being written, keys and values; or, without any, a head is.
    Group(Vec<(u32, f32), GROUP>),
    /// Nothing is.
    Settled(Sums),
    /// All parameters are being written over damaged ones: until they are settled they stay damaged.
    Rewriting,
}

/// What a ledger was settled with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sums {
    /// The table of parameters.
    table: u32,
    /// Over the values of all parameters: [`values`].
    values: u32,
    /// Over the heads: [`Head::sum`].
    heads: [u32; 3],
}

impl Sums {
    /// Of this firmware's parameters.
    pub const fn new(values: u32, heads: [u32; 3]) -> Self {
        Self {
            table: TABLE,
            values,
            heads,
        }
    }
}

impl Ledger {
    /// Whether parameters of this sum may be those that are written, as far as this firmware can
    /// tell.
    pub fn allows_values(&self, values: u32) -> bool {
        match self {
            Self::Settled(sums) if sums.table == TABLE => sums.values == values,
            Self::Settled(_) | Self::Group(_) => true,
            Self::Rewriting => false,
        }
    }

    /// Which heads, of these sums, may be those that are written.
    pub fn allows_heads(&self, heads: [u32; 3]) -> [bool; 3] {
        match self {
            Self::Settled(sums) => [0, 1, 2].map(|kind| sums.heads.get(kind) == heads.get(kind)),
            Self::Group(_) | Self::Rewriting => [true; 3],
        }
    }

    /// Whether it is settled for this firmware.
    pub fn is_settled(&self) -> bool {
        matches!(self, Self::Settled(sums) if sums.table == TABLE)
    }

    /// As it is written.
    pub fn entry(&self) -> Entry {
        entry(Key::Ledger, |out| match self {
            Self::Group(group) => {
                out.bytes(1u32.to_le_bytes());
                out.bytes((group.len() as u32).to_le_bytes());
                for (key, value) in group {
                    out.bytes(key.to_le_bytes());
                    out.bytes(value.to_le_bytes());
                }
            }
            Self::Settled(Sums { table, values, heads }) => {
                for word in [0, *table, *values].iter().chain(heads) {
                    out.bytes(word.to_le_bytes());
                }
            }
            Self::Rewriting => out.bytes([2, 0, 0, 0, 0, 0, 0, 0]),
        })
    }

    /// As it was written; `None` for what nobody writes.
    pub fn read(value: &[u8]) -> Option<Self> {
        let mut from = Decoder::new(value);
        let mut word = || from.bytes().map(u32::from_le_bytes);
        let ledger = match word()? {
            0 => Self::Settled(Sums {
                table: word()?,
                values: word()?,
                heads: [word()?, word()?, word()?],
            }),
            1 => {
                let mut group = Vec::new();
                for _ in 0..word()? {
                    group.push((word()?, f32::from_bits(word()?))).ok()?;
                }
                Self::Group(group)
            }
            2 if word()? == 0 => Self::Rewriting,
            _ => return None,
        };
        from.rest().is_empty().then_some(ledger)
    }
}

/// Sum over values, as of all parameters.
pub fn values(values: impl Iterator<Item = f32>) -> u32 {
    values.fold(sum::START, |sum, value| sum::word(sum, value.to_bits()))
}

/// The values of all parameters, by index.
pub fn all(parameters: &Parameters) -> impl Iterator<Item = f32> {
    (0..Parameters::COUNT).filter_map(|index| parameters.get(index))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_whatever_else_is_refused() {
        let group = Ledger::Group([(7, 1.5); GROUP].into_iter().collect());
        for ledger in [
            group,
            Ledger::Settled(Sums::new(5, [6, 7, 8])),
            Ledger::Group(Vec::new()),
            Ledger::Rewriting,
        ] {
            let entry = ledger.entry();
            assert_eq!(Ledger::read(&entry.value), Some(ledger));
            assert_eq!(Ledger::read(&entry.value[..entry.value.len() - 1]), None);
        }
        assert_eq!(Ledger::read(&[3, 0, 0, 0]), None);
    }

    /// One wrong value, anywhere, is noticed; those of another firmware are not compared.
    #[test]
    fn a_ledger_knows_the_values_that_it_was_settled_with() {
        let mut parameters = Parameters::default();
        let sum = values(all(&parameters));
        let settled = Ledger::Settled(Sums::new(sum, [1, 2, 3]));
        assert!(settled.allows_values(sum) && settled.is_settled());
        for index in 0..Parameters::COUNT {
            let before = parameters.get(index).unwrap();
            let declaration = Parameters::declaration(index).unwrap();
            let other = [declaration.min, declaration.max].map(f32::to_bits);
            let other = other.into_iter().find(|bits| *bits != before.to_bits()).unwrap();
            parameters.set(index, f32::from_bits(other)).unwrap();
            assert!(!settled.allows_values(values(all(&parameters))), "{index}");
            parameters.set(index, before).unwrap();
        }
        assert_eq!(settled.allows_heads([1, 0, 3]), [true, false, true]);
        let other = Ledger::Settled(Sums {
            table: TABLE ^ 1,
            ..Sums::new(sum, [1, 2, 3])
        });
        assert!(other.allows_values(sum ^ 1) && !other.is_settled());
        assert!(!Ledger::Rewriting.allows_values(sum));
    }
}
