//! Option bytes (RM0090 3.7): what is kept of them is the brown-out level and write protection.

use super::refusal::{Answer, misuse};

const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];

const OPTLOCK: u32 = 1 << 0;
const OPTSTRT: u32 = 1 << 1;
const BOR_LEV: u32 = 3 << 2;
const WDG_SW: u32 = 1 << 5;
const RDP: u32 = 0xFF << 8;
/// No read protection.
const RDP_LEVEL_0: u32 = 0xAA << 8;
const NWRP_SHIFT: u32 = 16;
const WRITABLE: u32 = 0x0FFF_FFEC;
/// As the part is delivered: brown-out off, nothing protected.
const DELIVERED: u32 = 0x0FFF_AAEC;

#[derive(Clone, Copy)]
pub(super) struct Options {
    register: u32,
    /// What was programmed, and will be there after the next reset.
    programmed: u32,
    keys: usize,
}

impl Options {
    pub(super) fn new() -> Self {
        Self {
            register: DELIVERED | OPTLOCK,
            programmed: DELIVERED,
            keys: 0,
        }
    }

    pub(super) fn after_reset(&self) -> Self {
        Self {
            register: self.programmed | OPTLOCK,
            programmed: self.programmed,
            keys: 0,
        }
    }

    /// As in `OPTCR.BOR_LEV`.
    pub(super) fn brown_out_level(&self) -> u32 {
        (self.programmed & BOR_LEV) >> 2
    }

    /// Refuses a sector whose write protection is on.
    pub(super) fn check_writable(&self, sector: usize) -> Answer<()> {
        if self.programmed & (1 << (NWRP_SHIFT + sector as u32)) == 0 {
            return misuse(format!("sector {sector} is write-protected (WRPERR)"));
        }
        Ok(())
    }

    pub(super) fn read(&self) -> u32 {
        self.register
    }

    pub(super) fn write_key(&mut self, value: u32) -> Answer<()> {
        if self.register & OPTLOCK == 0 || KEYS[self.keys] != value {
            return misuse(format!("{value:#010x} is not the key that OPTKEYR expects now"));
        }
        self.keys += 1;
        if self.keys == KEYS.len() {
            self.keys = 0;
            self.register &= !OPTLOCK;
        }
        Ok(())
    }

    /// Returns whether programming begins.
    pub(super) fn write(&mut self, value: u32) -> Answer<bool> {
        if self.register & OPTLOCK != 0 {
            return misuse("OPTCR is written while it is locked");
        }
        if self.register & OPTSTRT != 0 {
            return misuse("OPTCR is written while option bytes are programmed");
        }
        if value & RDP != RDP_LEVEL_0 {
            return misuse("OPTCR would read-protect the part");
        }
        if value & WDG_SW == 0 {
            return misuse("the watchdog started by hardware (WDG_SW = 0) is not modelled");
        }
        self.register = value & (WRITABLE | OPTLOCK | OPTSTRT);
        Ok(value & OPTSTRT != 0)
    }

    /// Programming is done.
    pub(super) fn finish(&mut self) {
        self.programmed = self.register & WRITABLE;
        self.register &= !OPTSTRT;
    }
}
