//! What identifies the part: the debug unit's registers (RM0090 38.6, 38.16) and the electronic
//! signature (RM0090 chapter 39).

use super::refusal::{Answer, Refusal, misuse};

const IDCODE: u32 = 0x00;
const CR: u32 = 0x04;
const APB1_FZ: u32 = 0x08;
const APB2_FZ: u32 = 0x0C;

/// STM32F405, revision Y.
const DEVICE: u32 = 0x1007_6413;

/// The debug unit's registers. Nothing is ever frozen: there is no debugger.
#[derive(Default)]
pub(super) struct Debug {
    registers: [u32; 3],
}

impl Debug {
    pub(super) fn new() -> Self {
        Self::default()
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            IDCODE => Ok(DEVICE),
            CR | APB1_FZ | APB2_FZ => Ok(self.registers[(offset / 4) as usize - 1]),
            _ => Err(Refusal::Unknown),
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> Answer<()> {
        match offset {
            IDCODE => misuse("IDCODE can only be read"),
            CR | APB1_FZ | APB2_FZ => {
                self.registers[(offset / 4) as usize - 1] = value;
                Ok(())
            }
            _ => Err(Refusal::Unknown),
        }
    }
}

/// The unique identifier, as offsets into its block and words: any will do, this one spells itself.
const UNIQUE_ID: [(u32, u32); 3] = [
    (0x210, u32::from_le_bytes(*b"wind")),
    (0x214, u32::from_le_bytes(*b"hove")),
    (0x218, u32::from_le_bytes(*b"r405")),
];
/// The flash size in KiB is the upper half of this word.
const FLASH_SIZE: u32 = 0x220;
const FLASH_KIBIBYTES: u32 = 1024;

/// The electronic signature.
pub(super) fn read_signature(offset: u32) -> Answer<u32> {
    if offset == FLASH_SIZE {
        return Ok(FLASH_KIBIBYTES << 16 | 0xFFFF);
    }
    UNIQUE_ID
        .iter()
        .find(|(place, _)| *place == offset)
        .map(|(_, word)| *word)
        .ok_or(Refusal::Unknown)
}
