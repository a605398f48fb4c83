//! What the board's flash keeps, in a file: parameters, calibrations and plans outlast the program.

use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::flight::Vehicle405;

/// The sectors in which the firmware stores: 1 to 3, 16 KiB each.
pub const SECTORS: Range<u32> = 0x0800_4000..0x0801_0000;

/// Their bytes.
const LENGTH: usize = (SECTORS.end - SECTORS.start) as usize;

/// A file for the sectors of a board.
#[derive(Clone, Debug)]
pub struct Memory {
    path: PathBuf,
    /// The flash's operations until the file was written last.
    operations: u64,
}

impl Memory {
    /// Puts what a file holds into a board's flash, before its program runs. A file that is not there
    /// is a board that nothing was stored on. The error is one line.
    pub fn load(path: &Path, machine: &mut Vehicle405) -> Result<Self, String> {
        if let Some(bytes) = read(path)? {
            machine.write_memory(SECTORS.start, &bytes);
        }
        Ok(Self {
            path: path.into(),
            operations: machine.bus().flash_operations(),
        })
    }

    /// Writes the file if the flash was written to since. The error is one line.
    pub fn store(&mut self, machine: &Vehicle405) -> Result<(), String> {
        let operations = machine.bus().flash_operations();
        if operations == self.operations {
            return Ok(());
        }
        let mut bytes = vec![0; LENGTH];
        machine.read_memory(SECTORS.start, &mut bytes);
        write(&self.path, &bytes)?;
        self.operations = operations;
        Ok(())
    }
}

fn read(path: &Path) -> Result<Option<Vec<u8>>, String> {
    match std::fs::read(path) {
        Ok(bytes) if bytes.len() == LENGTH => Ok(Some(bytes)),
        Ok(bytes) => Err(format!(
            "{}: {} bytes; a file for the flash has {LENGTH}",
            path.display(),
            bytes.len()
        )),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(format!("{}: {error}", path.display())),
    }
}

/// The old content or the new one, whenever the program is ended.
fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    std::fs::write(&beside, bytes)
        .and_then(|()| std::fs::rename(&beside, path))
        .map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("windhover-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = folder("memory");
        let path = folder.join("board.flash");
        assert_eq!(read(&path), Ok(None), "nothing was stored");
        for byte in [1, 2] {
            let bytes = vec![byte; LENGTH];
            write(&path, &bytes).unwrap();
            assert_eq!(read(&path), Ok(Some(bytes)));
        }
        assert_eq!(
            std::fs::read_dir(&folder).unwrap().count(),
            1,
            "nothing is left beside"
        );
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_file_of_another_length_is_refused_by_its_name() {
        let folder = folder("memory-length");
        let path = folder.join("short.flash");
        std::fs::write(&path, [0xFF; 100]).unwrap();
        let refusal = read(&path).unwrap_err();
        assert!(
            refusal.contains("short.flash: 100 bytes; a file for the flash has 49152"),
            "{refusal}"
        );
        assert!(
            read(&folder).unwrap_err().contains("windhover-memory-length"),
            "a folder is no file"
        );
        std::fs::remove_dir_all(folder).unwrap();
    }
}
