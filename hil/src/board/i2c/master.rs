//! What a master does on the bus (RM0090 27.3.3).

use super::super::refusal::{Answer, misuse};
use super::super::wiring::{I2cCondition, Wiring};
use super::{
    CR1_ACK, CR1_POS, CR1_START, CR1_STOP, I2c, SR1_ADDR, SR1_AF, SR1_ARLO, SR1_BTF, SR1_RXNE, SR1_SB,
    SR1_TXE, SR2_BUSY, SR2_MSL, SR2_TRA,
};
use crate::time::NEVER;

/// Clocks of a byte: eight bits and the acknowledgement.
const CLOCKS: u64 = 9;

/// Where a transfer stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// It is not master.
    Idle,
    /// A start condition is made.
    Starting,
    /// It waits for the address.
    Started,
    /// The address goes out.
    Addressing(u8),
    /// It waits for ADDR to be cleared.
    Addressed,
    /// It waits for a byte to send.
    Empty,
    /// A byte goes out.
    Sending(u8),
    /// A byte comes in.
    Receiving,
    /// Two bytes were received and none was read.
    Full,
    /// A byte was not acknowledged: it waits for START or STOP.
    Refused,
    /// A stop condition is made.
    Stopping,
}

impl Phase {
    /// Whether it lasts for a time of its own.
    fn is_timed(self) -> bool {
        matches!(self, Self::Starting | Self::Stopping) || self.is_byte()
    }

    fn is_byte(self) -> bool {
        matches!(self, Self::Addressing(_) | Self::Sending(_) | Self::Receiving)
    }
}

impl I2c {
    fn enter(&mut self, now: u64, phase: Phase) {
        self.phase = phase;
        self.begun = now;
        let clocks = if phase.is_byte() { CLOCKS } else { 1 };
        self.due = if phase.is_timed() {
            now + clocks * self.bit()
        } else {
            NEVER
        };
        self.acknowledge = self.control & CR1_ACK != 0;
        self.held = None;
        if !self.lines[0] {
            self.hold(now);
        }
    }

    /// Clocks of a byte that have passed, if it is master.
    pub(super) fn clocks_done(&self, now: u64) -> Option<u32> {
        let left = self.held.unwrap_or(self.due.saturating_sub(now));
        let done = || CLOCKS.saturating_sub(left.div_ceil(self.bit())) as u32;
        (self.bus & SR2_MSL != 0).then(|| if self.phase.is_byte() { done() } else { 0 })
    }

    /// A start or a stop that was asked for is begun, once nothing else goes on.
    pub(super) fn go_on(&mut self, now: u64) -> Answer<()> {
        if self.phase.is_timed() {
            return Ok(());
        }
        if self.control & CR1_STOP != 0 {
            return self.begin_stop(now);
        }
        let free = self.bus & SR2_MSL != 0 || self.bus & SR2_BUSY == 0;
        if self.control & CR1_START != 0 && free && self.lines == [true; 2] {
            if self.phase == Phase::Full {
                return misuse("START follows a byte that was acknowledged: the part drives the bus");
            }
            self.enter(now, Phase::Starting);
        }
        Ok(())
    }

    fn begin_stop(&mut self, now: u64) -> Answer<()> {
        match self.phase {
            Phase::Idle => misuse("STOP is set, and it is not master"),
            Phase::Full => misuse("STOP follows a byte that was acknowledged: the part drives the bus"),
            // What holds the data line keeps the stop from being seen.
            _ if !self.lines[1] => Ok(()),
            _ => {
                self.enter(now, Phase::Stopping);
                Ok(())
            }
        }
    }

    /// A phase is over.
    pub(super) fn finish(&mut self, now: u64, wiring: &mut dyn Wiring) -> Answer<()> {
        match self.phase {
            Phase::Starting => {
                wiring.i2c_condition(now, I2cCondition::Start);
                self.control &= !CR1_START;
                self.status = self.status & !(SR1_BTF | SR1_TXE) | SR1_SB;
                self.bus = SR2_MSL | SR2_BUSY;
                self.status_read = false;
                self.enter(now, Phase::Started);
            }
            Phase::Addressing(byte) => self.sent(now, byte, wiring),
            Phase::Sending(byte) => self.sent(now, byte, wiring),
            Phase::Receiving => self.received(now, wiring),
            Phase::Stopping => {
                wiring.i2c_condition(now, I2cCondition::Stop);
                self.control &= !CR1_STOP;
                self.status &= !(SR1_BTF | SR1_TXE | SR1_SB | SR1_ADDR);
                self.bus = 0;
                self.note_busy();
                self.enter(now, Phase::Idle);
            }
            _ => {}
        }
        Ok(())
    }

    fn sent(&mut self, now: u64, byte: u8, wiring: &mut dyn Wiring) {
        let data_held_low = !self.lines[1];
        if data_held_low && byte != 0 {
            // A one was sent and a zero seen.
            self.status |= SR1_ARLO;
            self.bus &= !(SR2_MSL | SR2_TRA);
            wiring.i2c_condition(now, I2cCondition::Released { clocks: 0 });
            return self.enter(now, Phase::Idle);
        }
        let address = matches!(self.phase, Phase::Addressing(_));
        if !(wiring.i2c_send(now, byte) || data_held_low) {
            self.status |= SR1_AF;
            self.enter(now, Phase::Refused);
        } else if address {
            self.status |= SR1_ADDR;
            self.status_read = false;
            self.bus |= if byte & 1 == 0 { SR2_TRA } else { 0 };
            self.enter(now, Phase::Addressed);
        } else if self.status & SR1_TXE == 0 {
            self.status |= SR1_TXE;
            self.enter(now, Phase::Sending(self.data));
        } else {
            self.status |= SR1_BTF;
            self.enter(now, Phase::Empty);
        }
    }

    fn received(&mut self, now: u64, wiring: &mut dyn Wiring) {
        let acknowledge = if self.control & CR1_POS != 0 {
            self.acknowledge
        } else {
            self.control & CR1_ACK != 0
        };
        let byte = wiring.i2c_receive(now, acknowledge);
        let byte = if self.lines[1] { byte } else { 0 };
        let full = self.status & SR1_RXNE != 0;
        if full {
            self.shifted = Some(byte);
            self.status |= SR1_BTF;
        } else {
            self.data = byte;
            self.status |= SR1_RXNE;
        }
        self.enter(
            now,
            match (acknowledge, full) {
                (false, _) => Phase::Refused,
                (true, true) => Phase::Full,
                (true, false) => Phase::Receiving,
            },
        );
    }

    /// ADDR is cleared: the first byte can go.
    pub(super) fn address_seen(&mut self, now: u64) {
        if self.phase != Phase::Addressed {
            return;
        }
        self.status &= !SR1_ADDR;
        if self.bus & SR2_TRA != 0 {
            self.status |= SR1_TXE;
            self.enter(now, Phase::Empty);
        } else {
            self.enter(now, Phase::Receiving);
        }
    }

    pub(super) fn read_data(&mut self, now: u64) -> u32 {
        let data = self.data;
        match self.shifted.take() {
            Some(next) => {
                self.data = next;
                self.status &= !SR1_BTF;
            }
            None => self.status &= !SR1_RXNE,
        }
        if self.phase == Phase::Full {
            self.enter(now, Phase::Receiving);
        }
        self.status_read = false;
        data.into()
    }

    pub(super) fn write_data(&mut self, now: u64, byte: u8) -> Answer<()> {
        let status_read = std::mem::take(&mut self.status_read);
        match self.phase {
            Phase::Started if !status_read => misuse("DR is written before SR1 was read: SB stays"),
            Phase::Started => {
                self.status &= !SR1_SB;
                self.enter(now, Phase::Addressing(byte));
                Ok(())
            }
            Phase::Empty => {
                self.status &= !SR1_BTF;
                self.enter(now, Phase::Sending(byte));
                Ok(())
            }
            Phase::Sending(_) if self.status & SR1_TXE != 0 => {
                self.status &= !SR1_TXE;
                self.data = byte;
                Ok(())
            }
            phase => misuse(format!("DR is written while it cannot be sent ({phase:?})")),
        }
    }

    /// Others let the lines, clock and data, be high, or hold them low.
    pub(in super::super) fn set_lines(&mut self, now: u64, lines: [bool; 2]) -> Answer<()> {
        if lines == self.lines {
            return Ok(());
        }
        let before = std::mem::replace(&mut self.lines, lines);
        if self.bus & SR2_MSL == 0 {
            let stop = lines == [true; 2] && before == [true, false];
            self.bus &= if stop { !SR2_BUSY } else { !0 };
            self.note_busy();
        }
        match (before[0], lines[0]) {
            (true, false) => self.hold(now),
            (false, true) => {
                self.due = self.held.take().map_or(self.due, |left| now + left);
            }
            _ => {}
        }
        self.go_on(now)
    }

    /// A line that is low says that the bus is busy.
    pub(super) fn note_busy(&mut self) {
        if self.lines != [true; 2] {
            self.bus |= SR2_BUSY;
        }
    }

    /// The clock is held: time stops on the bus.
    fn hold(&mut self, now: u64) {
        if self.due != NEVER {
            self.held = Some(self.due.saturating_sub(now));
            self.due = NEVER;
        }
    }
}
