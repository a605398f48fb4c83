//! What is soldered to the microcontroller's pins.

use std::fmt;

use super::line::Frame;

/// A pin: port 0 is A.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pin {
    /// 0 for port A, 1 for port B, and so on.
    pub port: u8,
    /// 0 to 15.
    pub number: u8,
}

impl Pin {
    /// Pin `number` of the port with this letter.
    pub const fn new(port: char, number: u8) -> Self {
        Self {
            port: port as u8 - b'A',
            number,
        }
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "P{}{}", char::from(b'A' + self.port), self.number)
    }
}

/// A serial port by its number in the reference manual: 1, 2, 3 or 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Usart(pub u8);

/// One period of a PWM output, as it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PwmPulse {
    /// How long the pin will be high, in ticks of virtual time.
    pub high: u64,
    /// Length of the whole period, in ticks of virtual time.
    pub period: u64,
}

/// What I2C1 does on its bus between bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum I2cCondition {
    /// A start, or a repeated start: the next byte is an address.
    Start,
    /// A stop.
    Stop,
    /// It lets go of both lines in the middle of a byte, without a stop: it was reset.
    Released {
        /// Clocks of the byte that were given.
        clocks: u32,
    },
}

/// What is on the other side of the pins. Times are virtual, see [`crate::time`].
pub trait Wiring {
    /// SPI1 exchanges one byte; chip selects have been told through [`Wiring::output`].
    fn spi(&mut self, now: u64, mosi: u8) -> u8;
    /// I2C1 does something else than bytes.
    fn i2c_condition(&mut self, _now: u64, _condition: I2cCondition) {}
    /// I2C1 sent a byte: whether it is acknowledged.
    fn i2c_send(&mut self, _now: u64, _byte: u8) -> bool {
        false
    }
    /// I2C1 received a byte, and acknowledges it or not. Ones, where nobody sends.
    fn i2c_receive(&mut self, _now: u64, _acknowledge: bool) -> u8 {
        0xFF
    }
    /// What a conversion of an analogue pin gives, in 12 bits of the supply.
    fn analogue(&mut self, _now: u64, _pin: Pin) -> u16 {
        0
    }
    /// A pin that the firmware drives as an output changed its level.
    fn output(&mut self, now: u64, pin: Pin, level: bool);
    /// A PWM period begins on a pin that is switched to its timer.
    fn pwm(&mut self, now: u64, pin: Pin, pulse: PwmPulse);
    /// A pin stops giving PWM: its timer stopped, its channel was disabled, or it was switched
    /// away from the timer.
    fn pwm_stopped(&mut self, now: u64, pin: Pin);
    /// The last stop bit of a byte left a serial port's transmitter pin.
    fn transmitted(&mut self, now: u64, port: Usart, frame: Frame);
    /// When something will next happen out here.
    fn next_event(&self) -> u64;
    /// Lets everything happen that is due by `now`.
    fn advance(&mut self, now: u64, inputs: &mut Inputs);
}

/// What the outside does to the pins.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// New levels of input pins, in order.
    pub levels: Vec<(Pin, bool)>,
    /// Bytes whose last stop bits end now at a serial port's receiver.
    pub received: Vec<(Usart, Frame)>,
}
