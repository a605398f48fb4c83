//! Three sectors of NOR flash as an STM32F405 has them: words of 32 bits whose bits are cleared by
//! programming and set by erasing 16 KiB at once. Power can fail in the middle of either.
//!
//! A word may be programmed again as long as its bits are only cleared (RM0090 3.6.2); setting one
//! is a mistake of the program.

use std::ops::Range;

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use super::Random;

pub const SECTOR: usize = 16 * 1024;
pub const SECTORS: usize = 3;

/// What is done to the flash, one after the other; each takes its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    Program { at: usize, word: [u8; 4] },
    Erase { sector: usize },
}

#[derive(Clone)]
pub struct Nor {
    pub bytes: Vec<u8>,
    /// What was done so far, once it is asked for.
    pub record: Option<Vec<Operation>>,
    /// So many operations more, then the power fails within the next one.
    pub power: Option<usize>,
    /// What is left by an operation in which the power fails.
    pub random: Random,
    /// Nothing is changed any more: the power is off.
    pub is_off: bool,
    /// Of all attempts, counted from the first, these are refused: as while armed.
    pub refused: Range<usize>,
    pub attempts: usize,
    /// Bytes that were read.
    pub read: usize,
    /// Whether setting a bit by programming is a mistake: not so where bits were flipped.
    pub strict: bool,
}

#[derive(Debug, PartialEq, Eq)]
pub struct Refused;

impl NorFlashError for Refused {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Nor {
    pub fn blank() -> Self {
        Self {
            bytes: vec![0xff; SECTORS * SECTOR],
            record: None,
            power: None,
            random: Random(1),
            is_off: false,
            refused: 0..0,
            attempts: 0,
            read: 0,
            strict: true,
        }
    }

    fn operate(&mut self, operation: Operation) -> Result<(), Refused> {
        self.attempts += 1;
        if self.is_off || self.refused.contains(&(self.attempts - 1)) {
            return Err(Refused);
        }
        if self.power == Some(0) {
            self.tear(operation);
            self.is_off = true;
            return Err(Refused);
        }
        self.power = self.power.map(|power| power - 1);
        if let Some(record) = &mut self.record {
            record.push(operation);
        }
        self.apply(operation);
        Ok(())
    }

    /// Does an operation whole.
    pub fn apply(&mut self, operation: Operation) {
        match operation {
            Operation::Program { at, word } => {
                for (place, byte) in self.bytes[at..at + 4].iter_mut().zip(word) {
                    assert!(!self.strict || *place & byte == byte, "a bit is set at {at:#x}");
                    *place &= byte;
                }
            }
            Operation::Erase { sector } => self.bytes[sector * SECTOR..][..SECTOR].fill(0xff),
        }
    }

    /// The power fails within an operation. Of a word some bits are programmed. A sector is first
    /// programmed to zeros and then erased, its cells at different speeds: from nothing to almost
    /// everything may be done.
    pub fn tear(&mut self, operation: Operation) {
        let random = &mut self.random;
        match operation {
            Operation::Program { at, word } => {
                for (place, byte) in self.bytes[at..at + 4].iter_mut().zip(word) {
                    *place &= byte | random.next() as u8;
                }
            }
            Operation::Erase { sector } => {
                let sector = &mut self.bytes[sector * SECTOR..][..SECTOR];
                let (manner, share) = (random.below(6), random.next());
                let border = random.below(SECTOR);
                for (place, byte) in sector.iter_mut().enumerate() {
                    let done = place < border;
                    *byte = match manner {
                        0 => *byte & random.next() as u8,
                        1 if done => 0xff,
                        2 if done => 0,
                        1 | 2 => *byte,
                        3 => random.next() as u8,
                        4 => *byte | (random.next() & share) as u8,
                        _ if place % 1024 == border % 1024 => !1,
                        _ => 0xff,
                    };
                }
            }
        }
    }

    pub fn flip(&mut self, bit: usize) {
        self.bytes[bit / 8] ^= 1 << (bit % 8);
    }
}

impl ErrorType for &mut Nor {
    type Error = Refused;
}

impl ReadNorFlash for &mut Nor {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Refused> {
        let offset = offset as usize;
        self.read += bytes.len();
        bytes.copy_from_slice(&self.bytes[offset..offset + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for &mut Nor {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Refused> {
        let (from, to) = (from as usize, to as usize);
        assert!(from.is_multiple_of(SECTOR) && to.is_multiple_of(SECTOR) && from < to);
        for sector in from / SECTOR..to / SECTOR {
            self.operate(Operation::Erase { sector })?;
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Refused> {
        let offset = offset as usize;
        assert!(offset.is_multiple_of(4) && bytes.len().is_multiple_of(4));
        for (n, word) in bytes.chunks(4).enumerate() {
            let word = word.try_into().expect("a word");
            self.operate(Operation::Program {
                at: offset + 4 * n,
                word,
            })?;
        }
        Ok(())
    }
}
