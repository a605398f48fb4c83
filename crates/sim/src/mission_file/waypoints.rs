//! The waypoint file `QGC WPL 110` of Mission Planner, MAVProxy and older QGroundControl:
//! a line an item, twelve fields apart by tabs or spaces.
//!
//! Mission Planner, MAVProxy and QGroundControl write the home position as item 0: a plain
//! waypoint (command 16) with altitude above the sea (frame 0) and no parameters. It is taken as
//! home and not flown. Anything else as item 0 (MAVSDK's sample begins with a takeoff) is flown.

use std::io::{BufRead, Read};

use windhover_autopilot::mission::item::MAX_ITEMS;

use super::MissionFile;
use super::convert::{self, RawItem};
use super::error::{Field, Place, Problem, one_line};

/// The most bytes in a line.
const LONGEST_LINE: usize = 1000;

/// The names of an item's fields, for messages.
const FIELDS: [&str; 12] = [
    "number",
    "current",
    "frame",
    "command",
    "parameter 1",
    "parameter 2",
    "parameter 3",
    "parameter 4",
    "parameter 5",
    "parameter 6",
    "parameter 7",
    "autocontinue",
];

/// Reads a waypoint file from its first line on.
pub(super) fn read(reader: impl BufRead) -> Result<MissionFile, Problem> {
    let mut lines = Lines::new(reader);
    let header = match lines.next() {
        Err(Problem::Line { .. }) => return Err(Problem::NotAMission),
        header => header?.unwrap_or_default(),
    };
    let words: Vec<&str> = header.split_whitespace().collect();
    match words.as_slice() {
        ["QGC", "WPL", "110"] => {}
        ["QGC", "WPL", version] => {
            return Err(Problem::Version {
                field: Box::new(Field::new(&Place::File, "QGC WPL")),
                found: format!("version {}", one_line(version)),
                known: "version 110",
            });
        }
        _ => return Err(Problem::NotAMission),
    }
    let mut file = MissionFile::default();
    let mut seq = 0;
    while let Some(text) = lines.next()? {
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        if file.items.len() == MAX_ITEMS {
            let count = MAX_ITEMS + 1 + lines.count_items()?;
            return Err(Problem::TooManyItems { count, exact: true });
        }
        item(text, lines.line, seq, &mut file)?;
        seq += 1;
    }
    Ok(file)
}

/// Reads one item, and tells home from what is flown.
fn item(text: &str, line: usize, expected: usize, file: &mut MissionFile) -> Result<(), Problem> {
    let words: Vec<&str> = text.split_whitespace().collect();
    if words.len() != FIELDS.len() {
        let found = words.len();
        return Err(Problem::Fields { line, found });
    }
    let place = Place::Line { line, seq: expected };
    let found = integer(words[0], 0, &place, u32::MAX)? as usize;
    if found != expected {
        return Err(Problem::Sequence {
            line,
            found,
            expected,
        });
    }
    integer(words[1], 1, &place, 1)?;
    let mut params = [0.0; 7];
    for (index, param) in params.iter_mut().enumerate() {
        *param = number(words[4 + index], 4 + index, &place)?;
    }
    let raw = RawItem {
        frame: integer(words[2], 2, &place, u8::MAX.into())? as u8,
        command: integer(words[3], 3, &place, u16::MAX.into())? as u16,
        autocontinue: integer(words[11], 11, &place, 1)? == 1,
        params,
    };
    let item = convert::item(&raw, &place)?;
    if expected == 0 && is_home(&raw) {
        let metres = Field::new(&place, "altitude");
        let alt = convert::millimetres(raw.params[6], &metres)?;
        // Mission Planner writes zeros when no home is set.
        file.home = (item.x != 0 || item.y != 0).then_some((item.x, item.y, alt));
    } else {
        file.push(item, place);
    }
    Ok(())
}

/// Whether item 0 is the home position.
fn is_home(item: &RawItem) -> bool {
    let plain = |p: &f64| *p == 0.0 || p.is_nan();
    item.command == 16 && item.frame == 0 && item.params[..4].iter().all(plain)
}

/// A whole number from 0 to `max`.
fn integer(word: &str, field: usize, place: &Place, max: u32) -> Result<u32, Problem> {
    let field = Box::new(Field::new(place, FIELDS[field]));
    match word.parse::<i128>() {
        Ok(value) if (0..=i128::from(max)).contains(&value) => Ok(value as u32),
        Ok(value) => Err(Problem::OutOfRange {
            field,
            found: value.to_string(),
            min: "0".into(),
            max: max.to_string(),
        }),
        Err(_) => Err(wrong(word, field, "a whole number")),
    }
}

/// A number with a point for its decimals.
fn number(word: &str, field: usize, place: &Place) -> Result<f64, Problem> {
    let field = Box::new(Field::new(place, FIELDS[field]));
    word.parse()
        .map_err(|_| wrong(word, field, "a number with a decimal point"))
}

fn wrong(word: &str, field: Box<Field>, wanted: &'static str) -> Problem {
    let found = format!("\"{}\"", one_line(word));
    Problem::WrongType { field, found, wanted }
}

/// Lines of text, none longer than [`LONGEST_LINE`].
struct Lines<R> {
    reader: R,
    line: usize,
}

impl<R: BufRead> Lines<R> {
    fn new(reader: R) -> Self {
        Self { reader, line: 0 }
    }

    /// The next line, or none at the end of the file.
    fn next(&mut self) -> Result<Option<String>, Problem> {
        self.line += 1;
        let mut bytes = Vec::new();
        let mut limited = (&mut self.reader).take(LONGEST_LINE as u64 + 1);
        limited.read_until(b'\n', &mut bytes)?;
        if bytes.is_empty() {
            return Ok(None);
        }
        let refused = Problem::Line {
            line: self.line,
            limit: LONGEST_LINE,
        };
        if bytes.len() > LONGEST_LINE {
            return Err(refused);
        }
        String::from_utf8(bytes).map(Some).map_err(|_| refused)
    }

    /// How many items follow, whatever they are.
    fn count_items(&mut self) -> Result<usize, Problem> {
        let mut count = 0;
        while let Some(text) = self.next()? {
            let text = text.trim();
            count += usize::from(!text.is_empty() && !text.starts_with('#'));
        }
        Ok(count)
    }
}
