//! System configuration (RM0090 9.2): which port each external interrupt line listens to.

use super::refusal::{Answer, Refusal, misuse};

const MEMRMP: u32 = 0x00;
const PMC: u32 = 0x04;
const EXTICR1: u32 = 0x08;
const EXTICR4: u32 = 0x14;
const CMPCR: u32 = 0x20;

#[derive(Default)]
pub(super) struct Syscfg {
    mode: u32,
    lines: [u32; 4],
}

impl Syscfg {
    pub(super) fn new() -> Self {
        Self::default()
    }

    /// The port, 0 for A, whose pin `line` feeds external interrupt line `line`.
    pub(super) fn port(&self, line: usize) -> usize {
        (self.lines[line / 4] >> (4 * (line % 4)) & 0xF) as usize
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            MEMRMP | CMPCR => Ok(0),
            PMC => Ok(self.mode),
            EXTICR1..=EXTICR4 => Ok(self.lines[((offset - EXTICR1) / 4) as usize]),
            _ => Err(Refusal::Unknown),
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> Answer<()> {
        match offset {
            MEMRMP if value & 3 != 0 => return misuse("memory remapping is not modelled"),
            CMPCR if value & 1 != 0 => return misuse("the I/O compensation cell is not modelled"),
            MEMRMP | CMPCR => {}
            PMC => self.mode = value,
            EXTICR1..=EXTICR4 => {
                let register = value & 0xFFFF;
                if (0..4).any(|line| (register >> (4 * line)) & 0xF > 8) {
                    return misuse("EXTICR names a port that does not exist");
                }
                self.lines[((offset - EXTICR1) / 4) as usize] = register;
            }
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }
}
