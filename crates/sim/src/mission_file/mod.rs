//! Mission files that ground stations save: QGroundControl's `.plan` with its geofence and rally
//! points, and the waypoint file `QGC WPL 110`, told apart by their first bytes, whatever their
//! names.
//!
//! Reading checks that a file says what an item is; whether the vehicle flies it is for the
//! core to say (`windhover_autopilot::mission`). Memory is bounded whatever is in the file.

mod convert;
mod error;
mod fence;
mod json;
mod plan;
mod waypoints;

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use windhover_autopilot::mission::item::MissionItem;

use crate::stored::Stored;
use convert::RawItem;

pub use error::{Field, MissionFileError, Place, Problem};

/// The most bytes that are read of a file: a million items, so that their number can be told.
const MOST_BYTES: u64 = 256_000_000;

/// Latitude and longitude in 1e-7 degree, altitude above the sea in mm.
pub type Position = (i32, i32, i32);

/// A mission as it stands in a file.
#[derive(Debug, Default)]
pub struct MissionFile {
    /// What is flown, in order; surveys and corridors as the items stored with them.
    pub items: Vec<MissionItem>,
    /// The home that the mission was planned for.
    pub home: Option<Position>,
    /// Speed of the plan for forward flight, m/s.
    pub cruise_speed: Option<f32>,
    /// Speed of the plan for multirotors, m/s.
    pub hover_speed: Option<f32>,
    /// The geofence, as the items that a ground station uploads.
    pub fence: Vec<MissionItem>,
    /// Rally points, as the items that a ground station uploads.
    pub rally: Vec<MissionItem>,
    /// What the user should know before the flight, a line each.
    pub notes: Vec<String>,
    /// Where each of `items` stands in the file.
    places: Vec<Place>,
    /// Where each of `fence` does.
    fence_places: Vec<Place>,
}

impl MissionFile {
    /// What is stored on board once it is uploaded.
    pub fn stored(&self) -> Stored {
        Stored {
            mission: self.items.clone(),
            fence: self.fence.clone(),
            rally: self.rally.clone(),
        }
    }

    /// How a person finds item `index` of `items` in the file: "item 3",
    /// "item 2 (survey), part 7" or, in a waypoint file, "item 3 (line 5)".
    pub fn describe(&self, index: usize) -> String {
        match self.places.get(index) {
            Some(place) => place.to_string(),
            None => format!("item {}", index + 1),
        }
    }

    /// Where item `index` of `items` stands in the file.
    pub fn place(&self, index: usize) -> Option<&Place> {
        self.places.get(index)
    }

    /// How a person finds the shape of item `index` of `fence` in the file: "geofence polygon 2".
    pub fn describe_fence(&self, index: usize) -> String {
        match self.fence_places.get(index) {
            Some(Place::Vertex { polygon, .. }) => Place::Polygon(*polygon).to_string(),
            Some(place) => place.to_string(),
            None => format!("geofence item {}", index + 1),
        }
    }

    fn push_fence(&mut self, raw: RawItem, place: Place) -> Result<(), Problem> {
        self.fence.push(convert::item(&raw, &place)?);
        self.fence_places.push(place);
        Ok(())
    }

    fn push(&mut self, item: MissionItem, place: Place) {
        self.items.push(item);
        self.places.push(place);
    }
}

/// Reads a mission file of either kind.
pub fn read(path: &Path) -> Result<MissionFile, MissionFileError> {
    let refuse = |problem| MissionFileError::new(path, problem);
    if path.is_dir() {
        return Err(refuse(Problem::Folder));
    }
    let file = File::open(path).map_err(|e| refuse(e.into()))?;
    read_from(file, MOST_BYTES).map_err(refuse)
}

/// Reads a mission that is already in memory; `name` is for messages.
pub fn read_bytes(name: &Path, bytes: &[u8]) -> Result<MissionFile, MissionFileError> {
    read_from(bytes, MOST_BYTES).map_err(|problem| MissionFileError::new(name, problem))
}

/// Reads at most `limit` bytes.
fn read_from(reader: impl Read, limit: u64) -> Result<MissionFile, Problem> {
    let mut reader = BufReader::new(reader.take(limit));
    skip_blanks(&mut reader)?;
    let start = reader.fill_buf()?;
    let result = match start.first() {
        None => Err(Problem::Empty),
        Some(b'{') => plan::read(&mut reader),
        Some(b'Q') => waypoints::read(&mut reader),
        Some(_) => Err(Problem::NotAMission),
    };
    // Cut at the limit, a file seems broken or short; what it is, is too large.
    match result {
        result if reader.get_ref().limit() > 0 => result,
        Err(Problem::TooManyItems { count, .. }) => {
            let exact = false;
            Err(Problem::TooManyItems { count, exact })
        }
        _ => Err(Problem::TooLarge { limit }),
    }
}

/// Skips a byte order mark and blank lines before the text.
fn skip_blanks(reader: &mut impl BufRead) -> Result<(), Problem> {
    const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
    if reader.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
        reader.consume(BYTE_ORDER_MARK.len());
    }
    loop {
        let buffer = reader.fill_buf()?;
        let blanks = buffer.iter().take_while(|b| b.is_ascii_whitespace());
        match blanks.count() {
            0 => return Ok(()),
            count => reader.consume(count),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_beyond_the_limit_is_too_large_not_broken() {
        let plan = br#"{"fileType": "Plan", "version": 1, "mission": {"#;
        let error = read_from(plan.as_slice(), 20).unwrap_err();
        assert!(matches!(error, Problem::TooLarge { limit: 20 }));
        let error = read_from(plan.as_slice(), 2000).unwrap_err();
        assert!(matches!(error, Problem::Json { .. }), "{error}");
    }

    #[test]
    fn an_endless_file_is_given_up() {
        let blanks = std::io::repeat(b' ');
        assert!(matches!(
            read_from(blanks, 100_000),
            Err(Problem::TooLarge { .. })
        ));
        let nested = std::io::repeat(b'{');
        assert!(read_from(nested, 100_000).is_err());
        let zeros = std::io::repeat(0);
        assert!(matches!(read_from(zeros, 100_000), Err(Problem::NotAMission)));
        let letters = std::io::repeat(b'Q');
        assert!(matches!(read_from(letters, 100_000), Err(Problem::NotAMission)));
    }
}
