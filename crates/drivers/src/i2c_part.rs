//! What the drivers of parts on I2C have in common: transfers, and when to begin anew.
//!
//! The bus blocks, and its transfers are to have a time-out of their own. A driver makes at most
//! two short transfers a call, never waits, and leaves a part that does not answer alone for
//! [`RETRY_US`].

use embedded_hal::i2c::{Error, ErrorKind, I2c};

use crate::health::Health;

/// How long a part that failed is left alone, in µs.
pub const RETRY_US: u64 = 1_000_000;

/// Transfers that fail one behind the other before a part that worked is given up.
pub const MOST_FAILURES: u8 = 5;

/// From a transfer that failed to the next one, in µs.
const PAUSE_US: u64 = 5_000;

/// Why a step failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trouble {
    NoAnswer,
    Bus,
    WrongPart(u8),
    Stuck,
}

impl<E: Error> From<E> for Trouble {
    fn from(error: E) -> Self {
        match error.kind() {
            ErrorKind::NoAcknowledge(_) => Self::NoAnswer,
            _ => Self::Bus,
        }
    }
}

/// State of a part, and when it is to be asked next.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    pub health: Health,
    /// No transfer before this time in µs.
    pub due: u64,
    failures: u8,
}

impl Watch {
    pub const fn new() -> Self {
        Self {
            health: Health::Configuring,
            due: 0,
            failures: 0,
        }
    }

    /// The part says that it is the right one. One that was stuck is so until it works.
    pub fn identified(&mut self) {
        if self.health != Health::Stuck {
            self.health = Health::Configuring;
        }
    }

    /// A step went well.
    pub fn succeeded(&mut self) {
        self.failures = 0;
    }

    /// A step failed at `now`: whether the part has to be set up anew, after a while.
    pub fn failed(&mut self, trouble: Trouble, now: u64) -> bool {
        self.failures = self.failures.saturating_add(1);
        let is_transfer = matches!(trouble, Trouble::NoAnswer | Trouble::Bus);
        if is_transfer && self.health == Health::Working && self.failures < MOST_FAILURES {
            self.due = now + PAUSE_US;
            return false;
        }
        self.failures = 0;
        self.due = now + RETRY_US;
        self.health = match trouble {
            Trouble::NoAnswer => Health::Absent,
            Trouble::Bus => Health::BusFault,
            Trouble::WrongPart(identity) => Health::WrongPart { identity },
            Trouble::Stuck => Health::Stuck,
        };
        true
    }
}

/// Reads registers that follow each other, in one transfer.
pub(crate) fn read<const N: usize>(
    bus: &mut impl I2c,
    address: u8,
    register: u8,
) -> Result<[u8; N], Trouble> {
    let mut bytes = [0; N];
    bus.write_read(address, &[register], &mut bytes)?;
    Ok(bytes)
}

/// Writes a register.
pub(crate) fn write(bus: &mut impl I2c, address: u8, register: u8, value: u8) -> Result<(), Trouble> {
    bus.write(address, &[register, value])?;
    Ok(())
}
