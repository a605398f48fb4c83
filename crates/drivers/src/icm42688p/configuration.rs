//! What is written into the part: one list, which is written, read back and watched in flight.

use super::registers::*;

/// How many samples the part takes a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OutputDataRate {
    /// 1 kHz.
    Hz1000,
    /// 2 kHz.
    Hz2000,
    /// 4 kHz.
    Hz4000,
    /// 8 kHz.
    Hz8000,
}

impl OutputDataRate {
    /// Samples a second, as the part's own oscillator counts them.
    pub const fn hz(self) -> u32 {
        match self {
            Self::Hz1000 => 1000,
            Self::Hz2000 => 2000,
            Self::Hz4000 => 4000,
            Self::Hz8000 => 8000,
        }
    }

    /// GYRO_ODR and ACCEL_ODR.
    const fn code(self) -> u8 {
        match self {
            Self::Hz8000 => 3,
            Self::Hz4000 => 4,
            Self::Hz2000 => 5,
            Self::Hz1000 => 6,
        }
    }

    /// The gyroscope's anti-alias filter: about a quarter of the rate, since behind it samples
    /// are only picked. Lower would cost phase in the rate loop.
    const fn gyro_filter(self) -> AntiAlias {
        match self {
            Self::Hz1000 => AntiAlias::HZ_258,
            Self::Hz2000 => AntiAlias::HZ_536,
            Self::Hz4000 => AntiAlias::HZ_997,
            Self::Hz8000 => AntiAlias::HZ_1962,
        }
    }
}

/// An anti-alias filter by the three figures that the part wants (data sheet, section 5.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct AntiAlias {
    delt: u8,
    delt_squared: u16,
    bit_shift: u8,
}

impl AntiAlias {
    /// 3 dB at 258 Hz.
    const HZ_258: Self = Self::new(6, 36, 10);
    /// 3 dB at 536 Hz.
    const HZ_536: Self = Self::new(12, 144, 8);
    /// 3 dB at 997 Hz.
    const HZ_997: Self = Self::new(21, 440, 6);
    /// 3 dB at 1962 Hz.
    const HZ_1962: Self = Self::new(37, 1376, 4);

    const fn new(delt: u8, delt_squared: u16, bit_shift: u8) -> Self {
        Self {
            delt,
            delt_squared,
            bit_shift,
        }
    }

    const fn low(self) -> u8 {
        self.delt_squared.to_le_bytes()[0]
    }

    const fn shift_and_high(self) -> u8 {
        self.bit_shift << 4 | self.delt_squared.to_le_bytes()[1]
    }
}

/// The accelerometer's anti-alias filter, at every rate: specific force is summed up over
/// milliseconds, and the rotors' vibration must not fold into it.
const ACCEL_FILTER: AntiAlias = AntiAlias::HZ_258;

/// Some bits of a register. The others are the factory's and are left as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Setting {
    pub register: Register,
    pub mask: u8,
    pub value: u8,
}

const fn set(register: Register, mask: u8, value: u8) -> Setting {
    Setting {
        register,
        mask,
        value,
    }
}

/// Number of settings.
pub(super) const SETTINGS: usize = 17;

/// The whole configuration, in the order in which it is written. The sensors are turned on last:
/// all but range and rate may be written only while they are off (data sheet, section 12.9).
pub(super) const fn settings(rate: OutputDataRate) -> [Setting; SETTINGS] {
    let gyro = rate.gyro_filter();
    let accel = ACCEL_FILTER;
    [
        set(GYRO_CONFIG_STATIC2, GYRO_FILTERS_OFF_MASK, 0),
        set(GYRO_CONFIG_STATIC3, GYRO_DELT_MASK, gyro.delt),
        set(GYRO_CONFIG_STATIC4, 0xFF, gyro.low()),
        set(GYRO_CONFIG_STATIC5, 0xFF, gyro.shift_and_high()),
        set(ACCEL_CONFIG_STATIC2, ACCEL_DELT_MASK, accel.delt << 1),
        set(ACCEL_CONFIG_STATIC3, 0xFF, accel.low()),
        set(ACCEL_CONFIG_STATIC4, 0xFF, accel.shift_and_high()),
        set(
            INTF_CONFIG0,
            INTF_CONFIG0_MASK,
            SENSOR_DATA_BIG_ENDIAN | DISABLE_I2C,
        ),
        set(INTF_CONFIG1, INTF_CONFIG1_MASK, AFSR_OFF | CLOCK_PLL),
        set(GYRO_ACCEL_CONFIG0, 0xFF, ACCEL_QUARTER | GYRO_LOW_LATENCY),
        set(INT_CONFIG, INT1_MASK, INT1_PUSH_PULL | INT1_ACTIVE_HIGH),
        set(INT_CONFIG0, DATA_READY_CLEAR_MASK, 0),
        set(INT_CONFIG1, INT_CONFIG1_MASK, PULSE_8_US | NO_REST),
        set(INT_SOURCE0, INT_SOURCE0_MASK, DATA_READY_INT1),
        set(GYRO_CONFIG0, RANGE_AND_RATE_MASK, rate.code()),
        set(ACCEL_CONFIG0, RANGE_AND_RATE_MASK, rate.code()),
        set(PWR_MGMT0, PWR_MGMT0_MASK, GYRO_LOW_NOISE | ACCEL_LOW_NOISE),
    ]
}
