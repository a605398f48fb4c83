//! Records: structs whose fields are declared once, and so get format, encoder and decoder.

use crate::value::{Scalar, Value};
use crate::wire::{Decoder, Encoder, kind, message};

/// A field of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its scalar.
    pub scalar: Scalar,
    /// How many.
    pub count: Count,
}

/// How many scalars a field has. K is the number of ticks in a period of the outer step; a log
/// has one K from its first to its last byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// One, no array.
    One,
    /// An array of so many.
    Fixed(u8),
    /// So many for each of K ticks.
    PerTick(u8),
    /// One for each tick of a period but the first.
    PerStep,
    /// Two bits for each tick, in bytes.
    TwoBits,
}

impl Count {
    /// The length of the array, for a log's K; `None` for no array.
    pub fn length(self, k: usize) -> Option<usize> {
        match self {
            Self::One => None,
            Self::Fixed(count) => Some(usize::from(count)),
            Self::PerTick(count) => Some(usize::from(count) * k),
            Self::PerStep => Some(k.saturating_sub(1)),
            Self::TwoBits => Some(k.div_ceil(4)),
        }
    }
}

impl Field {
    /// A field that holds a value of this type.
    pub const fn of<T: Value>(name: &'static str) -> Self {
        Self {
            name,
            scalar: T::SCALAR,
            count: match T::COUNT {
                0 => Count::One,
                count => Count::Fixed(count),
            },
        }
    }

    /// Its bytes, for a log's K.
    pub fn size(&self, k: usize) -> usize {
        self.scalar.size() * self.count.length(k).unwrap_or(1)
    }
}

/// A struct that can be written to a log, without its time.
pub trait Record: Sized {
    /// Its fields, in order.
    const FIELDS: &'static [Field];
    /// Writes the fields.
    fn put(&self, out: &mut Encoder<'_>);
    /// Reads the fields; `None` when there are too few bytes, or a value that nobody writes.
    fn get(from: &mut Decoder<'_>) -> Option<Self>;
}

/// Declares the fields of a struct that exists: `record!(Type { field: Type, ... })`.
#[macro_export]
macro_rules! record {
    ($Type:ty { $($field:ident: $Value:ty),* $(,)? }) => {
        impl $crate::record::Record for $Type {
            const FIELDS: &'static [$crate::record::Field] =
                &[$($crate::record::Field::of::<$Value>(stringify!($field)),)*];
            #[inline]
            fn put(&self, out: &mut $crate::wire::Encoder<'_>) {
                $(<$Value as $crate::value::Value>::put(&self.$field, out);)*
            }
            #[inline]
            fn get(from: &mut $crate::wire::Decoder<'_>) -> Option<Self> {
                Some(Self { $($field: <$Value as $crate::value::Value>::get(from)?,)* })
            }
        }
    };
}

/// What a log says of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Description {
    /// Its number in the logs that we write.
    pub id: u16,
    /// Its name.
    pub name: &'static str,
    /// Whether the tick stands before the fields.
    pub ticked: bool,
    /// Its fields after the time and the tick.
    pub fields: &'static [Field],
}

/// A record with a name of its own.
pub trait Topic: Record {
    /// What a log says of it.
    const TOPIC: Description;
}

impl Description {
    /// All fields, the time and the tick among them; those that are empty for this K left out.
    pub fn all_fields(&self, k: usize) -> impl Iterator<Item = Field> {
        let tick = self.ticked.then(|| Field::of::<u32>("tick"));
        let fields = self.fields.iter().copied();
        core::iter::once(Field::of::<u64>("timestamp"))
            .chain(tick)
            .chain(fields.filter(move |field| field.count.length(k) != Some(0)))
    }

    /// Bytes of a record, time and tick included.
    pub fn size(&self, k: usize) -> usize {
        self.all_fields(k).map(|field| field.size(k)).sum()
    }

    /// Writes the format, as in `name:uint64_t timestamp;float[4] q;`.
    pub fn format(&self, k: usize, out: &mut Encoder<'_>) {
        out.slice(self.name.as_bytes());
        out.bytes([b':']);
        for field in self.all_fields(k) {
            out.slice(field.scalar.name().as_bytes());
            if let Some(length) = field.count.length(k) {
                out.bytes([b'[']);
                out.decimal(length);
                out.bytes([b']']);
            }
            out.bytes([b' ']);
            out.slice(field.name.as_bytes());
            out.bytes([b';']);
        }
    }
}

/// Writes one data message; its length, or `None` when it does not fit.
#[inline]
pub fn data(buffer: &mut [u8], id: u16, time: u64, body: impl FnOnce(&mut Encoder<'_>)) -> Option<usize> {
    message(buffer, kind::DATA, |out| {
        out.bytes(id.to_le_bytes());
        out.bytes(time.to_le_bytes());
        body(out);
    })
}
