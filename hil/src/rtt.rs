//! SEGGER RTT from the probe's side: reads what the program wrote into its up-channel 0.

use crate::board::Memory;
use crate::elf::Elf;

const SYMBOL: &str = "_SEGGER_RTT";
const IDENTIFIER: &[u8] = b"SEGGER RTT";
/// No ring is larger than the memory: who says so has lost its control block.
const MOST: u32 = 0x2_0000;
/// In the control block: identifier, two counts, then the first up-channel.
const UP_CHANNEL: u32 = 24;
/// In a channel: name, buffer, size, write and read offset.
const BUFFER: u32 = UP_CHANNEL + 4;
const SIZE: u32 = UP_CHANNEL + 8;
const WRITE: u32 = UP_CHANNEL + 12;
const READ: u32 = UP_CHANNEL + 16;

/// The control block of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rtt {
    control: u32,
}

impl Rtt {
    /// Where the program has it, if it has one.
    pub fn find(elf: &Elf) -> Option<Self> {
        elf.find(SYMBOL).ok().map(|symbol| Self {
            control: symbol.address,
        })
    }

    /// Takes all bytes that wait; none before the program has initialised its memory.
    pub fn drain(self, memory: &mut dyn Memory) -> Vec<u8> {
        let mut identifier = [0; IDENTIFIER.len()];
        memory.read(self.control, &mut identifier);
        let [buffer, size, write, read] =
            [BUFFER, SIZE, WRITE, READ].map(|offset| word(memory, self.control + offset));
        if identifier != IDENTIFIER || size > MOST || write >= size || read >= size {
            return Vec::new();
        }
        let mut bytes = Vec::new();
        if write < read {
            bytes.extend(part(memory, buffer + read, size - read));
            bytes.extend(part(memory, buffer, write));
        } else {
            bytes.extend(part(memory, buffer + read, write - read));
        }
        if !bytes.is_empty() {
            memory.write(self.control + READ, &write.to_le_bytes());
        }
        bytes
    }
}

fn word(memory: &mut dyn Memory, address: u32) -> u32 {
    let mut bytes = [0; 4];
    memory.read(address, &mut bytes);
    u32::from_le_bytes(bytes)
}

fn part(memory: &mut dyn Memory, address: u32, size: u32) -> Vec<u8> {
    let mut bytes = vec![0; size as usize];
    memory.read(address, &mut bytes);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    const RTT: Rtt = Rtt { control: 0 };
    const RING: u32 = 64;

    struct Ram([u8; 128]);

    impl Memory for Ram {
        fn read(&mut self, address: u32, bytes: &mut [u8]) {
            let start = address as usize;
            bytes.copy_from_slice(&self.0[start..start + bytes.len()]);
        }

        fn write(&mut self, address: u32, bytes: &[u8]) {
            let start = address as usize;
            self.0[start..start + bytes.len()].copy_from_slice(bytes);
        }
    }

    fn ring(content: &[u8; 8], read: u32, write: u32) -> Ram {
        let mut ram = Ram([0; 128]);
        ram.write(0, IDENTIFIER);
        for (offset, value) in [(BUFFER, RING), (SIZE, 8), (WRITE, write), (READ, read)] {
            ram.write(offset, &value.to_le_bytes());
        }
        ram.write(RING, content);
        ram
    }

    #[test]
    fn takes_what_waits_and_says_so_to_the_program() {
        let mut ram = ring(b"abcdefgh", 2, 5);
        assert_eq!(RTT.drain(&mut ram), b"cde");
        assert_eq!(word(&mut ram, READ), 5);
        assert_eq!(RTT.drain(&mut ram), b"");
    }

    #[test]
    fn follows_the_ring_around() {
        assert_eq!(RTT.drain(&mut ring(b"abcdefgh", 6, 3)), b"ghabc");
    }

    #[test]
    fn takes_nothing_from_memory_that_is_not_initialised() {
        let mut ram = ring(b"abcdefgh", 2, 5);
        ram.write(0, b"noise");
        assert_eq!(RTT.drain(&mut ram), b"");
    }
}
