//! General-purpose input and output: RM0090 chapter 8.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::board::Pin;

const LED: Pin = Pin::new('C', 13);

// 8.4, table 39
#[test]
fn after_reset_the_debug_pins_are_alternate_functions_and_all_others_inputs() {
    let mut bench = Bench::powered();
    assert_eq!(bench.read(GPIOA + MODER), 0xA800_0000);
    assert_eq!(bench.read(GPIOA + PUPDR), 0x6400_0000);
    assert_eq!(bench.read(GPIOB + MODER), 0x0000_0280);
    assert_eq!(bench.read(GPIOB + PUPDR), 0x0000_0100);
    assert_eq!(bench.read(GPIOC + MODER), 0);
}

// 8.3.10
#[test]
fn an_output_drives_its_pin_by_the_output_register() {
    let mut bench = Bench::powered();
    bench.mode(LED, 1);
    bench.write(GPIOC + ODR, 1 << 13);
    assert_eq!(bench.read(GPIOC + IDR), 1 << 13);
    assert_eq!(bench.board.wiring.outputs, [(0, LED, false), (0, LED, true)]);
}

// 8.3.10
#[test]
fn a_pin_that_becomes_an_output_has_the_level_that_was_set_before() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + BSRR, 1 << 13);
    assert_eq!(bench.board.wiring.outputs, []);
    bench.mode(LED, 1);
    assert_eq!(bench.board.wiring.outputs, [(0, LED, true)]);
}

// 8.4.7
#[test]
fn bsrr_sets_by_its_lower_half_and_resets_by_its_upper() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + BSRR, 0x0000_0003);
    bench.write(GPIOC + BSRR, 0x0002_0004);
    assert_eq!(bench.read(GPIOC + ODR), 0x5);
}

// 8.4.7
#[test]
fn where_a_bit_is_set_and_reset_at_once_it_is_set() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + BSRR, 0x0001_0001);
    assert_eq!(bench.read(GPIOC + ODR), 1);
}

// 8.4.7
#[test]
fn bsrr_takes_half_words_and_bytes() {
    let mut bench = Bench::powered();
    bench.write_sized(GPIOC + BSRR, 2, 0x0101);
    bench.write_sized(GPIOC + BSRR + 1, 1, 0x02);
    bench.write_sized(GPIOC + BSRR + 2, 2, 0x0001);
    assert_eq!(bench.read(GPIOC + ODR), 0x0300);
    assert_eq!(bench.read(GPIOC + BSRR), 0);
}

// 8.3.9
#[test]
fn an_input_shows_the_level_outside() {
    let mut bench = Bench::powered();
    bench.plan_level(10, Pin::new('C', 4), true);
    bench.plan_level(20, Pin::new('C', 4), false);
    bench.wait(10);
    assert_eq!(bench.read(GPIOC + IDR), 1 << 4);
    bench.wait(10);
    assert_eq!(bench.read(GPIOC + IDR), 0);
}

// 8.3.9
#[test]
fn a_pull_up_holds_an_input_that_nothing_drives() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + PUPDR, 1 << 8);
    assert_eq!(bench.read(GPIOC + IDR), 1 << 4);
    bench.plan_level(1, Pin::new('C', 4), false);
    bench.wait(1);
    assert_eq!(bench.read(GPIOC + IDR), 0);
}

// 8.3.10
#[test]
fn an_open_drain_output_drives_low_only() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + OTYPER, 1 << 13);
    bench.write(GPIOC + ODR, 1 << 13);
    bench.mode(LED, 1);
    assert_eq!(bench.read(GPIOC + IDR), 0);
    bench.write(GPIOC + PUPDR, 1 << 26);
    assert_eq!(bench.read(GPIOC + IDR), 1 << 13);
    bench.write(GPIOC + ODR, 0);
    assert_eq!(bench.read(GPIOC + IDR), 0);
}

// 8.3.12
#[test]
fn an_analog_pin_reads_as_zero() {
    let mut bench = Bench::powered();
    bench.write(GPIOC + PUPDR, 1 << 8);
    bench.mode(Pin::new('C', 4), 3);
    assert_eq!(bench.read(GPIOC + IDR), 0);
}

// 8.4.5
#[test]
fn idr_can_only_be_read() {
    assert_says(
        &Bench::powered().refused(GPIOC + IDR, 1),
        "GPIOC: IDR can only be read",
    );
}

// 8.3.6, 8.4.8
#[test]
fn a_locked_pin_keeps_its_configuration() {
    let mut bench = Bench::powered();
    for value in [0x1_0010, 0x0_0010, 0x1_0010] {
        bench.write(GPIOC + LCKR, value);
    }
    assert_eq!(bench.read(GPIOC + LCKR), 0x1_0010);
    bench.mode(Pin::new('C', 5), 1);
    bench.write(GPIOC + BSRR, 1 << 4);
    assert_says(&bench.refused(GPIOC + MODER, 1 << 8 | 1 << 10), "locked pin");
}

// 8.4.8
#[test]
fn a_lock_sequence_that_is_interrupted_locks_nothing() {
    let mut bench = Bench::powered();
    for value in [0x1_0010, 0x0_0011, 0x1_0010] {
        bench.write(GPIOC + LCKR, value);
    }
    assert_eq!(bench.read(GPIOC + LCKR), 0);
}

// 7.3.5
#[test]
fn a_port_that_is_reset_no_longer_drives_its_pins() {
    let mut bench = Bench::powered();
    bench.mode(LED, 1);
    bench.write(RCC_AHB1RSTR, 1 << 2);
    bench.write(RCC_AHB1RSTR, 0);
    assert_eq!(bench.read(GPIOC + MODER), 0);
    bench.mode(LED, 1);
    assert_eq!(bench.board.wiring.outputs.len(), 2);
}
