//! Power control (RM0090 5.4).

use super::refusal::{Answer, Refusal, misuse};
use crate::time::MICROSECOND;

const CR: u32 = 0x00;
const CSR: u32 = 0x04;

const CR_CWUF: u32 = 1 << 2;
const CR_CSBF: u32 = 1 << 3;
const CR_PVDE: u32 = 1 << 4;
const CR_DBP: u32 = 1 << 8;
const CR_VOS: u32 = 1 << 14;
const CR_WRITABLE: u32 = 0x43FF;
const CSR_BRR: u32 = 1 << 3;
const CSR_BRE: u32 = 1 << 9;
const CSR_VOSRDY: u32 = 1 << 14;
const CSR_WRITABLE: u32 = 1 << 8 | CSR_BRE;

/// How long the regulator takes to its new voltage (datasheet table 21, scale change).
const VOLTAGE_CHANGE: u64 = 40 * MICROSECOND;

pub(super) struct Pwr {
    control: u32,
    status: u32,
    /// When the regulator will have its voltage.
    voltage_ready: u64,
}

impl Pwr {
    pub(super) fn new() -> Self {
        Self {
            control: CR_VOS,
            status: 0,
            voltage_ready: 0,
        }
    }

    /// Whether the backup domain can be written: DBP.
    pub(super) fn backup_writable(&self) -> bool {
        self.control & CR_DBP != 0
    }

    /// Whether the regulator is set for the highest frequencies: VOS.
    pub(super) fn scale_1(&self) -> bool {
        self.control & CR_VOS != 0
    }

    pub(super) fn read(&self, now: u64, offset: u32) -> Answer<u32> {
        match offset {
            CR => Ok(self.control),
            CSR => {
                let mut value = self.status;
                value |= if now >= self.voltage_ready { CSR_VOSRDY } else { 0 };
                value |= if value & CSR_BRE != 0 { CSR_BRR } else { 0 };
                Ok(value)
            }
            _ => Err(Refusal::Unknown),
        }
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        match offset {
            CR if value & CR_PVDE != 0 => return misuse("the voltage detector (PVDE) is not modelled"),
            CR => {
                if (value ^ self.control) & CR_VOS != 0 {
                    self.voltage_ready = now + VOLTAGE_CHANGE;
                }
                self.control = value & CR_WRITABLE & !(CR_CWUF | CR_CSBF);
            }
            CSR => self.status = value & CSR_WRITABLE,
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }
}
