//! Messages that are sent again and again: how often, and what gives way when the channel is full.
//!
//! The table is in the order of importance. When the budget does not reach for all that is due,
//! the first lines of the table are served and the last ones wait; what has waited for a whole
//! interval is counted as left out.

pub mod budget;
pub(crate) mod encode;
pub(crate) mod version;

use mavlink::MessageData;
use mavlink::dialects::common as wire;

use crate::frame::Address;
use crate::wire::Payload;

/// The shortest interval, µs.
const SHORTEST: u32 = 5_000;

/// The longest interval, µs.
const LONGEST: u32 = 60_000_000;

/// A line of the table.
struct Stream {
    message: u16,
    /// µs; 0 is off unless asked for.
    interval: u32,
    /// `MAV_DATA_STREAM` that it belongs to, for clients that ask so.
    group: u8,
}

const fn stream(message: u32, interval: u32, group: u8) -> Stream {
    Stream {
        message: message as u16,
        interval,
        group,
    }
}

/// `HEARTBEAT`.
pub(crate) const HEARTBEAT: u16 = wire::HEARTBEAT_DATA::ID as u16;
/// `EXTENDED_SYS_STATE`.
pub(crate) const EXTENDED_SYS_STATE: u16 = wire::EXTENDED_SYS_STATE_DATA::ID as u16;
/// `HOME_POSITION`.
pub(crate) const HOME_POSITION: u16 = wire::HOME_POSITION_DATA::ID as u16;
/// `MISSION_CURRENT`.
pub(crate) const MISSION_CURRENT: u16 = wire::MISSION_CURRENT_DATA::ID as u16;

/// How many messages are streamed.
pub(crate) const STREAMS: usize = 14;

/// All of them, the most important first.
static TABLE: [Stream; STREAMS] = [
    stream(wire::HEARTBEAT_DATA::ID, 1_000_000, 0),
    stream(wire::EXTENDED_SYS_STATE_DATA::ID, 500_000, 2),
    stream(wire::SYS_STATUS_DATA::ID, 500_000, 2),
    stream(wire::GLOBAL_POSITION_INT_DATA::ID, 200_000, 6),
    stream(wire::ATTITUDE_DATA::ID, 100_000, 10),
    stream(wire::MISSION_CURRENT_DATA::ID, 500_000, 2),
    stream(wire::BATTERY_STATUS_DATA::ID, 1_000_000, 2),
    stream(wire::GPS_RAW_INT_DATA::ID, 500_000, 2),
    stream(wire::VFR_HUD_DATA::ID, 250_000, 11),
    stream(wire::HOME_POSITION_DATA::ID, 2_000_000, 0),
    stream(wire::LOCAL_POSITION_NED_DATA::ID, 200_000, 6),
    stream(wire::ATTITUDE_QUATERNION_DATA::ID, 200_000, 10),
    stream(wire::SYSTEM_TIME_DATA::ID, 1_000_000, 12),
    stream(wire::SERVO_OUTPUT_RAW_DATA::ID, 500_000, 3),
];

/// When a stream is due.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// µs; 0 is off.
    interval: u32,
    due: u64,
}

impl Rate {
    /// If it is due, moves on to the next time: how many were missed. The rhythm is kept unless it
    /// was lost.
    fn serve(&mut self, now: u64) -> Option<u32> {
        if self.interval == 0 || now < self.due {
            return None;
        }
        let (first, late) = (self.due == 0, now - self.due);
        let from = if late < u64::from(self.interval) {
            self.due
        } else {
            now
        };
        self.due = from.saturating_add(u64::from(self.interval));
        // More than an hour late is as bad as an hour: 32 bits are divided in hardware.
        let late = u32::try_from(late).unwrap_or(u32::MAX);
        Some(if first { 0 } else { late / self.interval })
    }
}

/// All streams.
#[derive(Clone, Debug)]
pub(crate) struct Streams {
    rates: [Rate; STREAMS],
    left_out: u32,
}

impl Default for Streams {
    fn default() -> Self {
        Self {
            rates: core::array::from_fn(|number| Rate {
                interval: TABLE.get(number).map_or(0, |line| line.interval),
                due: 0,
            }),
            left_out: 0,
        }
    }
}

impl Streams {
    /// Sets how often a message is sent: `None` never, 0 as by default, else every so many µs.
    /// Whether there is such a stream.
    pub fn set(&mut self, message: u32, interval: Option<u32>, now: u64) -> bool {
        for (rate, line) in self.rates.iter_mut().zip(&TABLE) {
            if u32::from(line.message) != message {
                continue;
            }
            rate.interval = match interval {
                None => 0,
                Some(0) => line.interval,
                Some(interval) => interval.clamp(SHORTEST, LONGEST),
            };
            rate.due = now;
            return true;
        }
        false
    }

    /// How often a message is sent, µs; 0 for never, `None` when there is no such stream.
    pub fn interval(&self, message: u32) -> Option<u32> {
        let mut lines = self.rates.iter().zip(&TABLE);
        lines
            .find(|(_, line)| u32::from(line.message) == message)
            .map(|(rate, _)| rate.interval)
    }

    /// `REQUEST_DATA_STREAM`: the rate of a group; group 0 is all.
    pub fn legacy(&mut self, payload: Payload<'_>, own: Address, now: u64) {
        let (group, start) = (payload.byte(4), payload.byte(5));
        if !payload.is_for(own, 2) {
            return;
        }
        let interval = match (start, payload.word(0)) {
            (0, _) => None,
            (_, 0) => Some(0),
            (_, rate) => Some(1_000_000 / u32::from(rate)),
        };
        let members = TABLE
            .iter()
            .filter(|line| line.group != 0 && (group == 0 || line.group == group));
        for line in members {
            self.set(u32::from(line.message), interval, now);
        }
    }

    /// Sends a message at the next occasion, whatever its rate.
    #[inline(never)]
    pub fn hasten(&mut self, message: u16, now: u64) {
        for (rate, line) in self.rates.iter_mut().zip(&TABLE) {
            if line.message == message && rate.interval > 0 {
                rate.due = rate.due.min(now);
            }
        }
    }

    /// Whether a heartbeat is due; then it counts as sent.
    pub fn heartbeat(&mut self, now: u64) -> bool {
        let [heartbeat, ..] = &mut self.rates;
        heartbeat.serve(now).is_some()
    }

    /// The most important message that is due; it counts as sent.
    pub fn next(&mut self, now: u64) -> Option<u16> {
        let mut lines = self.rates.iter_mut().zip(&TABLE);
        let (missed, message) = lines.find_map(|(rate, line)| Some((rate.serve(now)?, line.message)))?;
        self.left_out = self.left_out.saturating_add(missed);
        Some(message)
    }

    /// Messages that were due and never sent, since start.
    pub fn left_out(&self) -> u32 {
        self.left_out
    }
}

/// Whether a message can be asked for at all.
pub(crate) fn exists(message: u32) -> bool {
    TABLE.iter().any(|line| u32::from(line.message) == message)
}
