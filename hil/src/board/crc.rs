//! The CRC calculation unit (RM0090 chapter 4).

use super::refusal::{Answer, Refusal};

const DR: u32 = 0x00;
const IDR: u32 = 0x04;
const CR: u32 = 0x08;

const POLYNOMIAL: u32 = 0x04C1_1DB7;
const RESET_VALUE: u32 = 0xFFFF_FFFF;

pub(super) struct Crc {
    remainder: u32,
    independent: u32,
}

impl Crc {
    pub(super) fn new() -> Self {
        Self {
            remainder: RESET_VALUE,
            independent: 0,
        }
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            DR => Ok(self.remainder),
            IDR => Ok(self.independent),
            CR => Ok(0),
            _ => Err(Refusal::Unknown),
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> Answer<()> {
        match offset {
            DR => self.remainder = divide(self.remainder ^ value),
            IDR => self.independent = value & 0xFF,
            CR if value & 1 != 0 => self.remainder = RESET_VALUE,
            CR => {}
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }
}

fn divide(mut remainder: u32) -> u32 {
    for _ in 0..32 {
        let carry = remainder & 1 << 31 != 0;
        remainder = remainder << 1 ^ if carry { POLYNOMIAL } else { 0 };
    }
    remainder
}
