//! Frames of MAVLink 2 and 1: found in a stream of bytes, and written.
//!
//! The framing is ours, because it has to find its way again after garbage: [`parser`] looks for
//! the next frame also *inside* what only looked like one. Checksum seeds and payloads are those
//! of the crate `mavlink` (dialect `common`); what a payload holds is read in `wire`.

pub mod crc;
pub mod losses;
pub mod parser;

use mavlink::Message;
use mavlink::dialects::common::MavMessage;

pub use losses::Losses;
pub use parser::{Counts, Parser};

/// The longest frame: header, payload, checksum, signature.
pub const MAX_FRAME: usize = HEADER + MAX_PAYLOAD + CHECKSUM + SIGNATURE;

/// The longest payload.
pub const MAX_PAYLOAD: usize = 255;

/// Bytes of a signature: link, time, hash.
pub const SIGNATURE: usize = 13;

/// Bytes before the payload in MAVLink 2.
pub(crate) const HEADER: usize = 10;

/// Bytes before the payload in MAVLink 1.
const HEADER_1: usize = 6;

/// Bytes of a checksum.
pub(crate) const CHECKSUM: usize = 2;

/// First byte of a frame of MAVLink 2.
const START_2: u8 = 0xfd;

/// First byte of a frame of MAVLink 1.
const START_1: u8 = 0xfe;

/// The one incompatibility flag there is: the frame is signed.
const SIGNED: u8 = 1;

/// Who sends: a system and a part of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Address {
    /// System: 1 is usually the vehicle, 255 a ground station.
    pub system: u8,
    /// Component of the system: 1 is the autopilot.
    pub component: u8,
}

impl Address {
    /// Whether a message for this target is for this address: 0 means everyone.
    pub fn is_meant(self, system: u8, component: u8) -> bool {
        (system == self.system || system == 0) && (component == self.component || component == 0)
    }
}

/// A frame whose checksum is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<'a> {
    /// Who sent it.
    pub source: Address,
    /// Counts the frames of its sender.
    pub sequence: u8,
    /// Number of the message.
    pub id: u32,
    /// The message; zeros at the end may be missing.
    pub payload: &'a [u8],
    /// The checksum.
    pub checksum: u16,
    /// From the first byte up to the signature, without it.
    pub covered: &'a [u8],
    /// The signature, if it has one.
    pub signature: Option<&'a [u8; SIGNATURE]>,
}

/// What the first bytes of a buffer are.
enum Look<'a> {
    /// A whole frame, and how long it is.
    Whole(Frame<'a>, usize),
    /// Perhaps a frame: more bytes will tell.
    Short,
    /// No frame starts here.
    Nothing,
}

/// Looks at the start of a buffer.
fn look(buffer: &[u8]) -> Look<'_> {
    let found = match buffer {
        [START_2, length, flags, ..] if flags & !SIGNED == 0 => look_2(buffer, *length, *flags),
        [START_1, length, ..] => look_1(buffer, *length),
        [START_2] | [START_2, _] | [START_1] => Some(Look::Short),
        _ => None,
    };
    found.unwrap_or(Look::Nothing)
}

fn look_2(buffer: &[u8], length: u8, flags: u8) -> Option<Look<'_>> {
    let Some((header, rest)) = buffer.split_first_chunk::<HEADER>() else {
        return Some(Look::Short);
    };
    let [_, _, _, _, sequence, system, component, low, middle, high] = *header;
    let id = u32::from_le_bytes([low, middle, high, 0]);
    let seed = seed(id)?;
    let length = usize::from(length);
    let signature = if flags & SIGNED == 0 { 0 } else { SIGNATURE };
    let whole = HEADER + length + CHECKSUM + signature;
    if buffer.len() < whole {
        return Some(Look::Short);
    }
    let (payload, rest) = rest.split_at_checked(length)?;
    let (checksum, rest) = rest.split_first_chunk::<CHECKSUM>()?;
    let frame = Frame {
        source: Address { system, component },
        sequence,
        id,
        payload,
        checksum: u16::from_le_bytes(*checksum),
        covered: buffer.get(..HEADER + length + CHECKSUM)?,
        signature: rest.first_chunk().filter(|_| signature > 0),
    };
    frame.checked(seed, whole)
}

fn look_1(buffer: &[u8], length: u8) -> Option<Look<'_>> {
    let Some((header, rest)) = buffer.split_first_chunk::<HEADER_1>() else {
        return Some(Look::Short);
    };
    let [_, _, sequence, system, component, id] = *header;
    let seed = seed(u32::from(id))?;
    let length = usize::from(length);
    let whole = HEADER_1 + length + CHECKSUM;
    if buffer.len() < whole {
        return Some(Look::Short);
    }
    let (payload, rest) = rest.split_at_checked(length)?;
    let frame = Frame {
        source: Address { system, component },
        sequence,
        id: u32::from(id),
        payload,
        checksum: u16::from_le_bytes(*rest.first_chunk()?),
        covered: buffer.get(..whole)?,
        signature: None,
    };
    frame.checked(seed, whole)
}

impl<'a> Frame<'a> {
    /// Whether the checksum is right: it covers all but the first byte and itself, and ends with a
    /// byte that stands for the message's layout.
    fn checked(self, seed: u8, whole: usize) -> Option<Look<'a>> {
        let end = self.covered.len().checked_sub(CHECKSUM)?;
        let crc = crc::update(crc::START, self.covered.get(1..end)?);
        (crc::update(crc, &[seed]) == self.checksum).then_some(Look::Whole(self, whole))
    }
}

/// The byte that stands for a message's layout in its checksum; `None` for messages that the
/// dialect `common` does not have, of which nobody here can tell whether they are whole.
fn seed(id: u32) -> Option<u8> {
    let seed = MavMessage::extra_crc(id);
    (seed != 0).then_some(seed)
}

/// Makes a signature from all that goes before it.
pub type Sign<'a> = &'a mut dyn FnMut(&[u8]) -> [u8; SIGNATURE];

/// Writes frames of MAVLink 2, each with the next sequence number.
#[derive(Clone, Debug)]
pub struct Writer {
    source: Address,
    pub(crate) sequence: u8,
}

impl Writer {
    /// Frames from here.
    pub fn new(source: Address) -> Self {
        Self { source, sequence: 0 }
    }

    /// Writes a frame around a payload, whose zeros at the end are left out; `sign` is given all
    /// up to the signature and returns it. The frame's length.
    pub fn write(
        &mut self,
        buffer: &mut [u8; MAX_FRAME],
        id: u32,
        payload: &[u8],
        sign: Option<Sign<'_>>,
    ) -> Option<usize> {
        let payload = without_zeros(payload);
        let length = u8::try_from(payload.len()).ok()?;
        let [low, middle, high, _] = id.to_le_bytes();
        let Address { system, component } = self.source;
        let flags = u8::from(sign.is_some());
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        *buffer.first_chunk_mut()? = [
            START_2, length, flags, 0, sequence, system, component, low, middle, high,
        ];
        let end = HEADER + payload.len();
        put(buffer.get_mut(HEADER..end)?, payload);
        let crc = crc::update(crc::START, buffer.get(1..end)?);
        let crc = crc::update(crc, &[seed(id)?]);
        *buffer.get_mut(end..)?.first_chunk_mut()? = crc.to_le_bytes();
        let end = end + CHECKSUM;
        let Some(sign) = sign else { return Some(end) };
        let signature = sign(buffer.get(..end)?);
        *buffer.get_mut(end..)?.first_chunk_mut()? = signature;
        Some(end + SIGNATURE)
    }
}

/// A payload without the zeros at its end; one byte always stays.
fn without_zeros(payload: &[u8]) -> &[u8] {
    let used = payload
        .iter()
        .rposition(|byte| *byte != 0)
        .map_or(1, |last| last + 1);
    payload.get(..used).unwrap_or(payload)
}

/// Copies as many bytes as both have.
pub(crate) fn put(to: &mut [u8], from: &[u8]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}
