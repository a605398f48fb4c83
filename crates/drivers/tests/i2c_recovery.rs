//! A bus is freed from a part that was left anywhere in a transfer.

use core::cell::RefCell;
use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use windhover_drivers::i2c_recovery::{CLOCKS, Held, RECOVER_US, recover};

/// A part that sends 0x00 or other bytes, or that takes a byte in, and was left there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Left {
    Idle,
    /// It sends these bits, the next one at the top; so many bits are left, then the ninth clock.
    Sending {
        bits: u8,
        left: u32,
    },
    /// It holds data for the acknowledgement of a byte.
    Acknowledging,
    /// So many bits of a byte have come.
    Receiving {
        bits: u32,
    },
}

/// Both lines. A line is high if nobody holds it.
#[derive(Debug)]
struct Lines {
    clock: bool,
    data: bool,
    part: Left,
    shorted: Option<Held>,
    clocks: u32,
    /// A byte that a part took for one that was sent.
    taken: u32,
    stops: u32,
    waited: u32,
}

impl Lines {
    fn levels(&self) -> (bool, bool) {
        let held = match self.part {
            Left::Sending { bits, left } => left > 0 && bits & 0x80 == 0,
            Left::Acknowledging => true,
            _ => false,
        };
        (
            self.clock && self.shorted != Some(Held::Clock),
            self.data && !held && self.shorted != Some(Held::Data),
        )
    }

    fn set(&mut self, clock: bool, data: bool) {
        let before = self.levels();
        (self.clock, self.data) = (clock, data);
        match (before, self.levels()) {
            // The clock falls.
            ((true, level), (false, _)) => {
                self.clocks += 1;
                self.part = match self.part {
                    Left::Sending { bits, left } if left > 0 => Left::Sending {
                        bits: bits << 1,
                        left: left - 1,
                    },
                    // Nobody acknowledges: it stops.
                    Left::Sending { .. } if level => Left::Idle,
                    Left::Sending { .. } => Left::Sending { bits: 0, left: 8 },
                    Left::Acknowledging => Left::Receiving { bits: 0 },
                    Left::Receiving { bits: 7 } => {
                        self.taken += 1;
                        Left::Acknowledging
                    }
                    Left::Receiving { bits } => Left::Receiving { bits: bits + 1 },
                    Left::Idle => Left::Idle,
                };
            }
            // Data changes while the clock is high: a start, a stop.
            ((true, true), (true, false)) => panic!("no start"),
            ((true, false), (true, true)) => {
                self.stops += 1;
                self.part = Left::Idle;
            }
            _ => {}
        }
    }
}

struct Clock<'a>(&'a RefCell<Lines>);
struct Data<'a>(&'a RefCell<Lines>);
struct Delay<'a>(&'a RefCell<Lines>);

impl ErrorType for Clock<'_> {
    type Error = Infallible;
}

impl ErrorType for Data<'_> {
    type Error = Infallible;
}

impl OutputPin for Clock<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let mut lines = self.0.borrow_mut();
        let data = lines.data;
        lines.set(false, data);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        let mut lines = self.0.borrow_mut();
        let data = lines.data;
        lines.set(true, data);
        Ok(())
    }
}

impl OutputPin for Data<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let mut lines = self.0.borrow_mut();
        let clock = lines.clock;
        lines.set(clock, false);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        let mut lines = self.0.borrow_mut();
        let clock = lines.clock;
        lines.set(clock, true);
        Ok(())
    }
}

impl InputPin for Clock<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.borrow().levels().0)
    }
    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().levels().0)
    }
}

impl InputPin for Data<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.borrow().levels().1)
    }
    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().levels().1)
    }
}

impl DelayNs for Delay<'_> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().waited += ns / 1_000;
    }
}

fn free(part: Left, shorted: Option<Held>) -> (Result<(), Held>, Lines) {
    let lines = RefCell::new(Lines {
        clock: true,
        data: true,
        part,
        shorted,
        clocks: 0,
        taken: 0,
        stops: 0,
        waited: 0,
    });
    let result = recover(&mut Clock(&lines), &mut Data(&lines), &mut Delay(&lines));
    let lines = lines.into_inner();
    assert!(lines.waited <= RECOVER_US && lines.clocks <= CLOCKS);
    (result, lines)
}

/// Each byte, left at each of its bits; and each place of a byte that is written.
#[test]
fn a_part_left_anywhere_lets_the_bus_go() {
    let sending = (0..=255).flat_map(|bits| (0..=8).map(move |left| Left::Sending { bits, left }));
    let receiving = (0..8).map(|bits| Left::Receiving { bits });
    for part in sending.chain(receiving).chain([Left::Acknowledging, Left::Idle]) {
        let (result, lines) = free(part, None);
        assert_eq!(result, Ok(()), "{part:?}");
        assert_eq!((lines.part, lines.stops), (Left::Idle, 1), "{part:?}");
        assert_eq!(lines.levels(), (true, true));
    }
}

/// One clock, for the stop, completes a byte only where all of its bits were on the line before.
#[test]
fn no_part_takes_clocks_for_a_byte_that_it_was_not_sent() {
    for bits in 0..7 {
        assert_eq!(free(Left::Receiving { bits }, None).1.taken, 0);
    }
}

#[test]
fn a_line_that_is_held_for_good_is_told() {
    for held in [Held::Clock, Held::Data] {
        assert_eq!(free(Left::Idle, Some(held)).0, Err(held));
    }
}
