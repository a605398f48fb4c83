//! Counting, flags and interrupts of the timers: RM0090 chapters 17 to 20.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::machine::Bus;

const CEN: u32 = 1;
const UDIS: u32 = 1 << 1;
const URS: u32 = 1 << 2;
const OPM: u32 = 1 << 3;
const ARPE: u32 = 1 << 7;
const UIF: u32 = 1;
const CC1IF: u32 = 2;
const CC2IF: u32 = 4;
const UG: u32 = 1;
/// Ticks in a cycle, at 16 MHz.
const CYCLE: u64 = 21;
const TIM3_INTERRUPT: u32 = 29;

/// TIM3 with a reload value in force, and no flags.
fn reloading(reload: u32) -> Bench {
    let mut bench = Bench::powered();
    bench.write(TIM3 + TIM_ARR, reload);
    bench
}

fn start(bench: &mut Bench) {
    bench.modify(TIM3 + TIM_CR1, |cr1| cr1 | CEN);
}

// 18.3.2: upcounting mode
#[test]
fn the_counter_counts_to_the_reload_value_and_restarts_from_zero_with_an_update() {
    let mut bench = reloading(9);
    start(&mut bench);
    bench.wait(9 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 9);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, 0);
    bench.wait(CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, UIF);
}

// 18.3.1: prescaler
#[test]
fn the_prescaler_divides_by_its_value_plus_one_after_an_update() {
    let mut bench = reloading(999);
    bench.write(TIM3 + TIM_PSC, 9);
    start(&mut bench);
    bench.wait(50 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 50);
    bench.write(TIM3 + TIM_EGR, UG);
    bench.wait(50 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 5);
}

// 18.3.1
#[test]
fn without_preload_a_reload_value_takes_effect_at_once() {
    let mut bench = reloading(99);
    start(&mut bench);
    bench.wait(5 * CYCLE);
    bench.write(TIM3 + TIM_ARR, 9);
    bench.wait(5 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
}

// 18.3.1
#[test]
fn a_reload_value_with_preload_takes_effect_at_the_next_update() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_CR1, ARPE);
    start(&mut bench);
    bench.write(TIM3 + TIM_ARR, 19);
    assert_eq!(bench.read(TIM3 + TIM_ARR), 19);
    bench.wait(10 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
    bench.wait(15 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 15);
}

// 18.3.2
#[test]
fn a_count_beyond_the_reload_value_runs_to_the_top_without_an_update() {
    let mut bench = reloading(99);
    start(&mut bench);
    bench.write(TIM3 + TIM_CNT, 0xFFF0);
    bench.wait(0x10 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, 0);
}

// 18.4.12
#[test]
fn a_reload_value_of_zero_blocks_the_counter() {
    let mut bench = reloading(0);
    start(&mut bench);
    bench.wait(1000 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
    assert_eq!(bench.read(TIM3 + TIM_SR), 0);
}

// 18.2
#[test]
fn tim2_counts_32_bits_and_tim3_16() {
    let mut bench = Bench::powered();
    for (timer, top) in [(TIM2, 0xFFFF_FFFF), (TIM3, 0xFFFF)] {
        assert_eq!(bench.read(timer + TIM_ARR), top);
        bench.write(timer + TIM_CR1, CEN);
        bench.write(timer + TIM_CNT, top - 1);
        bench.wait(CYCLE);
        assert_eq!(bench.read(timer + TIM_CNT), top);
        bench.wait(CYCLE);
        assert_eq!(bench.read(timer + TIM_CNT), 0);
    }
}

// 18.4.6: UG
#[test]
fn an_update_by_software_restarts_counter_and_prescaler() {
    let mut bench = reloading(999);
    start(&mut bench);
    bench.wait(50 * CYCLE + 7);
    bench.write(TIM3 + TIM_EGR, UG);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, UIF);
    bench.wait(CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 1);
}

// 18.4.1: URS
#[test]
fn with_urs_an_update_by_software_sets_no_flag() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_CR1, URS);
    bench.write(TIM3 + TIM_EGR, UG);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, 0);
    start(&mut bench);
    bench.wait(10 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, UIF);
}

// 18.4.1: UDIS
#[test]
fn with_udis_there_is_no_update_and_preloads_wait() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_CR1, UDIS);
    bench.write(TIM3 + TIM_PSC, 1);
    start(&mut bench);
    bench.wait(15 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, 0);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 5);
}

// 18.3.10, 18.4.1: OPM
#[test]
fn in_one_pulse_mode_the_counter_stops_at_the_update() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_CR1, OPM);
    start(&mut bench);
    bench.wait(25 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CR1), OPM);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 0);
    assert_eq!(bench.read(TIM3 + TIM_SR) & UIF, UIF);
}

// 18.4.5
#[test]
fn flags_are_cleared_by_writing_zero_and_kept_by_writing_one() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_EGR, UG | CC1IF);
    bench.write(TIM3 + TIM_SR, !UIF);
    assert_eq!(bench.read(TIM3 + TIM_SR), CC1IF);
}

// 18.4.4: UIE
#[test]
fn an_update_raises_the_interrupt_where_it_is_enabled() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_DIER, 1);
    start(&mut bench);
    assert_eq!(bench.board.next_event(), 10 * CYCLE);
    bench.wait(10 * CYCLE);
    assert!(bench.requests(TIM3_INTERRUPT));
    bench.write(TIM3 + TIM_SR, 0);
    assert!(!bench.requests(TIM3_INTERRUPT));
    assert_eq!(bench.board.next_event(), 20 * CYCLE);
}

// 18.3.8
#[test]
fn a_match_sets_the_channel_s_flag_and_raises_its_interrupt() {
    let mut bench = reloading(99);
    bench.write(TIM3 + TIM_CCR2, 40);
    bench.write(TIM3 + TIM_DIER, CC2IF);
    start(&mut bench);
    assert_eq!(bench.board.next_event(), 40 * CYCLE);
    bench.wait(40 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & (CC1IF | CC2IF), CC2IF);
    assert!(bench.requests(TIM3_INTERRUPT));
}

// 18.4.5: CC1IF
#[test]
fn a_compare_value_above_the_reload_value_matches_at_the_overflow() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_CCR1, 50);
    start(&mut bench);
    bench.wait(9 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, 0);
    bench.wait(CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, CC1IF);
}

// 18.3.8
#[test]
fn a_compare_value_of_zero_matches_as_the_counter_restarts() {
    let mut bench = reloading(9);
    start(&mut bench);
    bench.wait(9 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, 0);
    bench.wait(CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, CC1IF);
}

// 18.3.8
#[test]
fn a_compare_value_that_has_passed_matches_in_the_next_period() {
    let mut bench = reloading(99);
    bench.write(TIM3 + TIM_DIER, CC1IF);
    start(&mut bench);
    bench.wait(50 * CYCLE);
    bench.write(TIM3 + TIM_CCR1, 40);
    bench.wait(89 * CYCLE);
    assert!(!bench.requests(TIM3_INTERRUPT));
    bench.wait(CYCLE);
    assert!(bench.requests(TIM3_INTERRUPT));
}

// 18.3.8: OCxPE
#[test]
fn without_preload_a_compare_value_takes_effect_at_once() {
    let mut bench = reloading(99);
    bench.write(TIM3 + TIM_CCR1, 80);
    start(&mut bench);
    bench.wait(10 * CYCLE);
    bench.write(TIM3 + TIM_CCR1, 20);
    bench.wait(10 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, CC1IF);
}

// 18.3.8: OCxPE
#[test]
fn a_compare_value_with_preload_takes_effect_at_the_next_update() {
    let mut bench = reloading(99);
    bench.write(TIM3 + TIM_CCMR1, 1 << 3);
    bench.write(TIM3 + TIM_CCR1, 80);
    bench.write(TIM3 + TIM_EGR, UG);
    start(&mut bench);
    bench.write(TIM3 + TIM_CCR1, 20);
    bench.wait(79 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, 0);
    bench.wait(CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, CC1IF);
    bench.write(TIM3 + TIM_SR, 0);
    bench.wait(40 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_SR) & CC1IF, CC1IF);
}

// 18.4.6: CC1G
#[test]
fn software_can_set_a_channel_s_flag() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_EGR, CC2IF);
    assert_eq!(bench.read(TIM3 + TIM_SR), CC2IF);
}

// 18.3.2
#[test]
fn periods_that_nobody_watched_are_counted() {
    let mut bench = reloading(9);
    bench.write(TIM3 + TIM_CCR1, 5);
    start(&mut bench);
    bench.wait(1_000_000_007 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 7);
    assert_eq!(bench.read(TIM3 + TIM_SR) & (UIF | CC1IF), UIF | CC1IF);
}

// 18.4.1: CEN
#[test]
fn a_counter_that_is_stopped_keeps_its_count() {
    let mut bench = reloading(99);
    start(&mut bench);
    bench.wait(42 * CYCLE);
    bench.write(TIM3 + TIM_CR1, 0);
    bench.wait(42 * CYCLE);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 42);
}

// 12.1.3, table 62
#[test]
fn an_advanced_timer_has_an_interrupt_for_updates_and_one_for_matches() {
    let mut bench = Bench::powered();
    bench.write(TIM1 + TIM_DIER, 3);
    bench.write(TIM1 + TIM_EGR, UG);
    assert_eq!(bench.board.interrupts(), 1 << 25);
    bench.write(TIM1 + TIM_SR, 0);
    bench.write(TIM1 + TIM_EGR, CC1IF);
    assert_eq!(bench.board.interrupts(), 1 << 27);
}

// 20.3
#[test]
fn a_basic_timer_gives_updates() {
    let mut bench = Bench::powered();
    bench.write(TIM6 + TIM_ARR, 15_999);
    bench.write(TIM6 + TIM_DIER, 1);
    bench.write(TIM6 + TIM_CR1, CEN);
    bench.wait(16_000 * CYCLE);
    assert!(bench.requests(54));
}

#[test]
fn what_the_firmware_does_not_use_is_refused() {
    for (register, value, words) in [
        (TIM_CR1, 1 << 4, "counting up"),
        (TIM_CR1, 1 << 5, "counting up"),
        (0x08, 7, "slave modes"),
        (TIM_CCMR1, 1, "input capture"),
        (TIM_DIER, 1 << 6, "trigger"),
        (TIM_EGR, 1 << 6, "trigger"),
        (0x4C, 1, "bursts"),
    ] {
        assert_says(&Bench::powered().refused(TIM3 + register, value), words);
    }
    assert_says(&Bench::powered().refused(TIM1 + 0x30, 1), "repetition");
    assert_says(&Bench::powered().refused(TIM1 + TIM_BDTR, 10), "dead time");
}
