//! Registers as a transaction reads and writes them, and what a write sets off.

use super::registers::{
    ACCEL_CONFIG0, BANKS, DEVICE_CONFIG, GYRO_CONFIG0, GYRO_DATA_Z0, INT_CONFIG, INT_CONFIG0, INT_CONFIG1,
    INT_SOURCE0, INT_STATUS, PWR_MGMT0, REG_BANK_SEL, SIGNAL_PATH_RESET, TEMP_DATA1,
};
use super::sensors::DATA_BYTES;
use super::{Icm42688p, Misuse, NEVER, QUIET_US};

/// In the first byte of a transaction.
const READ: u8 = 0x80;
/// In DEVICE_CONFIG.
const SOFT_RESET: u8 = 1 << 0;
/// In SIGNAL_PATH_RESET.
const ABORT_AND_RESET: u8 = 1 << 3;

impl Icm42688p {
    /// One byte of a transaction.
    pub(super) fn respond(&mut self, now: u64, mosi: u8) -> u8 {
        if self.resetting != NEVER {
            return 0;
        }
        let bank = self.bank;
        let Some(transaction) = &mut self.transaction else {
            return 0xFF;
        };
        let (read, shadow) = (transaction.read, transaction.shadow);
        let Some(address) = transaction.address else {
            transaction.address = Some(mosi & !READ);
            transaction.read = mosi & READ != 0;
            return 0;
        };
        transaction.address = Some(address.wrapping_add(1) & !READ);
        if read {
            self.read(now, bank, address, &shadow)
        } else {
            self.write(now, bank, address, mosi);
            0
        }
    }

    fn read(&mut self, now: u64, bank: u8, address: u8, shadow: &[u8; DATA_BYTES]) -> u8 {
        match (bank, address) {
            (_, REG_BANK_SEL) => self.bank,
            (0, TEMP_DATA1..=GYRO_DATA_Z0) => {
                if self.data_ready_clear() & 2 != 0 {
                    self.int1.cleared(now);
                }
                shadow[usize::from(address - TEMP_DATA1)]
            }
            (0, INT_STATUS) => {
                if self.data_ready_clear() != 2 {
                    self.int1.cleared(now);
                }
                core::mem::take(&mut self.status)
            }
            _ => {
                if self.registers.writable(bank, address).is_none() {
                    self.misuse.push(Misuse::Reserved { bank, address });
                }
                self.registers.at(bank, address)
            }
        }
    }

    /// UI_DRDY_INT_CLEAR: 0 and 1 by reading the status, 2 by reading data, 3 by either.
    fn data_ready_clear(&self) -> u8 {
        self.registers.get(INT_CONFIG0) >> 4 & 3
    }

    fn write(&mut self, now: u64, bank: u8, address: u8, value: u8) {
        if let Err(misuse) = self.may_write(now, bank, address) {
            self.misuse.push(misuse);
            if !matches!(misuse, Misuse::WhileRunning { .. }) {
                return;
            }
        }
        if address == REG_BANK_SEL {
            self.bank = value & 7;
            if usize::from(self.bank) >= BANKS {
                self.misuse.push(Misuse::Reserved { bank, address });
                self.bank = 0;
            }
            return;
        }
        self.registers.write(bank, address, value);
        if bank == 0 {
            self.act(now, address, value);
        }
    }

    /// Whether the data sheet allows this write.
    fn may_write(&self, now: u64, bank: u8, address: u8) -> Result<(), Misuse> {
        // "The only register settings that user can modify during sensor operation are for ODR
        // selection, FSR selection, and sensor mode changes"; a reset ends operation.
        let always = bank == 0
            && matches!(
                address,
                GYRO_CONFIG0 | ACCEL_CONFIG0 | PWR_MGMT0 | DEVICE_CONFIG | SIGNAL_PATH_RESET
            );
        if now < self.quiet {
            return Err(Misuse::TooSoon { bank, address });
        }
        match self.registers.writable(bank, address) {
            None => Err(Misuse::Reserved { bank, address }),
            Some(0) => Err(Misuse::ReadOnly { bank, address }),
            Some(_) if self.sensors.running() && !always && address != REG_BANK_SEL => {
                Err(Misuse::WhileRunning { bank, address })
            }
            Some(_) => Ok(()),
        }
    }

    /// What follows from a write to a register of bank 0.
    fn act(&mut self, now: u64, address: u8, value: u8) {
        let (clock, registers) = (&self.clock, &self.registers);
        match address {
            DEVICE_CONFIG if value & SOFT_RESET != 0 => self.reset(now),
            PWR_MGMT0 => {
                let started = self.sensors.set_modes(now, clock, registers, &mut self.misuse);
                if started {
                    self.quiet = now + clock.microseconds(QUIET_US);
                }
            }
            GYRO_CONFIG0 | ACCEL_CONFIG0 => self.sensors.restart(now, clock, registers, &mut self.misuse),
            SIGNAL_PATH_RESET => {
                if value & ABORT_AND_RESET != 0 {
                    self.sensors.restart(now, clock, registers, &mut self.misuse);
                }
                self.registers.write(0, SIGNAL_PATH_RESET, 0);
            }
            INT_CONFIG | INT_CONFIG1 | INT_SOURCE0 => self.int1.configure(now, registers),
            _ => {}
        }
    }
}
