//! Where and why reading stops.

use std::string::String;

use thiserror::Error;

/// What makes a file no log of ours at all.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OpenError {
    /// It does not begin as ULog files do.
    #[error("this is no ULog file")]
    NotUlog,
    /// A version of ULog that we do not know.
    #[error("this is a ULog file of version {0}; versions 0 and 1 can be read")]
    Version(u8),
    /// A flag says that it cannot be read without knowing what the flag means.
    #[error("this ULog file needs something that is not known here (its incompatible flags are set)")]
    Incompatible,
}

/// The end of what can be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("at byte {offset}: {reason}")]
pub struct End {
    /// Everything before this byte was read.
    pub offset: usize,
    /// Why reading stops here.
    pub reason: Reason,
}

/// Why reading stops.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Reason {
    /// The file ends with a whole message.
    #[error("the log ends")]
    Complete,
    /// The file ends within a message.
    #[error("the log is cut off")]
    Cut,
    /// There is no message here.
    #[error("these bytes are no message")]
    NoMessage,
    /// A message does not hold what its kind says.
    #[error("a message of kind '{0}' is corrupt")]
    Corrupt(char),
    /// A record does not hold what its topic says.
    #[error("a record of topic {0} is corrupt")]
    Record(String),
    /// A topic that replay needs has another format here.
    #[error("topic {0} has another format than this version's")]
    Format(String),
    /// More of something than any log has.
    #[error("there is more of '{0}' than a log has")]
    TooMany(char),
}
