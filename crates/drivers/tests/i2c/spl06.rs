//! The barometer: start, results, faults.

use windhover_drivers::health::Health;
use windhover_drivers::i2c_part::{MOST_FAILURES, RETRY_US};
use windhover_drivers::spl06::{ADDRESS, BarometerReading, Spl06};
use windhover_model::sensor::spl06::{Coefficients, Formula, Oversampling};

use super::bus::{Bus, Fault, Registers};

const SECOND: u64 = 1_000_000;

/// The part's registers as its data sheet has them. Wrong use fails the test.
struct Part {
    identity: u8,
    formula: Formula,
    pascal: f64,
    celsius: f64,
    powered: u64,
    configuration: [u8; 4],
    /// From when on it measures.
    measures: Option<u64>,
    /// Results that were read.
    read: u64,
    broken: bool,
}

impl Part {
    fn new() -> Self {
        Self {
            identity: 0x10,
            formula: Formula {
                coefficients: Coefficients::default(),
                pressure: Oversampling::X16,
                temperature: Oversampling::X4,
            },
            pascal: 95_600.0,
            celsius: 31.0,
            powered: 0,
            configuration: [0; 4],
            measures: None,
            read: 0,
            broken: false,
        }
    }

    fn results(&self, now: u64) -> u64 {
        // The first one takes its time; then 32 a second.
        let begun = self.measures.map_or(0, |from| now.saturating_sub(from + 36_000));
        if self.broken || begun == 0 {
            self.read
        } else {
            1 + begun / 31_250
        }
    }

    fn coefficient(&self, index: usize) -> u8 {
        let c = &self.formula.coefficients;
        let bits = |value: i32, bits: u32| (i64::from(value) & ((1 << bits) - 1), bits);
        let fields = [
            bits(c.c0.into(), 12),
            bits(c.c1.into(), 12),
            bits(c.c00, 20),
            bits(c.c10, 20),
            bits(c.c01.into(), 16),
            bits(c.c11.into(), 16),
            bits(c.c20.into(), 16),
            bits(c.c21.into(), 16),
            bits(c.c30.into(), 16),
        ];
        // One bit behind the other.
        let all = fields
            .iter()
            .flat_map(|(value, bits)| (0..*bits).rev().map(move |bit| (value >> bit & 1) as u8));
        all.skip(8 * index).take(8).fold(0, |byte, bit| byte << 1 | bit)
    }
}

impl Registers for Part {
    fn address(&self) -> u8 {
        ADDRESS
    }

    fn power_cycle(&mut self, now: u64) {
        self.powered = now;
        self.configuration = [0; 4];
        self.measures = None;
        self.read = 0;
    }

    fn read(&mut self, now: u64, register: u8) -> u8 {
        let temperature = self.formula.raw_temperature(self.celsius);
        let pressure = self.formula.raw_pressure(self.pascal, temperature);
        let ready = |time| u8::from(now >= self.powered + time);
        match register {
            0..=5 if self.results(now) == 0 => [0x80, 0, 0][usize::from(register % 3)],
            0..=2 => {
                self.read = self.results(now);
                pressure.to_be_bytes()[1 + usize::from(register)]
            }
            3..=5 => temperature.to_be_bytes()[usize::from(register) - 2],
            8 => {
                let result = u8::from(self.results(now) > self.read);
                ready(40_000) << 7 | ready(12_000) << 6 | result << 4 | self.configuration[2]
            }
            6 | 7 | 9 => self.configuration[usize::from(register - 6)],
            0x0D => self.identity,
            0x10..=0x21 => {
                assert_eq!(ready(40_000), 1);
                self.coefficient(usize::from(register - 0x10))
            }
            _ => panic!("{register:#x} is read"),
        }
    }

    fn write(&mut self, now: u64, register: u8, value: u8) {
        assert_eq!(
            self.identity, 0x10,
            "nothing is written to a part that is not known"
        );
        match register {
            0x0C => {
                assert_eq!(value, 9);
                self.power_cycle(now);
            }
            6 | 7 | 9 => {
                assert_eq!(self.measures, None);
                self.configuration[usize::from(register - 6)] = value;
            }
            8 => {
                assert_eq!(value, 7);
                assert_eq!(self.configuration, [0x54, 0xB2, 0, 4]);
                self.configuration[2] = 7;
                self.measures = Some(now);
            }
            _ => panic!("{register:#x} is written"),
        }
    }
}

/// Part and driver, polled every ms.
struct Bench {
    bus: Bus<Part>,
    driver: Spl06,
}

impl Bench {
    fn new(part: Part) -> Self {
        Self {
            bus: Bus::new(part),
            driver: Spl06::new(),
        }
    }

    fn run(&mut self, us: u64) -> Vec<BarometerReading> {
        let driver = &mut self.driver;
        self.bus.poll(us, |bus, now| driver.poll(bus, now))
    }
}

#[test]
fn from_power_on_it_measures_32_times_a_second() {
    let mut bench = Bench::new(Part::new());
    assert_eq!(bench.driver.health(), Health::Configuring);
    assert!(!bench.run(200_000).is_empty(), "within 0.2 s");
    assert_eq!(bench.driver.health(), Health::Working);
    let before = bench.bus.transfers;
    let readings = bench.run(10 * SECOND);
    assert!((319..=321).contains(&readings.len()), "{}", readings.len());
    assert!(readings.windows(2).all(|pair| pair[0].time < pair[1].time));
    let transfers = bench.bus.transfers - before;
    assert!(transfers < 320 * 7, "the bus has rest: {transfers}");
}

/// The data sheet's formula in double precision, over all that a vehicle may fly in.
#[test]
fn pressure_is_that_of_the_formula() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    for celsius in [-40.0, 0.0, 25.0, 85.0] {
        for kilopascal in 30..=110 {
            bench.bus.part.celsius = celsius;
            bench.bus.part.pascal = 1e3 * f64::from(kilopascal);
            let readings = bench.run(63_000);
            let pressure = readings.last().expect("two results").pressure;
            let error = f64::from(pressure) - bench.bus.part.pascal;
            assert!(error.abs() < 0.3, "{kilopascal} kPa, {celsius} °C: {error} Pa");
        }
    }
}

#[test]
fn coefficients_of_any_sign_and_size_are_read() {
    for sign in [-1, 1] {
        let mut part = Part::new();
        part.formula.coefficients = Coefficients {
            c0: 2047 * sign,
            c1: -2047 * sign,
            c00: 524_287 * i32::from(sign),
            c10: -524_287,
            c01: 32_767 * sign,
            c11: -32_767 * sign,
            c20: 1,
            c21: -1,
            c30: 3 * sign,
        };
        part.pascal = 90_000.0;
        let mut bench = Bench::new(part);
        let pressure = bench.run(SECOND)[0].pressure;
        assert!((f64::from(pressure) - 90_000.0).abs() < 2.0, "{pressure}");
    }
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
    assert!(!bench.run(RETRY_US + 200_000).is_empty());
    assert_eq!(bench.driver.health(), Health::Working);
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
    part.identity = 0x58;
    let mut bench = Bench::new(part);
    assert!(bench.run(3 * SECOND).is_empty());
    assert_eq!(bench.driver.health(), Health::WrongPart { identity: 0x58 });
}

#[test]
fn a_part_that_lost_its_configuration_gets_it_again() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    bench.bus.part.power_cycle(bench.bus.now);
    bench.run(100_000);
    assert_eq!(bench.driver.health(), Health::Stuck);
    assert!(!bench.run(2 * SECOND).is_empty());
    assert_eq!(bench.driver.health(), Health::Working);
}

#[test]
fn a_part_that_measures_no_more_is_said_to_be_stuck_all_the_time() {
    let mut bench = Bench::new(Part::new());
    bench.run(SECOND);
    bench.bus.part.broken = true;
    bench.run(SECOND / 2);
    for _ in 0..500 {
        assert_eq!(bench.driver.health(), Health::Stuck);
        assert!(bench.run(10_000).is_empty());
    }
}

/// One transfer fails, whichever: at worst the part is set up anew.
#[test]
fn any_single_failure_is_overcome() {
    for transfer in 0..60 {
        let mut bench = Bench::new(Part::new());
        bench.bus.fault = Some(Fault::Next(transfer));
        bench.run(2 * SECOND);
        assert_eq!(bench.bus.fault, None);
        assert_eq!(bench.driver.health(), Health::Working, "{transfer}");
        assert!(bench.run(SECOND).len() >= 31);
    }
}
