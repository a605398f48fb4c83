//! What a stream's settings must be before it may run (RM0090 10.3.3, 10.3.10 and 10.3.17).

use super::super::Memory;
use super::super::refusal::{Answer, misuse};
use super::requests;
use super::stream::{DIR_SHIFT, EN, HTIF, MSIZE_SHIFT, PSIZE_SHIFT, Stream, TCIF};

const PFCTRL: u32 = 1 << 5;
const PINCOS: u32 = 1 << 15;
const PBURST: u32 = 3 << 21;
const CHSEL_SHIFT: u32 = 25;

/// TEIF, HTIF and TCIF: what must be clear before a stream is enabled.
const FLAGS_OF_A_TRANSFER: u32 = 1 << 3 | HTIF | TCIF;

impl Stream {
    /// The stream is to run: its settings are checked, and transfer begins.
    pub(super) fn enable(&mut self, controller: usize, index: usize, memory: &mut dyn Memory) -> Answer<()> {
        self.check_modes()?;
        let channel = self.control >> CHSEL_SHIFT & 7;
        self.heard = requests::heard(controller, index, channel);
        self.check_request(channel)?;
        if self.flags & FLAGS_OF_A_TRANSFER != 0 {
            return misuse("it is enabled before its flags are cleared");
        }
        self.begin();
        if self.left == 0 {
            return misuse("it is enabled with nothing to transfer (NDTR = 0)");
        }
        let sizes = (self.memory_size(), self.peripheral_size());
        if !(self.left as usize * sizes.1).is_multiple_of(sizes.0) {
            return misuse("NDTR is no multiple of what fits the memory's size");
        }
        self.control |= EN;
        self.filled = 0;
        self.refill(memory)
    }

    fn check_modes(&self) -> Answer<()> {
        if self.control >> DIR_SHIFT & 3 > 1 {
            return misuse("transfers from memory to memory are not modelled");
        }
        if self.control & (PFCTRL | PINCOS | PBURST) != 0 {
            return misuse("PFCTRL, PINCOS and PBURST are not modelled");
        }
        let sizes = [PSIZE_SHIFT, MSIZE_SHIFT].map(|shift| self.control >> shift & 3);
        if sizes.contains(&3) {
            return misuse("a size of 3 is reserved");
        }
        Ok(())
    }

    fn check_request(&self, channel: u32) -> Answer<()> {
        let Some(first) = self.heard[0] else {
            return misuse(format!("channel {channel} carries no modelled request"));
        };
        if first.to_peripheral().is_some_and(|to| to != self.transmits()) {
            return misuse(format!(
                "its direction is not that of {first:?}, which channel {channel} carries"
            ));
        }
        if !self
            .heard
            .iter()
            .flatten()
            .any(|request| request.registers().contains(&self.peripheral))
        {
            return misuse(format!(
                "channel {channel} carries {first:?}, whose data are not at PAR = {:#010x}",
                self.peripheral
            ));
        }
        Ok(())
    }
}
