//! A bus that is held, and how a driver frees it: by clocks and a stop, by hand.

use super::desk::{BSRR, Desk, GPIOB, IDR, MS};
use super::i2c::Failure::{Arbitration, TimedOut};
use super::i2c::{ACK, BAROMETER, COMPASS, CR1, PE, SCL, SDA, SR2, START, desk};
use windhover_hil::time::MICROSECOND;

const BUSY: u32 = 1 << 1;
const SWRST: u32 = 1 << 15;

impl Desk {
    pub fn data(&mut self) -> bool {
        self.read(GPIOB + IDR) >> 9 & 1 == 1
    }

    fn set(&mut self, pin: u32, level: bool) {
        self.write(GPIOB + BSRR, if level { 1 << pin } else { 1 << (16 + pin) });
        self.wait(5 * MICROSECOND);
    }

    /// At most nine clocks, and a stop: how many it took.
    fn free_bus(&mut self) -> u32 {
        self.write(GPIOB + BSRR, 1 << 8 | 1 << 9);
        self.switch(SCL, 1, 4);
        self.switch(SDA, 1, 4);
        self.wait(5 * MICROSECOND);
        let mut clocks = 0;
        while !self.data() && clocks < 9 {
            self.set(8, false);
            self.set(8, true);
            clocks += 1;
        }
        self.set(8, false);
        self.set(9, false);
        self.set(8, true);
        self.set(9, true);
        self.set_up_i2c();
        clocks
    }
}

#[test]
fn a_line_that_is_held_low_times_out_and_nothing_hangs() {
    for fault in ["i2c-data-low@0.1+0.1", "i2c-clock-low@0.1+0.1"] {
        let mut desk = desk(&[fault]);
        assert_eq!(desk.load(BAROMETER, 0x0D), Ok([0x10]));
        desk.wait(60 * MS);
        let begin = desk.now;
        assert_eq!(desk.load::<1>(BAROMETER, 0x0D), Err(TimedOut));
        assert!(desk.now - begin < 2 * MS + 10 * MICROSECOND);
        assert_eq!(desk.read(SR2) & BUSY, BUSY);
        desk.free_bus();
        assert_eq!(desk.load::<1>(BAROMETER, 0x0D), Err(TimedOut), "it is still held");
        desk.wait(100 * MS);
        desk.free_bus();
        assert_eq!(desk.load(BAROMETER, 0x0D), Ok([0x10]));
        assert_eq!(desk.load(COMPASS, 0x00), Ok([0x10]));
    }
}

/// The fault comes in the middle of a transfer.
#[test]
fn a_line_that_falls_during_a_transfer_ends_it() {
    for (fault, failure) in [
        ("i2c-data-low@0.0501", Arbitration),
        ("i2c-clock-low@0.0501", TimedOut),
    ] {
        let mut desk = desk(&[fault]);
        assert_eq!(desk.load::<1>(BAROMETER, 0x0D), Err(failure), "{fault}");
    }
}

/// The interface is reset after so many half clocks of a read, of coefficients with zeros among their
/// bits.
pub fn reset_in_a_read(after: u64) -> Desk {
    let mut desk = desk(&[]);
    let until = desk.now + 2 * MS;
    assert_eq!(desk.load(BAROMETER, 0x0F), Ok([0x00]));
    desk.address(BAROMETER << 1 | 1, ACK, until).unwrap();
    desk.wait(after * 5 * MICROSECOND);
    desk.write(CR1, SWRST);
    desk.write(CR1, 0);
    desk.wait(MICROSECOND);
    desk
}

/// A reset comes at any time of a read: the part may be left driving a zero, and is clocked free.
#[test]
fn after_a_reset_in_the_middle_of_a_read_clocks_free_the_bus() {
    let mut held = 0;
    for after in 0..40 {
        let mut desk = reset_in_a_read(after);
        if desk.data() {
            continue;
        }
        held += 1;
        desk.set_up_i2c();
        desk.write(CR1, PE | START);
        desk.wait(MS);
        assert_eq!(desk.read(CR1) & START, START, "no start can be made");
        let clocks = desk.free_bus();
        assert!((1..=9).contains(&clocks));
        assert_eq!(desk.load(BAROMETER, 0x0D), Ok([0x10]), "{after}");
    }
    assert!(held > 10, "{held}");
}
