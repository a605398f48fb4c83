//! External interrupts: RM0090 9.2 and chapter 12.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::board::Pin;

const DATA_READY: Pin = Pin::new('C', 4);
const EXTI4: u32 = 10;

/// EXTI4 listens to PC4, on rising edges.
fn listening() -> Bench {
    let mut bench = Bench::powered();
    bench.write(EXTICR2, 2);
    bench.write(RTSR, 1 << 4);
    bench.write(IMR, 1 << 4);
    bench
}

fn pulse(bench: &mut Bench) {
    bench.plan_level(1, DATA_READY, true);
    bench.plan_level(2, DATA_READY, false);
    bench.wait(2);
}

// 12.2.4
#[test]
fn a_rising_edge_sets_the_pending_bit_and_raises_the_interrupt() {
    let mut bench = listening();
    pulse(&mut bench);
    assert_eq!(bench.read(PR), 1 << 4);
    assert!(bench.requests(EXTI4));
}

// 12.3.6
#[test]
fn the_pending_bit_is_cleared_by_writing_one() {
    let mut bench = listening();
    pulse(&mut bench);
    bench.write(PR, 0);
    assert!(bench.requests(EXTI4));
    bench.write(PR, 1 << 4);
    assert!(!bench.requests(EXTI4));
}

// 12.3.3, 12.3.4
#[test]
fn falling_edges_count_only_where_they_are_selected() {
    let mut bench = listening();
    bench.plan_level(1, DATA_READY, true);
    bench.wait(1);
    bench.write(PR, 1 << 4);
    bench.plan_level(1, DATA_READY, false);
    bench.wait(1);
    assert_eq!(bench.read(PR), 0);
    bench.write(FTSR, 1 << 4);
    pulse(&mut bench);
    assert_eq!(bench.read(PR), 1 << 4);
}

// 12.2.4, figure 42
#[test]
fn a_masked_line_becomes_pending_but_raises_nothing() {
    let mut bench = listening();
    bench.write(IMR, 0);
    pulse(&mut bench);
    assert_eq!(bench.read(PR), 1 << 4);
    assert!(!bench.requests(EXTI4));
}

// 9.2.4, 12.2.5
#[test]
fn a_line_listens_to_the_port_that_exticr_names() {
    let mut bench = listening();
    bench.write(EXTICR2, 0);
    pulse(&mut bench);
    assert_eq!(bench.read(PR), 0);
}

// 12.2.5, figure 43
#[test]
fn an_output_s_own_edges_reach_its_line() {
    let mut bench = listening();
    bench.mode(DATA_READY, 1);
    bench.write(GPIOC + BSRR, 1 << 4);
    assert_eq!(bench.read(PR), 1 << 4);
}

// 12.3.5
#[test]
fn software_can_raise_an_unmasked_line() {
    let mut bench = listening();
    bench.write(SWIER, 1 << 4 | 1 << 5);
    assert_eq!(bench.read(PR), 1 << 4);
    assert!(bench.requests(EXTI4));
    bench.write(PR, 1 << 4);
    assert_eq!(bench.read(SWIER), 1 << 5);
}

// 12.1.3, table 62
#[test]
fn lines_above_four_share_two_interrupts() {
    for (line, interrupt) in [(0, 6), (3, 9), (5, 23), (9, 23), (10, 40), (15, 40)] {
        let mut bench = Bench::powered();
        bench.write(IMR, 1 << line);
        bench.write(SWIER, 1 << line);
        assert!(bench.requests(interrupt), "line {line}");
    }
}

// 9.2.3
#[test]
fn a_port_that_does_not_exist_is_refused() {
    assert_says(&Bench::powered().refused(EXTICR1, 9), "does not exist");
}

// 9.2.1, 9.2.7
#[test]
fn memory_remapping_and_the_compensation_cell_are_refused() {
    assert_says(&Bench::powered().refused(SYSCFG, 3), "remapping");
    assert_says(&Bench::powered().refused(SYSCFG + 0x20, 1), "compensation");
}
