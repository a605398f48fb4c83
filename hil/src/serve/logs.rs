//! The flight logs that come from the board, in files as they come: each start of the firmware begins
//! another one.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use windhover_flight_log::wire::MAGIC;

/// Logs of earlier starts that are kept, at most; of further ones only the last.
const KEPT: usize = 20;

/// Splits a stream of bytes where a log starts in it.
#[derive(Clone, Debug, Default)]
struct Starts {
    /// The end of what came: perhaps the beginning of a start.
    held: Vec<u8>,
}

impl Starts {
    /// Gives what is known to belong to the log so far, and `None` before each start.
    fn split(&mut self, bytes: &[u8], sink: &mut dyn FnMut(Option<&[u8]>)) {
        self.held.extend_from_slice(bytes);
        let mut rest = &self.held[..];
        while let Some(start) = find(rest) {
            sink(Some(&rest[..start]));
            sink(None);
            sink(Some(&MAGIC));
            rest = &rest[start + MAGIC.len()..];
        }
        let begun = (0..MAGIC.len())
            .rev()
            .find(|count| rest.ends_with(&MAGIC[..*count]));
        let sure = rest.len() - begun.unwrap_or(0);
        sink(Some(&rest[..sure]));
        self.held = rest[sure..].to_vec();
    }

    /// Gives what was held back, for nothing comes any more.
    fn end(&mut self, sink: &mut dyn FnMut(Option<&[u8]>)) {
        sink(Some(&std::mem::take(&mut self.held)));
    }
}

fn find(bytes: &[u8]) -> Option<usize> {
    bytes.windows(MAGIC.len()).position(|window| window == MAGIC)
}

/// The files.
pub struct Logs {
    path: PathBuf,
    starts: Starts,
    file: Option<File>,
    earlier: Vec<PathBuf>,
    /// Logs of earlier starts that were not kept.
    pub dropped: u64,
}

impl Logs {
    /// The log of the last start goes to `path`, those of the starts before beside it: of `hil.ulg`
    /// they are `hil.1.ulg` and so on. The error is one line.
    pub fn create(path: &Path) -> Result<Self, String> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        }
        // Not that of another flight, should none come.
        File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self {
            path: path.into(),
            starts: Starts::default(),
            file: None,
            earlier: Vec::new(),
            dropped: 0,
        })
    }

    /// Bytes came from the board. The error is one line.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.with_starts(|starts, sink| starts.split(bytes, sink))
    }

    /// No more comes: the logs of earlier starts. The error is one line.
    pub fn finish(mut self) -> Result<Vec<PathBuf>, String> {
        self.with_starts(Starts::end)?;
        Ok(self.earlier)
    }

    fn with_starts(
        &mut self,
        split: impl FnOnce(&mut Starts, &mut dyn FnMut(Option<&[u8]>)),
    ) -> Result<(), String> {
        let mut starts = std::mem::take(&mut self.starts);
        let mut done = Ok(());
        split(&mut starts, &mut |piece| {
            if done.is_ok() {
                done = self.take(piece);
            }
        });
        self.starts = starts;
        done.map_err(|e| format!("{}: {e}", self.path.display()))
    }

    fn take(&mut self, piece: Option<&[u8]>) -> std::io::Result<()> {
        match (piece, &mut self.file) {
            (Some(bytes), Some(file)) => file.write_all(bytes),
            // Before the first start there is nothing to be read.
            (Some(_), None) => Ok(()),
            (None, file) => {
                let started = file.take().is_some();
                if started && self.earlier.len() < KEPT {
                    let name = format!("{}.ulg", self.earlier.len() + 1);
                    let to = self.path.with_extension(name);
                    std::fs::rename(&self.path, &to)?;
                    self.earlier.push(to);
                } else if started {
                    self.dropped += 1;
                }
                self.file = Some(File::create(&self.path)?);
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The logs of a stream that comes in pieces of a length.
    fn logs(stream: &[u8], length: usize) -> Vec<Vec<u8>> {
        let mut logs = vec![Vec::new()];
        let mut sink = |piece: Option<&[u8]>| match piece {
            Some(bytes) => logs.last_mut().unwrap().extend_from_slice(bytes),
            None => logs.push(Vec::new()),
        };
        let mut starts = Starts::default();
        for piece in stream.chunks(length) {
            starts.split(piece, &mut sink);
            assert!(starts.held.len() < MAGIC.len());
        }
        starts.end(&mut sink);
        logs
    }

    #[test]
    fn a_stream_is_split_at_each_start_however_it_comes() {
        let one = [&MAGIC[..], b"one", &MAGIC[..4]].concat();
        let two = [&MAGIC[..], &MAGIC[1..], b"two"].concat();
        let three = [&MAGIC[..], &MAGIC[..6]].concat();
        let stream = [&b"??"[..], &one, &two, &three].concat();
        let expected = vec![b"??".to_vec(), one, two, three];
        for length in 1..stream.len() + 1 {
            assert_eq!(logs(&stream, length), expected, "by {length}");
        }
    }

    #[test]
    fn the_last_start_has_the_name_and_the_first_ones_are_kept() {
        let folder = std::env::temp_dir().join(format!("windhover-logs-{}", std::process::id()));
        let path = folder.join("hil.ulg");
        let mut files = Logs::create(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"", "there is none yet");
        let log = |n: u8| [&MAGIC[..], &[n]].concat();
        for n in 0..KEPT as u8 + 3 {
            files.write(&log(n)).unwrap();
        }
        assert_eq!(files.dropped, 2);
        let earlier = files.finish().unwrap();
        assert_eq!(earlier.len(), KEPT);
        assert_eq!(earlier[1], folder.join("hil.2.ulg"));
        assert_eq!(std::fs::read(&earlier[1]).unwrap(), log(1));
        assert_eq!(std::fs::read(&path).unwrap(), log(KEPT as u8 + 2));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
