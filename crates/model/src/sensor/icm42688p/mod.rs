//! The inertial measurement unit TDK ICM-42688-P behind its SPI, byte by byte.
//!
//! A state machine after the data sheet DS-000347 rev. 1.7: registers in five banks, reset,
//! power modes and start-up times, samples on the part's own oscillator, INT1. Its owner moves
//! chip select and bytes, says what is measured when a sample is taken, and listens to INT1.
//! Times are the owner's ticks, a whole number of them in a microsecond; call
//! [`Icm42688p::advance`] up to a moment before anything else happens at it.
//!
//! Not modelled: FIFO, APEX functions, low-power modes, filters, external clock, self-test, user
//! offsets. What a driver does against the data sheet is kept in [`Icm42688p::misuse`].

mod access;
mod clock;
mod interrupt;
mod misuse;
mod registers;
mod sensors;

use clock::Clock;
use interrupt::Int1;
pub use misuse::Misuse;
use registers::{BANKS, Registers};
use sensors::{DATA_BYTES, Sensors};

/// A moment that does not come.
pub const NEVER: u64 = u64::MAX;

/// From power-on or reset until registers can be accessed, in µs.
pub const RESET_US: u64 = 1_000;

/// After a sensor is turned on: no writes for that long, in µs.
pub const QUIET_US: u64 = 200;

/// In INT_STATUS.
const RESET_DONE: u8 = 1 << 4;
const DATA_READY: u8 = 1 << 3;

/// What the sensors measure, in counts of the widest range: 2048 per g, 16.4 per °/s, and
/// 132.48 per °C from 25 °C. In the part's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measurement {
    /// Specific force.
    pub accel: [i16; 3],
    /// Angular rate.
    pub gyro: [i16; 3],
    /// Temperature of the part.
    pub temperature: i16,
}

/// What happened in the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A sample is taken: [`Icm42688p::put`] what is measured now.
    Sample {
        /// When.
        time: u64,
    },
    /// INT1 changed.
    Int1 {
        /// When.
        time: u64,
        /// To which level.
        level: bool,
    },
}

/// What is on the line from the part to the processor (MISO).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DataLine {
    /// What the part sends.
    #[default]
    Connected,
    /// Always high: every byte is 0xFF.
    StuckHigh,
    /// Always low: every byte is 0x00.
    StuckLow,
    /// The byte that came last, again and again.
    Repeats,
}

/// The transaction that chip select began.
#[derive(Clone, Copy, Debug)]
struct Transaction {
    /// Where the next byte is read or written; `None` until the first byte said so.
    address: Option<u8>,
    read: bool,
    /// The data registers as they were when the transaction began: a burst is one sample.
    shadow: [u8; DATA_BYTES],
}

/// The part.
#[derive(Clone, Debug)]
pub struct Icm42688p {
    clock: Clock,
    registers: Registers,
    bank: u8,
    status: u8,
    sensors: Sensors,
    int1: Int1,
    powered: bool,
    /// When the reset is over; `NEVER` if it is.
    resetting: u64,
    /// Until when there should be no write.
    quiet: u64,
    transaction: Option<Transaction>,
    /// When the sample was taken that the owner has to put.
    wanted: Option<u64>,
    line: DataLine,
    last: u8,
    misuse: Vec<Misuse>,
}

impl Icm42688p {
    /// A part whose power comes on at time 0, for an owner with so many ticks in a microsecond.
    pub fn new(ticks_per_microsecond: u64) -> Self {
        let registers = Registers::new();
        let mut part = Self {
            clock: Clock::new(ticks_per_microsecond),
            int1: Int1::new(&registers),
            registers,
            bank: 0,
            status: 0,
            sensors: Sensors::new(),
            powered: true,
            resetting: NEVER,
            quiet: 0,
            transaction: None,
            wanted: None,
            line: DataLine::Connected,
            last: 0,
            misuse: Vec::new(),
        };
        part.reset(0);
        part
    }

    /// The same part with an oscillator that is so many millionths too fast, within ±1 %.
    pub fn with_clock_error(mut self, ppm: i32) -> Self {
        self.clock = self.clock.with_error(ppm);
        self
    }

    /// Chip select goes low: a transaction begins.
    pub fn select(&mut self) {
        if self.resetting != NEVER {
            self.misuse.push(Misuse::DuringReset);
        }
        self.transaction = Some(Transaction {
            address: None,
            read: false,
            shadow: self.sensors.bytes(&self.registers),
        });
    }

    /// Chip select goes high: the transaction is over.
    pub fn deselect(&mut self) {
        self.transaction = None;
    }

    /// A byte goes over the bus in both directions; returns what comes from the part.
    pub fn exchange(&mut self, now: u64, mosi: u8) -> u8 {
        let sent = if self.powered {
            self.respond(now, mosi)
        } else {
            0xFF
        };
        let miso = match self.line {
            DataLine::Connected => sent,
            DataLine::StuckHigh => 0xFF,
            DataLine::StuckLow => 0x00,
            DataLine::Repeats => self.last,
        };
        self.last = miso;
        miso
    }

    /// When something will next happen by itself.
    pub fn next_event(&self) -> u64 {
        if let Some(time) = self.int1.untold() {
            return time;
        }
        self.resetting.min(self.int1.fall()).min(self.sensors.next())
    }

    /// Lets the next thing happen that is due by `now`, and says what it was. Call it until it
    /// returns `None`.
    pub fn advance(&mut self, now: u64) -> Option<Event> {
        loop {
            if let Some((time, level)) = self.int1.tell() {
                return Some(Event::Int1 { time, level });
            }
            let next = self.next_event();
            if next > now || next == NEVER {
                return None;
            }
            if next == self.int1.fall() {
                self.int1.end_pulse(&self.clock);
            } else if next == self.resetting {
                self.resetting = NEVER;
                self.status |= RESET_DONE;
            } else {
                let time = self.sensors.tick(&self.clock);
                self.wanted = Some(time);
                return Some(Event::Sample { time });
            }
        }
    }

    /// What is measured at the sample that [`Event::Sample`] announced. Without an announcement
    /// nothing happens.
    pub fn put(&mut self, measured: &Measurement) {
        if let Some(time) = self.wanted.take() {
            self.sensors.put(time, measured, &self.registers);
            self.status |= DATA_READY;
            self.int1.data_ready(time, &self.clock);
        }
    }

    /// The level of INT1.
    pub fn int1(&self) -> bool {
        self.int1.level()
    }

    /// What a register holds, for tests and reports; sensor data and INT_STATUS excepted.
    pub fn register(&self, bank: u8, address: u8) -> u8 {
        self.registers.at(bank.min(BANKS as u8 - 1), address & 0x7F)
    }

    /// What was done against the data sheet, in order.
    pub fn misuse(&self) -> &[Misuse] {
        &self.misuse
    }

    /// The part resets: by its power for a moment, or as if it had been told to.
    pub fn reset(&mut self, now: u64) {
        self.registers.reset();
        self.bank = 0;
        self.status = 0;
        self.sensors = Sensors::new();
        self.wanted = None;
        self.transaction = None;
        self.quiet = 0;
        self.resetting = now + self.clock.microseconds(RESET_US);
        self.int1.reset(now, &self.registers);
    }

    /// The part loses its power, or is not there at all: nothing drives its lines.
    pub fn unplug(&mut self, now: u64) {
        self.reset(now);
        self.powered = false;
        self.resetting = NEVER;
    }

    /// The part has power again.
    pub fn plug(&mut self, now: u64) {
        self.powered = true;
        self.reset(now);
    }

    /// Damages or repairs the line from the part to the processor.
    pub fn set_data_line(&mut self, line: DataLine) {
        self.line = line;
    }

    /// Breaks or mends the wire at INT1; broken, it reads low while samples go on.
    pub fn connect_int1(&mut self, now: u64, connected: bool) {
        self.int1.connected = connected;
        self.int1.update(now);
    }
}
