//! The independent watchdog: RM0090 chapter 21.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::board::ResetCause;
use windhover_hil::machine::Bus;
use windhover_hil::time::{NEVER, SECOND};

const UNLOCK: u32 = 0x5555;
const RELOAD: u32 = 0xAAAA;
const START: u32 = 0xCCCC;
/// A cycle of the oscillator of 32 kHz.
const CYCLE: u64 = SECOND / 32_000;

/// 250 ms: 250 counts of 32 cycles.
fn quarter_second() -> Bench {
    let mut bench = Bench::new();
    bench.write(IWDG_KR, UNLOCK);
    bench.write(IWDG_PR, 3);
    bench.write(IWDG_RLR, 250);
    bench.write(IWDG_KR, START);
    bench.write(IWDG_KR, RELOAD);
    bench
}

// 21.3
#[test]
fn it_resets_when_it_is_not_fed_in_time() {
    let mut bench = quarter_second();
    bench.wait(SECOND / 4 - 1);
    assert_eq!(bench.board.take_reset(), None);
    bench.wait(1);
    assert_eq!(bench.board.take_reset(), Some(ResetCause::IndependentWatchdog));
    assert_eq!(bench.board.take_reset(), None);
}

// 21.3
#[test]
fn feeding_it_starts_the_time_again() {
    let mut bench = quarter_second();
    for _ in 0..10 {
        bench.wait(SECOND / 5);
        bench.write(IWDG_KR, RELOAD);
    }
    assert_eq!(bench.board.take_reset(), None);
}

// 21.3
#[test]
fn it_starts_from_the_highest_count() {
    let mut bench = Bench::new();
    bench.write(IWDG_KR, START);
    bench.wait(0xFFF * 4 * CYCLE - 1);
    assert_eq!(bench.board.take_reset(), None);
    bench.wait(1);
    assert!(bench.board.take_reset().is_some());
}

// 21.4.2
#[test]
fn the_prescaler_divides_by_4_to_256() {
    for prescaler in 0..8 {
        let mut bench = Bench::new();
        bench.write(IWDG_KR, UNLOCK);
        bench.write(IWDG_PR, prescaler);
        bench.write(IWDG_KR, START);
        // Its oscillator starts first.
        bench.wait(SECOND / 1000);
        let division = (4 << prescaler).min(256);
        assert_eq!(bench.board.next_event(), 0xFFF * division * CYCLE);
    }
}

// 21.3.2
#[test]
fn prescaler_and_reload_value_are_protected() {
    let mut bench = Bench::new();
    assert_says(&bench.refused(IWDG_PR, 1), "0x5555");
    bench.write(IWDG_KR, UNLOCK);
    bench.write(IWDG_KR, RELOAD);
    assert_says(&bench.refused(IWDG_RLR, 1), "0x5555");
}

// 21.4.4
#[test]
fn new_values_take_time_to_arrive_and_cannot_be_followed_by_others_before() {
    let mut bench = Bench::new();
    bench.write(IWDG_KR, UNLOCK);
    bench.write(IWDG_PR, 1);
    bench.write(IWDG_RLR, 1);
    assert_eq!(bench.read(IWDG_SR), 3);
    assert_says(&bench.refused(IWDG_PR, 2), "PVU");
    assert_says(&bench.refused(IWDG_RLR, 2), "RVU");
    bench.wait(5 * CYCLE);
    assert_eq!(bench.read(IWDG_SR), 0);
    bench.write(IWDG_PR, 2);
    assert_eq!(bench.read(IWDG_PR), 2);
}

// 7.2.5
#[test]
fn it_keeps_its_oscillator_on() {
    let mut bench = quarter_second();
    bench.wait(SECOND / 8);
    assert_eq!(bench.read(RCC_CSR) & 3, 3);
}

// 21.3
#[test]
fn a_reset_stops_it() {
    let mut bench = quarter_second();
    bench.board.reset(0, ResetCause::Software);
    assert_eq!(bench.board.next_event(), NEVER);
}

// 21.3
#[test]
fn feeding_a_watchdog_that_was_not_started_does_nothing() {
    let mut bench = Bench::new();
    bench.write(IWDG_KR, RELOAD);
    assert_eq!(bench.board.next_event(), NEVER);
}
