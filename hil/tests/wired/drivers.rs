//! The drivers that the firmware ships, on the board's registers: what they do, the parts' data
//! sheets allow, and what they read is what the vehicle's truth is.

use core::cell::RefCell;
use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType as PinErrorType, InputPin, OutputPin};
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use windhover_drivers::health::Health;
use windhover_drivers::i2c_recovery::recover;
use windhover_drivers::ist8310::{CompassReading, Ist8310};
use windhover_drivers::spl06::{BarometerReading, Spl06};
use windhover_drivers::ublox::{Action, Message, NavPvt, Parser, Setup};
use windhover_hil::board::Pin;
use windhover_hil::parts::ublox::Generation;
use windhover_hil::time::{MICROSECOND, SECOND};
use windhover_model::sensor::barometer::atmosphere;

use super::desk::{BSRR, Desk, GPIOB, IDR, MS};
use super::i2c::{BAROMETER, Failure, SCL, SDA};
use super::recovery::reset_in_a_read;
use super::serial::{PLAIN, USART6};

impl Error for Failure {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Refused => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown),
            Self::Arbitration => ErrorKind::ArbitrationLoss,
            Self::TimedOut => ErrorKind::Other,
        }
    }
}

impl ErrorType for Desk {
    type Error = Failure;
}

impl I2c for Desk {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Failure> {
        let result = match operations {
            [Operation::Write(bytes)] => self.store(address, bytes),
            [Operation::Write(register), Operation::Read(bytes)] => self.load_to(address, register[0], bytes),
            _ => panic!("no driver does so"),
        };
        // A transfer that failed may leave the interface in the middle of something.
        if result.is_err() {
            self.set_up_i2c();
        }
        result
    }
}

#[derive(Default)]
struct Parts {
    barometer: Spl06,
    compass: Ist8310,
    pressures: Vec<BarometerReading>,
    fields: Vec<CompassReading>,
}

impl Parts {
    /// Both are polled each ms.
    fn run(&mut self, desk: &mut Desk, time: u64) {
        let end = desk.now + time;
        while desk.now < end {
            let now = desk.now / MICROSECOND;
            self.pressures.extend(self.barometer.poll(desk, now));
            self.fields.extend(self.compass.poll(desk, now));
            desk.wait(MS);
        }
    }

    fn health(&self) -> [Health; 2] {
        [self.barometer.health(), self.compass.health()]
    }
}

#[test]
fn barometer_and_compass_read_the_truth_by_the_rules_of_their_data_sheets() {
    let mut desk = Desk::new(&[], |_| {});
    desk.set_up_i2c();
    let mut parts = Parts::default();
    parts.run(&mut desk, 3 * SECOND);
    assert_eq!(parts.health(), [Health::Working; 2]);
    assert!(
        (85..=96).contains(&parts.pressures.len()),
        "{}",
        parts.pressures.len()
    );
    let (_, expected, _) = atmosphere(488.0);
    for reading in &parts.pressures {
        let error = f64::from(reading.pressure) - expected;
        assert!(error.abs() < 10.0, "{error} Pa");
    }
    assert!(
        (130..=150).contains(&parts.fields.len()),
        "{}",
        parts.fields.len()
    );
    for reading in &parts.fields {
        let field = reading.counts.map(|count| f64::from(count) / 3.3);
        let square: f64 = field.iter().map(|axis| axis * axis).sum();
        assert!((44.0 * 44.0..52.0 * 52.0).contains(&square), "{field:?}");
    }
    assert_eq!(desk.board.wiring.part_misuse(), []);
}

/// Unplugged for half a second, one after the other.
#[test]
fn parts_that_come_back_are_found() {
    let mut desk = Desk::new(&["baro-unplugged@1+0.5", "compass-unplugged@2+0.5"], |_| {});
    desk.set_up_i2c();
    let mut parts = Parts::default();
    parts.run(&mut desk, SECOND + SECOND / 3);
    assert_eq!(parts.health(), [Health::Absent, Health::Working]);
    parts.run(&mut desk, SECOND);
    assert_eq!(parts.health(), [Health::Working, Health::Absent]);
    parts.run(&mut desk, SECOND);
    assert_eq!(parts.health(), [Health::Working; 2]);
    assert_eq!(desk.board.wiring.part_misuse(), []);
}

/// Each part costs a few time-outs of 2 ms, and then one a second.
#[test]
fn a_bus_that_is_held_hangs_nothing() {
    let mut desk = Desk::new(&["i2c-data-low@1+3"], |_| {});
    desk.set_up_i2c();
    let mut parts = Parts::default();
    parts.run(&mut desk, 3 * SECOND);
    assert!(
        parts
            .health()
            .iter()
            .all(|health| matches!(health, Health::BusFault | Health::Absent))
    );
    parts.run(&mut desk, 3 * SECOND);
    assert_eq!(parts.health(), [Health::Working; 2]);
}

/// A pin of the bus as an open-drain output, by hand.
struct Hand<'a>(&'a RefCell<Desk>, Pin);

impl PinErrorType for Hand<'_> {
    type Error = Infallible;
}

impl OutputPin for Hand<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().write(GPIOB + BSRR, 1 << (16 + self.1.number));
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().write(GPIOB + BSRR, 1 << self.1.number);
        Ok(())
    }
}

impl InputPin for Hand<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.borrow_mut().read(GPIOB + IDR) >> self.1.number & 1 == 1)
    }
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

struct Clock<'a>(&'a RefCell<Desk>);

impl DelayNs for Clock<'_> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().wait(u64::from(ns) * MICROSECOND / 1_000);
    }
}

/// The interface is reset at any time of a read; the part may be left driving a zero.
#[test]
fn recovery_frees_a_bus_that_was_left_anywhere_in_a_read() {
    let mut held = 0;
    for after in 0..80 {
        let mut desk = reset_in_a_read(after);
        held += u32::from(!desk.data());
        desk.write(GPIOB + BSRR, 1 << SCL.number | 1 << SDA.number);
        desk.switch(SCL, 1, 4);
        desk.switch(SDA, 1, 4);
        let desk = RefCell::new(desk);
        let freed = recover(&mut Hand(&desk, SCL), &mut Hand(&desk, SDA), &mut Clock(&desk));
        assert_eq!(freed, Ok(()), "{after}");
        let mut desk = desk.into_inner();
        desk.set_up_i2c();
        assert_eq!(desk.load(BAROMETER, 0x0D), Ok([0x10]), "{after}");
    }
    assert!(held > 10, "{held}");
}

/// The receiver's driver at its port.
#[derive(Default)]
struct Gnss {
    setup: Setup,
    parser: Parser,
    open: bool,
    reports: Vec<NavPvt>,
}

impl Gnss {
    fn run(&mut self, desk: &mut Desk, time: u64) {
        let end = desk.now + time;
        while desk.now < end {
            if self.open {
                let (bytes, _) = desk.listen(USART6, 2 * MS);
                let (setup, reports, now) = (&mut self.setup, &mut self.reports, desk.now / MICROSECOND);
                self.parser.feed(&bytes, |message| {
                    setup.heard(&message, now);
                    if let Message::NavPvt(report) = message {
                        reports.push(report);
                    }
                });
            }
            match self.setup.poll(desk.now / MICROSECOND) {
                None => {}
                Some(Action::SetBaud(baud)) => {
                    desk.open(USART6, baud, PLAIN);
                    self.open = true;
                }
                Some(Action::Send(bytes)) => desk.say(USART6, bytes),
            }
        }
    }
}

#[test]
fn a_receiver_of_either_generation_is_found_and_reports_where_it_is() {
    for generation in [Generation::M8, Generation::M10] {
        let mut desk = Desk::new(&["gnss-unplugged@8+1"], |setup| setup.gnss = generation);
        let mut gnss = Gnss::default();
        for seconds in [6, 13] {
            gnss.run(&mut desk, seconds * SECOND);
            gnss.reports.clear();
            gnss.run(&mut desk, SECOND);
            assert_eq!(gnss.setup.health(), Health::Working, "{generation:?}");
            assert!((9..=11).contains(&gnss.reports.len()), "{generation:?}");
            for report in &gnss.reports {
                assert!((report.latitude - 473_977_419).abs() < 1_000, "{report:?}");
                assert!((report.longitude - 85_455_938).abs() < 1_500, "{report:?}");
                assert!((report.altitude - 488_000).abs() < 12_000, "{report:?}");
                assert_eq!(report.fix, 3);
            }
        }
    }
}
