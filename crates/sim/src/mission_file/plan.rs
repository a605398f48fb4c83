//! QGroundControl's `.plan`: JSON, format version 1 with mission version 2.

use std::io::Read;

use windhover_autopilot::mission::item::{MAX_ITEMS, MissionItem};

use super::convert::{self, RawItem};
use super::error::{Field, Place, Problem, one_line};
use super::json::{self, Json};
use super::{MissionFile, Position, fence};

/// The pattern versions whose stored items are understood: kind, versions, and how to say them.
const PATTERNS: [(&str, &[f64], &str); 2] = [
    ("survey", &[4.0, 5.0], "version 4 or 5"),
    ("CorridorScan", &[2.0], "version 2"),
];

/// Reads a plan from its first brace on.
pub(super) fn read(reader: impl Read) -> Result<MissionFile, Problem> {
    let (root, complete) = json::read(reader).map_err(broken)?;
    let top = Node::new(&root, Place::File);
    if top.text("fileType").ok().as_deref() != Some("Plan") {
        return Err(Problem::NotAMission);
    }
    top.version("version", "version", &[1.0], "version 1")?;
    let mission = Node::new(top.need("mission")?, Place::File);
    if !matches!(mission.json, Json::Object(_)) {
        return Err(mission.wrong("mission", mission.json, "an object"));
    }
    mission.version("version", "mission version", &[2.0], "version 2")?;

    let mut file = MissionFile {
        home: home(&mission)?,
        cruise_speed: speed(&mission, "cruiseSpeed")?,
        hover_speed: speed(&mission, "hoverSpeed")?,
        ..MissionFile::default()
    };
    items(mission.need("items")?, complete, &mut file)?;
    fence::fence(&top, &mut file)?;
    fence::rally(&top, &mut file)?;
    notes(&mission, &mut file);
    Ok(file)
}

/// Everything under `mission.items`, patterns flattened into their parts.
fn items(list: &Json, complete: bool, file: &mut MissionFile) -> Result<(), Problem> {
    let Json::List { kept, len } = list else {
        return Err(Node::new(list, Place::File).wrong("items", list, "a list"));
    };
    let parts = |item: &Json| part_list(item).map_or(1, Json::list_len);
    let count = kept.iter().map(parts).sum::<usize>() + len.saturating_sub(kept.len());
    if count > MAX_ITEMS {
        let exact = complete && *len <= MAX_ITEMS || !kept.iter().any(|i| part_list(i).is_some());
        return Err(Problem::TooManyItems { count, exact });
    }
    for (index, json) in kept.iter().enumerate() {
        let node = Node::new(json, Place::Item(index + 1));
        if !matches!(json, Json::Object(_)) {
            return Err(node.wrong("type", json, "an item"));
        }
        match node.text("type")?.as_str() {
            "SimpleItem" => file.push(simple(&node)?, node.place),
            "ComplexItem" => pattern(&node, index + 1, file)?,
            other => {
                let found = format!("\"{other}\"");
                let advice = "known are SimpleItem and ComplexItem";
                return Err(node.unsupported("type", found, advice));
            }
        }
    }
    Ok(())
}

/// The list of items that a pattern stores, if it does.
fn part_list(item: &Json) -> Option<&Json> {
    item.get("TransectStyleComplexItem")?.get("Items")
}

/// A survey or corridor: the items that QGroundControl computed and stored with it.
fn pattern(node: &Node, item: usize, file: &mut MissionFile) -> Result<(), Problem> {
    const FIELD: &str = "complexItemType";
    let kind = one_line(&node.text(FIELD)?);
    let Some((_, versions, known)) = PATTERNS.iter().find(|(name, ..)| *name == kind) else {
        let advice = match kind.as_str() {
            "StructureScan" => "QGroundControl stores no waypoints for it: plan waypoints or a survey",
            "fwLandingPattern" | "vtolLandingPattern" => {
                "it is for aeroplanes: end with a land or return item"
            }
            _ => "flown are survey and CorridorScan: plan waypoints instead",
        };
        return Err(node.unsupported(FIELD, format!("\"{kind}\""), advice));
    };
    node.version("version", &format!("{kind} version"), versions, known)?;
    let stored = node.need("TransectStyleComplexItem")?;
    let Some(list) = stored.get("Items") else {
        let advice = "open and save the plan in QGroundControl once more";
        return Err(node.unsupported("Items", format!("a {kind} without stored items"), advice));
    };
    let Json::List { kept, .. } = list else {
        return Err(node.wrong("Items", list, "a list"));
    };
    for (index, json) in kept.iter().enumerate() {
        let part = Place::Part {
            item,
            pattern: kind.clone(),
            part: index + 1,
        };
        let part = Node::new(json, part);
        match part.text("type")?.as_str() {
            "SimpleItem" => file.push(simple(&part)?, part.place),
            other => {
                let advice = "a pattern is made of SimpleItem";
                return Err(part.unsupported("type", format!("\"{other}\""), advice));
            }
        }
    }
    Ok(())
}

/// One MAVLink item.
fn simple(node: &Node) -> Result<MissionItem, Problem> {
    let raw = RawItem {
        command: node.integer("command", u16::MAX.into())? as u16,
        frame: node.integer("frame", u8::MAX.into())? as u8,
        autocontinue: node.boolean("autoContinue")?,
        params: node.params()?,
    };
    convert::item(&raw, &node.place)
}

/// `plannedHomePosition`: absent, null and 0, 0 all say that none was planned.
fn home(mission: &Node) -> Result<Option<Position>, Problem> {
    const FIELD: &str = "plannedHomePosition";
    let list = match mission.json.get(FIELD) {
        None | Some(Json::Null) => return Ok(None),
        Some(list) => list,
    };
    let [lat, lon, alt] = mission.position(FIELD, list, false)?;
    if lat.is_nan() || lon.is_nan() || (lat == 0.0 && lon == 0.0) {
        return Ok(None);
    }
    let named = |part: &str| Field::new(&Place::File, &format!("{FIELD} {part}"));
    let alt = if alt.is_nan() { 0.0 } else { alt };
    Ok(Some((
        convert::latitude(lat, &named("latitude"))?,
        convert::longitude(lon, &named("longitude"))?,
        convert::millimetres(alt, &named("altitude"))?,
    )))
}

/// A speed of the plan as a whole; absent, null and 0 say that none was planned.
fn speed(mission: &Node, field: &str) -> Result<Option<f32>, Problem> {
    const FASTEST: f64 = 1000.0;
    let value = match mission.json.get(field) {
        None => return Ok(None),
        Some(json) => number(json).ok_or_else(|| mission.wrong(field, json, "a number"))?,
    };
    if value.is_nan() || value == 0.0 {
        return Ok(None);
    }
    if !(0.0..=FASTEST).contains(&value) {
        return Err(Problem::OutOfRange {
            field: Box::new(Field::new(&Place::File, field)),
            found: convert::number(value),
            min: "0".into(),
            max: convert::number(FASTEST),
        });
    }
    Ok(Some(value as f32))
}

/// What the user should know of the plan.
fn notes(mission: &Node, file: &mut MissionFile) {
    if let Some(Json::Number(kind)) = mission.json.get("vehicleType")
        && *kind != 2.0
    {
        let note = format!("the plan was made for vehicle type {kind}, not for a multirotor (2)");
        file.notes.push(note);
    }
}

/// A JSON value and where it stands, with the questions that a plan is asked.
pub(super) struct Node<'a> {
    pub(super) json: &'a Json,
    pub(super) place: Place,
}

impl<'a> Node<'a> {
    pub(super) fn new(json: &'a Json, place: Place) -> Self {
        Self { json, place }
    }

    fn field(&self, name: &str) -> Box<Field> {
        Box::new(Field::new(&self.place, name))
    }

    pub(super) fn wrong(&self, name: &str, found: &Json, wanted: &'static str) -> Problem {
        Problem::WrongType {
            field: self.field(name),
            found: found.name(),
            wanted,
        }
    }

    fn unsupported(&self, name: &str, found: String, advice: &'static str) -> Problem {
        Problem::Unsupported {
            field: self.field(name),
            found,
            advice,
        }
    }

    pub(super) fn need(&self, name: &str) -> Result<&'a Json, Problem> {
        let value = self.json.get(name);
        value.ok_or_else(|| Problem::Missing(self.field(name)))
    }

    /// What a list keeps, and how many values it has; absent and null are an empty one.
    pub(super) fn list(&self, name: &str) -> Result<(&'a [Json], usize), Problem> {
        match self.json.get(name) {
            None | Some(Json::Null) => Ok((&[], 0)),
            Some(Json::List { kept, len }) => Ok((kept, *len)),
            Some(other) => Err(self.wrong(name, other, "a list")),
        }
    }

    fn text(&self, name: &str) -> Result<String, Problem> {
        match self.need(name)? {
            Json::Text(text) => Ok(one_line(text)),
            other => Err(self.wrong(name, other, "text")),
        }
    }

    pub(super) fn boolean(&self, name: &str) -> Result<bool, Problem> {
        match self.need(name)? {
            Json::Bool(value) => Ok(*value),
            other => Err(self.wrong(name, other, "true or false")),
        }
    }

    /// A whole number from 0 to `max`.
    fn integer(&self, name: &str, max: u32) -> Result<u32, Problem> {
        const WANTED: &str = "a whole number";
        let json = self.need(name)?;
        let Json::Number(value) = *json else {
            return Err(self.wrong(name, json, WANTED));
        };
        if !(0.0..=f64::from(max)).contains(&value) {
            return Err(Problem::OutOfRange {
                field: self.field(name),
                found: json.name(),
                min: "0".into(),
                max: max.to_string(),
            });
        }
        if value.trunc() != value {
            return Err(self.wrong(name, json, WANTED));
        }
        Ok(value as u32)
    }

    /// The seven parameters; null says unset.
    fn params(&self) -> Result<[f64; 7], Problem> {
        const FIELD: &str = "params";
        let json = self.need(FIELD)?;
        let Json::List { kept, len: 7 } = json else {
            return Err(self.wrong(FIELD, json, "a list of 7 numbers"));
        };
        let mut params = [f64::NAN; 7];
        for (index, json) in kept.iter().enumerate() {
            let name = format!("parameter {}", index + 1);
            params[index] = number(json).ok_or_else(|| self.wrong(&name, json, "a number or null"))?;
        }
        Ok(params)
    }

    /// Latitude, longitude and height; the height may be left out unless it is needed, and is 0
    /// then.
    pub(super) fn position(&self, name: &str, json: &Json, needs_height: bool) -> Result<[f64; 3], Problem> {
        let (least, wanted) = if needs_height {
            (3, "latitude, longitude and height")
        } else {
            (2, "latitude and longitude")
        };
        let kept = match json {
            Json::List { kept, len } if (least..=3).contains(len) => kept,
            _ => return Err(self.wrong(name, json, wanted)),
        };
        let mut values = [0.0; 3];
        for (value, json) in values.iter_mut().zip(kept) {
            *value = number(json).ok_or_else(|| self.wrong(name, json, "a number"))?;
        }
        Ok(values)
    }

    /// Refuses every version but those in `versions`.
    pub(super) fn version(
        &self,
        key: &str,
        name: &str,
        versions: &[f64],
        known: &'static str,
    ) -> Result<(), Problem> {
        match self.json.get(key) {
            None => Err(Problem::Missing(self.field(name))),
            Some(Json::Number(found)) if versions.contains(found) => Ok(()),
            Some(other) => Err(Problem::Version {
                field: self.field(name),
                found: other.name(),
                known,
            }),
        }
    }
}

/// A number, or NaN for null.
fn number(json: &Json) -> Option<f64> {
    match json {
        Json::Number(value) => Some(*value),
        Json::Null => Some(f64::NAN),
        _ => None,
    }
}

/// What the JSON reader says, its position apart.
fn broken(error: serde_json::Error) -> Problem {
    if let Some(kind) = error.io_error_kind() {
        return Problem::Unreadable(kind.into());
    }
    let (line, column) = (error.line(), error.column());
    let text = error.to_string();
    let what = text.split(" at line ").next().unwrap_or(&text);
    let what = one_line(what);
    Problem::Json { line, column, what }
}
