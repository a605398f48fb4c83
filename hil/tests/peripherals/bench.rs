//! A board on the bench: wires that record, memory, and a clock that the test moves.

use super::registers::*;
use std::collections::VecDeque;
use windhover_hil::board::{
    Board, Format, Frame, I2cCondition, Inputs, Memory, Pin, PwmPulse, Usart, Wiring,
};
use windhover_hil::machine::Bus;
use windhover_hil::time::{MICROSECOND, NEVER};
use windhover_hil::violation::Violation;

/// What went over I2C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Talk {
    Condition(I2cCondition),
    Sent(u8),
    /// And whether it was acknowledged.
    Received(u8, bool),
}

/// Wires that record what comes out, and carry in what a test has planned.
#[derive(Default)]
pub struct Wires {
    pub outputs: Vec<(u64, Pin, bool)>,
    pub pulses: Vec<(u64, Pin, PwmPulse)>,
    pub stopped: Vec<(u64, Pin)>,
    pub sent: Vec<(u64, Usart, u8)>,
    /// How the last byte was sent.
    pub sent_as: Option<Format>,
    /// Bytes that went out over SPI, with the times of their ends.
    pub exchanged: Vec<(u64, u8)>,
    /// What went over I2C, with the times of its end.
    pub talk: Vec<(u64, Talk)>,
    /// Bytes that are acknowledged on I2C.
    pub acknowledged: Vec<u8>,
    /// Bytes that I2C will read.
    pub to_read: VecDeque<u8>,
    /// Pins that were converted, and when.
    pub converted: Vec<(u64, Pin)>,
    pub planned: VecDeque<(u64, Inputs)>,
}

impl Wiring for Wires {
    /// Echoes the byte, inverted.
    fn spi(&mut self, now: u64, mosi: u8) -> u8 {
        self.exchanged.push((now, mosi));
        !mosi
    }
    fn i2c_condition(&mut self, now: u64, condition: I2cCondition) {
        self.talk.push((now, Talk::Condition(condition)));
    }
    fn i2c_send(&mut self, now: u64, byte: u8) -> bool {
        self.talk.push((now, Talk::Sent(byte)));
        self.acknowledged.contains(&byte)
    }
    fn i2c_receive(&mut self, now: u64, acknowledge: bool) -> u8 {
        let byte = self.to_read.pop_front().unwrap_or(0xFF);
        self.talk.push((now, Talk::Received(byte, acknowledge)));
        byte
    }
    /// Of PC0 0x100, 0x101, and so on with each conversion; of PC1 0x200, and so on.
    fn analogue(&mut self, now: u64, pin: Pin) -> u16 {
        let before = self.converted.iter().filter(|(_, other)| *other == pin);
        let counts = 0x100 * (1 + u16::from(pin.number)) + before.count() as u16;
        self.converted.push((now, pin));
        counts
    }
    fn output(&mut self, now: u64, pin: Pin, level: bool) {
        self.outputs.push((now, pin, level));
    }
    fn pwm(&mut self, now: u64, pin: Pin, pulse: PwmPulse) {
        self.pulses.push((now, pin, pulse));
    }
    fn pwm_stopped(&mut self, now: u64, pin: Pin) {
        self.stopped.push((now, pin));
    }
    fn transmitted(&mut self, now: u64, port: Usart, frame: Frame) {
        self.sent.push((now, port, frame.data as u8));
        self.sent_as = Some(frame.format);
    }
    fn next_event(&self) -> u64 {
        self.planned.front().map_or(NEVER, |(time, _)| *time)
    }
    fn advance(&mut self, now: u64, inputs: &mut Inputs) {
        while self.planned.front().is_some_and(|(time, _)| *time <= now) {
            let (_, planned) = self.planned.pop_front().unwrap();
            inputs.levels.extend(planned.levels);
            inputs.received.extend(planned.received);
        }
    }
}

pub const SRAM: u32 = 0x2000_0000;
pub const FLASH_START: u32 = 0x0800_0000;

/// SRAM and flash, the flash erased.
pub struct Chips {
    pub sram: Vec<u8>,
    pub flash: Vec<u8>,
}

impl Chips {
    fn place(&mut self, address: u32, size: usize) -> &mut [u8] {
        let (bytes, start) = if address >= SRAM {
            (&mut self.sram, SRAM)
        } else {
            (&mut self.flash, FLASH_START)
        };
        let from = (address - start) as usize;
        &mut bytes[from..from + size]
    }
}

impl Memory for Chips {
    fn read(&mut self, address: u32, bytes: &mut [u8]) {
        bytes.copy_from_slice(self.place(address, bytes.len()));
    }
    fn write(&mut self, address: u32, bytes: &[u8]) {
        self.place(address, bytes.len()).copy_from_slice(bytes);
    }
}

/// The board, its memory and the time.
pub struct Bench {
    pub board: Board<Wires>,
    pub memory: Chips,
    pub now: u64,
    /// How planned bytes lie on the line.
    pub line: Format,
}

impl Bench {
    /// As after power-on: 16 MHz, every gated clock off.
    pub fn new() -> Self {
        Self {
            board: Board::new(Wires::default()),
            memory: Chips {
                sram: vec![0; 0x2_0000],
                flash: vec![0xFF; 0x10_0000],
            },
            now: 0,
            line: Format {
                bit: 0,
                ..Format::plain(115_200)
            },
        }
    }

    /// With the clocks of most peripherals on, still at 16 MHz: 21 ticks a cycle on every bus.
    pub fn powered() -> Self {
        let mut bench = Self::new();
        bench.write(RCC_AHB1ENR, 0x0070_11FF);
        bench.write(RCC_APB1ENR, 0x1026_01FF);
        bench.write(RCC_APB2ENR, 0x0007_5133);
        bench
    }

    /// At 168 MHz by the crystal: 2 ticks a cycle, APB1 8, APB2 4; every clock on.
    pub fn fast() -> Self {
        let mut bench = Self::powered();
        bench.write(FLASH_ACR, 5);
        bench.modify(RCC_CR, |cr| cr | HSEON);
        bench.wait(3_000 * MICROSECOND);
        bench.write(RCC_PLLCFGR, PLL_168_MHZ);
        bench.modify(RCC_CR, |cr| cr | PLLON);
        bench.wait(300 * MICROSECOND);
        bench.write(RCC_CFGR, CFGR_168_MHZ);
        bench
    }

    pub fn try_read(&mut self, address: u32) -> Result<u32, Violation> {
        self.board.read(self.now, address, 4, &mut self.memory)
    }

    pub fn try_write(&mut self, address: u32, value: u32) -> Result<(), Violation> {
        self.board.write(self.now, address, 4, value, &mut self.memory)
    }

    #[track_caller]
    pub fn read(&mut self, address: u32) -> u32 {
        self.try_read(address).unwrap()
    }

    #[track_caller]
    pub fn write(&mut self, address: u32, value: u32) {
        self.try_write(address, value).unwrap();
    }

    #[track_caller]
    pub fn write_sized(&mut self, address: u32, size: u32, value: u32) {
        self.board
            .write(self.now, address, size, value, &mut self.memory)
            .unwrap();
    }

    #[track_caller]
    pub fn modify(&mut self, address: u32, change: impl FnOnce(u32) -> u32) {
        let old = self.read(address);
        self.write(address, change(old));
    }

    /// Lets time pass.
    pub fn try_wait(&mut self, ticks: u64) -> Result<(), Violation> {
        self.now += ticks;
        self.board.advance(self.now, &mut self.memory)
    }

    #[track_caller]
    pub fn wait(&mut self, ticks: u64) {
        self.try_wait(ticks).unwrap();
    }

    /// The words of the violation that a write is.
    #[track_caller]
    pub fn refused(&mut self, address: u32, value: u32) -> String {
        self.try_write(address, value).unwrap_err().to_string()
    }

    /// Whether an interrupt's request line is high.
    pub fn requests(&self, interrupt: u32) -> bool {
        self.board.interrupts() & 1 << interrupt != 0
    }

    /// Plans that a pin will have a level after so many ticks.
    pub fn plan_level(&mut self, after: u64, pin: Pin, level: bool) {
        let inputs = Inputs {
            levels: vec![(pin, level)],
            received: vec![],
        };
        self.board.wiring.planned.push_back((self.now + after, inputs));
    }

    /// Plans that a byte of the format of [`Self::line`] will have come in after so many ticks.
    pub fn plan_byte(&mut self, after: u64, port: Usart, byte: u8) {
        let frame = Frame {
            data: byte.into(),
            format: self.line,
        };
        let inputs = Inputs {
            levels: vec![],
            received: vec![(port, frame)],
        };
        self.board.wiring.planned.push_back((self.now + after, inputs));
    }

    /// Switches a pin to an alternate function.
    pub fn alternate(&mut self, pin: Pin, function: u32) {
        let port = GPIOA + 0x400 * u32::from(pin.port);
        let number = u32::from(pin.number);
        let register = port + AFRL + 4 * (number / 8);
        let shift = 4 * (number % 8);
        self.modify(register, |afr| afr & !(0xF << shift) | function << shift);
        self.mode(pin, 2);
    }

    /// Writes a pin's two bits in MODER.
    pub fn mode(&mut self, pin: Pin, mode: u32) {
        let port = GPIOA + 0x400 * u32::from(pin.port);
        let shift = 2 * u32::from(pin.number);
        self.modify(port + MODER, |moder| moder & !(3 << shift) | mode << shift);
    }

    /// Bytes of memory.
    pub fn bytes(&mut self, address: u32, size: usize) -> Vec<u8> {
        self.memory.place(address, size).to_vec()
    }

    pub fn set_bytes(&mut self, address: u32, bytes: &[u8]) {
        self.memory.write(address, bytes);
    }
}

/// Asserts that a violation says something.
#[track_caller]
pub fn assert_says(violation: &str, words: &str) {
    assert!(violation.contains(words), "{violation:?} does not say {words:?}");
}
