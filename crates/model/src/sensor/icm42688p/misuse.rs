//! What a driver should not do to the part.

/// A use of the part that its data sheet forbids, or that this model does not cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misuse {
    /// Registers were accessed too soon after power-on or reset.
    #[error("accessed within 1 ms of a reset")]
    DuringReset,
    /// A register was written too soon after a sensor was turned on; the write is ignored.
    #[error("register {address:#04x} of bank {bank} written within 200 µs of turning a sensor on")]
    TooSoon {
        /// The bank selected.
        bank: u8,
        /// The register.
        address: u8,
    },
    /// A register was written that has to be left alone while a sensor runs (section 12.9).
    #[error("register {address:#04x} of bank {bank} written while a sensor runs")]
    WhileRunning {
        /// The bank selected.
        bank: u8,
        /// The register.
        address: u8,
    },
    /// There is no such register.
    #[error("reserved register {address:#04x} of bank {bank} accessed")]
    Reserved {
        /// The bank selected.
        bank: u8,
        /// Its address.
        address: u8,
    },
    /// A register was written that can only be read.
    #[error("read-only register {address:#04x} of bank {bank} written")]
    ReadOnly {
        /// The bank selected.
        bank: u8,
        /// The register.
        address: u8,
    },
    /// A rate was chosen that is reserved.
    #[error("reserved output data rate")]
    ReservedRate,
    /// The gyroscope was on for less than 45 ms.
    #[error("gyroscope turned off within 45 ms of turning it on")]
    GyroscopeTooShort,
    /// Something that the part has and this model has not.
    #[error("{0}: not modelled")]
    NotModelled(&'static str),
}
