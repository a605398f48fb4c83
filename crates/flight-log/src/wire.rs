//! Bytes of a ULog file: its fixed parts, and an encoder and a decoder that cannot overrun.

/// The first bytes of every ULog file.
pub const MAGIC: [u8; 7] = [0x55, 0x4c, 0x6f, 0x67, 0x01, 0x12, 0x35];

/// The version of the format that is written.
pub const VERSION: u8 = 1;

/// Bytes before the first message: magic, version, time of the start.
pub const FILE_HEADER: usize = 16;

/// Bytes of a message before its body: size and kind.
pub const MESSAGE_HEADER: usize = 3;

/// The body of a synchronisation message.
pub const SYNC: [u8; 8] = [0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12];

/// Kinds of messages.
pub mod kind {
    /// Flags, the first message of all.
    pub const FLAGS: u8 = b'B';
    /// The format of a topic.
    pub const FORMAT: u8 = b'F';
    /// A named value.
    pub const INFO: u8 = b'I';
    /// A named value of several parts.
    pub const INFO_MULTIPLE: u8 = b'M';
    /// A parameter.
    pub const PARAMETER: u8 = b'P';
    /// A parameter's default.
    pub const PARAMETER_DEFAULT: u8 = b'Q';
    /// A topic gets a number.
    pub const SUBSCRIPTION: u8 = b'A';
    /// A record of a topic.
    pub const DATA: u8 = b'D';
    /// A line of text.
    pub const TEXT: u8 = b'L';
    /// Synchronisation.
    pub const SYNC: u8 = b'S';
    /// Something was lost.
    pub const DROPOUT: u8 = b'O';
}

/// Writes into a buffer; what does not fit is not written, and [`Encoder::finish`] says so.
#[derive(Debug)]
pub struct Encoder<'a> {
    buffer: &'a mut [u8],
    length: usize,
    full: bool,
}

impl<'a> Encoder<'a> {
    /// Writes from the buffer's start.
    pub fn new(buffer: &'a mut [u8]) -> Self {
        Self {
            buffer,
            length: 0,
            full: false,
        }
    }

    /// A few bytes.
    #[inline]
    pub fn bytes<const L: usize>(&mut self, bytes: [u8; L]) {
        let rest = self.buffer.get_mut(self.length..);
        match rest.and_then(|rest| rest.first_chunk_mut::<L>()) {
            Some(place) => {
                *place = bytes;
                self.length += L;
            }
            None => self.full = true,
        }
    }

    /// Bytes of a number known only now.
    #[inline]
    pub fn slice(&mut self, bytes: &[u8]) {
        let rest = self.buffer.get_mut(self.length..);
        match rest.and_then(|rest| rest.get_mut(..bytes.len())) {
            Some(place) => {
                copy(place, bytes);
                self.length += bytes.len();
            }
            None => self.full = true,
        }
    }

    /// A number in decimal.
    pub fn decimal(&mut self, number: usize) {
        if number >= 10 {
            self.decimal(number / 10);
        }
        self.bytes([b'0' + (number % 10) as u8]);
    }

    /// Gives up: what is written here cannot be written.
    pub fn fail(&mut self) {
        self.full = true;
    }

    /// How many bytes were written; `None` when not all of them fitted.
    pub fn finish(self) -> Option<usize> {
        (!self.full).then_some(self.length)
    }
}

/// Writes one message; its length, or `None` when it does not fit.
#[inline]
pub fn message(buffer: &mut [u8], kind: u8, body: impl FnOnce(&mut Encoder<'_>)) -> Option<usize> {
    let mut encoder = Encoder::new(buffer);
    encoder.bytes([0, 0, kind]);
    body(&mut encoder);
    let length = encoder.finish()?;
    let size = u16::try_from(length.checked_sub(MESSAGE_HEADER)?).ok()?;
    *buffer.first_chunk_mut()? = size.to_le_bytes();
    Some(length)
}

/// Copies as many bytes as both have.
#[inline]
pub(crate) fn copy(to: &mut [u8], from: &[u8]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// Reads from a slice; `None` beyond its end.
#[derive(Clone, Copy, Debug)]
pub struct Decoder<'a> {
    rest: &'a [u8],
}

impl<'a> Decoder<'a> {
    /// Reads from the slice's start.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// A few bytes.
    #[inline]
    pub fn bytes<const L: usize>(&mut self) -> Option<[u8; L]> {
        let (bytes, rest) = self.rest.split_first_chunk::<L>()?;
        self.rest = rest;
        Some(*bytes)
    }

    /// So many bytes.
    #[inline]
    pub fn slice(&mut self, length: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(bytes)
    }

    /// What was not read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }
}
