//! Reset and clock control, power control: RM0090 chapters 5 and 7.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::machine::Bus;
use windhover_hil::time::{MICROSECOND, SECOND};

// 7.2.6
#[test]
fn after_reset_the_internal_oscillator_is_the_system_clock() {
    let mut bench = Bench::new();
    assert_eq!(bench.read(RCC_CFGR) & 0xC, 0);
    assert_eq!(bench.board.ticks_per_cycle(), SECOND / 16_000_000);
}

// 7.3.1, 7.3.2, 7.3.10, 7.3.21
#[test]
fn registers_have_their_reset_values() {
    let mut bench = Bench::new();
    assert_eq!(bench.read(RCC_CR), 0x83);
    assert_eq!(bench.read(RCC_PLLCFGR), 0x2400_3010);
    assert_eq!(bench.read(RCC_AHB1ENR), 0x0010_0000);
    assert_eq!(bench.read(RCC_CSR), 0x0E00_0000);
    assert_eq!(bench.read(RCC + 0x50), 0x7E67_91FF);
}

// 7.2.1
#[test]
fn the_crystal_is_ready_some_time_after_it_is_switched_on() {
    let mut bench = Bench::new();
    bench.modify(RCC_CR, |cr| cr | HSEON);
    assert_eq!(bench.read(RCC_CR) & HSERDY, 0);
    bench.wait(3_000 * MICROSECOND);
    assert_ne!(bench.read(RCC_CR) & HSERDY, 0);
}

// 7.2.6
#[test]
fn a_switch_to_a_source_that_is_not_ready_happens_when_it_is() {
    let mut bench = Bench::new();
    bench.modify(RCC_CR, |cr| cr | HSEON);
    bench.write(RCC_CFGR, 1);
    assert_eq!(bench.read(RCC_CFGR) & 0xC, 0);
    bench.wait(3_000 * MICROSECOND);
    assert_eq!(bench.read(RCC_CFGR) & 0xC, 1 << 2);
    assert_eq!(bench.board.ticks_per_cycle(), SECOND / 8_000_000);
}

// 7.2.3, 7.3.2
#[test]
fn the_pll_multiplies_its_divided_input_and_divides_its_output() {
    let bench = Bench::fast();
    assert_eq!(bench.board.ticks_per_cycle(), SECOND / 168_000_000);
}

// 7.3.3
#[test]
fn the_ahb_prescaler_divides_the_processor_s_clock() {
    let mut bench = Bench::fast();
    bench.write(RCC_CFGR, CFGR_168_MHZ | 8 << 4);
    assert_eq!(bench.board.ticks_per_cycle(), 4);
    bench.write(RCC_CFGR, CFGR_168_MHZ | 0xC << 4);
    assert_eq!(bench.board.ticks_per_cycle(), 2 * 64);
}

// 7.2, figure 21
#[test]
fn timers_run_at_twice_their_bus_where_that_is_divided() {
    let mut bench = Bench::fast();
    for (timer, cycle) in [(TIM3, 4), (TIM1, 2)] {
        bench.write(timer + TIM_CR1, 1);
        bench.wait(100 * cycle);
        assert_eq!(bench.read(timer + TIM_CNT), 100);
    }
}

// 7.2, figure 21
#[test]
fn timers_run_with_their_bus_where_that_is_not_divided() {
    let mut bench = Bench::powered();
    bench.write(TIM3 + TIM_CR1, 1);
    bench.wait(100 * 21);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 100);
}

#[test]
fn a_pll_output_that_is_no_whole_number_of_ticks_is_refused() {
    let mut bench = Bench::new();
    // 16 MHz / 16 * 100 / 2.
    bench.write(RCC_PLLCFGR, 16 | 100 << 6);
    assert_says(&bench.refused(RCC_CR, HSION | PLLON), "no whole number");
}

// 7.3.2
#[test]
fn pll_factors_out_of_range_are_refused() {
    for (factors, words) in [
        (1 | 168 << 6, "PLLM = 1"),
        (16 | 40 << 6, "PLLN = 40"),
        (4 | 100 << 6, "1 to 2 MHz"),
        (16 | 50 << 6, "VCO"),
        (8 | 300 << 6, "VCO"),
    ] {
        let mut bench = Bench::new();
        bench.write(RCC_PLLCFGR, factors);
        assert_says(&bench.refused(RCC_CR, HSION | PLLON), words);
    }
}

// 7.3.1: PLLON
#[test]
fn the_pll_needs_its_source_to_be_ready() {
    let mut bench = Bench::new();
    bench.write(RCC_PLLCFGR, PLL_168_MHZ);
    assert_says(
        &bench.refused(RCC_CR, HSION | HSEON | PLLON),
        "before its source is ready",
    );
}

// 7.3.2
#[test]
fn pllcfgr_can_be_written_only_while_the_pll_is_off() {
    let mut bench = Bench::fast();
    assert_says(&bench.refused(RCC_PLLCFGR, PLL_168_MHZ), "while the PLL is on");
}

// 7.3.1: PLLON
#[test]
fn the_source_of_the_system_clock_cannot_be_switched_off() {
    let mut bench = Bench::fast();
    let cr = bench.read(RCC_CR);
    assert_says(&bench.refused(RCC_CR, cr & !PLLON), "switches the PLL off");
    assert_says(&bench.refused(RCC_CR, cr & !HSEON), "switches HSE off");
    bench.write(RCC_CR, cr & !HSION);
}

// 3.5.1, table 10
#[test]
fn a_clock_too_fast_for_the_flash_s_wait_states_is_refused() {
    let mut bench = Bench::fast();
    assert_says(&bench.refused(FLASH_ACR, 4), "4 flash wait states");
}

// 7.2
#[test]
fn a_bus_faster_than_it_may_be_is_refused() {
    let mut bench = Bench::fast();
    assert_says(&bench.refused(RCC_CFGR, 2 | 4 << 10 | 4 << 13), "PCLK1");
    let mut bench = Bench::fast();
    assert_says(&bench.refused(RCC_CFGR, 2 | 5 << 10), "PCLK2");
}

// 5.1.3, 5.4.1: VOS
#[test]
fn the_highest_frequency_needs_voltage_scale_1() {
    let mut bench = Bench::fast();
    assert_eq!(bench.read(PWR_CR), 1 << 14);
    assert_says(&bench.refused(PWR_CR, 0), "voltage scale 1");
}

// 5.4.2: VOSRDY
#[test]
fn the_regulator_is_ready_some_time_after_a_change_of_its_voltage() {
    let mut bench = Bench::powered();
    assert_ne!(bench.read(PWR_CSR) & 1 << 14, 0);
    bench.write(PWR_CR, 0);
    assert_eq!(bench.read(PWR_CSR) & 1 << 14, 0);
    bench.wait(100 * MICROSECOND);
    assert_ne!(bench.read(PWR_CSR) & 1 << 14, 0);
}

// 7.3.4
#[test]
fn an_oscillator_that_becomes_ready_can_raise_an_interrupt() {
    let mut bench = Bench::new();
    bench.write(RCC_CIR, 1 << 11);
    bench.modify(RCC_CR, |cr| cr | HSEON);
    bench.wait(3_000 * MICROSECOND);
    assert!(bench.requests(5));
    bench.write(RCC_CIR, 1 << 11 | 1 << 19);
    assert!(!bench.requests(5));
}

// 7.3.10
#[test]
fn a_peripheral_whose_clock_is_off_cannot_be_used() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.try_read(GPIOB + IDR).unwrap_err().to_string(),
        "GPIOB is used at 0x40020410 while its clock is off"
    );
    bench.write(RCC_AHB1ENR, 1 << 1);
    assert_eq!(bench.read(GPIOB + MODER), 0x280);
}

// 7.3.9
#[test]
fn a_reset_bit_puts_a_peripheral_back_to_its_reset_values() {
    let mut bench = Bench::powered();
    bench.write(SPI_CR2, 3);
    bench.write(RCC_APB2RSTR, 1 << 12);
    bench.write(RCC_APB2RSTR, 0);
    assert_eq!(bench.read(SPI_CR2), 0);
}

// 7.3.9
#[test]
fn a_peripheral_that_is_held_in_reset_cannot_be_used() {
    let mut bench = Bench::powered();
    bench.write(RCC_APB2RSTR, 1 << 12);
    assert_says(&bench.refused(SPI_CR2, 3), "holds it in reset");
}

// 7.3.13
#[test]
fn a_timer_stands_still_while_its_clock_is_off() {
    let mut bench = Bench::powered();
    bench.write(TIM3 + TIM_CR1, 1);
    bench.wait(10 * 21);
    bench.modify(RCC_APB1ENR, |enr| enr & !2);
    bench.wait(10 * 21);
    bench.modify(RCC_APB1ENR, |enr| enr | 2);
    assert_eq!(bench.read(TIM3 + TIM_CNT), 10);
}

// 5.4.1: DBP, 7.3.20
#[test]
fn the_backup_domain_is_protected_until_dbp_is_set() {
    let mut bench = Bench::powered();
    assert_says(&bench.refused(RCC_BDCR, 1 << 15), "DBP");
    assert_says(&bench.refused(BKP0R, 1), "DBP");
    bench.write(PWR_CR, 1 << 14 | 1 << 8);
    bench.write(RCC_BDCR, 2 << 8 | 1 << 15);
    bench.write(BKP0R, 7);
    assert_eq!(bench.read(RCC_BDCR), 2 << 8 | 1 << 15);
    assert_eq!(bench.read(BKP0R), 7);
}

// 7.3.20: RTCSEL
#[test]
fn the_rtc_s_source_changes_only_by_a_reset_of_the_backup_domain() {
    let mut bench = Bench::powered();
    bench.write(PWR_CR, 1 << 14 | 1 << 8);
    bench.write(RCC_BDCR, 2 << 8);
    bench.write(RCC_BDCR, 1 << 8);
    assert_eq!(bench.read(RCC_BDCR), 2 << 8);
    bench.write(RCC_BDCR, 1 << 16);
    bench.write(RCC_BDCR, 0);
    bench.write(RCC_BDCR, 1 << 8);
    assert_eq!(bench.read(RCC_BDCR), 1 << 8);
}

// The reserved place after the last register, which embassy-stm32 writes.
#[test]
fn the_dedicated_clock_register_of_other_parts_takes_only_zero() {
    let mut bench = Bench::new();
    bench.write(RCC + 0x8C, 0);
    assert_eq!(bench.read(RCC + 0x8C), 0);
    assert!(bench.try_write(RCC + 0x8C, 1).is_err());
}

// 7.3.21: LSION
#[test]
fn the_low_speed_oscillator_is_ready_some_time_after_it_is_switched_on() {
    let mut bench = Bench::new();
    bench.modify(RCC_CSR, |csr| csr | 1);
    assert_eq!(bench.read(RCC_CSR) & 2, 0);
    bench.wait(100 * MICROSECOND);
    assert_eq!(bench.read(RCC_CSR) & 2, 2);
}

#[test]
fn an_external_clock_instead_of_the_crystal_is_refused() {
    let mut bench = Bench::new();
    assert_says(&bench.refused(RCC_CR, HSION | 1 << 18), "crystal");
}

// 7.3.3: SW
#[test]
fn the_fourth_source_of_the_system_clock_does_not_exist() {
    assert_says(&Bench::new().refused(RCC_CFGR, 3), "not allowed");
}

// 5.2.3
#[test]
fn the_voltage_detector_is_refused() {
    assert_says(&Bench::powered().refused(PWR_CR, 1 << 14 | 1 << 4), "PVDE");
}
