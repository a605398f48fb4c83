//! What can be wrong with the part.

use core::fmt;

use super::registers::Register;

/// Why a call failed. `E` is the bus's own error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Error<E> {
    /// The bus reported an error.
    Bus(E),
    /// Nobody answers: the identity reads 0xFF or 0x00, as on a line that nothing drives or
    /// that is stuck.
    Absent {
        /// What was read.
        who_am_i: u8,
    },
    /// Another part answers, or this one garbled.
    WrongPart {
        /// What was read instead of 0x47.
        who_am_i: u8,
    },
    /// A register does not hold what was written. In flight: the part was reset.
    Mismatch {
        /// The register.
        register: Register,
        /// What was written, those bits that the driver sets.
        wrote: u8,
        /// What these bits are.
        read: u8,
    },
    /// All bytes of a sample are the same: the line is stuck, or nobody drives it.
    Stuck {
        /// The byte: 0xFF or 0x00 as a rule.
        byte: u8,
    },
    /// The registers hold no sample yet, as after a start: an axis reads −32768.
    NotReady,
}

impl<E: fmt::Debug> fmt::Display for Error<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "bus error: {error:?}"),
            Self::Absent { who_am_i } => write!(f, "absent: identity reads {who_am_i:#04x}"),
            Self::WrongPart { who_am_i } => write!(f, "wrong part: identity reads {who_am_i:#04x}"),
            Self::Mismatch {
                register: Register { bank, address },
                wrote,
                read,
            } => write!(
                f,
                "register {address:#04x} of bank {} holds {read:#04x}, not {wrote:#04x}",
                *bank as u8
            ),
            Self::Stuck { byte } => write!(f, "line stuck: every byte is {byte:#04x}"),
            Self::NotReady => write!(f, "no sample yet"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for Error<E> {}
