//! JSON cut down to what a plan needs while it is read, so that memory is bounded whatever the
//! file holds: only keys of a plan are kept, long lists are counted rather than stored.

use std::cell::Cell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use windhover_autopilot::fence::{MAX_RALLY, MAX_SHAPES, MAX_VERTICES};
use windhover_autopilot::mission::item::MAX_ITEMS;

/// The keys that are read; everything under another key is skipped unseen.
const KEYS: [&str; 27] = [
    "fileType",
    "version",
    "mission",
    "geoFence",
    "rallyPoints",
    "circles",
    "polygons",
    "points",
    "polygon",
    "circle",
    "center",
    "radius",
    "inclusion",
    "breachReturn",
    "items",
    "plannedHomePosition",
    "cruiseSpeed",
    "hoverSpeed",
    "type",
    "command",
    "frame",
    "autoContinue",
    "params",
    "complexItemType",
    "TransectStyleComplexItem",
    "Items",
    "vehicleType",
];

/// The key under which `serde_json` hands over a number as text, in a map of this one entry, where
/// another package of the same build asks for its `arbitrary_precision`.
const NUMBER: &str = "$serde_json::private::Number";

/// The most values kept of one file: forty times what the longest mission needs.
const MOST_VALUES: usize = 200_000;

/// The most values kept of a list that holds no items: one more than an item has parameters.
const MOST_NUMBERS: usize = 8;

/// The most bytes kept of a text.
const MOST_TEXT: usize = 60;

/// A JSON value, cut down.
#[derive(Debug)]
pub(super) enum Json {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    /// The first values, and how many there are in all.
    List {
        kept: Vec<Json>,
        len: usize,
    },
    /// The known keys, in the file's order.
    Object(Vec<(&'static str, Json)>),
    /// Not kept, for there is too much.
    Dropped,
}

impl Json {
    /// The value under `key`, if this is an object that has it.
    pub(super) fn get(&self, key: &str) -> Option<&Json> {
        match self {
            Self::Object(entries) => entries.iter().find(|(k, _)| *k == key).map(|(_, v)| v),
            _ => None,
        }
    }

    /// How many values a list has; none for anything else.
    pub(super) fn list_len(&self) -> usize {
        match self {
            Self::List { len, .. } => *len,
            _ => 0,
        }
    }

    /// How to name this value in a message.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Null => "null".into(),
            Self::Bool(value) => value.to_string(),
            Self::Number(value) => super::convert::number(*value),
            Self::Text(value) => format!("\"{}\"", super::error::one_line(value)),
            Self::List { len, .. } => format!("a list of {len}"),
            Self::Object(_) => "an object".into(),
            Self::Dropped => "more data than a mission needs".into(),
        }
    }
}

/// Reads one JSON document and says whether all of it was kept.
pub(super) fn read(reader: impl std::io::Read) -> Result<(Json, bool), serde_json::Error> {
    let left = Cell::new(MOST_VALUES);
    let mut deserializer = serde_json::Deserializer::from_reader(reader);
    let seed = Pruned {
        left: &left,
        most: MOST_NUMBERS,
    };
    let json = seed.deserialize(&mut deserializer)?;
    deserializer.end()?;
    Ok((json, left.get() > 0))
}

/// Reads a value: at most `most` elements if it is a list, and nothing once `left` is used up.
#[derive(Clone, Copy)]
struct Pruned<'a> {
    left: &'a Cell<usize>,
    most: usize,
}

impl<'de> DeserializeSeed<'de> for Pruned<'_> {
    type Value = Json;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Json, D::Error> {
        match self.left.get().checked_sub(1) {
            Some(left) => {
                self.left.set(left);
                deserializer.deserialize_any(self)
            }
            None => deserializer
                .deserialize_ignored_any(IgnoredAny)
                .map(|_| Json::Dropped),
        }
    }
}

impl<'de> Visitor<'de> for Pruned<'_> {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E: Error>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Json, E> {
        Ok(Json::Bool(value))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Json, E> {
        Ok(Json::Number(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Json, E> {
        Ok(Json::Number(value as f64))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Json, E> {
        Ok(Json::Number(value as f64))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Json, E> {
        let cut = value.floor_char_boundary(MOST_TEXT);
        let more = if cut < value.len() { "…" } else { "" };
        Ok(Json::Text(format!("{}{more}", &value[..cut])))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Json, A::Error> {
        let inner = Pruned {
            most: MOST_NUMBERS,
            ..self
        };
        let mut kept = Vec::new();
        while kept.len() < self.most {
            match list.next_element_seed(inner)? {
                Some(value) => kept.push(value),
                None => {
                    let len = kept.len();
                    return Ok(Json::List { kept, len });
                }
            }
        }
        let mut len = kept.len();
        while list.next_element::<IgnoredAny>()?.is_some() {
            len += 1;
        }
        Ok(Json::List { kept, len })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Json, A::Error> {
        let mut entries: Vec<(&'static str, Json)> = Vec::new();
        while let Some(key) = map.next_key_seed(Key)? {
            let Some(key) = key else {
                map.next_value::<IgnoredAny>()?;
                continue;
            };
            if entries.iter().any(|(seen, _)| *seen == key) {
                return Err(A::Error::custom(format_args!("`{key}` stands twice")));
            }
            if key == NUMBER {
                return number(&map.next_value::<String>()?).map(Json::Number);
            }
            let most = match key {
                "items" | "Items" => MAX_ITEMS,
                "polygon" => MAX_VERTICES,
                "polygons" | "circles" => MAX_SHAPES,
                "points" => MAX_RALLY,
                _ => MOST_NUMBERS,
            };
            entries.push((key, map.next_value_seed(Pruned { most, ..self })?));
        }
        Ok(Json::Object(entries))
    }
}

/// A number from its text, as finite as the file's format has it.
fn number<E: Error>(text: &str) -> Result<f64, E> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(E::custom("number out of range")),
    }
}

/// Reads a key and keeps it if it is one of [`KEYS`], or [`NUMBER`].
struct Key;

impl<'de> DeserializeSeed<'de> for Key {
    type Value = Option<&'static str>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl<'de> Visitor<'de> for Key {
    type Value = Option<&'static str>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Self::Value, E> {
        Ok(KEYS.into_iter().chain([NUMBER]).find(|key| *key == value))
    }
}

#[cfg(test)]
mod tests {
    use serde::de::value::{Error as ValueError, MapDeserializer};

    use super::*;

    fn handed_over(text: &'static str) -> Result<Json, ValueError> {
        let left = Cell::new(10);
        let seed = Pruned {
            left: &left,
            most: MOST_NUMBERS,
        };
        seed.deserialize(MapDeserializer::new([(NUMBER, text)].into_iter()))
    }

    /// Whether a program is built alone or with one that wants numbers as text, it reads the same.
    #[test]
    fn a_number_as_text_is_a_number() {
        for (text, value) in [("47.3977419", 47.3977419), ("-3", -3.0), ("1e-7", 1e-7)] {
            assert!(
                matches!(handed_over(text), Ok(Json::Number(read)) if read == value),
                "{text}"
            );
        }
        for text in ["1e999", "north"] {
            let refused = handed_over(text).unwrap_err().to_string();
            assert!(refused.contains("out of range"), "{text}: {refused}");
        }
    }
}
