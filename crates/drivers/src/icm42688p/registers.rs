//! Registers of the ICM-42688-P: addresses and fields (DS-000347 rev. 1.7, sections 13 to 19).

/// One of the part's register banks, as REG_BANK_SEL holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Bank {
    /// Data, interrupts, modes and rates; selected after a reset.
    Zero = 0,
    /// Filters of the gyroscope.
    One = 1,
    /// Filters of the accelerometer.
    Two = 2,
}

/// A register: its bank and its address there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Register {
    /// The bank it lies in.
    pub bank: Bank,
    /// Its address in the bank.
    pub address: u8,
}

const fn register(bank: Bank, address: u8) -> Register {
    Register { bank, address }
}

/// The bit of the first byte of a transaction that makes it a read.
pub const READ: u8 = 0x80;

/// Software reset.
pub const DEVICE_CONFIG: Register = register(Bank::Zero, 0x11);
/// In [`DEVICE_CONFIG`]: reset now.
pub const SOFT_RESET: u8 = 1 << 0;

/// Polarity, drive and mode of the interrupt pins.
pub const INT_CONFIG: Register = register(Bank::Zero, 0x14);
/// In [`INT_CONFIG`]: mode, drive and polarity of INT1.
pub const INT1_MASK: u8 = 0x07;
/// In [`INT_CONFIG`]: INT1 is driven high and low, not open drain.
pub const INT1_PUSH_PULL: u8 = 1 << 1;
/// In [`INT_CONFIG`]: INT1 rises when something happens. Pulsed, for the latch bit is clear.
pub const INT1_ACTIVE_HIGH: u8 = 1 << 0;

/// First register of the burst: temperature, accelerometer, gyroscope, high bytes first.
pub const TEMP_DATA1: Register = register(Bank::Zero, 0x1D);

/// Byte order and serial interface.
pub const INTF_CONFIG0: Register = register(Bank::Zero, 0x4C);
/// In [`INTF_CONFIG0`]: what the driver depends on, the treatment of invalid samples included.
pub const INTF_CONFIG0_MASK: u8 = 0x93;
/// In [`INTF_CONFIG0`]: sensor data have their high byte first.
pub const SENSOR_DATA_BIG_ENDIAN: u8 = 1 << 4;
/// In [`INTF_CONFIG0`]: no I2C, so that traffic on the bus is never mistaken for it.
pub const DISABLE_I2C: u8 = 0x03;

/// Clock source, and the adaptive full-scale range.
pub const INTF_CONFIG1: Register = register(Bank::Zero, 0x4D);
/// In [`INTF_CONFIG1`]: the adaptive full-scale range, and the clock source.
pub const INTF_CONFIG1_MASK: u8 = 0xC3;
/// In [`INTF_CONFIG1`]: no adaptive full-scale range. Not in the data sheet; with it, rates
/// stand still for 1 to 2 ms when it switches (ArduPilot pull request 25332).
pub const AFSR_OFF: u8 = 0x40;
/// In [`INTF_CONFIG1`]: the PLL as soon as it runs.
pub const CLOCK_PLL: u8 = 0x01;

/// Power modes.
pub const PWR_MGMT0: Register = register(Bank::Zero, 0x4E);
/// In [`PWR_MGMT0`]: thermometer, oscillator, gyroscope and accelerometer.
pub const PWR_MGMT0_MASK: u8 = 0x3F;
/// In [`PWR_MGMT0`]: the gyroscope runs in low-noise mode.
pub const GYRO_LOW_NOISE: u8 = 0x0C;
/// In [`PWR_MGMT0`]: the accelerometer runs in low-noise mode.
pub const ACCEL_LOW_NOISE: u8 = 0x03;

/// Range and rate of the gyroscope.
pub const GYRO_CONFIG0: Register = register(Bank::Zero, 0x4F);
/// Range and rate of the accelerometer.
pub const ACCEL_CONFIG0: Register = register(Bank::Zero, 0x50);
/// In [`GYRO_CONFIG0`] and [`ACCEL_CONFIG0`]: range and rate. Range 0 is ±2000 °/s and ±16 g.
pub const RANGE_AND_RATE_MASK: u8 = 0xEF;

/// Bandwidths of the filters behind the anti-alias filters.
pub const GYRO_ACCEL_CONFIG0: Register = register(Bank::Zero, 0x52);
/// In [`GYRO_ACCEL_CONFIG0`]: the gyroscope's lowest latency, samples of eight times the rate.
pub const GYRO_LOW_LATENCY: u8 = 0x0F;
/// In [`GYRO_ACCEL_CONFIG0`]: the accelerometer has a quarter of the rate.
pub const ACCEL_QUARTER: u8 = 0x10;

/// How interrupts are cleared.
pub const INT_CONFIG0: Register = register(Bank::Zero, 0x63);
/// In [`INT_CONFIG0`]: data ready; 0 is by reading the status.
pub const DATA_READY_CLEAR_MASK: u8 = 0x30;

/// Timing of the interrupt pins.
pub const INT_CONFIG1: Register = register(Bank::Zero, 0x64);
/// In [`INT_CONFIG1`]: pulse duration, rest duration, and INT_ASYNC_RESET, which has to be
/// cleared "for proper INT1 and INT2 pin operation".
pub const INT_CONFIG1_MASK: u8 = 0x70;
/// In [`INT_CONFIG1`]: pulses of 8 µs instead of 100 µs. Required from 4 kHz on, optional below.
pub const PULSE_8_US: u8 = 1 << 6;
/// In [`INT_CONFIG1`]: no rest of 100 µs after a pulse. Required from 4 kHz on, optional below.
pub const NO_REST: u8 = 1 << 5;

/// What raises INT1.
pub const INT_SOURCE0: Register = register(Bank::Zero, 0x65);
/// In [`INT_SOURCE0`]: all sources.
pub const INT_SOURCE0_MASK: u8 = 0x7F;
/// In [`INT_SOURCE0`]: a sample is ready.
pub const DATA_READY_INT1: u8 = 1 << 3;

/// The part's identity.
pub const WHO_AM_I: Register = register(Bank::Zero, 0x75);
/// In [`WHO_AM_I`]: an ICM-42688-P.
pub const IDENTITY: u8 = 0x47;

/// The bank selection has this address in every bank.
pub const REG_BANK_SEL: u8 = 0x76;

/// Switches of the gyroscope's filters.
pub const GYRO_CONFIG_STATIC2: Register = register(Bank::One, 0x0B);
/// In [`GYRO_CONFIG_STATIC2`]: anti-alias filter off, notch filter off.
pub const GYRO_FILTERS_OFF_MASK: u8 = 0x03;
/// Anti-alias filter of the gyroscope: DELT.
pub const GYRO_CONFIG_STATIC3: Register = register(Bank::One, 0x0C);
/// In [`GYRO_CONFIG_STATIC3`]: DELT.
pub const GYRO_DELT_MASK: u8 = 0x3F;
/// Anti-alias filter of the gyroscope: low byte of DELTSQR.
pub const GYRO_CONFIG_STATIC4: Register = register(Bank::One, 0x0D);
/// Anti-alias filter of the gyroscope: BITSHIFT and the high bits of DELTSQR.
pub const GYRO_CONFIG_STATIC5: Register = register(Bank::One, 0x0E);

/// Anti-alias filter of the accelerometer: DELT and its switch.
pub const ACCEL_CONFIG_STATIC2: Register = register(Bank::Two, 0x03);
/// In [`ACCEL_CONFIG_STATIC2`]: DELT, and bit 0, which turns the filter off.
pub const ACCEL_DELT_MASK: u8 = 0x7F;
/// Anti-alias filter of the accelerometer: low byte of DELTSQR.
pub const ACCEL_CONFIG_STATIC3: Register = register(Bank::Two, 0x04);
/// Anti-alias filter of the accelerometer: BITSHIFT and the high bits of DELTSQR.
pub const ACCEL_CONFIG_STATIC4: Register = register(Bank::Two, 0x05);
