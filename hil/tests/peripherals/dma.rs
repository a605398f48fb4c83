//! The DMA controllers: RM0090 chapter 10.

use super::bench::{Bench, FLASH_START, SRAM};
use super::registers::*;
use windhover_hil::board::{Pin, Usart};

pub const EN: u32 = 1;
pub const TEIE: u32 = 1 << 2;
pub const HTIE: u32 = 1 << 3;
pub const TCIE: u32 = 1 << 4;
pub const TO_PERIPHERAL: u32 = 1 << 6;
pub const CIRC: u32 = 1 << 8;
pub const PINC: u32 = 1 << 9;
pub const MINC: u32 = 1 << 10;
pub const PSIZE_16: u32 = 1 << 11;
pub const MSIZE_16: u32 = 1 << 13;
pub const MSIZE_32: u32 = 2 << 13;
pub const DBM: u32 = 1 << 18;
pub const DMDIS: u32 = 1 << 2;
pub const HTIF: u32 = 1 << 4;
pub const TCIF: u32 = 1 << 5;

pub const SPI_ENABLED: u32 = 1 << 2 | 1 << 6 | 1 << 8 | 1 << 9;
/// Eight periods of SCK at PCLK2 / 2, with 21 ticks a cycle.
pub const BYTE: u64 = 8 * 2 * 21;
/// The channel of SPI1 on streams 0 and 3 of DMA2, and of USART3 on streams 1 and 3 of DMA1.
pub const SPI_CHANNEL: u32 = 3 << 25;
pub const USART3_CHANNEL: u32 = 4 << 25;
pub const SOURCE: u32 = SRAM + 0x100;
pub const TARGET: u32 = SRAM + 0x200;

pub fn stream(controller: u32, index: u32) -> u32 {
    controller + 0x10 + 0x18 * index
}

/// Writes a stream's registers, and enables it.
#[track_caller]
pub fn set_up(bench: &mut Bench, stream: u32, peripheral: u32, memory: u32, items: u32, control: u32) {
    bench.write(stream + 0x04, items);
    bench.write(stream + 0x08, peripheral);
    bench.write(stream + 0x0C, memory);
    bench.write(stream, control);
    bench.write(stream, control | EN);
}

/// SPI1 connected, with both DMA requests enabled, but not itself.
pub fn spi() -> Bench {
    let mut bench = Bench::powered();
    for number in [5, 6, 7] {
        bench.alternate(Pin::new('A', number), 5);
    }
    bench.write(SPI_CR2, 3);
    bench
}

/// Exchanges so many bytes from SOURCE to TARGET.
pub fn exchange(count: u32) -> Bench {
    let mut bench = spi();
    bench.set_bytes(SOURCE, &[1, 2, 3, 4, 5, 6, 7, 8]);
    let receive = SPI_CHANNEL | MINC | TCIE | TEIE;
    set_up(&mut bench, stream(DMA2, 0), SPI_DR, TARGET, count, receive);
    set_up(
        &mut bench,
        stream(DMA2, 3),
        SPI_DR,
        SOURCE,
        count,
        receive | TO_PERIPHERAL,
    );
    bench.write(SPI_CR1, SPI_ENABLED);
    bench
}

/// USART3 running at 16 cycles a bit; its first idle frame is over.
pub fn serial() -> Bench {
    let mut bench = Bench::powered();
    bench.modify(RCC_APB1ENR, |enr| enr | 1 << 18);
    bench.alternate(Pin::new('B', 10), 7);
    bench.alternate(Pin::new('B', 11), 7);
    bench.write(USART3 + BRR, 16);
    bench.line.bit = FRAME / 10;
    bench.write(USART3 + CR1, 1 << 13 | 1 << 3 | 1 << 2);
    bench.wait(FRAME);
    bench.write(USART3 + CR3, 1 << 6 | 1 << 7);
    bench
}

pub const FRAME: u64 = 10 * 16 * 21;

// 28.3.9
#[test]
fn spi_exchanges_bytes_by_dma_without_gaps() {
    let mut bench = exchange(4);
    bench.wait(4 * BYTE);
    let ends: Vec<u64> = bench.board.wiring.exchanged.iter().map(|byte| byte.0).collect();
    assert_eq!(ends, [1, 2, 3, 4].map(|byte| byte * BYTE));
    assert_eq!(bench.bytes(TARGET, 4), [!1, !2, !3, !4]);
}

// 10.3.13
#[test]
fn at_the_end_tcif_is_set_and_the_stream_disabled() {
    let mut bench = exchange(4);
    bench.wait(4 * BYTE - 1);
    assert_eq!(bench.read(DMA2 + LISR) & TCIF, 0);
    bench.wait(1);
    assert_eq!(bench.read(DMA2 + LISR) & TCIF, TCIF);
    assert_eq!(bench.read(stream(DMA2, 0)) & EN, 0);
    assert_eq!(bench.read(stream(DMA2, 0) + 4), 0);
}

// 10.4, 12.1.3 table 62
#[test]
fn each_stream_has_an_interrupt_that_its_flags_raise() {
    let mut bench = exchange(4);
    bench.wait(4 * BYTE);
    assert!(bench.requests(56) && bench.requests(59));
    bench.write(DMA2 + LIFCR, TCIF);
    assert!(!bench.requests(56) && bench.requests(59));
}

// 10.5.1: HTIF
#[test]
fn half_way_htif_is_set() {
    let mut bench = exchange(4);
    bench.wait(2 * BYTE - 1);
    assert_eq!(bench.read(DMA2 + LISR) & HTIF, 0);
    bench.wait(1);
    assert_eq!(bench.read(DMA2 + LISR) & HTIF, HTIF);
    assert_eq!(bench.read(stream(DMA2, 0) + 4), 2);
}

// 10.5.1 to 10.5.4
#[test]
fn flags_of_streams_4_to_7_lie_in_the_high_registers() {
    let mut bench = spi();
    set_up(
        &mut bench,
        stream(DMA2, 5),
        SPI_DR,
        SOURCE,
        1,
        SPI_CHANNEL | TO_PERIPHERAL,
    );
    assert_eq!(bench.read(DMA2 + HISR) >> 6 & (HTIF | TCIF), HTIF | TCIF);
    bench.write(DMA2 + HIFCR, 0x3D << 6);
    assert_eq!(bench.read(DMA2 + HISR), 0);
}

// 10.3.7
#[test]
fn without_minc_the_same_place_is_used_again() {
    let mut bench = spi();
    bench.set_bytes(SOURCE, &[7, 8, 9]);
    set_up(
        &mut bench,
        stream(DMA2, 3),
        SPI_DR,
        SOURCE,
        3,
        SPI_CHANNEL | TO_PERIPHERAL,
    );
    bench.write(SPI_CR1, SPI_ENABLED);
    bench.wait(3 * BYTE);
    let bytes: Vec<u8> = bench.board.wiring.exchanged.iter().map(|byte| byte.1).collect();
    assert_eq!(bytes, [7, 7, 7]);
}

// 10.3.8
#[test]
fn a_circular_stream_begins_again_by_itself() {
    let mut bench = serial();
    let circular = USART3_CHANNEL | MINC | CIRC | HTIE | TCIE;
    set_up(&mut bench, stream(DMA1, 1), USART3 + DR, TARGET, 4, circular);
    for byte in 0..6 {
        bench.plan_byte(FRAME * u64::from(byte), Usart(3), byte);
    }
    bench.wait(6 * FRAME);
    assert_eq!(bench.bytes(TARGET, 4), [4, 5, 2, 3]);
    assert_eq!(bench.read(stream(DMA1, 1) + 4), 2);
    assert_eq!(bench.read(stream(DMA1, 1)) & EN, EN);
    assert_eq!(bench.read(DMA1 + LISR) >> 6, HTIF | TCIF);
}

// 10.3.8, 10.5.6: NDTR is reloaded when the stream is enabled again
#[test]
fn a_ring_that_is_stopped_and_enabled_again_begins_at_its_beginning() {
    let mut bench = serial();
    let ring = USART3_CHANNEL | MINC | CIRC;
    set_up(&mut bench, stream(DMA1, 1), USART3 + DR, TARGET, 4, ring);
    for byte in 1..=9 {
        bench.plan_byte(FRAME * u64::from(byte), Usart(3), byte);
    }
    bench.wait(3 * FRAME);
    bench.write(stream(DMA1, 1), ring);
    assert_eq!(bench.read(stream(DMA1, 1) + 4), 1, "what is left can be read");
    bench.write(DMA1 + LIFCR, 0x3F << 6);
    bench.write(stream(DMA1, 1), ring | EN);
    bench.wait(6 * FRAME);
    assert_eq!(bench.bytes(TARGET, 4), [8, 9, 6, 7]);
    assert_eq!(bench.read(stream(DMA1, 1) + 4), 2);
}

// 10.3.9
#[test]
fn with_two_buffers_each_is_filled_in_turn() {
    let mut bench = serial();
    bench.write(stream(DMA1, 1) + 0x10, TARGET + 16);
    let double = USART3_CHANNEL | MINC | DBM | CIRC;
    set_up(&mut bench, stream(DMA1, 1), USART3 + DR, TARGET, 2, double);
    for byte in 0..5 {
        bench.plan_byte(FRAME * u64::from(byte), Usart(3), byte);
    }
    bench.wait(5 * FRAME);
    assert_eq!(bench.bytes(TARGET, 2), [4, 1]);
    assert_eq!(bench.bytes(TARGET + 16, 2), [2, 3]);
}

// 30.3.13
#[test]
fn a_serial_port_transmits_by_dma_from_flash() {
    let mut bench = serial();
    bench.set_bytes(FLASH_START + 0x1000, b"ULog");
    let transmit = USART3_CHANNEL | MINC | TO_PERIPHERAL | TCIE;
    set_up(
        &mut bench,
        stream(DMA1, 3),
        USART3 + DR,
        FLASH_START + 0x1000,
        4,
        transmit,
    );
    bench.wait(4 * FRAME);
    let bytes: Vec<u8> = bench.board.wiring.sent.iter().map(|sent| sent.2).collect();
    assert_eq!(bytes, b"ULog");
    assert!(bench.requests(14));
}

// 10.3.12: direct mode
#[test]
fn in_direct_mode_the_first_item_is_fetched_when_the_stream_is_enabled() {
    let mut bench = serial();
    bench.write(USART3 + CR3, 0);
    bench.set_bytes(SOURCE, &[1, 2]);
    let transmit = USART3_CHANNEL | MINC | TO_PERIPHERAL;
    set_up(&mut bench, stream(DMA1, 3), USART3 + DR, SOURCE, 2, transmit);
    bench.set_bytes(SOURCE, &[8, 9]);
    bench.write(USART3 + CR3, 1 << 7);
    bench.wait(2 * FRAME);
    let bytes: Vec<u8> = bench.board.wiring.sent.iter().map(|sent| sent.2).collect();
    assert_eq!(bytes, [1, 9]);
}

// 10.3.12: FIFO threshold
#[test]
fn the_fifo_is_stored_when_it_reaches_its_threshold() {
    let mut bench = serial();
    bench.write(stream(DMA1, 1) + 0x14, DMDIS);
    let receive = USART3_CHANNEL | MINC | MSIZE_32;
    set_up(&mut bench, stream(DMA1, 1), USART3 + DR, TARGET, 8, receive);
    for byte in 1..=5 {
        bench.plan_byte(FRAME * u64::from(byte), Usart(3), byte);
    }
    bench.wait(3 * FRAME);
    assert_eq!(bench.bytes(TARGET, 4), [0; 4]);
    bench.wait(2 * FRAME);
    assert_eq!(bench.bytes(TARGET, 8), [1, 2, 3, 4, 0, 0, 0, 0]);
}

// 10.3.14
#[test]
fn a_stream_that_is_disabled_stores_what_it_has_and_sets_tcif() {
    let mut bench = serial();
    bench.write(stream(DMA1, 1) + 0x14, DMDIS | 3);
    let receive = USART3_CHANNEL | MINC;
    set_up(&mut bench, stream(DMA1, 1), USART3 + DR, TARGET, 8, receive);
    bench.plan_byte(1, Usart(3), 5);
    bench.wait(1);
    bench.write(stream(DMA1, 1), receive);
    assert_eq!(bench.bytes(TARGET, 1), [5]);
    assert_eq!(bench.read(DMA1 + LISR) >> 6 & TCIF, TCIF);
    assert_eq!(bench.read(stream(DMA1, 1) + 4), 7);
}

// 10.3.10
#[test]
fn the_memory_s_size_may_differ_from_the_peripheral_s_with_the_fifo() {
    let mut bench = serial();
    bench.set_bytes(SOURCE, &[1, 2, 3, 4]);
    bench.write(stream(DMA1, 3) + 0x14, DMDIS | 1);
    let transmit = USART3_CHANNEL | MINC | TO_PERIPHERAL | MSIZE_16;
    set_up(&mut bench, stream(DMA1, 3), USART3 + DR, SOURCE, 4, transmit);
    bench.wait(4 * FRAME);
    let bytes: Vec<u8> = bench.board.wiring.sent.iter().map(|sent| sent.2).collect();
    assert_eq!(bytes, [1, 2, 3, 4]);
}

// 10.3.4
#[test]
fn of_two_streams_that_wait_the_one_of_higher_priority_goes_first() {
    // Both serve SPI's transmit request; a byte each, the second stream with higher priority.
    let mut bench = spi();
    bench.write(SPI_CR2, 0);
    bench.set_bytes(SOURCE, &[1, 2]);
    let transmit = SPI_CHANNEL | TO_PERIPHERAL;
    set_up(&mut bench, stream(DMA2, 3), SPI_DR, SOURCE, 1, transmit);
    set_up(
        &mut bench,
        stream(DMA2, 5),
        SPI_DR,
        SOURCE + 1,
        1,
        transmit | 1 << 16,
    );
    bench.write(SPI_CR1, SPI_ENABLED);
    bench.write(SPI_CR2, 2);
    bench.wait(2 * BYTE);
    let bytes: Vec<u8> = bench.board.wiring.exchanged.iter().map(|byte| byte.1).collect();
    assert_eq!(bytes, [2, 1]);
}

// 18.4.4: UDE
#[test]
fn a_timer_s_update_moves_compare_values() {
    let mut bench = Bench::powered();
    bench.set_bytes(SOURCE, &[10, 0, 20, 0, 30, 0]);
    bench.write(TIM3 + TIM_ARR, 99);
    let update = 5 << 25 | TO_PERIPHERAL | MINC | PSIZE_16 | MSIZE_16;
    set_up(&mut bench, stream(DMA1, 2), TIM3 + TIM_CCR1, SOURCE, 3, update);
    bench.write(TIM3 + TIM_DIER, 1 << 8);
    bench.write(TIM3 + TIM_CR1, 1);
    for value in [0, 10, 20, 30] {
        assert_eq!(bench.read(TIM3 + TIM_CCR1), value);
        bench.wait(100 * 21);
    }
}

// 10.3.7
#[test]
fn with_pinc_the_peripheral_s_registers_are_used_in_turn() {
    let mut bench = Bench::powered();
    bench.set_bytes(SOURCE, &[1, 0, 0, 0, 2, 0, 0, 0]);
    let update = 5 << 25 | TO_PERIPHERAL | MINC | PINC | 2 << 11 | MSIZE_32;
    set_up(&mut bench, stream(DMA1, 2), TIM3 + TIM_CCR1, SOURCE, 2, update);
    bench.write(TIM3 + TIM_DIER, 1 << 8);
    bench.write(TIM3 + TIM_EGR, 1);
    bench.write(TIM3 + TIM_EGR, 1);
    assert_eq!(bench.read(TIM3 + TIM_CCR1), 1);
    assert_eq!(bench.read(TIM3 + TIM_CCR2), 2);
}
