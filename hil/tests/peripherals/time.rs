//! Events happen at their time, however the time passes.

use super::bench::Bench;
use super::dma::{BYTE, exchange};
use super::registers::*;
use windhover_hil::board::{Pin, PwmPulse, Usart};
use windhover_hil::machine::Bus;
use windhover_hil::time::{MICROSECOND, NEVER};

/// What the wires saw of SPI by DMA, PWM and a serial port that work at the same time.
type Record = (
    Vec<(u64, u8)>,
    Vec<(u64, Pin, PwmPulse)>,
    Vec<(u64, Usart, u8)>,
    u128,
);

fn record(steps: &[u64]) -> Record {
    let mut bench = exchange(8);
    bench.alternate(Pin::new('B', 0), 2);
    bench.alternate(Pin::new('A', 9), 7);
    bench.write(TIM3 + TIM_ARR, 6);
    bench.write(TIM3 + TIM_CCMR2, 6 << 4);
    bench.write(TIM3 + TIM_CCR3, 3);
    bench.write(TIM3 + TIM_CCER, 1 << 8);
    bench.write(TIM3 + TIM_CR1, 1);
    bench.write(USART1 + BRR, 16);
    bench.write(USART1 + CR1, 1 << 13 | 1 << 3);
    bench.write(USART1 + DR, 0x5A);
    let end = 9 * BYTE;
    for step in steps.iter().cycle() {
        if bench.now + step > end {
            break;
        }
        bench.wait(*step);
    }
    bench.wait(end - bench.now);
    let wires = &bench.board.wiring;
    (
        wires.exchanged.clone(),
        wires.pulses.clone(),
        wires.sent.clone(),
        bench.board.interrupts(),
    )
}

#[test]
fn one_long_step_is_equal_to_many_short_ones() {
    let whole = record(&[9 * BYTE]);
    assert_eq!(whole.0.len(), 8);
    assert_eq!(record(&[1]), whole);
    assert_eq!(record(&[17, 1, 333]), whole);
}

#[test]
fn a_board_on_which_nothing_was_started_waits_for_ever() {
    let mut bench = Bench::new();
    assert_eq!(bench.board.next_event(), NEVER);
    bench.wait(1_000_000 * MICROSECOND);
    assert_eq!(bench.board.interrupts(), 0);
}

#[test]
fn an_access_sees_what_was_due_before_it() {
    let mut bench = Bench::powered();
    bench.plan_level(10, Pin::new('C', 4), true);
    bench.now += 10;
    assert_eq!(bench.read(GPIOC + IDR), 1 << 4);
}
