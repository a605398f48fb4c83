//! One stream of a DMA controller (RM0090 10.3).

use super::super::Memory;
use super::super::refusal::{Answer, misuse};
use super::requests::Heard;
use std::ops::Range;

pub(super) const EN: u32 = 1 << 0;
const DMEIE: u32 = 1 << 1;
const TEIE: u32 = 1 << 2;
const HTIE: u32 = 1 << 3;
const TCIE: u32 = 1 << 4;
pub(super) const DIR_SHIFT: u32 = 6;
const CIRC: u32 = 1 << 8;
const PINC: u32 = 1 << 9;
const MINC: u32 = 1 << 10;
pub(super) const PSIZE_SHIFT: u32 = 11;
pub(super) const MSIZE_SHIFT: u32 = 13;
const PL_SHIFT: u32 = 16;
const DBM: u32 = 1 << 18;
const CT: u32 = 1 << 19;
const WRITABLE: u32 = 0x0FEF_FFFF;
/// What may change while the stream runs: the interrupts.
const CHANGEABLE: u32 = DMEIE | TEIE | HTIE | TCIE;

const FCR_FTH: u32 = 3;
const FCR_DMDIS: u32 = 1 << 2;
const FCR_EMPTY: u32 = 4 << 3;
pub(super) const FCR_RESET: u32 = FCR_EMPTY | 1;
const FCR_WRITABLE: u32 = 1 << 7 | FCR_DMDIS | FCR_FTH;

/// Flags, as they lie in the first place of LISR and HISR.
pub(super) const HTIF: u32 = 1 << 4;
pub(super) const TCIF: u32 = 1 << 5;
/// What the controllers reach of memory: SRAM, and flash to read. The core-coupled memory at
/// 0x1000_0000 is the processor's alone (RM0090 2.3.1).
const SRAM: Range<u32> = 0x2000_0000..0x2002_0000;
const FLASH: Range<u32> = 0x0800_0000..0x0810_0000;

const FIFO_BYTES: usize = 16;

#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    pub control: u32,
    /// NDTR: what is left, in items of the peripheral's size.
    pub left: u32,
    pub peripheral: u32,
    pub memories: [u32; 2],
    pub fifo_control: u32,
    pub flags: u32,
    /// What it listens to while it is enabled.
    pub heard: Heard,
    /// What was written to NDTR: what each round has.
    total: u32,
    memory_address: u32,
    peripheral_address: u32,
    fifo: [u8; FIFO_BYTES],
    pub filled: usize,
}

impl Stream {
    pub(super) fn new() -> Self {
        Self {
            control: 0,
            left: 0,
            peripheral: 0,
            memories: [0; 2],
            fifo_control: FCR_RESET,
            flags: 0,
            heard: [None; 3],
            total: 0,
            memory_address: 0,
            peripheral_address: 0,
            fifo: [0; FIFO_BYTES],
            filled: 0,
        }
    }

    pub(super) fn enabled(&self) -> bool {
        self.control & EN != 0
    }

    /// Items before the one that sets HTIF or TCIF.
    pub(super) fn silent_items(&self) -> u32 {
        let half = self.total / 2;
        let flagged = if self.left > half { half } else { 0 };
        self.left.saturating_sub(flagged + 1)
    }

    /// Whether its request line is high.
    pub(super) fn interrupt(&self) -> bool {
        [(TEIE, 1 << 3), (HTIE, HTIF), (TCIE, TCIF)]
            .iter()
            .any(|(enable, flag)| self.control & enable != 0 && self.flags & flag != 0)
    }

    /// Which of several streams goes first: PL.
    pub(super) fn priority(&self) -> u32 {
        self.control >> PL_SHIFT & 3
    }

    pub(super) fn transmits(&self) -> bool {
        self.control >> DIR_SHIFT & 3 == 1
    }

    pub(super) fn peripheral_size(&self) -> usize {
        1 << (self.control >> PSIZE_SHIFT & 3)
    }

    /// In direct mode the memory's size is the peripheral's (RM0090 10.3.12).
    pub(super) fn memory_size(&self) -> usize {
        if self.direct() {
            self.peripheral_size()
        } else {
            1 << (self.control >> MSIZE_SHIFT & 3)
        }
    }

    fn direct(&self) -> bool {
        self.fifo_control & FCR_DMDIS == 0
    }

    /// Bytes in the FIFO at which the memory's side acts.
    fn threshold(&self) -> usize {
        4 * (1 + (self.fifo_control & FCR_FTH) as usize)
    }

    pub(super) fn write_fifo_control(&mut self, value: u32) {
        self.fifo_control = value & FCR_WRITABLE;
    }

    pub(super) fn fifo_status(&self) -> u32 {
        let level = match self.filled {
            0 => 4,
            FIFO_BYTES => 5,
            filled => filled as u32 / 4,
        };
        self.fifo_control & FCR_WRITABLE | level << 3
    }

    pub(super) fn write_control(
        &mut self,
        controller: usize,
        index: usize,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Answer<()> {
        let value = value & WRITABLE;
        if !self.enabled() {
            self.control = value & !EN;
            if value & EN != 0 {
                self.enable(controller, index, memory)?;
            }
        } else if value & EN == 0 {
            self.stop(memory)?;
            self.control = value;
        } else if (value ^ self.control) & !CHANGEABLE != 0 {
            return misuse("CR is changed while the stream is enabled");
        } else {
            self.control = value;
        }
        Ok(())
    }

    /// NDTR is written.
    pub(super) fn write_count(&mut self, value: u32) {
        self.left = value & 0xFFFF;
        self.total = self.left;
    }

    /// A new round, of as many items as were written to NDTR: after an end, in circular mode, and
    /// also when the stream is enabled again without a new number (RM0090 10.3.8, 10.5.6).
    pub(super) fn begin(&mut self) {
        self.left = self.total;
        self.memory_address = self.memories[usize::from(self.control & CT != 0)];
        self.peripheral_address = self.peripheral;
    }

    /// The firmware disables it: what was received is stored, and TCIF says that it is over
    /// (RM0090 10.3.14).
    fn stop(&mut self, memory: &mut dyn Memory) -> Answer<()> {
        if !self.transmits() {
            self.drain(memory)?;
        }
        self.flags |= TCIF;
        Ok(())
    }

    /// The next data for the peripheral, and the register for them.
    pub(super) fn take(&mut self, memory: &mut dyn Memory) -> Answer<(u32, u32)> {
        let size = self.peripheral_size();
        let mut bytes = [0; 4];
        bytes[..size].copy_from_slice(&self.fifo[..size]);
        self.fifo.copy_within(size.., 0);
        self.filled -= size;
        let address = self.peripheral_address;
        self.count();
        self.refill(memory)?;
        Ok((address, u32::from_le_bytes(bytes)))
    }

    /// The register to read next.
    pub(super) fn source(&self) -> u32 {
        self.peripheral_address
    }

    /// Takes data from the peripheral.
    pub(super) fn put(&mut self, value: u32, memory: &mut dyn Memory) -> Answer<()> {
        let size = self.peripheral_size();
        self.fifo[self.filled..self.filled + size].copy_from_slice(&value.to_le_bytes()[..size]);
        self.filled += size;
        if self.direct() || self.filled >= self.threshold() || self.left == 1 {
            self.drain(memory)?;
        }
        self.count();
        Ok(())
    }

    /// One item is through.
    fn count(&mut self) {
        if self.control & PINC != 0 {
            self.peripheral_address += self.peripheral_size() as u32;
        }
        self.left -= 1;
        if self.left == self.total / 2 {
            self.flags |= HTIF;
        }
        if self.left > 0 {
            return;
        }
        self.flags |= TCIF;
        if self.control & DBM != 0 {
            self.control ^= CT;
        }
        if self.control & (CIRC | DBM) != 0 {
            self.begin();
        } else {
            self.control &= !EN;
        }
    }

    /// Fetches from memory ahead of the peripheral's requests.
    pub(super) fn refill(&mut self, memory: &mut dyn Memory) -> Answer<()> {
        if !self.transmits() || !self.enabled() {
            return Ok(());
        }
        let (size, room) = (
            self.memory_size(),
            if self.direct() {
                self.peripheral_size()
            } else {
                FIFO_BYTES
            },
        );
        let due = if self.direct() {
            self.filled == 0
        } else {
            self.filled <= self.threshold()
        };
        let wanted = self.left as usize * self.peripheral_size();
        while due && self.filled + size <= room && self.filled < wanted {
            self.check_address(size, true)?;
            memory.read(
                self.memory_address,
                &mut self.fifo[self.filled..self.filled + size],
            );
            self.filled += size;
            self.step(size);
        }
        Ok(())
    }

    /// Stores what the FIFO holds.
    fn drain(&mut self, memory: &mut dyn Memory) -> Answer<()> {
        let mut from = 0;
        while from < self.filled {
            let size = self.memory_size().min(self.filled - from);
            self.check_address(size, false)?;
            memory.write(self.memory_address, &self.fifo[from..from + size]);
            from += size;
            self.step(size);
        }
        self.filled = 0;
        Ok(())
    }

    fn step(&mut self, size: usize) {
        if self.control & MINC != 0 {
            self.memory_address += size as u32;
        }
    }

    fn check_address(&self, size: usize, to_read: bool) -> Answer<()> {
        let address = self.memory_address;
        let readable = to_read && FLASH.contains(&address);
        if !readable && !SRAM.contains(&address) {
            let what = if to_read { "read" } else { "write" };
            return misuse(format!("it cannot {what} memory at {address:#010x}"));
        }
        if !address.is_multiple_of(size as u32) {
            return misuse(format!("its memory address {address:#010x} is not aligned"));
        }
        Ok(())
    }
}
