//! What a reset does: RM0090 7.1, and 7.3.21 for the flags.

use super::bench::Bench;
use super::registers::*;
use windhover_hil::board::{Pin, ResetCause};
use windhover_hil::machine::Bus;
use windhover_hil::time::NEVER;

const RMVF: u32 = 1 << 24;
const PINRSTF: u32 = 1 << 26;
const PORRSTF: u32 = 1 << 27;
const SFTRSTF: u32 = 1 << 28;
const IWDGRSTF: u32 = 1 << 29;

#[test]
fn each_cause_sets_its_flag_and_that_of_the_pin() {
    for (cause, flags) in [
        (ResetCause::Pin, PINRSTF),
        (ResetCause::Software, SFTRSTF | PINRSTF),
        (ResetCause::IndependentWatchdog, IWDGRSTF | PINRSTF),
    ] {
        let mut bench = Bench::new();
        bench.write(RCC_CSR, RMVF);
        assert_eq!(bench.read(RCC_CSR), 0);
        bench.board.reset(bench.now, cause);
        assert_eq!(bench.read(RCC_CSR), flags);
    }
}

#[test]
fn flags_stay_until_they_are_removed() {
    let mut bench = Bench::new();
    bench.board.reset(0, ResetCause::Software);
    assert_ne!(bench.read(RCC_CSR) & PORRSTF, 0);
    assert_ne!(bench.read(RCC_CSR) & SFTRSTF, 0);
}

#[test]
fn power_on_clears_the_flags_of_other_causes() {
    let mut bench = Bench::new();
    bench.board.reset(0, ResetCause::Software);
    bench.board.reset(0, ResetCause::PowerOn);
    assert_eq!(bench.read(RCC_CSR), 0x0E00_0000);
}

#[test]
fn the_clock_is_the_internal_oscillator_again() {
    let mut bench = Bench::fast();
    bench.board.reset(bench.now, ResetCause::Software);
    assert_eq!(bench.board.ticks_per_cycle(), 21);
    assert_eq!(bench.read(RCC_CR), 0x83);
    assert_eq!(bench.board.next_event(), NEVER);
}

#[test]
fn peripherals_have_their_reset_values_and_no_clock() {
    let mut bench = Bench::powered();
    bench.write(SPI_CR2, 3);
    bench.board.reset(0, ResetCause::Software);
    assert!(bench.try_read(SPI_CR2).is_err());
    bench.write(RCC_APB2ENR, 1 << 12);
    assert_eq!(bench.read(SPI_CR2), 0);
}

#[test]
fn the_backup_domain_outlives_all_but_power_on() {
    let mut bench = Bench::powered();
    bench.write(PWR_CR, 1 << 14 | 1 << 8);
    bench.write(BKP0R, 42);
    bench.write(RCC_BDCR, 2 << 8);
    bench.board.reset(0, ResetCause::IndependentWatchdog);
    assert_eq!((bench.read(BKP0R), bench.read(RCC_BDCR)), (42, 2 << 8));
    bench.board.reset(0, ResetCause::PowerOn);
    assert_eq!((bench.read(BKP0R), bench.read(RCC_BDCR)), (0, 0));
}

#[test]
fn what_the_outside_drives_is_still_driven() {
    let mut bench = Bench::powered();
    bench.plan_level(1, Pin::new('C', 4), true);
    bench.wait(1);
    bench.board.reset(bench.now, ResetCause::Pin);
    bench.write(RCC_AHB1ENR, 1 << 2);
    assert_eq!(bench.read(GPIOC + IDR), 1 << 4);
}

#[test]
fn interrupts_are_no_longer_requested() {
    let mut bench = Bench::powered();
    bench.write(TIM6 + TIM_DIER, 1);
    bench.write(TIM6 + TIM_EGR, 1);
    assert!(bench.requests(54));
    bench.board.reset(bench.now, ResetCause::Software);
    assert_eq!(bench.board.interrupts(), 0);
}
