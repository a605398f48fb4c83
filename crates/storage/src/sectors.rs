//! Sectors whose erasure is whole, or is done again.
//!
//! When power fails while a sector is erased, any bits may be left in it: the old ones, cleared
//! ones, set ones, a mixture. It may look like a sector in use, and `sequential-storage`, which
//! lies above, would then take its remains for data and erase the copy of them. So the first word
//! of each sector is a mark. It is written after an erasure and cleared before one; a sector
//! without it holds nothing, whatever its bits are. Above this layer such a sector reads as
//! blank, and its erasure waits until something is written into it.
//!
//! When power fails while a record's header is written, its length may be any, and once in 65,536
//! times the sum over the length fits it. `sequential-storage` would want to read such a record and
//! have no room for it, now and ever after. Here it is shown as one that was erased. Headers are
//! told from all else by their length: no record of ours has it.
//!
//! Clearing the mark programs a word twice. The STM32F405 allows that as long as bits are only
//! cleared (RM0090 3.6.2).

use core::ops::Range;

use embassy_futures::yield_now;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use crate::StoreError;
use crate::record::{KEY, VALUE};

/// How many sectors there are: one is always free for what is moved.
pub const SECTORS: usize = 3;

/// Says that a sector was erased to its end. Half of its bits are set.
const MARK: u32 = 0xA5C3_96E1;

/// So many bits of a mark may be wrong: flash ages. What an erasure leaves is as near to it once
/// in eight million times.
const MARK_TOLERANCE: u32 = 2;

const MARK_SIZE: u32 = 4;

/// Bytes of a few records: power failed while the first one was written, and again.
const FEW: u32 = 1024;

/// After so many bytes read others have a turn: to move a sector reads it many times over.
const TURN: u32 = 2048;

/// What the sectors held when they were opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// Nothing: a new part, or one that was erased.
    Blank,
    /// A journal.
    Journal,
    /// Something that nobody here wrote.
    Foreign,
}

/// See the [module](self).
pub struct Sectors<F> {
    flash: F,
    start: u32,
    marked: [bool; SECTORS],
    /// Never used: at most the first mark was begun.
    untouched: [bool; SECTORS],
    /// No sector was ever used: they need no erasure. A sector of a journal that looks blank may have
    /// been erased for too short a time.
    new: bool,
    /// Nothing may be changed.
    read_only: bool,
    until_turn: u32,
}

impl<F: NorFlash> Sectors<F> {
    const SIZE: u32 = F::ERASE_SIZE as u32;

    /// What is left of a sector above this layer, bytes.
    pub const ROOM: u32 = Self::SIZE - MARK_SIZE;

    /// Looks at the sectors in a range of the flash; nothing is written.
    ///
    /// # Errors
    /// [`StoreError::Range`] if the range is not [`SECTORS`] whole ones, or the flash writes units
    /// longer than a word; [`StoreError::Flash`] if it cannot be read.
    pub async fn open(flash: F, range: Range<u32>) -> Result<(Self, Found), StoreError> {
        let whole = range.start.is_multiple_of(Self::SIZE)
            && range.end.checked_sub(range.start) == Some(Self::SIZE * SECTORS as u32)
            && MARK_SIZE.is_multiple_of(F::WRITE_SIZE as u32)
            && MARK_SIZE.is_multiple_of(F::READ_SIZE as u32);
        if !whole {
            return Err(StoreError::Range);
        }
        let mut sectors = Self {
            flash,
            start: range.start,
            marked: [false; SECTORS],
            untouched: [false; SECTORS],
            new: false,
            read_only: false,
            until_turn: TURN,
        };
        match sectors.look().await {
            Ok(found) => Ok((sectors, found)),
            Err(_) => Err(StoreError::Flash),
        }
    }

    async fn look(&mut self) -> Result<Found, F::Error> {
        for sector in 0..SECTORS {
            let start = self.start + sector as u32 * Self::SIZE;
            let mut mark = [0; MARK_SIZE as usize];
            self.flash.read(start, &mut mark).await?;
            let mark = u32::from_le_bytes(mark);
            let is_marked = (mark ^ MARK).count_ones() <= MARK_TOLERANCE;
            let may_become_marked = mark & MARK == MARK;
            let is_blank = self.is_blank(start + MARK_SIZE..start + Self::SIZE).await?;
            set(&mut self.marked, sector, is_marked);
            set(&mut self.untouched, sector, is_blank && may_become_marked);
        }
        self.new = self.untouched == [true; SECTORS];
        Ok(match self.marked.contains(&true) {
            true if !self.new => Found::Journal,
            _ if self.new => Found::Blank,
            _ => Found::Foreign,
        })
    }

    async fn is_blank(&mut self, range: Range<u32>) -> Result<bool, F::Error> {
        let mut buffer = [0; 64];
        let mut at = range.start;
        while at < range.end {
            let length = (range.end - at).min(buffer.len() as u32);
            let part = buffer.get_mut(..length as usize).unwrap_or_default();
            self.flash.read(at, part).await?;
            if part.iter().any(|byte| *byte != 0xff) {
                return Ok(false);
            }
            at += length;
        }
        Ok(true)
    }

    /// Whether there is more than a few first records that were interrupted: other sectors were used,
    /// or were to be cleared.
    pub async fn holds_something(&mut self) -> bool {
        for sector in 0..SECTORS {
            let start = self.start + sector as u32 * Self::SIZE;
            let rest = start + Self::SIZE.min(FEW)..start + Self::SIZE;
            let something = match self.is_marked(sector) {
                true => !matches!(self.is_blank(rest).await, Ok(true)),
                false => self.untouched.get(sector) != Some(&true),
            };
            if something {
                return true;
            }
        }
        false
    }

    /// From now on changes are refused, or taken again.
    pub fn set_read_only(&mut self, read_only: bool) {
        self.read_only = read_only;
    }

    /// The sector and the place in the flash of a stretch that lies in one sector.
    fn place(offset: u32, length: usize) -> Result<(usize, u32), NorFlashErrorKind> {
        let (sector, within) = (offset / Self::ROOM, offset % Self::ROOM);
        if sector as usize >= SECTORS || within as usize + length > Self::ROOM as usize {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        Ok((sector as usize, sector * Self::SIZE + MARK_SIZE + within))
    }

    fn is_marked(&self, sector: usize) -> bool {
        self.marked.get(sector) == Some(&true)
    }

    /// Makes a sector ready to be written into.
    async fn prepare(&mut self, sector: usize) -> Result<(), F::Error> {
        if self.is_marked(sector) {
            return Ok(());
        }
        let start = self.start + sector as u32 * Self::SIZE;
        if !(self.new && self.untouched.get(sector) == Some(&true)) {
            // The mark may still stand there: to take it off was refused, or it went wrong.
            self.flash.write(start, &[0; MARK_SIZE as usize]).await?;
            self.flash.erase(start, start + Self::SIZE).await?;
        }
        self.flash.write(start, &MARK.to_le_bytes()).await?;
        set(&mut self.untouched, sector, false);
        set(&mut self.marked, sector, true);
        Ok(())
    }

    /// Whether that is what was written: a cell may have lost its bit before.
    async fn verify(&mut self, place: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let mut buffer = [0; 64];
        for (part, at) in bytes.chunks(buffer.len()).zip((place..).step_by(buffer.len())) {
            let read = buffer.get_mut(..part.len()).unwrap_or_default();
            self.flash.read(at, read).await.map_err(kind)?;
            if read != part {
                return Err(NorFlashErrorKind::Other);
            }
        }
        Ok(())
    }
}

/// Shows the header of a record that nobody wrote, as it is longer than any, as erased: with a sum
/// of zero over its data. A header is that sum, 4 bytes, the length, 2 bytes, and a sum over that.
fn hide_long_record(bytes: &mut [u8]) {
    if let [sum @ .., low, high, _, _] = bytes
        && sum.len() == 4
    {
        let length = u16::from_le_bytes([*low, *high]);
        if usize::from(length) > KEY + VALUE && length != u16::MAX {
            sum.fill(0);
        }
    }
}

/// Notes something of a sector.
fn set(flags: &mut [bool; SECTORS], sector: usize, value: bool) {
    if let Some(flag) = flags.get_mut(sector) {
        *flag = value;
    }
}

/// The kind of a flash's error.
fn kind<E: NorFlashError>(error: E) -> NorFlashErrorKind {
    error.kind()
}

impl<F> ErrorType for Sectors<F> {
    type Error = NorFlashErrorKind;
}

impl<F: NorFlash> ReadNorFlash for Sectors<F> {
    const READ_SIZE: usize = F::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let (sector, place) = Self::place(offset, bytes.len())?;
        if !self.is_marked(sector) {
            bytes.fill(0xff);
            return Ok(());
        }
        self.until_turn = self.until_turn.saturating_sub(bytes.len() as u32);
        if self.until_turn == 0 {
            self.until_turn = TURN;
            yield_now().await;
        }
        self.flash.read(self.start + place, bytes).await.map_err(kind)?;
        hide_long_record(bytes);
        Ok(())
    }

    fn capacity(&self) -> usize {
        Self::ROOM as usize * SECTORS
    }
}

impl<F: NorFlash> NorFlash for Sectors<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = Self::ROOM as usize;

    /// Takes the marks off; see the [module](self).
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        if self.read_only {
            return Err(NorFlashErrorKind::Other);
        }
        for sector in from / Self::ROOM..to / Self::ROOM {
            set(&mut self.marked, sector as usize, false);
            set(&mut self.untouched, sector as usize, false);
            let start = self.start + sector * Self::SIZE;
            self.flash
                .write(start, &[0; MARK_SIZE as usize])
                .await
                .map_err(kind)?;
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        if self.read_only {
            return Err(NorFlashErrorKind::Other);
        }
        let (sector, place) = Self::place(offset, bytes.len())?;
        self.prepare(sector).await.map_err(kind)?;
        self.flash.write(self.start + place, bytes).await.map_err(kind)?;
        self.verify(self.start + place, bytes).await
    }
}
