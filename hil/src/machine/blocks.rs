//! What is known of each block of instructions: its cost, and whether something wants to see it.

use super::cost;
use super::engine::{FLASH, FLASH_SIZE};
use std::cell::Cell;

/// A probe waits for calls of this function.
pub(super) const MARK_ENTRY: u16 = 1;
/// A probed function will return to here.
pub(super) const MARK_RETURN: u16 = 2;
/// An injection acts here.
pub(super) const MARK_INJECTION: u16 = 4;

/// A block that begins at some address. Nothing is known while `size` is 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    size: u16,
    pub instructions: u16,
    pub cycles: u16,
    pub marks: u16,
}

/// One entry for each halfword of flash, which alone can be executed.
#[derive(Debug)]
pub(super) struct Blocks(Vec<Cell<Block>>);

impl Blocks {
    pub fn new() -> Self {
        Self(vec![Cell::default(); FLASH_SIZE as usize / 2])
    }

    fn index(address: u32) -> usize {
        ((address & (FLASH_SIZE - 1)) / 2) as usize
    }

    /// The block with this address and size; `read` fetches its bytes when it is new.
    pub fn get(&self, address: u32, size: u32, read: impl FnOnce(u32, &mut [u8])) -> Block {
        let cell = &self.0[Self::index(address)];
        let mut block = cell.get();
        if u32::from(block.size) != size {
            let mut code = vec![0; size as usize];
            read(FLASH | address, &mut code);
            (block.instructions, block.cycles) = measure(&code);
            block.size = size as u16;
            cell.set(block);
        }
        block
    }

    /// Marks the block that begins at an address.
    pub fn mark(&self, address: u32, mark: u16) {
        let cell = &self.0[Self::index(address)];
        cell.set(Block {
            marks: cell.get().marks | mark,
            ..cell.get()
        });
    }

    /// Removes a mark.
    pub fn unmark(&self, address: u32, mark: u16) {
        let cell = &self.0[Self::index(address)];
        cell.set(Block {
            marks: cell.get().marks & !mark,
            ..cell.get()
        });
    }

    /// Whether a block has one of these marks.
    pub fn marked(&self, address: u32, marks: u16) -> bool {
        self.0[Self::index(address)].get().marks & marks != 0
    }

    /// Flash was erased or programmed: costs of what may lie there are to be found anew.
    pub fn forget(&self, address: u32, size: u32) {
        let first = Self::index(address).saturating_sub(LONGEST / 2);
        let last = (Self::index(address) + size as usize / 2).min(self.0.len() - 1);
        for cell in &self.0[first..=last] {
            cell.set(Block {
                marks: cell.get().marks,
                ..Block::default()
            });
        }
    }
}

/// Bytes of the longest block: one does not reach beyond the engine's page and two more bytes.
const LONGEST: usize = 1024 + 2;

fn measure(code: &[u8]) -> (u16, u16) {
    let halfword = |at: usize| {
        code.get(at..at + 2)
            .map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]))
    };
    let (mut at, mut instructions, mut cycles) = (0, 0, 0);
    while at < code.len() {
        let (first, second) = (halfword(at), halfword(at + 2));
        instructions += 1;
        cycles += cost::cycles(first, second) as u16;
        at += if cost::is_wide(first) { 4 } else { 2 };
    }
    (instructions, cycles)
}
