//! Which registers exist, and how wide accesses reach them: RM0090 chapters 2, 38 and 39.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::machine::Bus;
use windhover_hil::violation::Violation;

// 2.3, table 1
#[test]
fn a_peripheral_that_is_not_modelled_is_refused_by_its_name() {
    for (address, peripheral) in [
        (0x4000_5810, "I2C2"),
        (0x4000_3C08, "SPI3"),
        (0x4000_7400, "DAC"),
        (0x5000_0010, "USB OTG FS"),
        (0x4000_2C00, "WWDG"),
        (0x4100_0000, "reserved"),
        (0x4210_0000, "bit-band alias"),
    ] {
        let access = "read";
        let expected = Violation::UnknownRegister {
            peripheral,
            address,
            access,
        };
        assert_eq!(Bench::new().try_read(address).unwrap_err(), expected);
    }
}

// 2.3, table 1
#[test]
fn a_register_that_a_peripheral_does_not_have_is_refused() {
    for address in [
        RCC + 0x1C,
        RCC + 0x88,
        GPIOA + 0x28,
        USART1 + 0x1C,
        DMA1 + 0xD0,
        TIM6 + TIM_CCR1,
        TIM3 + TIM_BDTR,
        PWR_CR + 8,
        IWDG_SR + 4,
        EXTI + 0x18,
        SYSCFG + 0x18,
        FLASH + 0x18,
        SPI1 + 0x24,
        BKP0R - 4,
    ] {
        let violation = Bench::powered().try_read(address).unwrap_err();
        assert!(
            matches!(violation, Violation::UnknownRegister { .. }),
            "{violation}"
        );
    }
}

// 2.1, AHB/APB bridges
#[test]
fn on_apb_a_half_word_fills_the_register() {
    let mut bench = Bench::powered();
    bench.write_sized(TIM3 + TIM_PSC, 2, 0x1234);
    assert_eq!(bench.read(TIM3 + TIM_PSC), 0x1234);
    bench.write_sized(TIM2 + TIM_ARR, 2, 0x1234);
    assert_eq!(bench.read(TIM2 + TIM_ARR), 0x1234_1234);
}

// 8.4
#[test]
fn on_ahb_a_byte_reaches_its_lane_only() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + MODER, 0x1111_1111);
    bench.write_sized(GPIOC + MODER + 1, 1, 0x55);
    assert_eq!(bench.read(GPIOC + MODER), 0x1111_5511);
}

// 8.4
#[test]
fn a_byte_of_a_register_can_be_read() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + MODER, 0x1234_5678);
    let half = bench.board.read(0, GPIOC + MODER + 2, 2, &mut bench.memory);
    assert_eq!(half, Ok(0x1234));
}

// 10.5
#[test]
fn registers_of_dma_are_accessed_by_words() {
    let mut bench = Bench::powered();
    let violation = bench
        .board
        .write(0, DMA1 + 0x14, 2, 1, &mut bench.memory)
        .unwrap_err();
    assert_says(&violation.to_string(), "by words only");
}

// 38.6.1
#[test]
fn the_debug_unit_identifies_the_part() {
    let mut bench = Bench::new();
    assert_eq!(bench.read(0xE004_2000), 0x1007_6413);
    assert_says(&bench.refused(0xE004_2000, 0), "only be read");
}

// 38.16.3 to 38.16.5
#[test]
fn the_debug_unit_keeps_what_should_freeze() {
    let mut bench = Bench::new();
    for offset in [0x4, 0x8, 0xC] {
        bench.write(0xE004_2000 + offset, 7);
        assert_eq!(bench.read(0xE004_2000 + offset), 7);
    }
}

// 39.1, 39.2
#[test]
fn the_part_has_an_identifier_and_tells_the_size_of_its_flash() {
    let mut bench = Bench::new();
    for address in [0x1FFF_7A10, 0x1FFF_7A14, 0x1FFF_7A18] {
        assert_ne!(bench.read(address), 0);
    }
    let size = bench.board.read(0, 0x1FFF_7A22, 2, &mut bench.memory);
    assert_eq!(size, Ok(1024));
    assert_says(&bench.refused(0x1FFF_7A10, 0), "only be read");
}

// 4.4.1; the value is that of the CRC-32/MPEG-2 of the words' bytes, highest first.
#[test]
fn the_crc_unit_divides_by_the_ethernet_polynomial() {
    let mut bench = Bench::powered();
    const CRC_DR: u32 = 0x4002_3000;
    const CRC_CR: u32 = 0x4002_3008;
    assert_eq!(bench.read(CRC_DR), 0xFFFF_FFFF);
    bench.write(CRC_DR, u32::from_be_bytes(*b"1234"));
    bench.write(CRC_DR, u32::from_be_bytes(*b"5678"));
    assert_eq!(bench.read(CRC_DR), mpeg_crc(b"12345678"));
    bench.write(CRC_CR, 1);
    assert_eq!(bench.read(CRC_DR), 0xFFFF_FFFF);
}

fn mpeg_crc(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0xFFFF_FFFF, |crc: u32, byte| {
        (0..8).rev().fold(crc, |crc, bit| {
            let carry = crc >> 31 != u32::from(byte >> bit & 1);
            crc << 1 ^ if carry { 0x04C1_1DB7 } else { 0 }
        })
    })
}
