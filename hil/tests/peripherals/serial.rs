//! Serial ports: RM0090 chapter 30.

use super::bench::{Bench, assert_says};
use super::registers::*;
use windhover_hil::board::line::{Format, Parity};
use windhover_hil::board::{Pin, Usart};
use windhover_hil::machine::Bus;
use windhover_hil::time::SECOND;

const UE: u32 = 1 << 13;
const TE: u32 = 1 << 3;
const RE: u32 = 1 << 2;
const PE: u32 = 1 << 0;
const FE: u32 = 1 << 1;
const IDLE: u32 = 1 << 4;
const ORE: u32 = 1 << 3;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
const INTERRUPT: u32 = 37;
/// Cycles of the bus in a bit, and ticks in a frame of ten bits, with 21 ticks a cycle.
const DIVISOR: u32 = 139;
const FRAME: u64 = 10 * 139 * 21;

fn connected() -> Bench {
    let mut bench = Bench::powered();
    bench.alternate(Pin::new('A', 9), 7);
    bench.alternate(Pin::new('A', 10), 7);
    bench.write(USART1 + BRR, DIVISOR);
    bench.line.bit = FRAME / 10;
    bench
}

/// Running, the first idle frame is over.
fn running() -> Bench {
    let mut bench = connected();
    bench.write(USART1 + CR1, UE | TE | RE);
    bench.wait(FRAME);
    bench
}

fn bytes(bench: &Bench) -> Vec<u8> {
    bench.board.wiring.sent.iter().map(|(.., byte)| *byte).collect()
}

// 30.6.1
#[test]
fn after_reset_transmitter_and_data_register_are_empty() {
    assert_eq!(Bench::powered().read(USART1 + SR), TXE | TC);
}

// 30.3.2
#[test]
fn a_byte_has_left_after_ten_bits() {
    let mut bench = running();
    bench.write(USART1 + DR, 0x55);
    bench.wait(FRAME - 1);
    assert!(bytes(&bench).is_empty());
    bench.wait(1);
    assert_eq!(bench.board.wiring.sent, [(2 * FRAME, Usart(1), 0x55)]);
}

// 30.3.4
#[test]
fn the_baud_rate_is_the_bus_s_clock_by_the_divisor() {
    // USART3 on APB1 at 42 MHz: 2 Mbaud.
    let mut bench = Bench::fast();
    bench.modify(RCC_APB1ENR, |enr| enr | 1 << 18);
    bench.alternate(Pin::new('B', 10), 7);
    bench.write(USART3 + BRR, 21);
    bench.write(USART3 + CR1, UE | TE);
    let frame = 10 * 21 * 8;
    assert_eq!(frame, SECOND / 200_000);
    assert_eq!(bench.board.next_event(), bench.now + frame);
}

// 30.3.4
#[test]
fn with_over8_the_fraction_has_three_bits() {
    let mut bench = connected();
    bench.write(USART1 + BRR, 2 << 4 | 5);
    bench.write(USART1 + CR1, UE | TE | 1 << 15);
    assert_eq!(bench.board.next_event(), 10 * (2 * 8 + 5) * 21);
}

// 30.3.1, 30.6.5: STOP
#[test]
fn a_frame_is_longer_with_nine_bits_or_two_stop_bits() {
    for (control, stop, bits) in [(1 << 12, 0, 11), (0, 2 << 12, 11), (1 << 12, 2 << 12, 12)] {
        let mut bench = connected();
        bench.write(USART1 + CR2, stop);
        bench.write(USART1 + CR1, UE | TE | control);
        assert_eq!(bench.board.next_event(), bits * FRAME / 10);
    }
}

// 30.3.2
#[test]
fn an_idle_frame_goes_out_first() {
    let mut bench = connected();
    bench.write(USART1 + CR1, UE | TE);
    bench.write(USART1 + DR, 1);
    bench.wait(2 * FRAME);
    assert_eq!(bench.board.wiring.sent, [(2 * FRAME, Usart(1), 1)]);
}

// 30.3.2
#[test]
fn txe_says_that_the_data_register_is_empty() {
    let mut bench = running();
    bench.write(USART1 + DR, 1);
    assert_eq!(bench.read(USART1 + SR) & TXE, TXE);
    bench.write(USART1 + DR, 2);
    assert_eq!(bench.read(USART1 + SR) & TXE, 0);
    bench.wait(FRAME);
    assert_eq!(bench.read(USART1 + SR) & TXE, TXE);
}

// 30.3.2
#[test]
fn tc_is_set_when_the_last_frame_is_complete() {
    let mut bench = running();
    bench.read(USART1 + SR);
    bench.write(USART1 + DR, 1);
    bench.write(USART1 + DR, 2);
    bench.wait(2 * FRAME - 1);
    assert_eq!(bench.read(USART1 + SR) & TC, 0);
    bench.wait(1);
    assert_eq!(bench.read(USART1 + SR) & TC, TC);
}

// 30.6.1: TC
#[test]
fn tc_is_cleared_by_reading_status_and_then_writing_data() {
    let mut bench = running();
    bench.write(USART1 + DR, 1);
    assert_eq!(bench.read(USART1 + SR) & TC, TC);
    bench.write(USART1 + DR, 2);
    assert_eq!(bench.read(USART1 + SR) & TC, 0);
}

// 30.6.1: TC
#[test]
fn tc_is_cleared_by_writing_zero() {
    let mut bench = running();
    bench.write(USART1 + SR, !TC);
    assert_eq!(bench.read(USART1 + SR), TXE);
}

// 30.3.3
#[test]
fn a_byte_received_sets_rxne_until_it_is_read() {
    let mut bench = running();
    bench.plan_byte(1, Usart(1), 0xA5);
    bench.wait(1);
    assert_eq!(bench.read(USART1 + SR) & RXNE, RXNE);
    assert_eq!(bench.read(USART1 + DR), 0xA5);
    assert_eq!(bench.read(USART1 + SR) & RXNE, 0);
}

// 30.3.3: overrun error
#[test]
fn a_byte_that_comes_before_the_last_was_read_is_lost_and_flagged() {
    let mut bench = running();
    bench.plan_byte(1, Usart(1), 1);
    bench.plan_byte(1 + FRAME, Usart(1), 2);
    bench.wait(1 + FRAME);
    assert_eq!(bench.read(USART1 + SR) & (ORE | RXNE), ORE | RXNE);
    assert_eq!(bench.read(USART1 + DR), 1);
    assert_eq!(bench.read(USART1 + SR) & (ORE | RXNE), 0);
}

// 30.6.1: ORE
#[test]
fn an_overrun_is_cleared_only_by_reading_status_first() {
    let mut bench = running();
    bench.plan_byte(1, Usart(1), 1);
    bench.plan_byte(2, Usart(1), 2);
    bench.wait(2);
    bench.read(USART1 + DR);
    assert_eq!(bench.read(USART1 + SR) & ORE, ORE);
    bench.read(USART1 + DR);
    assert_eq!(bench.read(USART1 + SR) & ORE, 0);
}

// 30.3.3: idle character
#[test]
fn a_line_that_falls_silent_is_idle_once() {
    let mut bench = running();
    bench.plan_byte(1, Usart(1), 1);
    bench.wait(1);
    bench.read(USART1 + DR);
    assert_eq!(bench.read(USART1 + SR) & IDLE, 0);
    bench.wait(2 * FRAME);
    assert_eq!(bench.read(USART1 + SR) & IDLE, IDLE);
    bench.read(USART1 + DR);
    bench.wait(10 * FRAME);
    assert_eq!(bench.read(USART1 + SR) & IDLE, 0);
}

// 30.3.3: idle character
#[test]
fn bytes_without_a_gap_leave_the_line_busy() {
    let mut bench = running();
    for n in 0..5 {
        // A sender that is one per cent slow.
        bench.plan_byte(FRAME * 101 * n / 100 + 1, Usart(1), 0);
    }
    bench.wait(5 * FRAME);
    assert_eq!(bench.read(USART1 + SR) & IDLE, 0);
}

// 30.3.3
#[test]
fn a_receiver_that_is_off_hears_nothing() {
    let mut bench = connected();
    bench.write(USART1 + CR1, UE | TE);
    bench.plan_byte(1, Usart(1), 1);
    bench.wait(1);
    assert_eq!(bench.read(USART1 + SR) & RXNE, 0);
}

// 30.3.1: parity
#[test]
fn with_parity_and_eight_bits_seven_are_data() {
    let mut bench = connected();
    bench.write(USART1 + CR1, UE | TE | RE | 1 << 10);
    bench.wait(FRAME);
    bench.write(USART1 + DR, 0xFF);
    bench.wait(FRAME);
    assert_eq!(bytes(&bench), [0x7F]);
}

// 30.6.2: with parity, the bit in the place of the highest is the parity that was received
#[test]
fn eight_bits_and_even_parity_make_nine_that_are_read() {
    let mut bench = connected();
    let with_parity = Format {
        parity: Parity::Even,
        stop_halves: 4,
        ..bench.line
    };
    bench.line = with_parity;
    bench.write(USART1 + CR2, 2 << 12);
    bench.write(USART1 + CR1, UE | TE | RE | 1 << 12 | 1 << 10);
    bench.plan_byte(1, Usart(1), 0x07);
    bench.wait(1);
    assert_eq!(bench.read(USART1 + SR) & (PE | FE | RXNE), RXNE);
    assert_eq!(bench.read(USART1 + DR), 0x107);
    bench.wait(2 * FRAME);
    bench.write(USART1 + DR, 0x07);
    bench.wait(2 * FRAME);
    assert_eq!(bench.board.wiring.sent_as, Some(with_parity));
}

// 30.3.3: framing error
#[test]
fn a_sender_that_is_too_slow_makes_framing_errors() {
    let mut bench = running();
    bench.line.bit = FRAME;
    bench.plan_byte(1, Usart(1), 0x00);
    bench.wait(FRAME);
    assert_eq!(bench.read(USART1 + SR) & (FE | RXNE), FE | RXNE);
    assert_eq!(bench.read(USART1 + DR), 0);
    assert_eq!(bench.read(USART1 + SR) & (FE | RXNE), 0);
}

// 30.3.3
#[test]
fn a_sender_that_is_too_fast_is_not_understood() {
    let mut bench = running();
    bench.line.bit = FRAME / 40;
    for n in 0..40 {
        bench.plan_byte(1 + n * FRAME / 4, Usart(1), 0xB5);
    }
    let mut heard = vec![];
    for _ in 0..12 {
        bench.wait(FRAME);
        if bench.read(USART1 + SR) & RXNE != 0 {
            heard.push(bench.read(USART1 + DR));
        }
    }
    assert!(!heard.is_empty() && !heard.contains(&0xB5), "{heard:?}");
}

// 30.3.5, 30.4: PEIE
#[test]
fn wrong_parity_raises_the_interrupt_where_it_is_enabled() {
    let mut bench = connected();
    bench.line.parity = Parity::Odd;
    let on = UE | TE | RE | 1 << 12 | 1 << 10;
    bench.write(USART1 + CR1, on);
    bench.plan_byte(1, Usart(1), 0x55);
    bench.wait(2 * FRAME);
    assert_eq!(bench.read(USART1 + SR) & (PE | FE), PE);
    assert!(!bench.requests(INTERRUPT));
    bench.write(USART1 + CR1, on | 1 << 8);
    assert!(bench.requests(INTERRUPT));
    bench.read(USART1 + DR);
    assert!(!bench.requests(INTERRUPT));
}

// 30.6.6: EIE
#[test]
fn a_framing_error_raises_the_error_interrupt_under_dma() {
    let mut bench = running();
    bench.write(USART1 + CR3, 1 | 1 << 6);
    bench.line.bit = FRAME;
    bench.plan_byte(1, Usart(1), 0x00);
    bench.wait(FRAME);
    assert!(bench.requests(INTERRUPT));
}

// 30.4
#[test]
fn each_flag_raises_the_interrupt_where_it_is_enabled() {
    let mut bench = running();
    let on = UE | TE | RE;
    bench.write(USART1 + SR, 0);
    for (enable, raised) in [(1 << 7, true), (1 << 6, false), (1 << 5, false), (1 << 4, false)] {
        bench.write(USART1 + CR1, on | enable);
        assert_eq!(bench.requests(INTERRUPT), raised);
    }
    bench.plan_byte(1, Usart(1), 1);
    bench.plan_byte(2, Usart(1), 2);
    bench.wait(2);
    bench.write(USART1 + CR1, on | 1 << 5);
    assert!(bench.requests(INTERRUPT));
    bench.wait(2 * FRAME);
    bench.write(USART1 + CR1, on | 1 << 4);
    assert!(bench.requests(INTERRUPT));
}

// 30.4: ORE raises the receiver's interrupt too
#[test]
fn an_overrun_raises_the_receiver_s_interrupt() {
    let mut bench = running();
    bench.write(USART1 + CR1, UE | TE | RE | 1 << 5);
    bench.plan_byte(1, Usart(1), 1);
    bench.plan_byte(2, Usart(1), 2);
    bench.wait(2);
    bench.read(USART1 + DR);
    assert!(bench.requests(INTERRUPT));
}

// 30.6.6: EIE
#[test]
fn the_error_interrupt_is_for_reception_by_dma() {
    let mut bench = running();
    bench.write(USART1 + CR3, 1);
    bench.plan_byte(1, Usart(1), 1);
    bench.plan_byte(2, Usart(1), 2);
    bench.wait(2);
    assert!(!bench.requests(INTERRUPT));
    bench.write(USART1 + CR3, 1 | 1 << 6);
    assert!(bench.requests(INTERRUPT));
}

// 30.6.1: TXE
#[test]
fn a_byte_written_over_one_that_waits_is_refused() {
    let mut bench = running();
    bench.write(USART1 + DR, 1);
    bench.write(USART1 + DR, 2);
    assert_says(&bench.refused(USART1 + DR, 3), "before TXE");
}

// 30.3.2
#[test]
fn a_byte_for_a_transmitter_that_is_off_is_refused() {
    assert_says(&connected().refused(USART1 + DR, 1), "transmitter is off");
}

// 30.3.4
#[test]
fn a_port_without_a_baud_rate_is_refused() {
    let mut bench = connected();
    bench.write(USART1 + BRR, 0);
    assert_says(&bench.refused(USART1 + CR1, UE | TE), "baud rate");
}

// 8.3.2
#[test]
fn a_direction_without_its_pin_is_refused_by_the_pins_that_could_carry_it() {
    let mut bench = Bench::powered();
    bench.write(USART1 + BRR, DIVISOR);
    assert_says(
        &bench.refused(USART1 + CR1, UE | TE),
        "USART1: no pin is switched to TX: it takes PA9 in AF7 or PB6 in AF7",
    );
    let mut bench = connected();
    bench.mode(Pin::new('A', 10), 0);
    assert_says(&bench.refused(USART1 + CR1, UE | TE | RE), "RX");
}

// 30.3.10
#[test]
fn in_half_duplex_the_transmitter_s_pin_receives() {
    let mut bench = connected();
    bench.mode(Pin::new('A', 10), 0);
    bench.write(USART1 + CR3, 1 << 3);
    bench.write(USART1 + CR1, UE | TE | RE);
    bench.plan_byte(1, Usart(1), 9);
    bench.wait(1);
    assert_eq!(bench.read(USART1 + DR), 9);
}

#[test]
fn what_the_boards_do_not_use_is_refused() {
    assert_says(&connected().refused(USART1 + CR2, 1 << 14), "LIN");
    assert_says(&connected().refused(USART1 + CR3, 1 << 9), "flow control");
    assert_says(&connected().refused(USART1 + CR1, UE | 1), "break");
}
