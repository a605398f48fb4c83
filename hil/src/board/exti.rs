//! The external interrupt controller (RM0090 12.3).

use super::refusal::{Answer, Refusal};

const IMR: u32 = 0x00;
const EMR: u32 = 0x04;
const RTSR: u32 = 0x08;
const FTSR: u32 = 0x0C;
const SWIER: u32 = 0x10;
const PR: u32 = 0x14;

/// Lines 0 to 22.
const LINES: u32 = 0x007F_FFFF;

/// Which lines raise which interrupt (RM0090 table 62).
const INTERRUPTS: [(u32, u32); 13] = [
    (1 << 0, 6),
    (1 << 1, 7),
    (1 << 2, 8),
    (1 << 3, 9),
    (1 << 4, 10),
    (0x1F << 5, 23),
    (0x3F << 10, 40),
    (1 << 16, 1),
    (1 << 17, 41),
    (1 << 18, 42),
    (1 << 20, 76),
    (1 << 21, 2),
    (1 << 22, 3),
];

#[derive(Default)]
pub(super) struct Exti {
    interrupt_mask: u32,
    event_mask: u32,
    rising: u32,
    falling: u32,
    software: u32,
    pending: u32,
    /// The inputs of lines 0 to 15.
    levels: u32,
}

impl Exti {
    pub(super) fn new() -> Self {
        Self::default()
    }

    /// A line's input is at `level`. An edge is detected also where the line is masked. Returns
    /// whether there is one.
    pub(super) fn set_level(&mut self, line: usize, level: bool) -> bool {
        let bit = 1 << line;
        if (self.levels & bit != 0) == level {
            return false;
        }
        self.levels ^= bit;
        let selected = if level { self.rising } else { self.falling };
        self.pending |= selected & bit;
        true
    }

    /// Its request lines, a bit for each interrupt.
    pub(super) fn interrupts(&self) -> u128 {
        let requested = self.pending & self.interrupt_mask;
        if requested == 0 {
            return 0;
        }
        INTERRUPTS
            .iter()
            .filter(|(lines, _)| requested & lines != 0)
            .fold(0, |all, (_, interrupt)| all | 1 << interrupt)
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            IMR => self.interrupt_mask,
            EMR => self.event_mask,
            RTSR => self.rising,
            FTSR => self.falling,
            SWIER => self.software,
            PR => self.pending,
            _ => return Err(Refusal::Unknown),
        })
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> Answer<()> {
        let value = value & LINES;
        match offset {
            IMR => self.interrupt_mask = value,
            EMR => self.event_mask = value,
            RTSR => self.rising = value,
            FTSR => self.falling = value,
            SWIER => {
                self.pending |= value & !self.software & self.interrupt_mask;
                self.software |= value;
            }
            PR => {
                self.pending &= !value;
                self.software &= !value;
            }
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }
}
