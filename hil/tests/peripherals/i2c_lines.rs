//! I2C's lines, as others hold them, and as pins show and drive them: RM0090 27.3, 27.6, 8.3.

use super::bench::{Bench, Talk};
use super::i2c::*;
use super::registers::*;
use windhover_hil::board::I2cCondition::Start;
use windhover_hil::board::Pin;

const ARLO: u32 = 1 << 9;
const WRITE: u8 = 0x76 << 1;

fn hold(bench: &mut Bench, pin: Pin, level: bool) {
    bench.plan_level(1, pin, level);
    bench.wait(1);
}

// 27.6.7: BUSY
#[test]
fn a_line_that_is_low_says_that_the_bus_is_busy() {
    let mut bench = connected();
    assert_eq!(bench.read(I2C_SR2), 0);
    hold(&mut bench, SDA, false);
    assert_eq!(bench.read(I2C_SR2), BUSY);
    // It rises while the clock is high: a stop.
    hold(&mut bench, SDA, true);
    assert_eq!(bench.read(I2C_SR2), 0);
}

// 27.3.3
#[test]
fn a_start_waits_for_a_free_bus() {
    for line in [SCL, SDA] {
        let mut bench = connected();
        hold(&mut bench, line, false);
        bench.write(I2C_CR1, PE | START);
        bench.wait(100 * BYTE);
        assert_eq!(bench.read(I2C_SR1), 0);
        assert_eq!(bench.read(I2C_CR1), PE | START);
    }
    let mut bench = connected();
    hold(&mut bench, SDA, false);
    bench.write(I2C_CR1, PE | START);
    hold(&mut bench, SDA, true);
    bench.wait(BIT);
    assert_eq!(bench.read(I2C_SR1), SB);
}

// 27.6.1: SWRST is for a BUSY that does not end
#[test]
fn a_busy_that_no_stop_ended_goes_with_a_reset() {
    let mut bench = connected();
    hold(&mut bench, SCL, false);
    hold(&mut bench, SCL, true);
    assert_eq!(bench.read(I2C_SR2), BUSY);
    bench.write(I2C_CR1, SWRST);
    bench.write(I2C_CR1, 0);
    assert_eq!(bench.read(I2C_SR2), 0);
    hold(&mut bench, SDA, false);
    bench.write(I2C_CR1, SWRST);
    bench.write(I2C_CR1, 0);
    assert_eq!(
        bench.read(I2C_SR2),
        BUSY,
        "while the line is low it does not help"
    );
}

// 27.3.3: clock stretching
#[test]
fn a_clock_that_is_held_stops_the_byte() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    bench.wait(BIT);
    bench.read(I2C_SR1);
    bench.write(I2C_DR, WRITE.into());
    bench.wait(4 * BIT);
    hold(&mut bench, SCL, false);
    bench.wait(100 * BYTE);
    assert_eq!(bench.read(I2C_SR1), 0);
    hold(&mut bench, SCL, true);
    bench.wait(5 * BIT - 3);
    assert_eq!(bench.read(I2C_SR1), 0);
    bench.wait(2);
    assert_eq!(bench.read(I2C_SR1), ADDR);
}

// 27.3.4: arbitration lost
#[test]
fn data_that_are_held_low_take_the_bus_away() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    bench.wait(BIT);
    hold(&mut bench, SDA, false);
    bench.read(I2C_SR1);
    bench.write(I2C_DR, WRITE.into());
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_SR1), ARLO);
    assert_eq!(bench.read(I2C_SR2), BUSY);
    bench.write(I2C_SR1, !ARLO);
    assert_eq!(bench.read(I2C_SR1), 0);
}

// 8.3.10: a pin in open drain reads what the line is
#[test]
fn the_bus_is_clocked_by_hand_through_open_drain_outputs() {
    let mut bench = connected();
    bench.write(I2C_CR1, 0);
    bench.write(GPIOB + BSRR, 1 << 8 | 1 << 9);
    bench.mode(SCL, 1);
    bench.mode(SDA, 1);
    let lines = |bench: &mut Bench| bench.read(GPIOB + IDR) >> 8 & 3;
    assert_eq!(lines(&mut bench), 3);
    bench.write(GPIOB + BSRR, 1 << 24);
    assert_eq!(lines(&mut bench), 2);
    bench.write(GPIOB + BSRR, 1 << 8);
    assert_eq!(lines(&mut bench), 3);
    hold(&mut bench, SDA, false);
    assert_eq!(lines(&mut bench), 1, "a part holds it");
    let clock: Vec<bool> = bench
        .board
        .wiring
        .outputs
        .iter()
        .filter(|(_, pin, _)| *pin == SCL)
        .map(|(.., level)| *level)
        .collect();
    assert_eq!(clock, [true, false, true]);
}

// 27.6.7: pins that are not switched to it tell it nothing
#[test]
fn after_clocking_by_hand_a_transfer_begins_afresh() {
    let mut bench = connected();
    hold(&mut bench, SDA, false);
    bench.write(GPIOB + BSRR, 1 << 8 | 1 << 9);
    bench.mode(SCL, 1);
    bench.mode(SDA, 1);
    bench.write(GPIOB + BSRR, 1 << 24);
    hold(&mut bench, SDA, true);
    bench.write(GPIOB + BSRR, 1 << 8);
    bench.alternate(SCL, 4);
    bench.alternate(SDA, 4);
    bench.write(RCC_APB1RSTR, 1 << 21);
    bench.write(RCC_APB1RSTR, 0);
    set_up(&mut bench);
    addressed(&mut bench, 0, WRITE);
    assert_eq!(bench.read(I2C_SR1), ADDR);
    assert_eq!(bench.board.wiring.talk[0].1, Talk::Condition(Start));
}
