//! The serial peripheral interface (RM0090 chapter 28) as it is used: master, full duplex, bytes.

use super::refusal::{Answer, Refusal, misuse};
use crate::time::NEVER;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
const DR: u32 = 0x0C;
const CRCPR: u32 = 0x10;
const TXCRCR: u32 = 0x18;
const I2SCFGR: u32 = 0x1C;
const I2SPR: u32 = 0x20;

/// Its data register, for DMA.
pub(super) const DATA: u32 = 0x4001_3000 + DR;
pub(super) const INTERRUPT: u32 = 35;

const CR1_MSTR: u32 = 1 << 2;
const CR1_SPE: u32 = 1 << 6;
const CR1_SSI: u32 = 1 << 8;
const CR1_SSM: u32 = 1 << 9;
/// What a master on these boards does not use, and what it is.
const CR1_UNMODELLED: [(u32, &str); 5] = [
    (1 << 7, "LSBFIRST"),
    (1 << 10, "RXONLY"),
    (1 << 11, "DFF = 1: frames of 16 bits"),
    (1 << 13, "CRCEN"),
    (1 << 15, "BIDIMODE"),
];
/// What must not change while it is enabled: CPHA, CPOL, MSTR, BR.
const CR1_FIXED: u32 = 0x3F;

const CR2_RXDMAEN: u32 = 1 << 0;
const CR2_TXDMAEN: u32 = 1 << 1;
const CR2_ERRIE: u32 = 1 << 5;
const CR2_RXNEIE: u32 = 1 << 6;
const CR2_TXEIE: u32 = 1 << 7;
const CR2_FRF: u32 = 1 << 4;
const CR2_WRITABLE: u32 = 0xF7;

const SR_RXNE: u32 = 1 << 0;
const SR_TXE: u32 = 1 << 1;
const SR_OVR: u32 = 1 << 6;
const SR_BSY: u32 = 1 << 7;

pub(super) struct Spi {
    control: u32,
    control_2: u32,
    status: u32,
    polynomial: u32,
    received: u8,
    waiting: Option<u8>,
    shifting: Option<u8>,
    /// When the byte in the shift register will be through.
    shifted: u64,
    /// DR was read: a read of SR now clears OVR.
    data_read: bool,
    /// Ticks in a cycle of its bus.
    cycle: u64,
}

impl Spi {
    pub(super) fn new() -> Self {
        Self {
            control: 0,
            control_2: 0,
            status: SR_TXE,
            polynomial: 7,
            received: 0,
            waiting: None,
            shifting: None,
            shifted: NEVER,
            data_read: false,
            cycle: 0,
        }
    }

    pub(super) fn set_cycle(&mut self, cycle: u64) {
        self.cycle = cycle;
    }

    pub(super) fn requests_byte(&self) -> bool {
        self.control_2 & CR2_TXDMAEN != 0 && self.status & SR_TXE != 0
    }

    pub(super) fn offers_byte(&self) -> bool {
        self.control_2 & CR2_RXDMAEN != 0 && self.status & SR_RXNE != 0
    }

    pub(super) fn interrupt(&self) -> bool {
        [(CR2_TXEIE, SR_TXE), (CR2_RXNEIE, SR_RXNE), (CR2_ERRIE, SR_OVR)]
            .iter()
            .any(|(enable, flag)| self.control_2 & enable != 0 && self.status & flag != 0)
    }

    pub(super) fn next_event(&self) -> u64 {
        self.shifted
    }

    /// Whether a byte goes over the wires.
    pub(super) fn busy(&self) -> bool {
        self.shifting.is_some()
    }

    /// Exchanges the byte that is due.
    pub(super) fn advance(&mut self, now: u64, exchange: impl FnOnce(u8) -> u8) {
        if self.shifted > now {
            return;
        }
        let Some(sent) = self.shifting.take() else {
            return;
        };
        let byte = exchange(sent);
        if self.status & SR_RXNE != 0 {
            self.status |= SR_OVR;
        } else {
            self.received = byte;
            self.status |= SR_RXNE;
        }
        let start = std::mem::replace(&mut self.shifted, NEVER);
        self.status &= !SR_BSY;
        self.begin(start);
    }

    /// Moves the byte that waits, if one does, into the shift register.
    fn begin(&mut self, now: u64) {
        if self.control & CR1_SPE == 0 || self.shifting.is_some() {
            return;
        }
        if let Some(byte) = self.waiting.take() {
            self.shifting = Some(byte);
            self.shifted = now + self.byte_time();
            self.status |= SR_TXE | SR_BSY;
        }
    }

    fn byte_time(&self) -> u64 {
        8 * self.cycle * (2 << (self.control >> 3 & 7))
    }

    pub(super) fn read(&mut self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            CR1 => self.control,
            CR2 => self.control_2,
            SR => {
                let status = self.status;
                if std::mem::take(&mut self.data_read) {
                    self.status &= !SR_OVR;
                }
                status
            }
            DR => self.read_data(),
            CRCPR => self.polynomial,
            CRCPR..=TXCRCR | I2SCFGR => 0,
            I2SPR => 2,
            _ => return Err(Refusal::Unknown),
        })
    }

    /// The byte received last.
    pub(super) fn read_data(&mut self) -> u32 {
        self.data_read = self.status & SR_OVR != 0;
        self.status &= !SR_RXNE;
        u32::from(self.received)
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        match offset {
            CR1 => return self.write_control(now, value & 0xFFFF),
            CR2 if value & CR2_FRF != 0 => return misuse("TI mode is not modelled"),
            CR2 => self.control_2 = value & CR2_WRITABLE,
            SR => {}
            DR => return self.write_data(now, value),
            CRCPR => self.polynomial = value & 0xFFFF,
            I2SCFGR if value & 1 << 11 != 0 => return misuse("SPI1 has no I2S"),
            I2SCFGR | I2SPR => {}
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }

    fn write_control(&mut self, now: u64, value: u32) -> Answer<()> {
        let stays_on = self.control & value & CR1_SPE != 0;
        if stays_on && (self.control ^ value) & CR1_FIXED != 0 {
            return misuse("mode or baud rate are changed while it is enabled");
        }
        if self.control & !value & CR1_SPE != 0 && self.busy() {
            return misuse("it is disabled in the middle of a byte");
        }
        if value & CR1_SPE != 0 {
            check_enabled(value)?;
        }
        self.control = value;
        self.begin(now);
        Ok(())
    }

    /// Hands it a byte to send.
    pub(super) fn write_data(&mut self, now: u64, value: u32) -> Answer<()> {
        if self.status & SR_TXE == 0 {
            return misuse("DR is written before TXE: the byte that waits is lost");
        }
        self.waiting = Some(value as u8);
        self.status &= !SR_TXE;
        self.begin(now);
        Ok(())
    }
}

fn check_enabled(control: u32) -> Answer<()> {
    for (bit, what) in CR1_UNMODELLED {
        if control & bit != 0 {
            return misuse(format!("{what} is not modelled"));
        }
    }
    if control & CR1_MSTR == 0 {
        return misuse("slave mode is not modelled");
    }
    match (control & CR1_SSM != 0, control & CR1_SSI != 0) {
        (true, true) => Ok(()),
        (true, false) => misuse("a master with SSM and without SSI has a mode fault (MODF)"),
        (false, _) => misuse("chip select by hardware (SSM = 0) is not modelled"),
    }
}
