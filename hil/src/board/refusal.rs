//! Why a peripheral refuses an access. The bus adds whose register it was.

use crate::violation::Violation;

/// A refusal, before it has the peripheral's name.
#[derive(Debug)]
pub(super) enum Refusal {
    /// There is no such register.
    Unknown,
    /// The register exists, but not for this.
    Misuse(String),
}

/// What a peripheral says to an access.
pub(super) type Answer<T> = Result<T, Refusal>;

/// Refuses, in words that need only the peripheral's name before them.
pub(super) fn misuse<T>(what: impl Into<String>) -> Answer<T> {
    Err(Refusal::Misuse(what.into()))
}

impl Refusal {
    /// The violation it becomes for an access by the processor.
    pub(super) fn of(self, peripheral: &'static str, address: u32, access: &'static str) -> Violation {
        match self {
            Self::Unknown => Violation::UnknownRegister {
                peripheral,
                address,
                access,
            },
            Self::Misuse(what) => Violation::Misuse { peripheral, what },
        }
    }

    /// The violation it becomes where no register was accessed: something came due.
    pub(super) fn during(self, peripheral: &'static str) -> Violation {
        let what = match self {
            Self::Unknown => "reached a register that does not exist".to_owned(),
            Self::Misuse(what) => what,
        };
        Violation::Misuse { peripheral, what }
    }
}
