//! The compass iSentek IST8310 behind I2C, after its data sheet: single measurements by command,
//! each as long as its averaging takes, in the 14 bits of its reset.
//!
//! Not modelled: self-test, thermometer, the data-ready pin, 16 bits.

use super::Misuse;
use super::i2c::Part;
use crate::time::{MICROSECOND, NEVER};

/// Its address, as it leaves the factory.
pub const ADDRESS: u8 = 0x0E;

const WAI: u8 = 0x00;
const STAT1: u8 = 0x02;
const DATA: u8 = 0x03;
const DATA_END: u8 = 0x08;
const STAT2: u8 = 0x09;
const CNTL1: u8 = 0x0A;
const CNTL2: u8 = 0x0B;
const CNTL3: u8 = 0x0D;
const AVGCNTL: u8 = 0x41;
const PDCNTL: u8 = 0x42;

const IDENTITY: u8 = 0x10;
const DRDY: u8 = 1 << 0;
const DOR: u8 = 1 << 1;
const SINGLE: u8 = 1;
const SRST: u8 = 1 << 0;
/// DREN and DRP, which concern the pin.
const CNTL2_PIN: u8 = 3 << 2;
/// The pulse that the data sheet asks for.
const PULSE: u8 = 0xC0;

/// From power-on or a reset until it can be used.
const START_TIME: u64 = 10_000 * MICROSECOND;

/// Time of a measurement by the larger of its two averagings, 1, 2, 4, 8 and 16, in µs. The data
/// sheet bounds the last; the others are ours.
const TIMES: [u64; 5] = [1_500, 2_000, 3_000, 4_000, 6_000];

/// One part.
#[derive(Clone, Debug)]
pub struct Ist8310 {
    powered: u64,
    status: u8,
    pin: u8,
    averaging: u8,
    pulse: u8,
    results: [i16; 3],
    /// What a transfer that has begun reads of them.
    seen: [i16; 3],
    /// When the measurement under way will be done.
    due: u64,
    misuse: Vec<Misuse>,
}

impl Ist8310 {
    /// A part whose power comes on now.
    pub fn new(now: u64) -> Self {
        Self {
            powered: now,
            status: 0,
            pin: 0x0C,
            averaging: 0x12,
            pulse: 0,
            results: [0; 3],
            seen: [0; 3],
            due: NEVER,
            misuse: Vec::new(),
        }
    }

    /// What was done against its data sheet.
    pub fn misuse(&self) -> &[Misuse] {
        &self.misuse
    }

    /// A measurement is over, of what was measured; nothing for a sensor that fails.
    pub fn put(&mut self, counts: Option<[i16; 3]>) {
        self.due = NEVER;
        if let Some(counts) = counts {
            self.results = counts;
            self.status |= if self.status & DRDY != 0 { DOR } else { DRDY };
        }
    }

    fn time(&self) -> u64 {
        let longer = (self.averaging & 7).max(self.averaging >> 3 & 7);
        TIMES[usize::from(longer.min(4))] * MICROSECOND
    }

    fn object(&mut self, now: u64, what: impl Into<String>) {
        self.misuse.push((now, what.into()));
    }

    fn measure(&mut self, now: u64) {
        if now < self.powered + START_TIME {
            self.object(now, "it is to measure before it has started");
        }
        if self.due != NEVER {
            self.object(now, "it is to measure while it measures");
        }
        if self.pulse != PULSE {
            self.object(now, "it is to measure without the pulse of PDCNTL");
        }
        self.due = now + self.time();
    }
}

impl Part for Ist8310 {
    fn begin(&mut self) {
        self.seen = self.results;
    }

    fn read(&mut self, now: u64, register: u8) -> u8 {
        match register {
            WAI => IDENTITY,
            STAT1 => self.status,
            DATA..=DATA_END => {
                self.status = 0;
                let place = usize::from(register - DATA);
                self.seen[place / 2].to_le_bytes()[place % 2]
            }
            STAT2 | CNTL3 => 0,
            CNTL1 => u8::from(self.due != NEVER),
            CNTL2 => self.pin,
            AVGCNTL => self.averaging,
            PDCNTL => self.pulse,
            _ => {
                self.object(
                    now,
                    format!("register {register:#04x} is read, which is not modelled"),
                );
                0
            }
        }
    }

    fn write(&mut self, now: u64, register: u8, value: u8) {
        match (register, value) {
            (CNTL1, 0) => self.due = NEVER,
            (CNTL1, SINGLE) => self.measure(now),
            (CNTL2, _) if value & SRST != 0 => self.power_on(now),
            (CNTL2, _) if value & !CNTL2_PIN == 0 => self.pin = value,
            (CNTL3, 0) => {}
            (AVGCNTL, _) if value & 7 <= 4 && value >> 3 <= 4 => self.averaging = value,
            (PDCNTL, _) => self.pulse = value,
            _ => self.object(now, format!("{value:#04x} is written to {register:#04x}")),
        }
    }

    fn power_on(&mut self, now: u64) {
        *self = Self {
            misuse: std::mem::take(&mut self.misuse),
            ..Self::new(now)
        };
    }

    fn next_event(&self) -> u64 {
        self.due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1000 * MICROSECOND;

    fn started() -> Ist8310 {
        let mut part = Ist8310::new(0);
        part.write(20 * MS, PDCNTL, PULSE);
        part
    }

    fn data(part: &mut Ist8310) -> [i16; 3] {
        part.begin();
        let bytes: [u8; 6] = core::array::from_fn(|n| part.read(0, DATA + n as u8));
        core::array::from_fn(|axis| i16::from_le_bytes([bytes[2 * axis], bytes[2 * axis + 1]]))
    }

    #[test]
    fn it_says_who_it_is() {
        assert_eq!(started().read(0, WAI), 0x10);
    }

    #[test]
    fn a_measurement_takes_its_averaging_and_is_ready_until_it_is_read() {
        for (averaging, time) in [(0x00, 1_500), (0x24, 6_000), (0x12, 3_000)] {
            let mut part = started();
            part.write(20 * MS, AVGCNTL, averaging);
            part.write(20 * MS, CNTL1, SINGLE);
            assert_eq!(part.next_event(), 20 * MS + time * MICROSECOND);
            assert_eq!((part.read(0, STAT1), part.read(0, CNTL1)), (0, 1));
            part.put(Some([100, -200, 8000]));
            assert_eq!((part.read(0, STAT1), part.read(0, CNTL1)), (DRDY, 0));
            assert_eq!(data(&mut part), [100, -200, 8000]);
            assert_eq!(part.read(0, STAT1), 0);
            assert_eq!(part.next_event(), NEVER, "one at a time");
            assert!(part.misuse().is_empty());
        }
    }

    #[test]
    fn a_result_over_one_that_nobody_read_is_flagged() {
        let mut part = started();
        for _ in 0..2 {
            part.write(20 * MS, CNTL1, SINGLE);
            part.put(Some([1; 3]));
        }
        assert_eq!(part.read(0, STAT1), DRDY | DOR);
    }

    #[test]
    fn a_sensor_that_fails_is_never_ready() {
        let mut part = started();
        part.write(20 * MS, CNTL1, SINGLE);
        part.put(None);
        assert_eq!(part.read(0, STAT1), 0);
    }

    #[test]
    fn a_reset_forgets_the_configuration() {
        let mut part = started();
        part.write(20 * MS, AVGCNTL, 0x24);
        part.write(20 * MS, CNTL2, SRST);
        assert_eq!((part.read(0, AVGCNTL), part.read(0, PDCNTL)), (0x12, 0));
    }

    #[test]
    fn what_its_data_sheet_forbids_is_noted() {
        let mut part = Ist8310::new(0);
        part.write(MS, CNTL1, SINGLE);
        assert_eq!(part.misuse().len(), 2, "too early, and no pulse");
        let mut part = started();
        part.write(20 * MS, CNTL1, SINGLE);
        part.write(21 * MS, CNTL1, SINGLE);
        part.write(21 * MS, CNTL3, 0x70);
        part.write(21 * MS, 0x0C, 0x40);
        part.read(21 * MS, 0x1C);
        assert_eq!(part.misuse().len(), 4, "{:?}", part.misuse());
    }
}
