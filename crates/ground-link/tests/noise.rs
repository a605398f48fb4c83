//! Noise and valid frames with any content: nothing panics, nothing changes that was not accepted,
//! and the link still answers afterwards.
#![allow(deprecated)]

mod common;

use std::collections::BTreeSet;

use common::*;
use mavlink::dialects::common::*;
use mavlink::{Message, MessageData};
use windhover_autopilot::Parameters;
use windhover_ground_link::{CommandResult, PlanKind};

/// A run of the release profile has ten million bytes and a million frames; one of the dev profile
/// a tenth of that.
const SCALE: u64 = if cfg!(debug_assertions) { 1 } else { 10 };

/// A bench whose vehicle refuses all that can be refused.
fn bench() -> Bench {
    let mut bench = Bench::new();
    bench.vehicle.answer = |_| Some(CommandResult::Denied);
    bench.vehicle.store.refuse_commit = true;
    bench
}

fn still_answers(bench: &mut Bench) {
    bench.run(1_000_000);
    let command = long(MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, [NAN; 7]);
    assert_eq!(all::<COMMAND_ACK_DATA>(&bench.ask(&command)).len(), 1);
    let read = PARAM_REQUEST_READ_DATA {
        param_index: 0,
        target_system: 1,
        target_component: 1,
        ..PARAM_REQUEST_READ_DATA::DEFAULT
    };
    assert_eq!(all::<PARAM_VALUE_DATA>(&bench.ask(&read)).len(), 1);
    bench.run(12_000_000);
    let seen = bench.ask(&count(3, MavMissionType::MAV_MISSION_TYPE_MISSION));
    assert_eq!(all::<MISSION_REQUEST_INT_DATA>(&seen).len(), 1);
}

#[test]
fn millions_of_bytes_of_noise() {
    for seed in 1..=4 {
        let mut bench = bench();
        let mut random = Random::new(seed);
        for _ in 0..2_500 * SCALE {
            let starts = random.below(3);
            let noise: Vec<u8> = (0..100)
                .map(|_| match random.below(8) {
                    0 if starts > 0 => 0xfd,
                    1 if starts > 1 => 0xfe,
                    _ => random.next() as u8,
                })
                .collect();
            bench.vehicle.receive(&noise, bench.now);
            if random.percent(5) {
                bench.run(STEP);
            }
        }
        assert!(bench.vehicle.orders.is_empty());
        still_answers(&mut bench);
    }
}

/// A payload of random bytes, often for us, often with numbers at the edge.
fn payload(random: &mut Random) -> Vec<u8> {
    let length = 1 + random.below(255) as usize;
    let edge = random.below(3) > 0;
    (0..length)
        .map(|_| match random.below(6) {
            0 | 1 if edge => 1,
            2 if edge => 0,
            3 if edge => 255,
            _ => random.next() as u8,
        })
        .collect()
}

/// Makes a `PARAM_SET` one for us, of a parameter that there is: no name is found by chance.
fn name(payload: &mut Vec<u8>, random: &mut Random) {
    let number = random.below(Parameters::COUNT as u64) as usize;
    let name = Parameters::declaration(number).unwrap().name.as_bytes();
    payload.resize(23, 0);
    payload[4..22].fill(0);
    payload[4..6].fill(1);
    payload[6..6 + name.len()].copy_from_slice(name);
}

/// Numbers of all messages that there are.
fn known_ids() -> Vec<u32> {
    (0..12_000).filter(|id| MavMessage::extra_crc(*id) != 0).collect()
}

/// A message that is missing from the list is hardly ever fed to the link, here and by the fuzzer.
#[test]
fn the_messages_that_are_understood_are_those_listed() {
    // This one is read, and nothing comes of it.
    let mut listed = BTreeSet::from([RADIO_STATUS_DATA::ID]);
    listed.extend(UNDERSTOOD);
    let understood = known_ids().into_iter().filter(|id| {
        let mut bench = Bench::new();
        let frame = bench.station.raw(*id, &[0]);
        bench.vehicle.receive(&frame, bench.now);
        let counters = bench.vehicle.link.counters();
        assert_eq!(counters.parser.frames, 1, "{id} is a frame");
        counters.unknown == 0
    });
    assert_eq!(understood.collect::<BTreeSet<u32>>(), listed);
}

#[test]
fn valid_frames_with_any_content() {
    let ids = known_ids();
    for seed in 1..=4 {
        let mut bench = bench();
        let mut stations = [Station::new(255), Station::new(254), Station::new(1)];
        let mut random = Random::new(seed);
        let mut accepted = 0;
        for _ in 0..25_000 * SCALE {
            let known = UNDERSTOOD[random.below(UNDERSTOOD.len() as u64) as usize];
            let any = ids[random.below(ids.len() as u64) as usize];
            let id = if random.percent(90) { known } else { any };
            let station = &mut stations[random.below(3) as usize];
            let mut payload = payload(&mut random);
            if id == PARAM_SET_DATA::ID {
                name(&mut payload, &mut random);
            }
            let frame = station.raw(id, &payload);
            bench.vehicle.receive(&frame, bench.now);
            if random.percent(30) {
                accepted += accepted_plans(&bench.run(STEP));
            }
        }
        assert!(
            bench.vehicle.orders.len() > 20,
            "{} orders",
            bench.vehicle.orders.len()
        );
        let writes = bench.vehicle.valid_writes();
        assert!(writes > 20, "{writes} writes");
        assert_eq!(accepted, 0, "the store takes no plan");
        still_answers(&mut bench);
        let counters = bench.vehicle.link.counters();
        println!("seed {seed}: {} orders, {counters:?}", bench.vehicle.orders.len());
    }
}

/// Frames of a real upload, a fifth of them damaged: what is stored is whole or not there, and over
/// the seeds there is both.
#[test]
fn damaged_frames_never_make_half_a_plan() {
    let kind = MavMissionType::MAV_MISSION_TYPE_MISSION;
    let stored = (1..=20).map(|seed| {
        let mut bench = Bench::new();
        let mut random = Random::new(seed);
        let items = plan(20, seed as u32);
        // What the vehicle asks for: nothing before it has heard the count, nor after the end.
        let mut next = None;
        for _ in 0..30 {
            let mut frame = match next {
                None => bench.station.frame(&count(20, kind)),
                Some(index) => {
                    let any = random.below(20) as u16;
                    let index = if random.percent(5) { any } else { index };
                    let item = item_data(&items[usize::from(index)], index, kind);
                    bench.station.frame(&item)
                }
            };
            if random.percent(20) {
                let place = random.below(frame.len() as u64) as usize;
                frame[place] ^= 1 << random.below(8);
            }
            let seen = bench.bytes(&frame);
            let asked: Vec<MISSION_REQUEST_INT_DATA> = all(&seen);
            if let Some(asked) = asked.last() {
                next = Some(asked.seq);
            } else if seen.iter().any(|seen| seen.id == MISSION_ACK_DATA::ID) {
                next = None;
            }
        }
        bench.vehicle.store.items(PlanKind::Mission).len()
    });
    let stored: BTreeSet<usize> = stored.collect();
    assert_eq!(stored, BTreeSet::from([0, 20]));
}
