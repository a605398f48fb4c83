//! Barometer and compass, by a driver that looks at each byte, with a time-out of 2 ms.

use windhover_hil::board::Pin;
use windhover_hil::time::SECOND;
use windhover_model::sensor::barometer::atmosphere;
use windhover_model::sensor::spl06::Formula;

use super::desk::{Desk, GPIOB, MS};

pub const I2C1: u32 = 0x4000_5400;
pub const CR1: u32 = I2C1;
const CR2: u32 = I2C1 + 0x04;
const DR: u32 = I2C1 + 0x10;
const SR1: u32 = I2C1 + 0x14;
pub const SR2: u32 = I2C1 + 0x18;
const CCR: u32 = I2C1 + 0x1C;
const TRISE: u32 = I2C1 + 0x20;
pub const PE: u32 = 1;
pub const START: u32 = 1 << 8;
const STOP: u32 = 1 << 9;
pub const ACK: u32 = 1 << 10;
const SB: u32 = 1;
const ADDR: u32 = 1 << 1;
const BTF: u32 = 1 << 2;
const RXNE: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
const ARLO: u32 = 1 << 9;
const AF: u32 = 1 << 10;
pub const SCL: Pin = Pin::new('B', 8);
pub const SDA: Pin = Pin::new('B', 9);

pub const BAROMETER: u8 = 0x76;
pub const COMPASS: u8 = 0x0E;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    Refused,
    Arbitration,
    TimedOut,
}
use Failure::{Arbitration, Refused, TimedOut};

impl Desk {
    /// Pins in open drain and switched, the interface reset and set to 100 kHz.
    pub fn set_up_i2c(&mut self) {
        self.write(GPIOB + 0x04, 1 << 8 | 1 << 9);
        self.switch(SCL, 2, 4);
        self.switch(SDA, 2, 4);
        const APB1RSTR: u32 = 0x4002_3820;
        self.write(APB1RSTR, 1 << 21);
        self.write(APB1RSTR, 0);
        self.write(CR2, 16);
        self.write(CCR, 80);
        self.write(TRISE, 17);
        self.write(CR1, PE);
    }

    pub fn await_flag(&mut self, flag: u32, until: u64) -> Result<(), Failure> {
        let status = self.poll(SR1, flag | AF | ARLO, until).ok_or(TimedOut)?;
        let failed = [(AF, Refused), (ARLO, Arbitration)];
        match failed.iter().find(|(bit, _)| status & bit != 0) {
            Some((bit, failure)) => {
                self.write(SR1, !bit);
                Err(*failure)
            }
            None => Ok(()),
        }
    }

    pub fn address(&mut self, byte: u8, control: u32, until: u64) -> Result<(), Failure> {
        self.modify(CR1, |cr| cr | START | control);
        self.await_flag(SB, until)?;
        self.write(DR, byte.into());
        self.await_flag(ADDR, until)?;
        self.read(SR2);
        Ok(())
    }

    fn send(&mut self, address: u8, bytes: &[u8], until: u64) -> Result<(), Failure> {
        self.address(address << 1, 0, until)?;
        for byte in bytes {
            self.await_flag(TXE, until)?;
            self.write(DR, (*byte).into());
            self.await_flag(BTF, until)?;
        }
        Ok(())
    }

    pub fn store(&mut self, address: u8, bytes: &[u8]) -> Result<(), Failure> {
        self.send(address, bytes, self.now + 2 * MS)?;
        self.modify(CR1, |cr| cr | STOP);
        Ok(())
    }

    pub fn load<const N: usize>(&mut self, address: u8, register: u8) -> Result<[u8; N], Failure> {
        let mut bytes = [0; N];
        self.load_to(address, register, &mut bytes)?;
        Ok(bytes)
    }

    pub fn load_to(&mut self, address: u8, register: u8, bytes: &mut [u8]) -> Result<(), Failure> {
        let until = self.now + 2 * MS;
        self.send(address, &[register], until)?;
        self.address(address << 1 | 1, ACK, until)?;
        let last = bytes.len() - 1;
        for (n, byte) in bytes.iter_mut().enumerate() {
            if n == last {
                self.modify(CR1, |cr| cr & !ACK | STOP);
            }
            self.await_flag(RXNE, until)?;
            *byte = self.read(DR) as u8;
        }
        Ok(())
    }
}

pub fn desk(faults: &[&str]) -> Desk {
    let mut desk = Desk::new(faults, |_| {});
    desk.set_up_i2c();
    desk.wait(50 * MS);
    desk
}

#[test]
fn both_parts_say_who_they_are() {
    let mut desk = desk(&[]);
    assert_eq!(desk.load(BAROMETER, 0x0D), Ok([0x10]));
    assert_eq!(desk.load(COMPASS, 0x00), Ok([0x10]));
    assert_eq!(desk.load::<1>(0x77, 0), Err(Refused));
    assert_eq!(
        desk.load(BAROMETER, 0x0D),
        Ok([0x10]),
        "after a refusal it goes on"
    );
}

/// The pressure of the air at home, by the formula and coefficients of the part.
#[test]
fn the_barometer_reads_the_air() {
    let mut desk = desk(&[]);
    for write in [[0x06, 0x53], [0x07, 0xD0], [0x09, 0x00], [0x08, 0x07]] {
        desk.store(BAROMETER, &write).unwrap();
    }
    desk.wait(100 * MS);
    assert_eq!(desk.load(BAROMETER, 0x08), Ok([0xF7]));
    let [a, b, c, d, e, f] = desk.load(BAROMETER, 0x00).unwrap();
    let signed = |high, middle, low| i32::from_be_bytes([high, middle, low, 0]) >> 8;
    let formula = Formula::default();
    let pressure = formula.pressure(signed(a, b, c), signed(d, e, f));
    let (_, expected, _) = atmosphere(488.0);
    assert!((pressure - expected).abs() < 10.0, "{pressure} Pa, {expected} Pa");
    assert_eq!(desk.board.wiring.part_misuse(), []);
}

#[test]
fn the_compass_reads_the_field() {
    let mut desk = desk(&[]);
    for write in [[0x41, 0x24], [0x42, 0xC0], [0x0A, 0x01]] {
        desk.store(COMPASS, &write).unwrap();
    }
    desk.wait(7 * MS);
    let [ready, bytes @ ..] = desk.load::<7>(COMPASS, 0x02).unwrap();
    assert_eq!(ready, 1);
    let axis = |n: usize| f64::from(i16::from_le_bytes([bytes[2 * n], bytes[2 * n + 1]])) / 3.3;
    let square: f64 = (0..3).map(|n| axis(n) * axis(n)).sum();
    assert!((44.0 * 44.0..52.0 * 52.0).contains(&square), "{square} uT^2");
    assert!(axis(2) < -30.0, "down, and its z points up: {} uT", axis(2));
    assert_eq!(desk.board.wiring.part_misuse(), []);
}

#[test]
fn a_part_that_is_absent_refuses_and_the_other_answers() {
    let mut desk = desk(&["baro-absent"]);
    assert_eq!(desk.load::<1>(BAROMETER, 0x0D), Err(Refused));
    assert_eq!(desk.load(COMPASS, 0x00), Ok([0x10]));
    let mut desk = self::desk(&["compass-absent"]);
    assert_eq!(desk.load::<1>(COMPASS, 0x00), Err(Refused));
    assert_eq!(desk.load(BAROMETER, 0x0D), Ok([0x10]));
}

#[test]
fn a_part_that_was_unplugged_comes_back_without_its_configuration() {
    let mut desk = desk(&["baro-unplugged@0.1+0.1"]);
    desk.store(BAROMETER, &[0x06, 0x53]).unwrap();
    assert_eq!(desk.load(BAROMETER, 0x06), Ok([0x53]));
    desk.wait(60 * MS);
    assert_eq!(desk.load::<1>(BAROMETER, 0x06), Err(Refused));
    desk.wait(SECOND / 10);
    assert_eq!(desk.load(BAROMETER, 0x06), Ok([0x00]));
}

/// Two parts, a thousand transfers, no byte wrong: 0.8 s on the bus.
#[test]
fn many_transfers_leave_no_trace() {
    let mut desk = desk(&[]);
    for n in 0..1000u32 {
        let (address, register, holds) = if n % 2 == 0 {
            (BAROMETER, 0x0D, 0x10)
        } else {
            (COMPASS, 0x41, 0x12)
        };
        assert_eq!(desk.load(address, register), Ok([holds]));
        if n % 7 == 0 {
            desk.wait(u64::from(n) * 11);
        }
    }
    assert_eq!(desk.board.wiring.part_misuse(), []);
}
