//! A serial port (RM0090 chapter 30), asynchronous: bytes come and go whole, at their time.

mod ports;

pub(super) use ports::PORTS;

use super::line::{Format, Frame, Heard, Parity, Receiver};
use super::refusal::{Answer, Refusal, misuse};
use crate::time::NEVER;

const SR: u32 = 0x00;
pub(super) const DR: u32 = 0x04;
const BRR: u32 = 0x08;
const CR1: u32 = 0x0C;
const CR2: u32 = 0x10;
const CR3: u32 = 0x14;
const GTPR: u32 = 0x18;

const SR_PE: u32 = 1 << 0;
const SR_FE: u32 = 1 << 1;
const SR_ORE: u32 = 1 << 3;
const SR_IDLE: u32 = 1 << 4;
const SR_RXNE: u32 = 1 << 5;
const SR_TC: u32 = 1 << 6;
const SR_TXE: u32 = 1 << 7;
/// Cleared by a read of SR and then of DR: PE, FE, NF, ORE, IDLE.
const SR_READ_TO_CLEAR: u32 = 0x1F;
/// Cleared by writing zero: RXNE, TC, and LBD and CTS, which are never set.
const SR_WRITE_TO_CLEAR: u32 = SR_RXNE | SR_TC | 3 << 8;

const CR1_SBK: u32 = 1 << 0;
const CR1_RWU: u32 = 1 << 1;
const CR1_RE: u32 = 1 << 2;
const CR1_TE: u32 = 1 << 3;
const CR1_IDLEIE: u32 = 1 << 4;
const CR1_RXNEIE: u32 = 1 << 5;
const CR1_TCIE: u32 = 1 << 6;
const CR1_TXEIE: u32 = 1 << 7;
const CR1_PEIE: u32 = 1 << 8;
const CR1_PS: u32 = 1 << 9;
const CR1_PCE: u32 = 1 << 10;
const CR1_M: u32 = 1 << 12;
const CR1_UE: u32 = 1 << 13;
const CR1_OVER8: u32 = 1 << 15;
const CR1_WRITABLE: u32 = 0xBFFF;

/// LINEN, CLKEN.
const CR2_UNMODELLED: u32 = 1 << 14 | 1 << 11;
const CR2_WRITABLE: u32 = 0x7F6F;
const CR3_EIE: u32 = 1 << 0;
const CR3_HDSEL: u32 = 1 << 3;
const CR3_DMAR: u32 = 1 << 6;
const CR3_DMAT: u32 = 1 << 7;
/// IREN, SCEN, RTSE, CTSE.
const CR3_UNMODELLED: u32 = 1 << 1 | 1 << 5 | 1 << 8 | 1 << 9;
const CR3_WRITABLE: u32 = 0x0FFF;

/// What is in the transmitter's shift register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shifting {
    Byte(u16),
    /// The frame of ones that goes out first when the transmitter is switched on.
    IdleFrame,
}

pub(super) struct Usart {
    status: u32,
    baud: u32,
    control: [u32; 3],
    guard: u32,
    /// SR was read: a read or write of DR now clears flags.
    status_read: bool,
    received: u32,
    receiver: Receiver,
    waiting: Option<u16>,
    shifting: Option<Shifting>,
    /// When the shift register will be empty.
    shifted: u64,
    /// When the line will have been idle for a frame.
    idle: u64,
    /// Ticks in a cycle of its bus.
    cycle: u64,
}

impl Usart {
    pub(super) fn new() -> Self {
        Self {
            status: SR_TXE | SR_TC,
            baud: 0,
            control: [0; 3],
            guard: 0,
            status_read: false,
            received: 0,
            receiver: Receiver::default(),
            waiting: None,
            shifting: None,
            shifted: NEVER,
            idle: NEVER,
            cycle: 0,
        }
    }

    pub(super) fn set_cycle(&mut self, cycle: u64) {
        self.cycle = cycle;
    }

    fn on(&self, bits: u32) -> bool {
        let wanted = CR1_UE | bits;
        self.control[0] & wanted == wanted
    }

    /// Whether its transmitter drives its pin.
    pub(super) fn transmits(&self) -> bool {
        self.on(CR1_TE)
    }

    /// Whether it listens to its receiver's pin; in half duplex that is the transmitter's.
    pub(super) fn receives(&self) -> bool {
        self.on(CR1_RE) && self.control[2] & CR3_HDSEL == 0
    }

    /// Whether it asks the DMA controller for a byte to transmit.
    pub(super) fn requests_byte(&self) -> bool {
        self.control[2] & CR3_DMAT != 0 && self.on(CR1_TE) && self.status & SR_TXE != 0
    }

    /// Whether it asks the DMA controller to fetch a byte.
    pub(super) fn offers_byte(&self) -> bool {
        self.control[2] & CR3_DMAR != 0 && self.status & SR_RXNE != 0
    }

    pub(super) fn interrupt(&self) -> bool {
        let [control, _, control_3] = self.control;
        // An overrun raises the receiver's interrupt; the error interrupt is for DMA.
        let enabled = [
            (CR1_TXEIE, SR_TXE),
            (CR1_TCIE, SR_TC),
            (CR1_RXNEIE, SR_RXNE | SR_ORE),
            (CR1_IDLEIE, SR_IDLE),
            (CR1_PEIE, SR_PE),
        ]
        .iter()
        .any(|(enable, flags)| control & enable != 0 && self.status & flags != 0);
        let errors = CR3_EIE | CR3_DMAR;
        let error = control_3 & errors == errors && self.status & (SR_ORE | SR_FE) != 0;
        control & CR1_UE != 0 && (enabled || error)
    }

    pub(super) fn next_event(&self) -> u64 {
        let heard = self.receiver.next_event(&self.format());
        self.shifted.min(self.idle).min(heard)
    }

    /// What is due: the byte that has left the transmitter, if one has.
    pub(super) fn advance(&mut self, now: u64) -> Option<Frame> {
        let heard = self.receiver.advance(now, &self.format());
        self.take(now, heard);
        if self.idle <= now {
            self.idle = NEVER;
            self.status |= SR_IDLE;
        }
        if self.shifted > now {
            return None;
        }
        let gone = self.shifting.take();
        match self.waiting.take() {
            Some(next) => {
                self.shift(self.shifted, Shifting::Byte(next));
                self.status |= SR_TXE;
            }
            None => {
                self.shifted = NEVER;
                self.status |= SR_TC;
            }
        }
        match gone {
            Some(Shifting::Byte(data)) => Some(Frame {
                data,
                format: self.format(),
            }),
            _ => None,
        }
    }

    /// A byte's last stop bit is over at the receiver's pin.
    pub(super) fn receive(&mut self, now: u64, frame: Frame) {
        if !self.on(CR1_RE) {
            return;
        }
        let heard = self.receiver.hear(now, frame, &self.format());
        self.take(now, heard);
    }

    /// The receiver read a byte. The parity bit is read with it (RM0090 30.6.2).
    fn take(&mut self, now: u64, heard: Option<Heard>) {
        let Some(heard) = heard else {
            return;
        };
        if self.status & SR_RXNE != 0 {
            self.status |= SR_ORE;
        } else {
            self.received = u32::from(heard.bits);
            self.status |= SR_RXNE;
            self.status |= if heard.framing_error { SR_FE } else { 0 };
            self.status |= if heard.parity_error { SR_PE } else { 0 };
        }
        // One frame of silence makes the line idle; a byte that begins within it is known here only
        // at its end, another frame later.
        self.idle = now + 2 * self.frame_time();
    }

    /// Cycles of the bus in a bit: USARTDIV, whose fraction is sixteenths, or eighths with OVER8.
    fn bit_cycles(&self) -> u64 {
        let baud = u64::from(self.baud);
        if self.control[0] & CR1_OVER8 != 0 {
            (baud >> 4) * 8 + (baud & 7)
        } else {
            baud
        }
    }

    /// How bytes lie on the line, by the registers. The parity bit is one of the 8 or 9 of M.
    fn format(&self) -> Format {
        let control = self.control[0];
        let parity = match (control & CR1_PCE != 0, control & CR1_PS != 0) {
            (false, _) => Parity::None,
            (true, false) => Parity::Even,
            (true, true) => Parity::Odd,
        };
        let bits = if control & CR1_M != 0 { 9 } else { 8 };
        Format {
            bit: self.bit_cycles() * self.cycle,
            data_bits: bits - u32::from(parity != Parity::None),
            parity,
            stop_halves: [2, 1, 4, 3][(self.control[1] >> 12 & 3) as usize],
        }
    }

    fn frame_time(&self) -> u64 {
        self.format().frame_time()
    }

    fn shift(&mut self, now: u64, what: Shifting) {
        self.shifting = Some(what);
        self.shifted = now + self.frame_time();
    }

    pub(super) fn read(&mut self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            SR => {
                self.status_read = true;
                self.status
            }
            DR => self.read_data(),
            BRR => self.baud,
            CR1 | CR2 | CR3 => self.control[((offset - CR1) / 4) as usize],
            GTPR => self.guard,
            _ => return Err(Refusal::Unknown),
        })
    }

    /// The byte received last.
    pub(super) fn read_data(&mut self) -> u32 {
        self.status &= !SR_RXNE;
        if self.status_read {
            self.status &= !SR_READ_TO_CLEAR;
            self.status_read = false;
        }
        self.received
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        match offset {
            SR => self.status &= value | !SR_WRITE_TO_CLEAR,
            DR => return self.write_data(now, value),
            BRR => self.baud = value & 0xFFFF,
            CR1 => return self.write_control(now, value & CR1_WRITABLE),
            CR2 if value & CR2_UNMODELLED != 0 => return misuse("LIN and synchronous mode are not modelled"),
            CR2 => self.control[1] = value & CR2_WRITABLE,
            CR3 if value & CR3_UNMODELLED != 0 => {
                return misuse("IrDA, smartcard and hardware flow control are not modelled");
            }
            CR3 => self.control[2] = value & CR3_WRITABLE,
            GTPR => self.guard = value & 0xFFFF,
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }

    fn write_control(&mut self, now: u64, value: u32) -> Answer<()> {
        if value & (CR1_SBK | CR1_RWU) != 0 {
            return misuse("break characters and mute mode are not modelled");
        }
        let transmitted = self.transmits();
        self.control[0] = value;
        if !self.on(CR1_RE) {
            self.receiver = Receiver::default();
        }
        if self.on(0) && self.bit_cycles() < 8 {
            return misuse("it is enabled without a baud rate");
        }
        if self.transmits() && !transmitted && self.shifting.is_none() {
            self.shift(now, Shifting::IdleFrame);
        }
        Ok(())
    }

    /// Hands the transmitter a byte.
    pub(super) fn write_data(&mut self, now: u64, value: u32) -> Answer<()> {
        if !self.transmits() {
            return misuse("DR is written while the transmitter is off");
        }
        if self.status & SR_TXE == 0 {
            return misuse("DR is written before TXE: the byte that waits is lost");
        }
        if self.status_read {
            self.status &= !SR_TC;
            self.status_read = false;
        }
        let data = value as u16 & self.format().mask();
        if self.shifting.is_some() {
            self.waiting = Some(data);
            self.status &= !SR_TXE;
        } else {
            self.shift(now, Shifting::Byte(data));
        }
        Ok(())
    }
}
