//! What the firmware must not do: real hardware would ignore it, hang, or do something else.

/// A mistake of the firmware. The run stops at the instruction that made it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Violation {
    /// No such register, or one that this board does not model.
    #[error("{access} of unknown register {address:#010x} ({peripheral})")]
    UnknownRegister {
        /// Where it would be.
        peripheral: &'static str,
        /// Its address.
        address: u32,
        /// `read` or `write`.
        access: &'static str,
    },
    /// The peripheral's clock is not enabled in RCC.
    #[error("{peripheral} is used at {address:#010x} while its clock is off")]
    ClockOff {
        /// The peripheral.
        peripheral: &'static str,
        /// The register.
        address: u32,
    },
    /// Anything else, in words that name the peripheral and what is wrong.
    #[error("{peripheral}: {what}")]
    Misuse {
        /// The peripheral.
        peripheral: &'static str,
        /// What is wrong.
        what: String,
    },
}
