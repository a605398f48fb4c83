//! The memory map (RM0090 table 1) and the clock gates (RM0090 7.3.5 to 7.3.14).

use super::timer::kinds::TIMERS;
use super::usart::PORTS;

/// A peripheral that is modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// Index in [`TIMERS`].
    Timer(usize),
    /// Index in [`PORTS`].
    Usart(usize),
    Spi1,
    I2c1,
    Adc1,
    /// 0 is port A.
    Gpio(usize),
    /// 0 is DMA1.
    Dma(usize),
    Rcc,
    Pwr,
    Flash,
    Syscfg,
    Exti,
    Iwdg,
    Backup,
    Crc,
    Debug,
    Identity,
}

/// A bus with its enable and reset registers, in the order of their addresses in RCC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bus {
    Ahb1,
    Apb1 = 3,
    Apb2,
}

/// Registers of a peripheral lie in blocks of this size.
const BLOCK: u32 = 0x400;

/// The modelled peripheral at an address.
pub(super) fn unit(address: u32) -> Option<Unit> {
    Some(match address & !(BLOCK - 1) {
        0x4000_0000 => Unit::Timer(1),
        0x4000_0400 => Unit::Timer(2),
        0x4000_0800 => Unit::Timer(3),
        0x4000_0C00 => Unit::Timer(4),
        0x4000_1000 => Unit::Timer(5),
        0x4000_1400 => Unit::Timer(6),
        0x4000_1800 => Unit::Timer(11),
        0x4000_1C00 => Unit::Timer(12),
        0x4000_2000 => Unit::Timer(13),
        0x4000_2800 => Unit::Backup,
        0x4000_3000 => Unit::Iwdg,
        0x4000_4400 => Unit::Usart(1),
        0x4000_4800 => Unit::Usart(2),
        0x4000_5400 => Unit::I2c1,
        0x4000_7000 => Unit::Pwr,
        0x4001_0000 => Unit::Timer(0),
        0x4001_0400 => Unit::Timer(7),
        0x4001_1000 => Unit::Usart(0),
        0x4001_1400 => Unit::Usart(3),
        0x4001_2000 => Unit::Adc1,
        0x4001_3000 => Unit::Spi1,
        0x4001_3800 => Unit::Syscfg,
        0x4001_3C00 => Unit::Exti,
        0x4001_4000 => Unit::Timer(8),
        0x4001_4400 => Unit::Timer(9),
        0x4001_4800 => Unit::Timer(10),
        base @ 0x4002_0000..0x4002_2400 => Unit::Gpio(((base >> 10) & 0xF) as usize),
        0x4002_3000 => Unit::Crc,
        0x4002_3800 => Unit::Rcc,
        0x4002_3C00 => Unit::Flash,
        0x4002_6000 => Unit::Dma(0),
        0x4002_6400 => Unit::Dma(1),
        0xE004_2000 => Unit::Debug,
        0x1FFF_7800 => Unit::Identity,
        _ => return None,
    })
}

const GPIO_NAMES: [&str; 9] = [
    "GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG", "GPIOH", "GPIOI",
];

impl Unit {
    /// Its name in the reference manual.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Timer(index) => TIMERS[index].name,
            Self::Usart(index) => PORTS[index].name,
            Self::Spi1 => "SPI1",
            Self::I2c1 => "I2C1",
            Self::Adc1 => "ADC1",
            Self::Gpio(index) => GPIO_NAMES[index],
            Self::Dma(index) => ["DMA1", "DMA2"][index],
            Self::Rcc => "RCC",
            Self::Pwr => "PWR",
            Self::Flash => "FLASH",
            Self::Syscfg => "SYSCFG",
            Self::Exti => "EXTI",
            Self::Iwdg => "IWDG",
            Self::Backup => "RTC",
            Self::Crc => "CRC",
            Self::Debug => "DBGMCU",
            Self::Identity => "device electronic signature",
        }
    }

    /// The bit that gates its clock, and resets it, in its bus's registers; none if it has none.
    pub(super) fn gate(self) -> Option<(Bus, u32)> {
        Some(match self {
            Self::Timer(index) => (TIMERS[index].bus, TIMERS[index].gate),
            Self::Usart(index) => (PORTS[index].bus, PORTS[index].gate),
            Self::Spi1 => (Bus::Apb2, 12),
            Self::I2c1 => (Bus::Apb1, 21),
            Self::Adc1 => (Bus::Apb2, 8),
            Self::Gpio(index) => (Bus::Ahb1, index as u32),
            Self::Dma(index) => (Bus::Ahb1, 21 + index as u32),
            Self::Pwr => (Bus::Apb1, 28),
            Self::Syscfg => (Bus::Apb2, 14),
            Self::Crc => (Bus::Ahb1, 12),
            Self::Rcc
            | Self::Flash
            | Self::Exti
            | Self::Iwdg
            | Self::Backup
            | Self::Debug
            | Self::Identity => return None,
        })
    }

    /// On the two APB buses a byte or half-word is repeated to fill the word (RM0090 2.1, AHB/APB
    /// bridges); on AHB it has lanes of its own.
    pub(super) fn on_apb(self) -> bool {
        matches!(
            self,
            Self::Timer(_)
                | Self::Usart(_)
                | Self::Spi1
                | Self::I2c1
                | Self::Adc1
                | Self::Pwr
                | Self::Syscfg
                | Self::Exti
                | Self::Iwdg
                | Self::Backup
        )
    }
}

/// Everything that a reset bit in RCC can reset.
pub(super) fn gated_units() -> impl Iterator<Item = Unit> {
    (0..TIMERS.len())
        .map(Unit::Timer)
        .chain((0..PORTS.len()).map(Unit::Usart))
        .chain((0..GPIO_NAMES.len()).map(Unit::Gpio))
        .chain([
            Unit::Dma(0),
            Unit::Dma(1),
            Unit::Spi1,
            Unit::I2c1,
            Unit::Adc1,
            Unit::Pwr,
            Unit::Syscfg,
            Unit::Crc,
        ])
}

/// Peripherals of the part that are not modelled, for a refusal that names them.
const UNMODELLED: [(u32, &str); 24] = [
    (0x4000_2C00, "WWDG"),
    (0x4000_3400, "I2S2ext"),
    (0x4000_3800, "SPI2"),
    (0x4000_3C00, "SPI3"),
    (0x4000_4000, "I2S3ext"),
    (0x4000_4C00, "UART4"),
    (0x4000_5000, "UART5"),
    (0x4000_5800, "I2C2"),
    (0x4000_5C00, "I2C3"),
    (0x4000_6400, "CAN1"),
    (0x4000_6800, "CAN2"),
    (0x4000_7400, "DAC"),
    (0x4001_2C00, "SDIO"),
    (0x4002_4000, "BKPSRAM"),
    (0x4002_8000, "ETHERNET MAC"),
    (0x4002_8400, "ETHERNET MAC"),
    (0x4002_8800, "ETHERNET MAC"),
    (0x4002_8C00, "ETHERNET MAC"),
    (0x4002_9000, "ETHERNET MAC"),
    (0x5005_0000, "DCMI"),
    (0x5006_0000, "CRYP"),
    (0x5006_0400, "HASH"),
    (0x5006_0800, "RNG"),
    (0xA000_0000, "FSMC"),
];

/// The name of what lies at an address that is not modelled.
pub(super) fn unmodelled(address: u32) -> &'static str {
    match address {
        0x4004_0000..0x4008_0000 => "USB OTG HS",
        0x5000_0000..0x5004_0000 => "USB OTG FS",
        0x4200_0000..0x4400_0000 => "bit-band alias",
        _ => UNMODELLED
            .iter()
            .find(|(base, _)| *base == address & !(BLOCK - 1))
            .map_or("reserved", |(_, name)| name),
    }
}
