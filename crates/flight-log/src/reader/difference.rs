//! Where two records of a topic differ, by field.

use std::format;
use std::string::{String, ToString};

use thiserror::Error;

use crate::record::Description;
use crate::value::{Scalar, Value};
use crate::views::View;
use crate::wire::Decoder;

/// The longest record of a view.
const LONGEST: usize = 256;

/// The first field in which two records differ.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{topic}.{field} is {found}, was {expected}")]
pub struct Difference {
    /// The topic.
    pub topic: &'static str,
    /// The field, as in `q[2]`.
    pub field: String,
    /// Its value in the first record.
    pub expected: String,
    /// Its value in the second record.
    pub found: String,
}

/// The first field in which two records of the same view differ, bit for bit; `None` when they are
/// equal.
pub fn difference(expected: &View, found: &View) -> Option<Difference> {
    let (mut a, mut b) = ([0; LONGEST], [0; LONGEST]);
    let (topic, a) = expected.put(&mut a);
    let (other, b) = found.put(&mut b);
    if topic.id != other.id {
        return Some(Difference {
            topic: topic.name,
            field: "topic".into(),
            expected: topic.name.into(),
            found: other.name.into(),
        });
    }
    fields(&topic, a, b)
}

fn fields(topic: &Description, a: &[u8], b: &[u8]) -> Option<Difference> {
    let (mut a, mut b) = (Decoder::new(a), Decoder::new(b));
    for field in topic.fields {
        let length = field.count.length(0);
        for index in 0..length.unwrap_or(1) {
            let (x, y) = (a.slice(field.scalar.size())?, b.slice(field.scalar.size())?);
            if x != y {
                return Some(Difference {
                    topic: topic.name,
                    field: match length {
                        Some(_) => format!("{}[{index}]", field.name),
                        None => field.name.into(),
                    },
                    expected: show(field.scalar, x),
                    found: show(field.scalar, y),
                });
            }
        }
    }
    None
}

/// A scalar as text. Floats are written so that different ones look different.
fn show(scalar: Scalar, bytes: &[u8]) -> String {
    fn text<T: Value + ToString>(bytes: &[u8]) -> String {
        T::get(&mut Decoder::new(bytes)).map_or_else(String::new, |value| value.to_string())
    }
    match scalar {
        Scalar::I8 => text::<i8>(bytes),
        Scalar::U8 => text::<u8>(bytes),
        Scalar::I16 => text::<i16>(bytes),
        Scalar::U16 => text::<u16>(bytes),
        Scalar::I32 => text::<i32>(bytes),
        Scalar::U32 => text::<u32>(bytes),
        Scalar::U64 => text::<u64>(bytes),
        Scalar::F32 => text::<f32>(bytes),
        Scalar::F64 => text::<f64>(bytes),
        Scalar::Bool => text::<bool>(bytes),
    }
}
