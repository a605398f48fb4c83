//! The compass: start, results, faults.

use windhover_drivers::health::Health;
use windhover_drivers::i2c_part::{MOST_FAILURES, RETRY_US};
use windhover_drivers::ist8310::{ADDRESS, CompassReading, Ist8310};

use super::bus::{Bus, Fault, Registers};

const SECOND: u64 = 1_000_000;

/// The part's registers as its data sheet has them. Wrong use fails the test.
struct Part {
    identity: u8,
    powered: u64,
    averaging: u8,
    pulse: u8,
    /// When the measurement under way will be done.
    done: Option<u64>,
    ready: bool,
    /// What is measured.
    field: [i16; 3],
    broken: bool,
}

impl Part {
    fn new() -> Self {
        Self {
            identity: 0x10,
            powered: 0,
            averaging: 0x12,
            pulse: 0,
            done: None,
            ready: false,
            field: [100, -200, 8000],
            broken: false,
        }
    }

    fn finish(&mut self, now: u64) {
        if let Some(done) = self.done
            && done <= now
            && !self.broken
        {
            self.done = None;
            self.ready = true;
        }
    }
}

impl Registers for Part {
    fn address(&self) -> u8 {
        ADDRESS
    }

    fn power_cycle(&mut self, now: u64) {
        *self = Self {
            identity: self.identity,
            powered: now,
            field: self.field,
            ..Self::new()
        };
    }

    fn read(&mut self, now: u64, register: u8) -> u8 {
        self.finish(now);
        match register {
            0 => self.identity,
            2 => u8::from(self.ready),
            3..=8 => {
                self.ready = false;
                let place = usize::from(register - 3);
                self.field[place / 2].to_le_bytes()[place % 2]
            }
            0x41 => self.averaging,
            0x42 => self.pulse,
            _ => panic!("{register:#x} is read"),
        }
    }

    fn write(&mut self, now: u64, register: u8, value: u8) {
        assert_eq!(
            self.identity, 0x10,
            "nothing is written to a part that is not known"
        );
        self.finish(now);
        match (register, value) {
            (0x0A, 1) => {
                assert!(now >= self.powered + 10_000, "not started");
                assert_eq!(self.done, None, "one at a time");
                let time = if self.averaging == 0x24 { 6_000 } else { 3_000 };
                self.done = Some(now + time);
            }
            (0x0B, 1) => self.power_cycle(now),
            (0x41, 0x24) => self.averaging = value,
            (0x42, 0xC0) => self.pulse = value,
            _ => panic!("{value:#x} is written to {register:#x}"),
        }
    }
}

/// Part and driver, polled every ms.
struct Bench {
    bus: Bus<Part>,
    driver: Ist8310,
}

impl Bench {
    fn new(part: Part) -> Self {
        Self {
            bus: Bus::new(part),
            driver: Ist8310::new(),
        }
    }

    fn run(&mut self, us: u64) -> Vec<CompassReading> {
        let driver = &mut self.driver;
        self.bus.poll(us, |bus, now| driver.poll(bus, now))
    }
}

#[test]
fn from_power_on_it_measures_50_times_a_second() {
    let mut bench = Bench::new(Part::new());
    assert_eq!(bench.driver.health(), Health::Configuring);
    assert!(!bench.run(100_000).is_empty(), "within 0.1 s");
    assert_eq!(bench.driver.health(), Health::Working);
    assert_eq!((bench.bus.part.averaging, bench.bus.part.pulse), (0x24, 0xC0));
    let readings = bench.run(10 * SECOND);
    assert!((495..=500).contains(&readings.len()), "{}", readings.len());
    assert!(readings.windows(2).all(|pair| pair[0].time < pair[1].time));
}

#[test]
fn counts_are_those_of_the_registers() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    for field in [[0, 1, -1], [i16::MIN, i16::MAX, 256], [-255, 127, 128]] {
        bench.bus.part.field = field;
        assert_eq!(
            bench.run(SECOND / 10).last().map(|reading| reading.counts),
            Some(field)
        );
    }
}

/// The middle of six milliseconds.
#[test]
fn a_result_is_of_the_time_at_which_it_was_measured() {
    let mut bench = Bench::new(Part::new());
    let mut readings = vec![];
    while readings.is_empty() {
        readings = bench.run(1_000);
    }
    let age = bench.bus.now - readings[0].time;
    assert!((3_000..=4_000).contains(&age), "{age}");
}

#[test]
fn a_missing_part_is_asked_once_a_second_and_found_when_it_comes() {
    let mut bench = Bench::new(Part::new());
    bench.bus.fault = Some(Fault::Unplugged);
    assert!(bench.run(10 * SECOND).is_empty());
    assert_eq!(bench.driver.health(), Health::Absent);
    assert!((9..=11).contains(&bench.bus.transfers), "{}", bench.bus.transfers);
    bench.bus.fault = None;
    bench.bus.part.power_cycle(bench.bus.now);
    assert!(!bench.run(RETRY_US + 100_000).is_empty());
}

#[test]
fn a_held_bus_costs_few_transfers() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    bench.bus.fault = Some(Fault::Held);
    let before = bench.bus.transfers;
    assert!(bench.run(5 * SECOND).is_empty());
    assert_eq!(bench.driver.health(), Health::BusFault);
    assert!(bench.bus.transfers - before <= u32::from(MOST_FAILURES) + 5);
    bench.bus.fault = None;
    assert!(!bench.run(2 * SECOND).is_empty());
}

#[test]
fn another_part_is_left_alone() {
    let mut part = Part::new();
    part.identity = 0xFF;
    let mut bench = Bench::new(part);
    assert!(bench.run(3 * SECOND).is_empty());
    assert_eq!(bench.driver.health(), Health::WrongPart { identity: 0xFF });
}

/// Without its averaging it would go on measuring, with four times the noise's power.
#[test]
fn a_part_that_lost_its_configuration_gets_it_again() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    bench.bus.part.averaging = 0x12;
    bench.run(3 * SECOND);
    assert_eq!(bench.bus.part.averaging, 0x24);
    bench.bus.part.power_cycle(bench.bus.now);
    bench.run(3 * SECOND);
    assert_eq!((bench.bus.part.averaging, bench.bus.part.pulse), (0x24, 0xC0));
    assert_eq!(bench.driver.health(), Health::Working);
}

#[test]
fn a_part_that_measures_no_more_is_said_to_be_stuck_all_the_time() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    bench.bus.part.broken = true;
    bench.run(SECOND / 5);
    for _ in 0..500 {
        assert_eq!(bench.driver.health(), Health::Stuck);
        bench.bus.part.broken = true;
        assert!(bench.run(10_000).is_empty());
    }
}

/// One transfer fails, whichever: at worst the part is set up anew.
#[test]
fn any_single_failure_is_overcome() {
    for transfer in 0..130 {
        let mut bench = Bench::new(Part::new());
        bench.bus.fault = Some(Fault::Next(transfer));
        bench.run(3 * SECOND);
        assert_eq!(bench.bus.fault, None);
        assert_eq!(bench.driver.health(), Health::Working, "{transfer}");
        assert!(bench.run(SECOND).len() >= 49);
    }
}
