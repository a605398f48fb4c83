//! Messages as they stand in the file.

use super::end::{End, OpenError, Reason};
use crate::wire::{Decoder, FILE_HEADER, MAGIC, SYNC, VERSION, kind};

/// One message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// Where in the file it begins.
    pub offset: usize,
    /// Its kind.
    pub kind: u8,
    /// Its body.
    pub body: &'a [u8],
}

impl Message<'_> {
    /// The end that it is when it is corrupt.
    pub(super) fn corrupt(&self) -> End {
        self.end(Reason::Corrupt(char::from(self.kind)))
    }

    pub(super) fn end(&self, reason: Reason) -> End {
        End {
            offset: self.offset,
            reason,
        }
    }
}

/// The messages of a file, from some byte on.
#[derive(Clone, Debug)]
pub struct Messages<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Messages<'a> {
    /// All messages, and the time of the file's start in µs.
    pub fn new(bytes: &'a [u8]) -> Result<(Self, u64), OpenError> {
        let mut header = Decoder::new(bytes);
        if header.bytes() != Some(MAGIC) {
            return Err(OpenError::NotUlog);
        }
        match header.bytes() {
            Some([version]) if version <= VERSION => {}
            Some([version]) => return Err(OpenError::Version(version)),
            None => return Err(OpenError::NotUlog),
        }
        let time = header.bytes().map(u64::from_le_bytes).ok_or(OpenError::NotUlog)?;
        let messages = Self {
            bytes,
            at: FILE_HEADER,
        };
        Ok((messages, time))
    }

    /// The next message, or the end of them.
    pub fn next_message(&mut self) -> Result<Message<'a>, End> {
        let offset = self.at;
        let end = |reason| End { offset, reason };
        let mut from = Decoder::new(self.bytes.get(offset..).unwrap_or_default());
        if from.rest().is_empty() {
            return Err(end(Reason::Complete));
        }
        let size = from.bytes().map(u16::from_le_bytes).ok_or(end(Reason::Cut))?;
        let [kind] = from.bytes().ok_or(end(Reason::Cut))?;
        if size == 0 || kind == 0 {
            return Err(end(Reason::NoMessage));
        }
        let body = from.slice(usize::from(size)).ok_or(end(Reason::Cut))?;
        let message = Message { offset, kind, body };
        if kind == kind::SYNC && body != SYNC {
            return Err(message.corrupt());
        }
        self.at = self.bytes.len() - from.rest().len();
        Ok(message)
    }

    /// Goes back to a message.
    pub(super) fn go_back(&mut self, to: &Message<'_>) {
        self.at = to.offset;
    }
}
