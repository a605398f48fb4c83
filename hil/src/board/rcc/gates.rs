//! The bits by which RCC resets peripherals and gates their clocks (RM0090 7.3.5 to 7.3.19).

use super::super::refusal::{Answer, Refusal};

/// Where the three kinds of registers begin, and the last one ends.
const RSTR: u32 = 0x10;
const ENR: u32 = 0x30;
const LPENR: u32 = 0x50;
const END: u32 = 0x70;

/// Reset values (RM0090 table 34), one for each bus: AHB1, AHB2, AHB3, APB1, APB2.
const ENR_RESET: [u32; 5] = [0x0010_0000, 0, 0, 0, 0];
const LPENR_RESET: [u32; 5] = [0x7E67_91FF, 0xF1, 0x1, 0x36FE_C9FF, 0x0007_5F33];

/// One register of each kind for each bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Gates {
    pub resets: [u32; 5],
    pub enables: [u32; 5],
    sleep_enables: [u32; 5],
}

impl Gates {
    pub(super) fn new() -> Self {
        Self {
            resets: [0; 5],
            enables: ENR_RESET,
            sleep_enables: LPENR_RESET,
        }
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match locate(offset)? {
            (RSTR, bus) => self.resets[bus],
            (ENR, bus) => self.enables[bus],
            (_, bus) => self.sleep_enables[bus],
        })
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> Answer<()> {
        match locate(offset)? {
            (RSTR, bus) => self.resets[bus] = value,
            (ENR, bus) => self.enables[bus] = value,
            (_, bus) => self.sleep_enables[bus] = value,
        }
        Ok(())
    }
}

/// The kind of register and the bus. The fourth place of each kind is empty.
fn locate(offset: u32) -> Answer<(u32, usize)> {
    let kind = match offset {
        RSTR..ENR => RSTR,
        ENR..LPENR => ENR,
        LPENR..END => LPENR,
        _ => return Err(Refusal::Unknown),
    };
    let bus = match offset - kind {
        0x00 => 0,
        0x04 => 1,
        0x08 => 2,
        0x10 => 3,
        0x14 => 4,
        _ => return Err(Refusal::Unknown),
    };
    Ok((kind, bus))
}
