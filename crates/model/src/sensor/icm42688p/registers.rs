//! The register map: reset values and what can be written (DS-000347 rev. 1.7, sections 13 to 19).

/// Banks that REG_BANK_SEL can select.
pub(super) const BANKS: usize = 5;

/// Addresses in a bank.
pub(super) const ADDRESSES: usize = 0x80;

pub(super) const DEVICE_CONFIG: u8 = 0x11;
pub(super) const INT_CONFIG: u8 = 0x14;
pub(super) const TEMP_DATA1: u8 = 0x1D;
pub(super) const ACCEL_DATA_X1: u8 = 0x1F;
pub(super) const GYRO_DATA_Z0: u8 = 0x2A;
pub(super) const INT_STATUS: u8 = 0x2D;
pub(super) const SIGNAL_PATH_RESET: u8 = 0x4B;
pub(super) const INTF_CONFIG0: u8 = 0x4C;
pub(super) const PWR_MGMT0: u8 = 0x4E;
pub(super) const GYRO_CONFIG0: u8 = 0x4F;
pub(super) const ACCEL_CONFIG0: u8 = 0x50;
pub(super) const INT_CONFIG0: u8 = 0x63;
pub(super) const INT_CONFIG1: u8 = 0x64;
pub(super) const INT_SOURCE0: u8 = 0x65;
pub(super) const REG_BANK_SEL: u8 = 0x76;

/// A register of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Definition {
    bank: u8,
    address: u8,
    /// What it holds after a reset.
    reset: u8,
    /// Bits that can be written; 0 for a register that can only be read.
    writable: u8,
}

const fn rw(bank: u8, address: u8, reset: u8, writable: u8) -> Definition {
    Definition {
        bank,
        address,
        reset,
        writable,
    }
}

const fn ro(bank: u8, address: u8, reset: u8) -> Definition {
    rw(bank, address, reset, 0)
}

/// What stands for a value that the factory trims on every part.
const FACTORY: u8 = 0x5A;

/// All registers with an address of their own. Sensor data (0x1D to 0x2A of bank 0) and
/// INT_STATUS are not stored here, but are listed, so that they are known.
const MAP: &[Definition] = &[
    rw(0, DEVICE_CONFIG, 0x00, 0x11),
    rw(0, 0x13, 0x05, 0x3F), // DRIVE_CONFIG
    rw(0, INT_CONFIG, 0x00, 0x3F),
    rw(0, 0x16, 0x00, 0xC0), // FIFO_CONFIG
    ro(0, TEMP_DATA1, 0x80),
    ro(0, 0x1E, 0x00),
    ro(0, ACCEL_DATA_X1, 0x80),
    ro(0, 0x20, 0x00),
    ro(0, 0x21, 0x80),
    ro(0, 0x22, 0x00),
    ro(0, 0x23, 0x80),
    ro(0, 0x24, 0x00),
    ro(0, 0x25, 0x80),
    ro(0, 0x26, 0x00),
    ro(0, 0x27, 0x80),
    ro(0, 0x28, 0x00),
    ro(0, 0x29, 0x80),
    ro(0, GYRO_DATA_Z0, 0x00),
    ro(0, 0x2B, 0x00), // TMST_FSYNCH
    ro(0, 0x2C, 0x00), // TMST_FSYNCL
    ro(0, INT_STATUS, 0x10),
    ro(0, 0x2E, 0x00), // FIFO_COUNTH
    ro(0, 0x2F, 0x00), // FIFO_COUNTL
    ro(0, 0x30, 0xFF), // FIFO_DATA
    ro(0, 0x31, 0x00), // APEX_DATA0 to 5
    ro(0, 0x32, 0x00),
    ro(0, 0x33, 0x00),
    ro(0, 0x34, 0x04),
    ro(0, 0x35, 0x00),
    ro(0, 0x36, 0x00),
    ro(0, 0x37, 0x00), // INT_STATUS2
    ro(0, 0x38, 0x00), // INT_STATUS3
    rw(0, SIGNAL_PATH_RESET, 0x00, 0x6E),
    rw(0, INTF_CONFIG0, 0x30, 0xF3),
    rw(0, 0x4D, 0x91, 0xCF), // INTF_CONFIG1, with the undocumented bits 7:6 (AFSR)
    rw(0, PWR_MGMT0, 0x00, 0x3F),
    rw(0, GYRO_CONFIG0, 0x06, 0xEF),
    rw(0, ACCEL_CONFIG0, 0x06, 0xEF),
    rw(0, 0x51, 0x16, 0xEF), // GYRO_CONFIG1
    rw(0, 0x52, 0x11, 0xFF), // GYRO_ACCEL_CONFIG0
    rw(0, 0x53, 0x0D, 0x1E), // ACCEL_CONFIG1
    rw(0, 0x54, 0x23, 0x1F), // TMST_CONFIG
    rw(0, 0x56, 0x82, 0xFB), // APEX_CONFIG0
    rw(0, 0x57, 0x00, 0x0F), // SMD_CONFIG
    rw(0, 0x5F, 0x00, 0x7F), // FIFO_CONFIG1
    rw(0, 0x60, 0x00, 0xFF), // FIFO_CONFIG2
    rw(0, 0x61, 0x00, 0x0F), // FIFO_CONFIG3
    rw(0, 0x62, 0x10, 0x73), // FSYNC_CONFIG
    rw(0, INT_CONFIG0, 0x00, 0x3F),
    rw(0, INT_CONFIG1, 0x10, 0x70),
    rw(0, INT_SOURCE0, 0x10, 0x7F),
    rw(0, 0x66, 0x00, 0x4F), // INT_SOURCE1
    rw(0, 0x68, 0x00, 0x7F), // INT_SOURCE3
    rw(0, 0x69, 0x00, 0x4F), // INT_SOURCE4
    ro(0, 0x6C, 0x00),       // FIFO_LOST_PKT0
    ro(0, 0x6D, 0x00),       // FIFO_LOST_PKT1
    rw(0, 0x70, 0x00, 0x7F), // SELF_TEST_CONFIG
    ro(0, 0x75, 0x47),       // WHO_AM_I
    rw(1, 0x03, 0x80, 0x3F), // SENSOR_CONFIG0
    rw(1, 0x0B, 0xA0, 0x03), // GYRO_CONFIG_STATIC2
    rw(1, 0x0C, 0x0D, 0x3F), // GYRO_CONFIG_STATIC3
    rw(1, 0x0D, 0xAA, 0xFF), // GYRO_CONFIG_STATIC4
    rw(1, 0x0E, 0x80, 0xFF), // GYRO_CONFIG_STATIC5
    rw(1, 0x0F, FACTORY, 0xFF),
    rw(1, 0x10, FACTORY, 0xFF),
    rw(1, 0x11, FACTORY, 0xFF),
    rw(1, 0x12, FACTORY, 0xFF),
    rw(1, 0x13, 0x11, 0x7F), // GYRO_CONFIG_STATIC10
    rw(1, 0x5F, FACTORY, 0xFF),
    rw(1, 0x60, FACTORY, 0xFF),
    rw(1, 0x61, FACTORY, 0xFF),
    ro(1, 0x62, 0x00), // TMSTVAL0 to 2
    ro(1, 0x63, 0x00),
    ro(1, 0x64, 0x00),
    rw(1, 0x7A, 0x83, 0x42), // INTF_CONFIG4
    rw(1, 0x7B, 0x00, 0x06), // INTF_CONFIG5
    rw(1, 0x7C, 0x5F, 0x1F), // INTF_CONFIG6
    rw(2, 0x03, 0x30, 0x7F), // ACCEL_CONFIG_STATIC2
    rw(2, 0x04, 0x40, 0xFF), // ACCEL_CONFIG_STATIC3
    rw(2, 0x05, 0x62, 0xFF), // ACCEL_CONFIG_STATIC4
    rw(2, 0x3B, FACTORY, 0xFF),
    rw(2, 0x3C, FACTORY, 0xFF),
    rw(2, 0x3D, FACTORY, 0xFF),
    rw(4, 0x40, 0xA2, 0xFF), // APEX_CONFIG1 to 9
    rw(4, 0x41, 0x85, 0xFF),
    rw(4, 0x42, 0x51, 0xFF),
    rw(4, 0x43, 0xA4, 0xFF),
    rw(4, 0x44, 0x8C, 0xFF),
    rw(4, 0x45, 0x5C, 0xFF),
    rw(4, 0x46, 0x45, 0xFF),
    rw(4, 0x47, 0x5B, 0xFF),
    rw(4, 0x48, 0x00, 0xFF),
    rw(4, 0x4A, 0x00, 0xFF), // ACCEL_WOM_X_THR, Y, Z
    rw(4, 0x4B, 0x00, 0xFF),
    rw(4, 0x4C, 0x00, 0xFF),
    rw(4, 0x4D, 0x00, 0x7F), // INT_SOURCE6 to 10
    rw(4, 0x4E, 0x00, 0x7F),
    rw(4, 0x4F, 0x00, 0x7F),
    rw(4, 0x50, 0x00, 0x7F),
    rw(4, 0x51, 0x00, 0x7F),
    rw(4, 0x77, 0x00, 0xFF), // OFFSET_USER0 to 8
    rw(4, 0x78, 0x00, 0xFF),
    rw(4, 0x79, 0x00, 0xFF),
    rw(4, 0x7A, 0x00, 0xFF),
    rw(4, 0x7B, 0x00, 0xFF),
    rw(4, 0x7C, 0x00, 0xFF),
    rw(4, 0x7D, 0x00, 0xFF),
    rw(4, 0x7E, 0x00, 0xFF),
    rw(4, 0x7F, 0x00, 0xFF),
];

/// What the registers hold. Reserved addresses hold 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Registers {
    values: [[u8; ADDRESSES]; BANKS],
    /// Bits that can be written; `None` where there is no register.
    writable: [[Option<u8>; ADDRESSES]; BANKS],
}

impl Registers {
    /// As after a reset.
    pub fn new() -> Self {
        let mut registers = Self {
            values: [[0; ADDRESSES]; BANKS],
            writable: [[None; ADDRESSES]; BANKS],
        };
        for definition in MAP {
            let (bank, address) = (usize::from(definition.bank), usize::from(definition.address));
            registers.values[bank][address] = definition.reset;
            registers.writable[bank][address] = Some(definition.writable);
        }
        for bank in 0..BANKS {
            registers.writable[bank][usize::from(REG_BANK_SEL)] = Some(0x07);
        }
        registers
    }

    /// Sets everything to its reset value.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// What a register of bank 0 holds.
    pub fn get(&self, address: u8) -> u8 {
        self.at(0, address)
    }

    /// What a register holds.
    pub fn at(&self, bank: u8, address: u8) -> u8 {
        self.values[usize::from(bank)][usize::from(address)]
    }

    /// Bits that can be written; `None` where there is no register.
    pub fn writable(&self, bank: u8, address: u8) -> Option<u8> {
        self.writable[usize::from(bank)][usize::from(address)]
    }

    /// Puts a value in a register, those bits that can be written.
    pub fn write(&mut self, bank: u8, address: u8, value: u8) {
        let mask = self.writable(bank, address).unwrap_or(0);
        let register = &mut self.values[usize::from(bank)][usize::from(address)];
        *register = *register & !mask | value & mask;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_register_is_listed_twice() {
        for (i, a) in MAP.iter().enumerate() {
            let twice = MAP[i + 1..]
                .iter()
                .any(|b| (a.bank, a.address) == (b.bank, b.address));
            assert!(!twice, "{a:?}");
        }
    }

    #[test]
    fn only_writable_bits_take_a_value() {
        let mut registers = Registers::new();
        registers.write(0, 0x75, 0x12);
        assert_eq!(registers.get(0x75), 0x47, "WHO_AM_I is read-only");
        registers.write(1, 0x0B, 0xFF);
        assert_eq!(registers.at(1, 0x0B), 0xA3, "reserved bits stay");
        registers.write(0, 0x12, 0xFF);
        assert_eq!(registers.get(0x12), 0, "a reserved address holds nothing");
    }
}
