//! An I2C interface (RM0090 chapter 27) as it is used: master, 7-bit addresses, by the processor.
//!
//! - here: the registers; [`master`]: what goes over the bus, byte by byte.
//!
//! Bytes take the time of their nine clocks. Others can hold a line low: a clock that is held
//! stops everything, data that are held keep a start from being made, and take away the bus.

mod master;

use super::refusal::{Answer, Refusal, misuse};
use super::wiring::Wiring;
use crate::time::{NEVER, SECOND};
use master::Phase;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const OAR1: u32 = 0x08;
const OAR2: u32 = 0x0C;
const DR: u32 = 0x10;
const SR1: u32 = 0x14;
const SR2: u32 = 0x18;
const CCR: u32 = 0x1C;
const TRISE: u32 = 0x20;

/// Event and error interrupts of I2C1.
pub(super) const INTERRUPTS: [u32; 2] = [31, 32];

const CR1_PE: u32 = 1 << 0;
const CR1_START: u32 = 1 << 8;
const CR1_STOP: u32 = 1 << 9;
const CR1_ACK: u32 = 1 << 10;
const CR1_POS: u32 = 1 << 11;
const CR1_SWRST: u32 = 1 << 15;
/// What is not used, and what it is.
const CR1_UNMODELLED: [(u32, &str); 4] = [
    (0x3A | 1 << 12 | 1 << 13, "SMBus and packet error checking"),
    (1 << 6, "ENGC"),
    (1 << 7, "NOSTRETCH"),
    (1 << 2 | 1 << 14, "a reserved bit"),
];

const CR2_FREQ: u32 = 0x3F;
const CR2_ITERREN: u32 = 1 << 8;
const CR2_ITEVTEN: u32 = 1 << 9;
const CR2_ITBUFEN: u32 = 1 << 10;
const CR2_DMA: u32 = 3 << 11;
const CR2_WRITABLE: u32 = 0x073F;

const SR1_SB: u32 = 1 << 0;
const SR1_ADDR: u32 = 1 << 1;
const SR1_BTF: u32 = 1 << 2;
const SR1_RXNE: u32 = 1 << 6;
const SR1_TXE: u32 = 1 << 7;
const SR1_ARLO: u32 = 1 << 9;
const SR1_AF: u32 = 1 << 10;
/// Cleared by writing zero.
const SR1_ERRORS: u32 = 0xDF00;

const SR2_MSL: u32 = 1 << 0;
const SR2_BUSY: u32 = 1 << 1;
const SR2_TRA: u32 = 1 << 2;

const CCR_DUTY: u32 = 1 << 14;
const CCR_FAST: u32 = 1 << 15;
const CCR_WRITABLE: u32 = 0xCFFF;

pub(super) struct I2c {
    control: u32,
    control_2: u32,
    own: [u32; 2],
    status: u32,
    /// SR2.
    bus: u32,
    clock: u32,
    rise: u32,
    data: u8,
    /// SR1 was read: SB and ADDR can be cleared.
    status_read: bool,
    /// A byte that came while the one before was not yet read.
    shifted: Option<u8>,
    phase: Phase,
    /// When the phase began.
    begun: u64,
    /// When it will be over, if by itself.
    due: u64,
    /// What of it was left when somebody held the bus.
    held: Option<u64>,
    /// POS: what ACK was when the byte began that is being received.
    acknowledge: bool,
    /// Lines as others leave them: clock and data, high or low.
    lines: [bool; 2],
    /// It let go of the bus in the middle of a byte, after so many clocks.
    released: Option<u32>,
    /// Ticks in a cycle of its bus.
    cycle: u64,
}

impl I2c {
    pub(super) fn new() -> Self {
        Self {
            control: 0,
            control_2: 0,
            own: [0; 2],
            status: 0,
            bus: 0,
            clock: 0,
            rise: 2,
            data: 0,
            status_read: false,
            shifted: None,
            phase: Phase::Idle,
            begun: 0,
            due: NEVER,
            held: None,
            acknowledge: false,
            lines: [true; 2],
            released: None,
            cycle: 0,
        }
    }

    /// A reset, by RCC or SWRST: it lets go of the bus, whose lines stay what they are.
    pub(super) fn reset(&mut self, now: u64) {
        let fresh = Self {
            released: self.clocks_done(now).or(self.released),
            lines: self.lines,
            cycle: self.cycle,
            ..Self::new()
        };
        *self = fresh;
        self.note_busy();
    }

    pub(super) fn set_cycle(&mut self, cycle: u64) {
        self.cycle = cycle;
    }

    /// It let go of the bus after so many clocks of a byte; asked once.
    pub(super) fn take_released(&mut self) -> Option<u32> {
        self.released.take()
    }

    /// Whether it makes, or wants to make, a start.
    pub(super) fn starts(&self) -> bool {
        self.control & CR1_START != 0
    }

    /// The event and the error request line.
    pub(super) fn interrupts(&self) -> [bool; 2] {
        let mut events = SR1_SB | SR1_ADDR | SR1_BTF;
        if self.control_2 & CR2_ITBUFEN != 0 {
            events |= SR1_TXE | SR1_RXNE;
        }
        [
            self.control_2 & CR2_ITEVTEN != 0 && self.status & events != 0,
            self.control_2 & CR2_ITERREN != 0 && self.status & SR1_ERRORS != 0,
        ]
    }

    pub(super) fn read(&mut self, now: u64, offset: u32) -> Answer<u32> {
        Ok(match offset {
            CR1 => self.control,
            CR2 => self.control_2,
            OAR1 | OAR2 => self.own[((offset - OAR1) / 4) as usize],
            DR => self.read_data(now),
            SR1 => {
                self.status_read = true;
                self.status
            }
            SR2 => {
                let bus = self.bus;
                if self.status_read {
                    self.address_seen(now);
                }
                bus
            }
            CCR => self.clock,
            TRISE => self.rise,
            _ => return Err(Refusal::Unknown),
        })
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        let enabled = self.control & CR1_PE != 0;
        match offset {
            CR1 => return self.write_control(now, value & 0xFFFF),
            CR2 if value & CR2_DMA != 0 => return misuse("DMA is not modelled"),
            CR2 => self.control_2 = value & CR2_WRITABLE,
            OAR1 | OAR2 => self.own[((offset - OAR1) / 4) as usize] = value & 0xFFFF,
            DR => return self.write_data(now, value as u8),
            SR1 => self.status &= value | !SR1_ERRORS,
            SR2 => return misuse("SR2 can only be read"),
            CCR | TRISE if enabled => return misuse("CCR or TRISE are written while it is enabled"),
            CCR => self.clock = value & CCR_WRITABLE,
            TRISE => self.rise = value & 0x3F,
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }

    fn write_control(&mut self, now: u64, value: u32) -> Answer<()> {
        for (bits, what) in CR1_UNMODELLED {
            if value & bits != 0 {
                return misuse(format!("{what}: not modelled"));
            }
        }
        if value & CR1_SWRST != 0 {
            self.reset(now);
            self.control = CR1_SWRST;
            return Ok(());
        }
        if value & CR1_PE == 0 && self.bus & SR2_MSL != 0 {
            return misuse("it is disabled in the middle of a transfer");
        }
        if value & (CR1_START | CR1_STOP) != 0 {
            if value & CR1_PE == 0 {
                return misuse("START or STOP are set while it is disabled");
            }
            self.check_clock()?;
        }
        self.control = value;
        self.go_on(now)
    }

    /// Clocks that the manual allows, and a bus no faster than its mode.
    fn check_clock(&self) -> Answer<()> {
        let megahertz = SECOND / 1_000_000 / self.cycle;
        if u64::from(self.control_2 & CR2_FREQ) != megahertz {
            return misuse(format!("FREQ is not the {megahertz} MHz of its bus"));
        }
        let fast = self.clock & CCR_FAST != 0;
        let (least, limit) = if fast { (1, 400_000) } else { (4, 100_000) };
        if self.clock & 0xFFF < least || self.bit() * limit < SECOND {
            return misuse(format!("CCR asks for more than {limit} Hz"));
        }
        Ok(())
    }

    /// Ticks in a clock of the bus.
    fn bit(&self) -> u64 {
        let parts = match (self.clock & CCR_FAST != 0, self.clock & CCR_DUTY != 0) {
            (false, _) => 2,
            (true, false) => 3,
            (true, true) => 25,
        };
        parts * u64::from(self.clock & 0xFFF) * self.cycle
    }

    pub(super) fn next_event(&self) -> u64 {
        self.due
    }

    /// What is due on the bus.
    pub(super) fn advance(&mut self, now: u64, wiring: &mut dyn Wiring) -> Answer<()> {
        if self.due > now {
            return Ok(());
        }
        self.due = NEVER;
        self.finish(now, wiring)?;
        self.go_on(now)
    }
}
