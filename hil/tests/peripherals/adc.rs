//! The converter ADC1: RM0090 chapter 13.

use super::bench::{Bench, assert_says};
use super::dma::{CIRC, EN, HTIE, HTIF, MINC, MSIZE_16, PSIZE_16, TARGET, TCIE, TCIF, set_up, stream};
use super::registers::*;
use windhover_hil::board::Pin;
use windhover_hil::machine::Bus;
use windhover_hil::time::MICROSECOND;

const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const OVR: u32 = 1 << 5;
const EOCIE: u32 = 1 << 5;
const SCAN: u32 = 1 << 8;
const OVRIE: u32 = 1 << 26;
const ADON: u32 = 1 << 0;
const CONT: u32 = 1 << 1;
const DMA: u32 = 1 << 8;
const DDS: u32 = 1 << 9;
const EOCS: u32 = 1 << 10;
const SWSTART: u32 = 1 << 30;
const INTERRUPT: u32 = 18;

/// 16 MHz by 2: 42 ticks a cycle. 480 cycles of sampling and 12 bits.
const SLOW: u64 = 492 * 42;
/// 3 cycles of sampling.
const QUICK: u64 = 15 * 42;

/// On and stable, PC0 (480 cycles) and PC1 (3 cycles) in sequence.
fn ready() -> Bench {
    let mut bench = Bench::powered();
    for pin in 0..2 {
        bench.mode(Pin::new('C', pin), 3);
    }
    bench.write(ADC_CR2, ADON);
    bench.wait(3 * MICROSECOND);
    bench.write(ADC_SMPR1, 7);
    bench.write(ADC_SQR1, 1 << 20);
    bench.write(ADC_SQR3, 10 | 11 << 5);
    bench.write(ADC_CR1, SCAN);
    bench
}

/// A ring of so many results at [`TARGET`] is filled by DMA, as drivers do it.
fn ring(count: u32) -> Bench {
    let mut bench = ready();
    let control = PSIZE_16 | MSIZE_16 | MINC | CIRC | TCIE | HTIE;
    set_up(&mut bench, stream(DMA2, 4), ADC_DR, TARGET, count, control);
    bench.write(ADC_CR2, ADON | CONT | DMA | DDS | EOCS);
    bench.modify(ADC_CR2, |cr2| cr2 | SWSTART);
    bench
}

fn results(bench: &mut Bench, count: usize) -> Vec<u16> {
    let bytes = bench.bytes(TARGET, 2 * count);
    bytes
        .chunks(2)
        .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
        .collect()
}

// 13.3.5, 13.5
#[test]
fn one_conversion_takes_its_sampling_and_twelve_cycles() {
    let mut bench = ready();
    bench.write(ADC_SQR1, 0);
    bench.write(ADC_CR2, ADON | SWSTART);
    assert_eq!(bench.read(ADC_CR2), ADON, "the hardware clears SWSTART");
    assert_eq!(bench.read(ADC_SR), STRT);
    bench.wait(SLOW - 1);
    assert_eq!(bench.read(ADC_SR), STRT);
    bench.wait(1);
    assert_eq!(bench.read(ADC_SR), STRT | EOC);
    assert_eq!(bench.read(ADC_DR), 0x100);
    assert_eq!(bench.read(ADC_SR), STRT);
    bench.wait(10 * SLOW);
    assert_eq!(bench.board.wiring.converted.len(), 1);
}

// 13.3.3, 13.13.15: ADCPRE
#[test]
fn its_clock_is_the_bus_s_by_2_to_8() {
    for divider in [2, 4, 6, 8] {
        let mut bench = ready();
        bench.write(ADC_CCR, (divider as u32 / 2 - 1) << 16);
        bench.write(ADC_CR2, ADON | SWSTART);
        assert_eq!(bench.board.next_event() - bench.now, 492 * 21 * divider);
    }
}

// 13.7: RES
#[test]
fn fewer_bits_are_quicker() {
    let mut bench = ready();
    bench.write(ADC_SQR1, 0);
    bench.write(ADC_CR1, 2 << 24);
    bench.write(ADC_CR2, ADON | SWSTART);
    bench.wait(488 * 42);
    assert_eq!(bench.read(ADC_DR), 0x100 >> 4);
}

// 13.3.2, datasheet table 67: tSTAB
#[test]
fn the_first_conversion_waits_until_it_is_stable() {
    let mut bench = ready();
    bench.write(ADC_CR2, 0);
    bench.write(ADC_CR2, ADON);
    bench.write(ADC_CR2, ADON | SWSTART);
    assert_eq!(bench.board.next_event() - bench.now, 3 * MICROSECOND + SLOW);
}

// 13.3.8
#[test]
fn a_scan_converts_its_sequence_in_order() {
    let mut bench = ready();
    bench.write(ADC_CR2, ADON | EOCS);
    let start = bench.now;
    bench.write(ADC_CR2, ADON | EOCS | SWSTART);
    let mut read = vec![];
    for time in [SLOW, QUICK] {
        bench.wait(time);
        read.push(bench.read(ADC_DR));
    }
    assert_eq!(read, [0x100, 0x200]);
    let expected = [
        (start + SLOW, Pin::new('C', 0)),
        (start + SLOW + QUICK, Pin::new('C', 1)),
    ];
    assert_eq!(bench.board.wiring.converted, expected);
}

// 13.3.8: EOCS = 0
#[test]
fn without_eocs_the_end_is_that_of_the_sequence() {
    let mut bench = ready();
    bench.write(ADC_CR2, ADON | SWSTART);
    bench.wait(SLOW);
    assert_eq!(bench.read(ADC_SR) & EOC, 0);
    bench.wait(QUICK);
    assert_eq!(bench.read(ADC_SR) & EOC, EOC);
    assert_eq!(bench.read(ADC_DR), 0x200);
}

// 13.8.1, 10.3.8
#[test]
fn dma_fills_a_ring_round_by_round() {
    let mut bench = ring(8);
    let scan = SLOW + QUICK;
    bench.wait(2 * scan - 1);
    assert_eq!(bench.read(DMA2 + HISR) & HTIF, 0);
    assert_eq!(bench.read(stream(DMA2, 4) + 4), 5);
    bench.wait(1);
    assert_eq!(bench.read(DMA2 + HISR) & (HTIF | TCIF), HTIF);
    bench.wait(2 * scan);
    assert_eq!(bench.read(DMA2 + HISR) & (HTIF | TCIF), HTIF | TCIF);
    let expected = [0x100, 0x200, 0x101, 0x201, 0x102, 0x202, 0x103, 0x203];
    assert_eq!(results(&mut bench, 8), expected);
    bench.wait(scan);
    assert_eq!(bench.read(stream(DMA2, 4) + 4), 6);
    assert_eq!(results(&mut bench, 3), [0x104, 0x204, 0x101]);
    assert_eq!(bench.read(ADC_SR) & OVR, 0);
}

// Conversions that nobody can notice are not events; each still has its own time.
#[test]
fn the_board_looks_up_only_where_a_stream_sets_a_flag() {
    let mut bench = ring(200);
    let start = bench.now;
    let mut events = 0;
    while !bench.requests(60) {
        let next = bench.board.next_event();
        bench.wait(next - bench.now);
        events += 1;
    }
    assert_eq!(bench.now - start, 50 * (SLOW + QUICK));
    assert_eq!(events, 1);
    let times: Vec<u64> = bench
        .board
        .wiring
        .converted
        .iter()
        .map(|(time, _)| *time)
        .collect();
    let apart: Vec<u64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(apart.chunks(2).all(|pair| pair[0] == QUICK));
    assert!(
        apart
            .chunks(2)
            .all(|pair| pair.get(1).is_none_or(|time| *time == SLOW))
    );
}

// 13.8.1: overrun
#[test]
fn a_result_that_nobody_fetches_stops_it() {
    let mut bench = ring(8);
    bench.modify(stream(DMA2, 4), |cr| cr & !EN);
    bench.wait(10 * SLOW);
    assert_eq!(bench.read(ADC_SR) & (EOC | OVR), EOC | OVR);
    assert_eq!(bench.board.wiring.converted.len(), 2);
    bench.write(ADC_CR1, SCAN | OVRIE);
    assert!(bench.requests(INTERRUPT));
    bench.write(ADC_SR, !(OVR | EOC));
    assert!(!bench.requests(INTERRUPT));
    bench.modify(ADC_CR2, |cr2| cr2 | SWSTART);
    bench.wait(SLOW);
    assert_eq!(bench.read(ADC_DR), 0x101, "from the first of the sequence");
}

// 13.11
#[test]
fn the_end_of_a_conversion_raises_the_interrupt() {
    let mut bench = ready();
    bench.write(ADC_CR1, SCAN | EOCIE);
    bench.write(ADC_CR2, ADON | EOCS | SWSTART);
    bench.wait(SLOW);
    assert!(bench.requests(INTERRUPT));
    bench.read(ADC_DR);
    assert!(!bench.requests(INTERRUPT));
}

#[test]
fn what_cannot_be_converted_is_refused() {
    let mut bench = ready();
    bench.write(ADC_CR2, 0);
    assert_says(&bench.refused(ADC_CR2, SWSTART), "while it is off");
    let mut bench = ready();
    bench.write(ADC_CR1, 0);
    assert_says(&bench.refused(ADC_CR2, ADON | SWSTART), "needs SCAN");
    assert_says(&ready().refused(ADC_CR2, ADON | DMA | SWSTART), "without DDS");
    let mut bench = ready();
    bench.mode(Pin::new('C', 0), 0);
    bench.write(ADC_CR2, ADON | SWSTART);
    assert_says(&bench.try_wait(SLOW).unwrap_err().to_string(), "PC0");
    let mut bench = ready();
    bench.write(ADC_SQR3, 17);
    bench.write(ADC_CR2, ADON | SWSTART);
    assert_says(&bench.try_wait(SLOW).unwrap_err().to_string(), "channel 17");
}

#[test]
fn what_the_boards_do_not_use_is_refused() {
    assert_says(&ready().refused(ADC_CR1, 1 << 23), "watchdog");
    assert_says(&ready().refused(ADC_CR2, 1 << 28), "triggers");
    assert_says(&ready().refused(ADC_CCR, 1 << 23), "inner channels");
    assert!(ready().try_read(ADC1 + 0x38).is_err());
    assert!(ready().try_read(ADC1 + 0x100).is_err(), "ADC2");
}
