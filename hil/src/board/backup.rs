//! The RTC's backup registers (RM0090 26.6.20). The rest of the RTC is not modelled.

use super::refusal::{Answer, Refusal, misuse};

const BKP0R: u32 = 0x50;
const BKP19R: u32 = 0x9C;

/// Twenty words that outlive every reset but that of the power.
#[derive(Default)]
pub(super) struct Backup {
    words: [u32; 20],
}

impl Backup {
    pub(super) fn new() -> Self {
        Self::default()
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            BKP0R..=BKP19R => Ok(self.words[((offset - BKP0R) / 4) as usize]),
            _ => Err(Refusal::Unknown),
        }
    }

    /// `writable` is `PWR_CR.DBP`.
    pub(super) fn write(&mut self, offset: u32, value: u32, writable: bool) -> Answer<()> {
        match offset {
            BKP0R..=BKP19R if !writable => {
                misuse("a backup register is written while PWR_CR.DBP protects it")
            }
            BKP0R..=BKP19R => {
                self.words[((offset - BKP0R) / 4) as usize] = value;
                Ok(())
            }
            _ => Err(Refusal::Unknown),
        }
    }
}
