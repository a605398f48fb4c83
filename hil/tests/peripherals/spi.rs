//! SPI1 as a master: RM0090 chapter 28.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::board::Pin;
use windhover_hil::machine::Bus;

/// Master, mode 3, PCLK2 / 8, chip select by software, enabled.
const RUNNING: u32 = 1 | 1 << 1 | 1 << 2 | 2 << 3 | 1 << 6 | 1 << 8 | 1 << 9;
const SPE: u32 = 1 << 6;
const RXNE: u32 = 1;
const TXE: u32 = 2;
const OVR: u32 = 1 << 6;
const BSY: u32 = 1 << 7;
/// Eight periods of SCK at PCLK2 / 8, with 21 ticks a cycle.
const BYTE: u64 = 8 * 8 * 21;

fn connected() -> Bench {
    let mut bench = Bench::powered();
    for number in [5, 6, 7] {
        bench.alternate(Pin::new('A', number), 5);
    }
    bench
}

fn running() -> Bench {
    let mut bench = connected();
    bench.write(SPI_CR1, RUNNING);
    bench
}

// 28.3.5
#[test]
fn a_byte_takes_eight_periods_of_the_clock() {
    let mut bench = running();
    bench.write(SPI_DR, 0x75);
    bench.wait(BYTE - 1);
    assert_eq!(bench.read(SPI_SR), TXE | BSY);
    bench.wait(1);
    assert_eq!(bench.read(SPI_SR), TXE | RXNE);
    assert_eq!(bench.board.wiring.exchanged, [(BYTE, 0x75)]);
    assert_eq!(bench.read(SPI_DR), 0x8A);
}

// 28.5.1: BR
#[test]
fn the_baud_rate_divides_the_bus_s_clock_by_powers_of_two() {
    for rate in 0..8 {
        let mut bench = connected();
        bench.write(SPI_CR1, RUNNING & !(7 << 3) | rate << 3);
        bench.write(SPI_DR, 0);
        assert_eq!(bench.board.next_event(), 8 * 21 * (2 << rate));
    }
}

// 28.3.7
#[test]
fn txe_is_set_when_the_buffer_has_room() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    assert_eq!(bench.read(SPI_SR) & TXE, TXE);
    bench.write(SPI_DR, 2);
    assert_eq!(bench.read(SPI_SR) & TXE, 0);
    bench.wait(BYTE);
    assert_eq!(bench.read(SPI_SR) & TXE, TXE);
}

// 28.3.5
#[test]
fn a_byte_that_waits_follows_at_once() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    bench.write(SPI_DR, 2);
    bench.wait(2 * BYTE);
    assert_eq!(bench.board.wiring.exchanged, [(BYTE, 1), (2 * BYTE, 2)]);
}

// 28.3.7
#[test]
fn rxne_is_cleared_by_reading_data() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    bench.wait(BYTE);
    bench.read(SPI_DR);
    assert_eq!(bench.read(SPI_SR), TXE);
}

// 28.3.10
#[test]
fn a_byte_that_comes_before_the_last_was_read_is_lost_and_flagged() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    bench.write(SPI_DR, 2);
    bench.wait(2 * BYTE);
    assert_eq!(bench.read(SPI_SR), TXE | RXNE | OVR);
    assert_eq!(bench.read(SPI_DR), 0xFE);
}

// 28.3.10
#[test]
fn an_overrun_is_cleared_by_reading_data_and_then_status() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    bench.write(SPI_DR, 2);
    bench.wait(2 * BYTE);
    bench.read(SPI_SR);
    assert_eq!(bench.read(SPI_SR) & OVR, OVR);
    bench.read(SPI_DR);
    bench.read(SPI_SR);
    assert_eq!(bench.read(SPI_SR) & OVR, 0);
}

// 28.3.11
#[test]
fn each_flag_raises_the_interrupt_where_it_is_enabled() {
    const SPI: u32 = 35;
    let mut bench = running();
    bench.write(SPI_CR2, 1 << 7);
    assert!(bench.requests(SPI));
    bench.write(SPI_CR2, 1 << 6);
    assert!(!bench.requests(SPI));
    bench.write(SPI_DR, 1);
    bench.write(SPI_DR, 2);
    bench.wait(BYTE);
    assert!(bench.requests(SPI));
    bench.write(SPI_CR2, 1 << 5);
    assert!(!bench.requests(SPI));
    bench.wait(BYTE);
    assert!(bench.requests(SPI));
}

// 28.3.5
#[test]
fn a_byte_written_before_it_is_enabled_goes_out_afterwards() {
    let mut bench = connected();
    bench.write(SPI_DR, 0x42);
    bench.wait(10 * BYTE);
    bench.write(SPI_CR1, RUNNING);
    bench.wait(BYTE);
    assert_eq!(bench.board.wiring.exchanged, [(11 * BYTE, 0x42)]);
}

// 28.3.7: TXE
#[test]
fn a_byte_written_over_one_that_waits_is_refused() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    bench.write(SPI_DR, 2);
    assert_says(&bench.refused(SPI_DR, 3), "before TXE");
}

// 28.3.8
#[test]
fn it_is_not_disabled_in_the_middle_of_a_byte() {
    let mut bench = running();
    bench.write(SPI_DR, 1);
    assert_says(&bench.refused(SPI_CR1, RUNNING & !SPE), "middle of a byte");
    bench.wait(BYTE);
    bench.write(SPI_CR1, RUNNING & !SPE);
}

// 28.5.1
#[test]
fn mode_and_baud_rate_do_not_change_while_it_is_enabled() {
    let mut bench = running();
    assert_says(&bench.refused(SPI_CR1, RUNNING ^ 1), "while it is enabled");
    assert_says(&bench.refused(SPI_CR1, RUNNING ^ 1 << 4), "while it is enabled");
}

// 28.3.10: MODF
#[test]
fn a_master_that_is_deselected_by_software_has_a_mode_fault() {
    assert_says(&connected().refused(SPI_CR1, RUNNING & !(1 << 8)), "MODF");
}

#[test]
fn what_a_master_on_the_boards_does_not_use_is_refused() {
    for (bits, words) in [
        (RUNNING | 1 << 7, "LSBFIRST"),
        (RUNNING | 1 << 10, "RXONLY"),
        (RUNNING | 1 << 11, "16 bits"),
        (RUNNING | 1 << 13, "CRCEN"),
        (RUNNING | 1 << 15, "BIDIMODE"),
        (RUNNING & !(1 << 2), "slave mode"),
        (RUNNING & !(1 << 9), "by hardware"),
    ] {
        assert_says(&connected().refused(SPI_CR1, bits), words);
    }
    assert_says(&connected().refused(SPI_CR2, 1 << 4), "TI mode");
    assert_says(&connected().refused(SPI1 + 0x1C, 1 << 11), "I2S");
}

// 8.3.2
#[test]
fn a_byte_without_its_pins_is_refused_by_the_pins_that_could_carry_it() {
    let mut bench = Bench::powered();
    bench.write(SPI_CR1, RUNNING);
    assert_says(&bench.refused(SPI_DR, 1), "SPI1: no pin is switched to SCK");
    let mut bench = connected();
    bench.alternate(Pin::new('A', 7), 2);
    bench.write(SPI_CR1, RUNNING);
    assert_says(
        &bench.refused(SPI_DR, 1),
        "MOSI: it takes PA7 in AF5 or PB5 in AF5",
    );
    let mut bench = connected();
    bench.mode(Pin::new('A', 6), 0);
    bench.write(SPI_CR1, RUNNING);
    assert_says(&bench.refused(SPI_DR, 1), "MISO");
}
