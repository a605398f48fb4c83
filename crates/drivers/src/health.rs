//! How a part is, for whoever has to name what is wrong.

/// State of a part on a bus or a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Health {
    /// Nothing answers.
    Absent,
    /// Transfers fail, and not by a missing acknowledgement: the lines may be held.
    BusFault,
    /// Something answers that is another part.
    WrongPart {
        /// What it says it is.
        identity: u8,
    },
    /// It answers, but gets not ready, forgets its configuration or measures no more.
    Stuck,
    /// It is being set up.
    Configuring,
    /// It measures.
    Working,
}
