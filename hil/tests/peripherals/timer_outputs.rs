//! Outputs of the timers: RM0090 17.3 and 18.3.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::board::{Pin, PwmPulse, ResetCause};
use windhover_hil::machine::Bus;

const CEN: u32 = 1;
const UG: u32 = 1;
/// PWM mode 1 with preload, and mode 2, on the lower channel of a CCMR.
const PWM_1: u32 = 6 << 4 | 1 << 3;
const PWM_2: u32 = 7 << 4 | 1 << 3;
const CYCLE: u64 = 21;
/// TIM3's third channel, and TIM1's first.
const MOTOR: Pin = Pin::new('B', 0);
const TIM1_CH1: Pin = Pin::new('A', 8);
const TIM1_CH3N: Pin = Pin::new('B', 15);
const CC3E: u32 = 1 << 8;
const CC3P: u32 = 1 << 9;

/// TIM3 gives pulses of 30 in periods of 100 cycles on MOTOR.
fn pulsing(mode: u32, enable: u32) -> Bench {
    let mut bench = Bench::powered();
    bench.alternate(MOTOR, 2);
    bench.write(TIM3 + TIM_ARR, 99);
    bench.write(TIM3 + TIM_CCMR2, mode);
    bench.write(TIM3 + TIM_CCR3, 30);
    bench.write(TIM3 + TIM_CCER, enable);
    bench.write(TIM3 + TIM_EGR, UG);
    bench.write(TIM3 + TIM_CR1, CEN);
    bench
}

fn highs(bench: &Bench) -> Vec<u64> {
    bench
        .board
        .wiring
        .pulses
        .iter()
        .map(|(_, _, pulse)| pulse.high / CYCLE)
        .collect()
}

// 18.3.9
#[test]
fn in_pwm_mode_1_the_output_is_high_until_the_compare_value() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.wait(250 * CYCLE);
    let pulse = PwmPulse {
        high: 30 * CYCLE,
        period: 100 * CYCLE,
    };
    assert_eq!(
        bench.board.wiring.pulses,
        [0, 100, 200].map(|cycles| (cycles * CYCLE, MOTOR, pulse))
    );
}

// 18.3.9
#[test]
fn in_pwm_mode_2_the_output_is_low_until_the_compare_value() {
    assert_eq!(highs(&pulsing(PWM_2, CC3E)), [70]);
}

// 18.4.9: CCxP
#[test]
fn an_inverted_output_is_low_where_it_would_be_high() {
    assert_eq!(highs(&pulsing(PWM_1, CC3E | CC3P)), [70]);
}

// 18.3.9
#[test]
fn a_compare_value_above_the_reload_value_keeps_the_output_high() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.write(TIM3 + TIM_CCR3, 100);
    bench.wait(100 * CYCLE);
    bench.write(TIM3 + TIM_CCR3, 0xFFFF);
    bench.wait(100 * CYCLE);
    assert_eq!(highs(&bench), [30, 100, 100]);
}

// 18.3.9
#[test]
fn a_compare_value_of_zero_keeps_the_output_low() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.write(TIM3 + TIM_CCR3, 0);
    bench.wait(100 * CYCLE);
    assert_eq!(highs(&bench), [30, 0]);
}

// 18.3.9
#[test]
fn a_compare_value_with_preload_shows_in_the_next_period() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.wait(50 * CYCLE);
    bench.write(TIM3 + TIM_CCR3, 60);
    bench.wait(150 * CYCLE);
    assert_eq!(highs(&bench), [30, 60, 60]);
}

// 18.3.9
#[test]
fn the_prescaler_stretches_pulses() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.write(TIM3 + TIM_PSC, 9);
    bench.wait(100 * CYCLE);
    let (time, _, pulse) = bench.board.wiring.pulses[1];
    assert_eq!(time, 100 * CYCLE);
    assert_eq!((pulse.high, pulse.period), (300 * CYCLE, 1000 * CYCLE));
}

// 18.3.7
#[test]
fn an_output_can_be_forced() {
    assert_eq!(highs(&pulsing(4 << 4, CC3E)), [0]);
    assert_eq!(highs(&pulsing(5 << 4, CC3E)), [100]);
}

// 18.4.6: UG
#[test]
fn an_update_by_software_begins_a_period() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.wait(50 * CYCLE);
    bench.write(TIM3 + TIM_EGR, UG);
    bench.wait(100 * CYCLE);
    let times: Vec<u64> = bench
        .board
        .wiring
        .pulses
        .iter()
        .map(|pulse| pulse.0 / CYCLE)
        .collect();
    assert_eq!(times, [0, 50, 150]);
}

// 18.4.9: CCxE
#[test]
fn a_channel_that_is_disabled_stops_at_once_and_is_back_with_the_next_period() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.wait(10 * CYCLE);
    bench.write(TIM3 + TIM_CCER, 0);
    assert_eq!(bench.board.wiring.stopped, [(10 * CYCLE, MOTOR)]);
    bench.wait(200 * CYCLE);
    assert_eq!(highs(&bench), [30]);
    bench.write(TIM3 + TIM_CCER, CC3E);
    assert_eq!(highs(&bench), [30]);
    bench.wait(100 * CYCLE);
    assert_eq!(bench.board.wiring.pulses[1].0, 300 * CYCLE);
}

// 18.4.1: CEN
#[test]
fn a_timer_that_is_stopped_gives_no_pulses() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.write(TIM3 + TIM_CR1, 0);
    assert_eq!(bench.board.wiring.stopped, [(0, MOTOR)]);
    bench.wait(200 * CYCLE);
    assert_eq!(highs(&bench), [30]);
}

// 8.3.2
#[test]
fn a_pin_that_is_switched_away_gives_no_pulses() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.alternate(Pin::new('C', 8), 2);
    bench.mode(MOTOR, 1);
    assert_eq!(bench.board.wiring.stopped, [(0, MOTOR)]);
    bench.wait(100 * CYCLE);
    assert_eq!(bench.board.wiring.pulses[1].1, Pin::new('C', 8));
}

// 7.1
#[test]
fn a_reset_ends_the_pulses() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.board.reset(bench.now, ResetCause::IndependentWatchdog);
    assert_eq!(bench.board.wiring.stopped, [(0, MOTOR)]);
    bench.wait(200 * CYCLE);
    assert_eq!(highs(&bench), [30]);
}

// 7.3.8
#[test]
fn a_timer_that_is_reset_or_loses_its_clock_gives_no_pulses() {
    for register in [RCC_APB1RSTR, RCC_APB1ENR] {
        let mut bench = pulsing(PWM_1, CC3E);
        bench.modify(register, |bits| bits ^ 2);
        assert_eq!(bench.board.wiring.stopped, [(0, MOTOR)]);
    }
}

/// TIM1 with its first channel and the complement of its third, periods of 100 cycles.
fn advanced(enable: u32, main_output: u32) -> Bench {
    let mut bench = Bench::powered();
    bench.alternate(TIM1_CH1, 1);
    bench.alternate(TIM1_CH3N, 1);
    bench.write(TIM1 + TIM_ARR, 99);
    bench.write(TIM1 + TIM_CCMR1, PWM_1);
    bench.write(TIM1 + TIM_CCMR2, PWM_1);
    bench.write(TIM1 + TIM_CCR1, 20);
    bench.write(TIM1 + TIM_CCR3, 30);
    bench.write(TIM1 + TIM_CCER, enable);
    bench.write(TIM1 + TIM_BDTR, main_output);
    bench.write(TIM1 + TIM_EGR, UG);
    bench.write(TIM1 + TIM_CR1, CEN);
    bench
}

const MOE: u32 = 1 << 15;
const CC1E: u32 = 1;
const CC3NE: u32 = 1 << 10;
const CC3NP: u32 = 1 << 11;

// 17.4.18: MOE
#[test]
fn an_advanced_timer_s_outputs_need_the_main_output_enable() {
    assert!(highs(&advanced(CC1E, 0)).is_empty());
    assert_eq!(highs(&advanced(CC1E, MOE)), [20]);
}

// 17.4.9, table 102
#[test]
fn a_complement_alone_follows_the_reference() {
    assert_eq!(highs(&advanced(CC3NE, MOE)), [30]);
    assert_eq!(highs(&advanced(CC3NE | CC3NP, MOE)), [70]);
}

// 17.3.11
#[test]
fn a_complement_beside_its_output_is_inverted() {
    let mut bench = Bench::powered();
    bench.alternate(Pin::new('A', 10), 1);
    bench.alternate(TIM1_CH3N, 1);
    bench.write(TIM1 + TIM_ARR, 99);
    bench.write(TIM1 + TIM_CCMR2, PWM_1);
    bench.write(TIM1 + TIM_CCR3, 30);
    bench.write(TIM1 + TIM_CCER, CC3E | CC3NE);
    bench.write(TIM1 + TIM_BDTR, MOE);
    bench.write(TIM1 + TIM_EGR, UG);
    bench.write(TIM1 + TIM_CR1, CEN);
    assert_eq!(highs(&bench), [30, 70]);
}

// 8.3.2
#[test]
fn an_output_that_reaches_no_pin_is_refused_by_the_pins_that_could_carry_it() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.write(TIM3 + TIM_CCER, CC3E | 1);
    let violation = bench.try_wait(100 * CYCLE).unwrap_err().to_string();
    assert_says(&violation, "TIM3: no pin is switched to CH1: it takes PA6 in AF2");
}

#[test]
fn output_modes_that_are_not_modelled_are_refused() {
    let mut bench = pulsing(PWM_1, CC3E);
    bench.write(TIM3 + TIM_CCMR2, 3 << 4);
    let violation = bench.try_wait(100 * CYCLE).unwrap_err().to_string();
    assert_says(&violation, "output mode 3");
}
