//! The mission service as a state machine: two ground stations upload, download, clear and cancel
//! in any order, with anything in between. What is stored changes by a whole valid upload only (the
//! store asserts that it is whole and in order), and afterwards the link still answers.
#![no_main]
#![allow(deprecated)]

#[path = "../../crates/ground-link/tests/common/mod.rs"]
mod common;
mod input;

use common::{Bench, STEP, Station, count, item_data, plan};
use input::{Input, any_frame, pass, still_answers};
use libfuzzer_sys::fuzz_target;
use mavlink::dialects::common::*;

/// Items that there are to be sent.
const ITEMS: u16 = 12;

const KINDS: [MavMissionType; 4] = [
    MavMissionType::MAV_MISSION_TYPE_MISSION,
    MavMissionType::MAV_MISSION_TYPE_FENCE,
    MavMissionType::MAV_MISSION_TYPE_RALLY,
    MavMissionType::MAV_MISSION_TYPE_ALL,
];

/// The next frame of a client that may do anything.
fn frame(what: u8, station: &mut Station, next: &mut u16, input: &mut Input<'_>) -> Vec<u8> {
    let kind = KINDS[usize::from(what >> 4 & 3)];
    let items = plan(ITEMS, 0);
    let target = [1, 1, what >> 4 & 3];
    match what & 15 {
        0 => {
            *next = 0;
            station.frame(&count(input.word() % (ITEMS + 2), kind))
        }
        1 => station.frame(&count(input.word(), kind)),
        // As it is asked for, most of the time.
        2..=6 => {
            let index = *next % ITEMS;
            *next = index + 1;
            station.frame(&item_data(&items[usize::from(index)], index, kind))
        }
        7 => {
            let index = input.word();
            station.frame(&item_data(&items[usize::from(index % ITEMS)], index, kind))
        }
        8 => station.raw(43, &target),
        9 => {
            let [low, high] = (input.word() % (ITEMS + 2)).to_le_bytes();
            station.raw(51, &[low, high, 1, 1, target[2]])
        }
        10 => station.raw(45, &target),
        11 => station.raw(47, &[1, 1, input.any() % 20, target[2]]),
        12 => station.raw(41, &[input.any(), 0, 1, 1]),
        13 => station.raw(38, &[0, 0, 1, 0, 1, 1, target[2]]),
        _ => any_frame(station, input),
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut input = Input(bytes);
    let mut bench = Bench::new();
    let mut stations = [Station::new(255), Station::new(254)];
    let mut next = [0; 2];
    let mut last = Vec::new();
    while let Some(what) = input.byte() {
        let who = usize::from(what >> 7);
        match what & 0x40 {
            0 => last = frame(what, &mut stations[who], &mut next[who], &mut input),
            _ if what & 0x20 == 0 => {
                pass(&mut bench, STEP << (what & 15).min(10));
            }
            _ => {} // the network repeats the last one
        }
        bench.vehicle.store.refuse_commit = what == 0x6f;
        bench.bytes(&last);
    }
    bench.vehicle.store.refuse_commit = false;
    let stored = bench.vehicle.store.bits();
    still_answers(&mut bench);
    assert_eq!(bench.vehicle.store.bits(), stored, "an upload that began is none");
});
