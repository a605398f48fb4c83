//! What can be wrong with a mission file, in one line that a person can act on.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use windhover_autopilot::mission::item::MAX_ITEMS;

/// A mission file that is refused: which file, and why.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", one_line(&.file.display().to_string()))]
pub struct MissionFileError {
    /// The file as it was named by the user.
    pub file: PathBuf,
    /// What is wrong with it.
    pub problem: Problem,
}

impl MissionFileError {
    pub(super) fn new(file: &Path, problem: Problem) -> Self {
        let file = file.to_path_buf();
        Self { file, problem }
    }
}

/// Where in a mission file something stands, as a person finds it there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Outside the items.
    File,
    /// The n-th item of a plan, counted from 1.
    Item(usize),
    /// A part of a survey or corridor of a plan, both counted from 1.
    Part {
        /// Number of the pattern in the list of items.
        item: usize,
        /// The kind of pattern, as the file names it.
        pattern: String,
        /// Number of the part in the pattern's list of items.
        part: usize,
    },
    /// The n-th polygon of the geofence, counted from 1.
    Polygon(usize),
    /// A corner of it, both counted from 1.
    Vertex {
        /// Number of the polygon.
        polygon: usize,
        /// Number of the corner.
        vertex: usize,
    },
    /// The n-th circle of the geofence, counted from 1.
    Circle(usize),
    /// Where the geofence would have a vehicle return that has left it.
    BreachReturn,
    /// The n-th rally point, counted from 1.
    Rally(usize),
    /// An item of a waypoint file.
    Line {
        /// Line of the file, counted from 1.
        line: usize,
        /// The item's number as it stands in the file, counted from 0.
        seq: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => write!(f, "the file"),
            Self::Item(item) => write!(f, "item {item}"),
            Self::Part { item, pattern, part } => {
                write!(f, "item {item} ({}), part {part}", one_line(pattern))
            }
            Self::Polygon(number) => write!(f, "geofence polygon {number}"),
            Self::Vertex { polygon, vertex } => write!(f, "geofence polygon {polygon}, vertex {vertex}"),
            Self::Circle(number) => write!(f, "geofence circle {number}"),
            Self::BreachReturn => write!(f, "geofence return point"),
            Self::Rally(number) => write!(f, "rally point {number}"),
            Self::Line { line, seq } => write!(f, "item {seq} (line {line})"),
        }
    }
}

/// A named field at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// The item, or the file as a whole.
    pub place: Place,
    /// The field as the file or MAVLink names it.
    pub name: String,
}

impl Field {
    pub(super) fn new(place: &Place, name: &str) -> Self {
        let (place, name) = (place.clone(), name.to_owned());
        Self { place, name }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Place::File => f.write_str(&self.name),
            _ => write!(f, "{}, {}", self.place, self.name),
        }
    }
}

/// Why a mission file is refused.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The operating system does not give it to us.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// A folder.
    #[error("is a folder; name a .plan or waypoint file in it")]
    Folder,
    /// No byte in it, or only blanks.
    #[error("is empty")]
    Empty,
    /// Something else altogether.
    #[error("is not a mission: neither a QGroundControl plan nor a waypoint file (QGC WPL 110)")]
    NotAMission,
    /// More than is ever read.
    #[error("is larger than {} MB, the most that is read", .limit / 1_000_000)]
    TooLarge {
        /// The most bytes that are read.
        limit: u64,
    },
    /// Broken JSON: cut off, or edited by hand.
    #[error("line {line}, column {column}: {what}; save the plan again in QGroundControl")]
    Json {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the JSON reader says.
        what: String,
    },
    /// A version of the format that is not known.
    #[error("{field}: {found} is not known, only {known} is read")]
    Version {
        /// Which version.
        field: Box<Field>,
        /// What the file says.
        found: String,
        /// What is read.
        known: &'static str,
    },
    /// A field that has to be there.
    #[error("{0} is missing")]
    Missing(Box<Field>),
    /// A field of another type.
    #[error("{field}: found {found}, {wanted} is needed")]
    WrongType {
        /// Which field.
        field: Box<Field>,
        /// What stands there.
        found: String,
        /// What should.
        wanted: &'static str,
    },
    /// A number that is not allowed.
    #[error("{field}: {found} is outside {min} to {max}")]
    OutOfRange {
        /// Which field.
        field: Box<Field>,
        /// The number as found.
        found: String,
        /// The least.
        min: String,
        /// The most.
        max: String,
    },
    /// A fraction where MAVLink has room for an integer only.
    #[error("{field}: {found} is not a whole number, and frame {frame} has no position")]
    NotWhole {
        /// Which field.
        field: Box<Field>,
        /// The number as found.
        found: String,
        /// The item's frame.
        frame: u8,
    },
    /// An item type or a pattern that is not flown.
    #[error("{field}: {found} is not flown; {advice}")]
    Unsupported {
        /// Which field.
        field: Box<Field>,
        /// What stands there.
        found: String,
        /// What to do about it.
        advice: &'static str,
    },
    /// A mission longer than the vehicle holds.
    #[error("has {count}{} items, a mission holds at most {MAX_ITEMS}", if *.exact { "" } else { " or more" })]
    TooManyItems {
        /// How many it has.
        count: usize,
        /// Whether `count` is exact, or the least.
        exact: bool,
    },
    /// More of something than the vehicle stores.
    #[error("has {count} {what}, the vehicle stores at most {most}")]
    TooMany {
        /// How many it has.
        count: usize,
        /// How many it may have.
        most: usize,
        /// Of what.
        what: &'static str,
    },
    /// A polygon without an area.
    #[error("{place}: {count} vertices, a polygon has 3 or more")]
    TooFewVertices {
        /// Which polygon.
        place: Box<Place>,
        /// How many it has.
        count: usize,
    },
    /// Items of a waypoint file that are lost, doubled or out of order.
    #[error("line {line}: item {found} stands where item {expected} is due")]
    Sequence {
        /// Line of the file, counted from 1.
        line: usize,
        /// The number found.
        found: usize,
        /// The number due.
        expected: usize,
    },
    /// A line of a waypoint file that is not twelve fields.
    #[error("line {line}: {found} fields, an item has 12")]
    Fields {
        /// Line of the file, counted from 1.
        line: usize,
        /// How many were found.
        found: usize,
    },
    /// A line of a waypoint file that is no text.
    #[error("line {line}: is not text, or longer than {limit} bytes")]
    Line {
        /// Line of the file, counted from 1.
        line: usize,
        /// The most bytes in a line.
        limit: usize,
    },
}

/// Text out of a file, fit to stand inside a message of one line: control characters escaped,
/// and not longer than a line.
pub(super) fn one_line(text: &str) -> String {
    const LONGEST: usize = 200;
    let mut line: String = text
        .chars()
        .take(LONGEST)
        .flat_map(|c| {
            let hidden = c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
            let escaped = hidden.then(|| c.escape_default());
            let plain = (!hidden).then_some(c);
            escaped.into_iter().flatten().chain(plain)
        })
        .collect();
    if text.chars().nth(LONGEST).is_some() {
        line.push('…');
    }
    line
}
