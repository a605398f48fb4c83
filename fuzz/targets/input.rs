//! What both targets of the link make of a fuzzer's bytes.
#![allow(dead_code, deprecated)]

use mavlink::dialects::common::*;
use windhover_ground_link::frame::MAX_PAYLOAD;

use crate::common::{Bench, STEP, Seen, Station, UNDERSTOOD, all, count};

/// Bytes that are used up.
pub struct Input<'a>(pub &'a [u8]);

impl<'a> Input<'a> {
    pub fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// A byte, 0 at the end.
    pub fn any(&mut self) -> u8 {
        self.byte().unwrap_or_default()
    }

    pub fn word(&mut self) -> u16 {
        u16::from_le_bytes([self.any(), self.any()])
    }

    pub fn bytes(&mut self, count: u8) -> &'a [u8] {
        let (first, rest) = self.0.split_at(usize::from(count).min(self.0.len()));
        self.0 = rest;
        first
    }
}

/// A frame with a right checksum around any payload.
pub fn any_frame(station: &mut Station, input: &mut Input<'_>) -> Vec<u8> {
    let id = UNDERSTOOD[usize::from(input.any()) % UNDERSTOOD.len()];
    let length = input.any();
    let mut payload = [0; MAX_PAYLOAD];
    let given = input.bytes(length);
    payload[..given.len()].copy_from_slice(given);
    station.raw(id, &payload)
}

/// Lets time pass without a poll in between, µs: a vehicle that was busy.
pub fn pass(bench: &mut Bench, time: u64) -> Vec<Seen> {
    bench.now += time;
    bench.run(STEP)
}

/// Whatever has been: a ping is answered, and an upload may begin.
pub fn still_answers(bench: &mut Bench) {
    // A frame that was swallowed by a false start is found when that is given up, and may begin an
    // upload, which is given up in turn.
    pass(bench, 100_000);
    pass(bench, 6_000_000);
    bench.station = Station::new(77);
    let ping = PING_DATA {
        time_usec: 12_345,
        seq: 7,
        target_system: 0,
        target_component: 0,
    };
    let mut seen = bench.ask(&ping);
    seen.extend(bench.run(STEP));
    let pongs: Vec<PING_DATA> = all(&seen);
    let answer = pongs.iter().find(|pong| pong.target_system == 77);
    assert_eq!(answer.map(|pong| (pong.time_usec, pong.seq)), Some((12_345, 7)));
    let seen = bench.ask(&count(1, MavMissionType::MAV_MISSION_TYPE_MISSION));
    let asked: Vec<MISSION_REQUEST_INT_DATA> = all(&seen);
    assert_eq!((asked.len(), asked[0].seq), (1, 0));
}
