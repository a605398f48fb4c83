//! The I2C interface as a master: RM0090 chapter 27.

use super::bench::{Bench, Talk, assert_says};
use super::registers::*;
use windhover_hil::board::I2cCondition::{Released, Start, Stop};
use windhover_hil::board::Pin;

pub const PE: u32 = 1 << 0;
pub const START: u32 = 1 << 8;
pub const STOP: u32 = 1 << 9;
pub const ACK: u32 = 1 << 10;
const POS: u32 = 1 << 11;
pub const SWRST: u32 = 1 << 15;
pub const SB: u32 = 1 << 0;
pub const ADDR: u32 = 1 << 1;
pub const BTF: u32 = 1 << 2;
pub const RXNE: u32 = 1 << 6;
pub const TXE: u32 = 1 << 7;
const AF: u32 = 1 << 10;
pub const MSL: u32 = 1 << 0;
pub const BUSY: u32 = 1 << 1;
const TRA: u32 = 1 << 2;
pub const SCL: Pin = Pin::new('B', 8);
pub const SDA: Pin = Pin::new('B', 9);

/// 16 MHz by 160: 100 kHz.
pub const BIT: u64 = 160 * 21;
pub const BYTE: u64 = 9 * BIT;
const WRITE: u8 = 0x76 << 1;
const READ: u8 = WRITE | 1;

/// Pins that are switched to it and pulled up outside, a part at 0x76 that takes 0x06 and 0x33.
pub fn connected() -> Bench {
    let mut bench = Bench::powered();
    bench.plan_level(1, SCL, true);
    bench.plan_level(1, SDA, true);
    bench.wait(1);
    bench.write(GPIOB + OTYPER, 1 << 8 | 1 << 9);
    bench.alternate(SCL, 4);
    bench.alternate(SDA, 4);
    bench.board.wiring.acknowledged = vec![WRITE, READ, 0x06, 0x33];
    set_up(&mut bench);
    bench
}

/// 100 kHz, enabled.
pub fn set_up(bench: &mut Bench) {
    bench.write(I2C_CR2, 16);
    bench.write(I2C_CCR, 80);
    bench.write(I2C_TRISE, 17);
    bench.write(I2C_CR1, PE);
}

/// A start was made, the address is out.
pub fn addressed(bench: &mut Bench, control: u32, address: u8) {
    bench.write(I2C_CR1, PE | START | control);
    bench.wait(BIT);
    assert_eq!(bench.read(I2C_SR1) & SB, SB);
    bench.write(I2C_DR, address.into());
    bench.wait(BYTE);
}

/// The address was acknowledged, and ADDR is cleared.
fn begun(control: u32, address: u8) -> Bench {
    let mut bench = connected();
    addressed(&mut bench, control, address);
    assert_eq!(bench.read(I2C_SR1) & ADDR, ADDR);
    bench.read(I2C_SR2);
    bench
}

fn talk(bench: &Bench) -> Vec<Talk> {
    bench.board.wiring.talk.iter().map(|(_, talk)| *talk).collect()
}

// 27.3.3: start condition
#[test]
fn a_start_makes_it_master() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    assert_eq!(bench.read(I2C_SR2), 0);
    bench.wait(BIT);
    assert_eq!(bench.read(I2C_CR1), PE, "the hardware clears START");
    assert_eq!(bench.read(I2C_SR1), SB);
    assert_eq!(bench.read(I2C_SR2), MSL | BUSY);
    assert_eq!(talk(&bench), [Talk::Condition(Start)]);
}

// 27.6.6: SB is cleared by reading SR1 and writing DR
#[test]
fn an_address_without_a_look_at_sb_is_refused() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    bench.wait(BIT);
    assert_says(&bench.refused(I2C_DR, WRITE.into()), "before SR1 was read");
}

// 27.6.6: what is read between does not matter
#[test]
fn a_look_at_sr2_leaves_sb_as_it_was_seen() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    bench.wait(BIT);
    bench.read(I2C_SR1);
    assert_eq!(bench.read(I2C_SR2), MSL | BUSY);
    bench.write(I2C_DR, WRITE.into());
    assert_eq!(bench.read(I2C_SR1) & SB, 0);
}

// 27.3.3: slave address transmission
#[test]
fn an_address_takes_nine_clocks_and_sets_addr() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    bench.wait(BIT);
    bench.read(I2C_SR1);
    bench.write(I2C_DR, WRITE.into());
    bench.wait(BYTE - 1);
    assert_eq!(bench.read(I2C_SR1) & (SB | ADDR), 0);
    bench.wait(1);
    assert_eq!(bench.read(I2C_SR1) & ADDR, ADDR);
    assert_eq!(bench.read(I2C_SR2), MSL | BUSY | TRA);
    assert_eq!(bench.read(I2C_SR1), TXE, "ADDR went with SR2");
}

// 27.3.3, 27.6.8
#[test]
fn a_byte_takes_the_time_that_ccr_says() {
    // 42 MHz by 3 times 35: 400 kHz. By 25 times 5: 336 kHz.
    for (ccr, bit) in [(1 << 15 | 35, 840), (1 << 15 | 1 << 14 | 5, 1000)] {
        let mut bench = Bench::fast();
        bench.modify(RCC_APB1ENR, |enr| enr | 1 << 21);
        bench.plan_level(1, SCL, true);
        bench.plan_level(1, SDA, true);
        bench.wait(1);
        bench.write(GPIOB + OTYPER, 1 << 8 | 1 << 9);
        bench.alternate(SCL, 4);
        bench.alternate(SDA, 4);
        bench.write(I2C_CR2, 42);
        bench.write(I2C_CCR, ccr);
        bench.write(I2C_CR1, PE | START);
        bench.wait(bit);
        bench.read(I2C_SR1);
        bench.write(I2C_DR, WRITE.into());
        bench.wait(9 * bit - 1);
        assert_eq!(bench.board.wiring.talk.len(), 1);
        bench.wait(1);
        assert_eq!(bench.board.wiring.talk.len(), 2);
    }
}

// 27.3.3: master transmitter, figure 237
#[test]
fn bytes_go_out_and_the_clock_is_stretched_between() {
    let mut bench = begun(0, WRITE);
    bench.write(I2C_DR, 0x06);
    assert_eq!(bench.read(I2C_SR1), TXE, "DR went on into the shift register");
    bench.write(I2C_DR, 0x33);
    assert_eq!(bench.read(I2C_SR1), 0);
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_SR1), TXE);
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_SR1), TXE | BTF);
    bench.wait(10 * BYTE);
    bench.write(I2C_CR1, PE | STOP);
    bench.wait(BIT);
    assert_eq!(bench.read(I2C_CR1), PE);
    assert_eq!(bench.read(I2C_SR2), 0);
    assert_eq!(bench.read(I2C_SR1), 0);
    let expected = [
        Talk::Condition(Start),
        Talk::Sent(WRITE),
        Talk::Sent(0x06),
        Talk::Sent(0x33),
        Talk::Condition(Stop),
    ];
    assert_eq!(talk(&bench), expected);
}

// 27.6.6: AF
#[test]
fn nobody_at_an_address_is_an_acknowledge_failure() {
    let mut bench = connected();
    addressed(&mut bench, 0, 0x0E << 1);
    assert_eq!(bench.read(I2C_SR1), AF);
    assert_eq!(bench.read(I2C_SR2), MSL | BUSY, "the bus is still held");
    bench.write(I2C_SR1, !AF);
    assert_eq!(bench.read(I2C_SR1), 0);
    // A driver that gives up without a stop begins anew with a repeated start.
    addressed(&mut bench, 0, WRITE);
    assert_eq!(bench.read(I2C_SR1) & (AF | ADDR), ADDR);
}

// 27.6.6: AF
#[test]
fn a_byte_that_is_not_acknowledged_is_a_failure_too() {
    let mut bench = begun(0, WRITE);
    bench.write(I2C_DR, 0x99);
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_SR1) & AF, AF);
    bench.write(I2C_CR1, PE | STOP);
    bench.wait(BIT);
    assert_eq!(talk(&bench).last(), Some(&Talk::Condition(Stop)));
}

// 27.3.3: master receiver, method for one byte
#[test]
fn one_byte_is_received() {
    let mut bench = connected();
    bench.board.wiring.to_read = [0x10].into();
    addressed(&mut bench, ACK, READ);
    bench.write(I2C_CR1, PE);
    bench.read(I2C_SR1);
    bench.read(I2C_SR2);
    bench.write(I2C_CR1, PE | STOP);
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_SR1) & RXNE, RXNE);
    assert_eq!(bench.read(I2C_DR), 0x10);
    bench.wait(BIT);
    let expected = [
        Talk::Condition(Start),
        Talk::Sent(READ),
        Talk::Received(0x10, false),
        Talk::Condition(Stop),
    ];
    assert_eq!(talk(&bench), expected);
    assert_eq!(bench.read(I2C_SR2), 0);
}

// 27.3.3: master receiver, method for two bytes: POS
#[test]
fn with_pos_the_acknowledgement_is_that_of_the_next_byte() {
    let mut bench = connected();
    bench.board.wiring.to_read = [1, 2].into();
    addressed(&mut bench, ACK | POS, READ);
    bench.read(I2C_SR1);
    bench.read(I2C_SR2);
    bench.write(I2C_CR1, PE | POS);
    bench.wait(2 * BYTE);
    assert_eq!(bench.read(I2C_SR1), BTF | RXNE);
    bench.write(I2C_CR1, PE | POS | STOP);
    assert_eq!((bench.read(I2C_DR), bench.read(I2C_DR)), (1, 2));
    assert_eq!(bench.read(I2C_SR1) & (BTF | RXNE), 0);
    assert_eq!(
        talk(&bench)[2..],
        [Talk::Received(1, true), Talk::Received(2, false)]
    );
}

// 27.3.3: master receiver; as drivers do it that look at each byte
#[test]
fn the_last_byte_is_refused_and_a_stop_follows_it() {
    let mut bench = begun(ACK, READ);
    bench.board.wiring.to_read = [1, 2, 3].into();
    let mut received = vec![];
    for last in [false, true] {
        bench.wait(BYTE);
        assert_eq!(bench.read(I2C_SR1), RXNE);
        received.push(bench.read(I2C_DR));
        if last {
            bench.write(I2C_CR1, PE | STOP);
        }
    }
    bench.wait(BYTE);
    received.push(bench.read(I2C_DR));
    bench.wait(BIT);
    assert_eq!(received, [1, 2, 3]);
    let expected = [
        Talk::Received(1, true),
        Talk::Received(2, true),
        Talk::Received(3, false),
        Talk::Condition(Stop),
    ];
    assert_eq!(talk(&bench)[2..], expected);
}

// 27.3.3: with DR and the shift register full the clock is stretched
#[test]
fn nothing_is_lost_by_who_reads_late() {
    let mut bench = begun(ACK, READ);
    bench.board.wiring.to_read = [1, 2, 3].into();
    bench.wait(20 * BYTE);
    assert_eq!(bench.read(I2C_SR1), BTF | RXNE);
    assert_eq!(bench.read(I2C_DR), 1);
    assert_eq!(bench.read(I2C_SR1), RXNE);
    assert_eq!(bench.read(I2C_DR), 2);
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_DR), 3);
}

// 27.3.3: who takes ACK back too late receives one byte too many, and finds it in the next transfer
#[test]
fn a_byte_too_many_stays_in_the_data_register() {
    let mut bench = begun(ACK, READ);
    bench.board.wiring.to_read = [1, 2].into();
    bench.wait(BYTE);
    bench.wait(1);
    bench.write(I2C_CR1, PE | STOP);
    assert_eq!(bench.read(I2C_DR), 1);
    bench.wait(BYTE + BIT);
    assert_eq!(bench.read(I2C_SR2), 0);
    assert_eq!(bench.read(I2C_SR1), RXNE);
    assert_eq!(bench.read(I2C_DR), 2);
}

// 27.3.3
#[test]
fn a_stop_after_an_acknowledged_byte_is_refused() {
    let mut bench = begun(ACK, READ);
    bench.wait(3 * BYTE);
    assert_says(&bench.refused(I2C_CR1, PE | STOP), "the part drives the bus");
}

// 27.6.1: START while master is a repeated start
#[test]
fn a_repeated_start_follows_the_byte() {
    let mut bench = begun(0, WRITE);
    bench.write(I2C_DR, 0x06);
    bench.wait(BYTE);
    addressed(&mut bench, ACK, READ);
    bench.read(I2C_SR1);
    bench.read(I2C_SR2);
    bench.board.wiring.to_read = [9].into();
    bench.write(I2C_CR1, PE | STOP);
    bench.wait(BYTE);
    assert_eq!(bench.read(I2C_DR), 9);
    let expected = [
        Talk::Condition(Start),
        Talk::Sent(WRITE),
        Talk::Sent(0x06),
        Talk::Condition(Start),
        Talk::Sent(READ),
        Talk::Received(9, false),
    ];
    assert_eq!(talk(&bench), expected);
}

// 27.6.1: a start asked for during a stop comes behind it
#[test]
fn a_start_waits_for_the_stop_before_it() {
    let mut bench = begun(0, WRITE);
    bench.write(I2C_DR, 0x06);
    bench.wait(BYTE);
    bench.write(I2C_CR1, PE | STOP);
    bench.modify(I2C_CR1, |cr| cr | START);
    bench.wait(2 * BIT);
    assert_eq!(bench.read(I2C_CR1), PE);
    assert_eq!(talk(&bench)[3..], [Talk::Condition(Stop), Talk::Condition(Start)]);
}

// 27.4, table 125
#[test]
fn events_and_errors_raise_their_interrupts_where_they_are_enabled() {
    let mut bench = connected();
    bench.write(I2C_CR1, PE | START);
    bench.wait(BIT);
    assert!(!bench.requests(31));
    bench.write(I2C_CR2, 16 | 1 << 9);
    assert!(bench.requests(31));
    bench.read(I2C_SR1);
    bench.write(I2C_DR, 0x20);
    assert!(!bench.requests(31));
    bench.wait(BYTE);
    assert!(!bench.requests(32));
    bench.write(I2C_CR2, 16 | 1 << 8);
    assert!(bench.requests(32));
}

// 27.6.1: SWRST; 7.3.13: its bit in RCC
#[test]
fn a_reset_lets_go_of_the_bus_in_the_middle_of_a_byte() {
    let resets: [(u32, u32); 2] = [(I2C_CR1, SWRST), (RCC_APB1RSTR, 1 << 21)];
    for (register, bit) in resets {
        let mut bench = begun(ACK, READ);
        bench.wait(3 * BIT);
        bench.write(register, bit);
        assert_eq!(
            talk(&bench).last(),
            Some(&Talk::Condition(Released { clocks: 3 }))
        );
        bench.write(register, 0);
        assert_eq!(bench.read(I2C_SR2), 0);
        bench.wait(BYTE);
        assert_eq!(bench.read(I2C_SR1), 0);
    }
}

#[test]
fn clocks_that_the_manual_does_not_allow_are_refused() {
    let mut bench = connected();
    assert_says(&bench.refused(I2C_CCR, 81), "while it is enabled");
    bench.write(I2C_CR1, 0);
    bench.write(I2C_CCR, 79);
    bench.write(I2C_CR1, PE);
    assert_says(&bench.refused(I2C_CR1, PE | START), "more than 100000 Hz");
    let mut bench = connected();
    bench.write(I2C_CR2, 42);
    assert_says(&bench.refused(I2C_CR1, PE | START), "FREQ is not the 16 MHz");
}

#[test]
fn data_at_the_wrong_time_are_refused() {
    assert_says(&connected().refused(I2C_DR, 1), "cannot be sent");
    let mut bench = begun(0, WRITE);
    bench.write(I2C_DR, 0x06);
    bench.write(I2C_DR, 0x06);
    assert_says(&bench.refused(I2C_DR, 0x06), "cannot be sent");
}

// 8.3.2, 27.3.1
#[test]
fn a_start_without_open_drain_pins_is_refused() {
    let mut bench = connected();
    bench.write(GPIOB + OTYPER, 1 << 8);
    assert_says(
        &bench.refused(I2C_CR1, PE | START),
        "PB9 carries SDA and is not open-drain",
    );
    let mut bench = connected();
    bench.mode(SCL, 0);
    assert_says(
        &bench.refused(I2C_CR1, PE | START),
        "no pin is switched to SCL: it takes PB6 in AF4 or PB8 in AF4",
    );
}

#[test]
fn what_the_boards_do_not_use_is_refused() {
    assert_says(&connected().refused(I2C_CR2, 16 | 1 << 11), "DMA");
    assert_says(&connected().refused(I2C_CR1, PE | 1 << 1), "SMBus");
    assert_says(&connected().refused(I2C_CR1, PE | 1 << 7), "NOSTRETCH");
    assert!(connected().try_read(I2C1 + 0x24).is_err());
}
