//! The program's defmt log as text.

use crate::elf::Elf;
use crate::time::SECOND;
use defmt_decoder::{DecodeError, Locations, Table};
use std::fmt;

/// One line of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Virtual time at which it was fetched from the program's memory, in ticks.
    pub time: u64,
    /// The program's own time stamp, if it gives one.
    pub timestamp: Option<String>,
    /// `info`, `warn` and so on; empty for `println`.
    pub level: &'static str,
    /// The message.
    pub message: String,
    /// File and line of the source, if the program has debug information.
    pub place: Option<String>,
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.timestamp {
            Some(timestamp) => write!(f, "{timestamp}")?,
            None => write!(f, "{:.3}", self.time as f64 / SECOND as f64)?,
        }
        write!(f, " {:5} {}", self.level, self.message)?;
        match &self.place {
            Some(place) => write!(f, " ({place})"),
            None => Ok(()),
        }
    }
}

/// Decodes what [`crate::machine::Machine::take_log`] gives.
pub struct Log {
    table: Table,
    locations: Locations,
    /// Of a frame that has not ended yet.
    partial: Vec<u8>,
    /// Frames that could not be decoded: cut off by a reset, or by a buffer that was full.
    pub malformed: u64,
}

/// The program's table of messages cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("the program's defmt table: {0}")]
pub struct LogError(String);

impl Log {
    /// For a program; none if it does not use defmt.
    pub fn new(elf: &Elf) -> Result<Option<Self>, LogError> {
        let failed = |error| LogError(format!("{error:#}"));
        let Some(table) = Table::parse(&elf.file).map_err(failed)? else {
            return Ok(None);
        };
        let locations = table.get_locations(&elf.file).unwrap_or_default();
        Ok(Some(Self {
            table,
            locations,
            partial: Vec::new(),
            malformed: 0,
        }))
    }

    /// The lines that end in these bytes, which were fetched at this time.
    pub fn decode(&mut self, time: u64, bytes: &[u8]) -> Vec<Line> {
        let mut lines = Vec::new();
        for &byte in bytes {
            self.partial.push(byte);
            // A zero ends each frame of defmt's encoding, rzCOBS.
            if byte == 0 {
                let frame = std::mem::take(&mut self.partial);
                match self.decode_frame(time, &frame) {
                    Some(line) => lines.push(line),
                    None if frame.len() > 1 => self.malformed += 1,
                    None => {}
                }
            }
        }
        lines
    }

    fn decode_frame(&self, time: u64, frame: &[u8]) -> Option<Line> {
        let mut decoder = self.table.new_stream_decoder();
        decoder.received(frame);
        let frame = match decoder.decode() {
            Ok(frame) => frame,
            Err(DecodeError::UnexpectedEof | DecodeError::Malformed) => return None,
        };
        let place = self.locations.get(&frame.index());
        Some(Line {
            time,
            timestamp: frame.display_timestamp().map(|timestamp| timestamp.to_string()),
            level: frame.level().map_or("", |level| level.as_str()),
            message: frame.display_message().to_string(),
            place: place.map(|place| format!("{}:{}", place.file.display(), place.line)),
        })
    }
}
