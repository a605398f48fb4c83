//! Messages among bytes.
//!
//! The messages that are read have fixed lengths. So [`Parser`] asks at each byte whether a message
//! ends with it, and remembers nothing but the last bytes: a message is found the moment it is
//! there, whatever came before it.

use super::frames::{ACK, ACK_ACK, ACK_NAK, AROUND, NAV_PVT, SYNC, sums};

/// Bytes of NAV-PVT.
const NAV_PVT_BYTES: usize = 92 + AROUND;

/// Bytes of ACK-ACK and ACK-NAK.
const ACK_BYTES: usize = 2 + AROUND;

/// In `flags`: the fix is within the receiver's limits.
const GNSS_FIX_OK: u8 = 1 << 0;

/// In `flags3`: longitude, latitude and heights are not valid.
const INVALID_LLH: u8 = 1 << 0;

/// What UBX-NAV-PVT says of position and velocity, in its units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NavPvt {
    /// GPS time of week of the moment described, in ms.
    pub time_of_week: u32,
    /// WGS84 latitude in 1e-7 degrees, north positive.
    pub latitude: i32,
    /// WGS84 longitude in 1e-7 degrees, east positive.
    pub longitude: i32,
    /// Altitude above mean sea level in mm.
    pub altitude: i32,
    /// Velocity over ground, NED, in mm/s.
    pub velocity: [i32; 3],
    /// Declared error (1 σ) of the horizontal position, both axes together, in mm.
    pub horizontal_accuracy: u32,
    /// Declared error (1 σ) of the altitude, in mm.
    pub vertical_accuracy: u32,
    /// Declared error (1 σ) of the velocity, three axes together, in mm/s.
    pub speed_accuracy: u32,
    /// 0 none, 2 flat, 3 three-dimensional, others as the receiver has them. 0 too where the
    /// receiver says that the fix or the position is not valid.
    pub fix: u8,
    /// Satellites used.
    pub satellites: u8,
}

/// A message that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Message {
    /// A report of position and velocity.
    NavPvt(NavPvt),
    /// A message of this class and number was done.
    Acknowledged([u8; 2]),
    /// A message of this class and number was not understood, or refused.
    Refused([u8; 2]),
}

/// What came in since the start. Counts stay at their ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Bytes.
    pub bytes: u32,
    /// Reports.
    pub reports: u32,
    /// Acknowledgements, of either kind.
    pub acknowledgements: u32,
    /// What began like one of these messages and whose sums were wrong: lost messages, mostly.
    pub damaged: u32,
}

impl Counts {
    /// Bytes outside of messages that were read: noise, sentences, other messages, and what is not
    /// yet a message.
    pub fn skipped(&self) -> u32 {
        let reports = self.reports.saturating_mul(NAV_PVT_BYTES as u32);
        let others = self.acknowledgements.saturating_mul(ACK_BYTES as u32);
        self.bytes.saturating_sub(reports).saturating_sub(others)
    }
}

/// Finds messages in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Parser {
    /// The last bytes, the newest at the end. Zeros begin no message.
    window: [u8; NAV_PVT_BYTES],
    counts: Counts,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// One that has seen nothing.
    pub const fn new() -> Self {
        Self {
            window: [0; NAV_PVT_BYTES],
            counts: Counts {
                bytes: 0,
                reports: 0,
                acknowledgements: 0,
                damaged: 0,
            },
        }
    }

    /// Takes bytes in, in pieces of any size, and hands out the messages that they end.
    pub fn feed(&mut self, bytes: &[u8], mut found: impl FnMut(Message)) {
        for byte in bytes {
            if let Some(message) = self.push(*byte) {
                found(message);
            }
        }
    }

    /// What came in since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    fn push(&mut self, byte: u8) -> Option<Message> {
        self.window.rotate_left(1);
        self.window[NAV_PVT_BYTES - 1] = byte;
        self.counts.bytes = self.counts.bytes.saturating_add(1);
        self.report().or_else(|| self.acknowledgement())
    }

    fn report(&mut self) -> Option<Message> {
        const LENGTH: [u8; 2] = (NAV_PVT_BYTES as u16 - AROUND as u16).to_le_bytes();
        let [s, t, class, number, low, high, payload @ .., _, _] = &self.window;
        if [*s, *t] != SYNC || [*class, *number] != NAV_PVT || [*low, *high] != LENGTH {
            return None;
        }
        if !checks(&self.window) {
            self.counts.damaged = self.counts.damaged.saturating_add(1);
            return None;
        }
        self.counts.reports = self.counts.reports.saturating_add(1);
        Some(Message::NavPvt(NavPvt::read(payload)))
    }

    fn acknowledgement(&mut self) -> Option<Message> {
        let frame = self.window.last_chunk::<ACK_BYTES>()?;
        let [s, t, ACK, kind, 2, 0, class, number, _, _] = *frame else {
            return None;
        };
        let message = match kind {
            ACK_ACK => Message::Acknowledged([class, number]),
            ACK_NAK => Message::Refused([class, number]),
            _ => return None,
        };
        if [s, t] != SYNC {
            return None;
        }
        if !checks(frame) {
            self.counts.damaged = self.counts.damaged.saturating_add(1);
            return None;
        }
        self.counts.acknowledgements = self.counts.acknowledgements.saturating_add(1);
        Some(message)
    }
}

/// Whether a frame's sums are right.
fn checks(frame: &[u8]) -> bool {
    match frame {
        [_, _, body @ .., a, b] => sums(body) == [*a, *b],
        _ => false,
    }
}

impl NavPvt {
    fn read(payload: &[u8; NAV_PVT_BYTES - AROUND]) -> Self {
        let byte = |place: usize| payload.get(place).copied().unwrap_or(0);
        let unsigned = |place: usize| {
            let bytes = [byte(place), byte(place + 1), byte(place + 2), byte(place + 3)];
            u32::from_le_bytes(bytes)
        };
        let signed = |place| unsigned(place).cast_signed();
        let is_valid = byte(21) & GNSS_FIX_OK != 0 && byte(78) & INVALID_LLH == 0;
        Self {
            time_of_week: unsigned(0),
            latitude: signed(28),
            longitude: signed(24),
            altitude: signed(36),
            velocity: [signed(48), signed(52), signed(56)],
            horizontal_accuracy: unsigned(40),
            vertical_accuracy: unsigned(44),
            speed_accuracy: unsigned(68),
            fix: if is_valid { byte(20) } else { 0 },
            satellites: byte(23),
        }
    }
}
