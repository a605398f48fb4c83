//! Uploads and downloads on a clean channel: who may do what, and what is answered.
#![allow(deprecated)]

mod common;

use common::*;
use mavlink::dialects::common::MavMissionResult as R;
use mavlink::dialects::common::*;
use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::{Mode, PlanKind, PlanStore, Request};

const MISSION: MavMissionType = MavMissionType::MAV_MISSION_TYPE_MISSION;
const FENCE: MavMissionType = MavMissionType::MAV_MISSION_TYPE_FENCE;
const RALLY: MavMissionType = MavMissionType::MAV_MISSION_TYPE_RALLY;
const ALL: MavMissionType = MavMissionType::MAV_MISSION_TYPE_ALL;

fn requested(seen: &[Seen]) -> Vec<u16> {
    all(seen)
        .iter()
        .map(|request: &MISSION_REQUEST_INT_DATA| request.seq)
        .collect()
}

fn results(seen: &[Seen]) -> Vec<R> {
    all(seen)
        .iter()
        .map(|ack: &MISSION_ACK_DATA| ack.mavtype)
        .collect()
}

/// Uploads; how it ended.
fn upload(bench: &mut Bench, items: &[MissionItem], kind: MavMissionType) -> R {
    let mut seen = bench.ask(&count(items.len() as u16, kind));
    for (index, item) in items.iter().enumerate() {
        if !results(&seen).is_empty() {
            break;
        }
        assert_eq!(requested(&seen), [index as u16]);
        seen = bench.ask(&item_data(item, index as u16, kind));
    }
    let acks: Vec<MISSION_ACK_DATA> = all(&seen);
    assert_eq!(acks.len(), 1);
    assert_eq!((acks[0].mission_type, acks[0].target_system), (kind, 255));
    acks[0].mavtype
}

fn list(kind: MavMissionType) -> MISSION_REQUEST_LIST_DATA {
    MISSION_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: kind,
    }
}

fn request(seq: u16, kind: MavMissionType) -> MISSION_REQUEST_INT_DATA {
    MISSION_REQUEST_INT_DATA {
        seq,
        target_system: 1,
        target_component: 1,
        mission_type: kind,
    }
}

fn clear(kind: MavMissionType) -> MISSION_CLEAR_ALL_DATA {
    MISSION_CLEAR_ALL_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: kind,
    }
}

fn download(bench: &mut Bench, kind: MavMissionType) -> Vec<String> {
    let counts: Vec<MISSION_COUNT_DATA> = all(&bench.ask(&list(kind)));
    assert_eq!((counts.len(), counts[0].mission_type), (1, kind));
    (0..counts[0].count)
        .map(|seq| {
            let items: Vec<MISSION_ITEM_INT_DATA> = all(&bench.ask(&request(seq, kind)));
            assert_eq!((items.len(), items[0].seq, items[0].mission_type), (1, seq, kind));
            bits(&item_of(&items[0]))
        })
        .collect()
}

#[test]
fn mission_fence_and_rally_points_go_up_and_come_back_as_they_were() {
    let mut bench = Bench::new();
    for (salt, kind) in [MISSION, FENCE, RALLY].into_iter().enumerate() {
        let items = plan(5 + salt as u16, salt as u32 * 100);
        assert_eq!(upload(&mut bench, &items, kind), R::MAV_MISSION_ACCEPTED);
        assert_eq!(
            download(&mut bench, kind),
            items.iter().map(bits).collect::<Vec<_>>()
        );
    }
    let lengths: Vec<_> = bench.vehicle.store.bits().iter().map(Vec::len).collect();
    assert_eq!(lengths, [5, 6, 7]);
    assert!(
        upload(&mut bench, &plan(256, 3), MISSION) == R::MAV_MISSION_ACCEPTED,
        "as many as fit"
    );
}

#[test]
fn clearing_one_kind_or_all() {
    let mut bench = Bench::new();
    for kind in [MISSION, FENCE, RALLY] {
        upload(&mut bench, &plan(4, 0), kind);
    }
    assert_eq!(results(&bench.ask(&clear(FENCE))), [R::MAV_MISSION_ACCEPTED]);
    let lengths = |bench: &Bench| {
        bench
            .vehicle
            .store
            .bits()
            .iter()
            .map(Vec::len)
            .collect::<Vec<_>>()
    };
    assert_eq!(lengths(&bench), [4, 0, 4]);
    let acks: Vec<MISSION_ACK_DATA> = all(&bench.ask(&clear(ALL)));
    assert_eq!(
        (acks[0].mavtype, acks[0].mission_type),
        (R::MAV_MISSION_ACCEPTED, ALL)
    );
    assert_eq!(lengths(&bench), [0, 0, 0]);
    upload(&mut bench, &plan(4, 0), MISSION);
    assert_eq!(
        upload(&mut bench, &[], MISSION),
        R::MAV_MISSION_ACCEPTED,
        "an empty plan clears"
    );
    assert_eq!(lengths(&bench), [0, 0, 0]);
}

#[test]
fn what_does_not_fit_or_cannot_be_flown_is_refused_with_its_reason_and_changes_nothing() {
    let mut bench = Bench::new();
    upload(&mut bench, &plan(4, 0), MISSION);
    let before = bench.vehicle.store.bits();
    let seen = bench.ask(&count(257, MISSION));
    assert_eq!(results(&seen), [R::MAV_MISSION_NO_SPACE]);
    assert_eq!(
        texts(&bench_texts(&mut bench, seen)),
        ["mission refused: 257 items, there is room for 256"]
    );
    bench.ask(&count(2, MISSION));
    let good = bench.station.frame(&item_data(&plan(1, 0)[0], 0, MISSION));
    let mut payload = good[10..good.len() - 2].to_vec();
    payload.resize(38, 0);
    payload[30..32].copy_from_slice(&REFUSED_COMMAND.to_le_bytes());
    let bytes = bench.station.raw(73, &payload);
    let seen = bench.bytes(&bytes);
    assert_eq!(results(&seen), [R::MAV_MISSION_UNSUPPORTED]);
    assert_eq!(
        texts(&bench_texts(&mut bench, seen)),
        ["mission refused: item 0: this is not flown"]
    );
    bench.vehicle.store.refuse_commit = true;
    assert_eq!(upload(&mut bench, &plan(3, 9), MISSION), R::MAV_MISSION_DENIED);
    assert_eq!(bench.vehicle.store.bits(), before);
}

/// What was seen, and what follows at once.
fn bench_texts(bench: &mut Bench, mut seen: Vec<Seen>) -> Vec<Seen> {
    seen.extend(bench.run(3 * STEP));
    seen
}

#[test]
fn a_type_that_there_is_not_is_unsupported() {
    let mut bench = Bench::new();
    for (id, payload) in [
        (44, vec![1, 0, 1, 1, 77]),
        (43, vec![1, 1, 77]),
        (51, vec![0, 0, 1, 1, 77]),
        (45, vec![1, 1, 77]),
        (37, vec![0, 0, 0, 0, 1, 1, 0]),
    ] {
        let bytes = bench.station.raw(id, &payload);
        let acks: Vec<_> = bench
            .bytes(&bytes)
            .into_iter()
            .filter(|seen| seen.id == 47)
            .collect();
        assert_eq!(acks.len(), 1, "message {id}");
        assert_eq!(
            acks[0].payload[2],
            R::MAV_MISSION_UNSUPPORTED as u8,
            "message {id}"
        );
    }
}

#[test]
fn a_second_station_is_refused_while_one_uploads_and_may_download() {
    let mut bench = Bench::new();
    upload(&mut bench, &plan(6, 0), MISSION);
    let items = plan(10, 500);
    let mut seen = bench.ask(&count(10, MISSION));
    let mut other = Station::new(254);
    for (index, item) in items.iter().enumerate() {
        assert_eq!(requested(&seen).last(), Some(&(index as u16)));
        let frame = other.frame(&count(3, MISSION));
        assert_eq!(results(&bench.bytes(&frame)), [R::MAV_MISSION_DENIED]);
        let frame = other.frame(&clear(MISSION));
        assert_eq!(results(&bench.bytes(&frame)), [R::MAV_MISSION_DENIED]);
        let frame = other.frame(&item_data(item, index as u16, MISSION));
        assert!(results(&bench.bytes(&frame)).is_empty());
        let frame = other.frame(&request(index as u16 % 6, MISSION));
        let given: Vec<MISSION_ITEM_INT_DATA> = all(&bench.bytes(&frame));
        assert_eq!((given.len(), given[0].target_system), (1, 254));
        seen = bench.ask(&item_data(item, index as u16, MISSION));
    }
    assert_eq!(results(&seen), [R::MAV_MISSION_ACCEPTED]);
    assert_eq!(bench.vehicle.store.items(PlanKind::Mission).len(), 10);
}

#[test]
fn a_plan_that_changes_during_a_download_ends_it() {
    let mut bench = Bench::new();
    upload(&mut bench, &plan(6, 0), MISSION);
    let mut other = Station::new(254);
    let frame = other.frame(&list(MISSION));
    assert_eq!(all::<MISSION_COUNT_DATA>(&bench.bytes(&frame)).len(), 1);
    upload(&mut bench, &plan(6, 9), MISSION);
    // However often it asks: the first refusal may get lost, and half a plan of each is none.
    for _ in 0..3 {
        let frame = other.frame(&request(3, MISSION));
        assert_eq!(
            results(&bench.bytes(&frame)),
            [R::MAV_MISSION_OPERATION_CANCELLED]
        );
    }
    let frame = other.frame(&list(MISSION));
    assert_eq!(all::<MISSION_COUNT_DATA>(&bench.bytes(&frame)).len(), 1);
    let frame = other.frame(&request(6, MISSION));
    assert_eq!(results(&bench.bytes(&frame)), [R::MAV_MISSION_INVALID_SEQUENCE]);
}

#[test]
fn whoever_exchanged_the_plan_reads_items_of_the_new_one_without_asking_for_their_count() {
    let mut bench = Bench::new();
    upload(&mut bench, &plan(6, 0), MISSION);
    assert_eq!(download(&mut bench, MISSION).len(), 6);
    let items = plan(8, 9);
    upload(&mut bench, &items, MISSION);
    let given: Vec<MISSION_ITEM_INT_DATA> = all(&bench.ask(&request(7, MISSION)));
    assert_eq!((given.len(), given[0].seq), (1, 7));
    assert_eq!(bits(&item_of(&given[0])), bits(&items[7]));
    let beyond = results(&bench.ask(&request(8, MISSION)));
    assert_eq!(beyond, [R::MAV_MISSION_INVALID_SEQUENCE]);
}

#[test]
fn a_wrong_item_ends_the_upload_with_the_right_result() {
    let items = plan(5, 0);
    for (index, kind, result) in [
        (3, MISSION, R::MAV_MISSION_INVALID_SEQUENCE),
        (700, MISSION, R::MAV_MISSION_INVALID_SEQUENCE),
        (1, FENCE, R::MAV_MISSION_INVALID),
    ] {
        let mut bench = Bench::new();
        bench.ask(&count(5, MISSION));
        bench.ask(&item_data(&items[0], 0, MISSION));
        let seen = bench.ask(&item_data(&items[1], index, kind));
        assert_eq!(results(&seen), [result]);
        assert!(requested(&bench.run(2_000_000)).is_empty(), "it is over");
        assert_eq!(bench.vehicle.store.commits, 0);
        assert_eq!(upload(&mut bench, &items, MISSION), R::MAV_MISSION_ACCEPTED);
    }
}

#[test]
fn an_old_item_that_comes_again_is_not_answered() {
    let mut bench = Bench::new();
    let items = plan(5, 0);
    bench.ask(&count(5, MISSION));
    for index in 0..3 {
        bench.ask(&item_data(&items[index], index as u16, MISSION));
        for (old, item) in items.iter().enumerate().take(index + 1) {
            let seen = bench.ask(&item_data(item, old as u16, MISSION));
            assert!(requested(&seen).is_empty() && results(&seen).is_empty());
        }
    }
}

#[test]
fn the_end_is_told_again_when_the_last_item_comes_again_and_otherwise_not() {
    let mut bench = Bench::new();
    let items = plan(3, 0);
    upload(&mut bench, &items, MISSION);
    let again = |bench: &mut Bench, index: usize| {
        results(&bench.ask(&item_data(&items[index], index as u16, MISSION)))
    };
    assert!(again(&mut bench, 2).is_empty(), "repeated by the network");
    assert!(again(&mut bench, 1).is_empty());
    bench.run(500_000);
    assert_eq!(again(&mut bench, 2), [R::MAV_MISSION_ACCEPTED]);
    assert_eq!(bench.vehicle.store.commits, 1);
    bench.run(2_000_000);
    assert_eq!(
        again(&mut bench, 1),
        [R::MAV_MISSION_ERROR],
        "nobody asked for it"
    );
}

#[test]
fn the_vehicle_asks_again_and_gives_up_in_the_end() {
    let mut bench = Bench::new();
    bench.ask(&count(5, MISSION));
    let seen = bench.run(1_000_000);
    assert!((4..=6).contains(&requested(&seen).len()));
    let seen = bench.run(10_000_000);
    assert_eq!(results(&seen), [R::MAV_MISSION_OPERATION_CANCELLED]);
    assert!(requested(&bench.run(2_000_000)).is_empty());
}

#[test]
fn a_client_may_cancel_and_start_again() {
    let mut bench = Bench::new();
    let items = plan(5, 0);
    bench.ask(&count(5, MISSION));
    bench.ask(&item_data(&items[0], 0, MISSION));
    let cancel = MISSION_ACK_DATA {
        target_system: 1,
        target_component: 1,
        mavtype: R::MAV_MISSION_OPERATION_CANCELLED,
        mission_type: MISSION,
        ..MISSION_ACK_DATA::DEFAULT
    };
    let seen = bench.ask(&cancel);
    assert!(results(&seen).is_empty(), "no answer to an answer");
    assert!(requested(&bench.run(1_000_000)).is_empty());
    bench.ask(&count(3, MISSION));
    assert_eq!(
        upload(&mut bench, &items, MISSION),
        R::MAV_MISSION_ACCEPTED,
        "without cancelling first"
    );
}

#[test]
fn what_is_for_another_vehicle_is_not_ours() {
    let mut bench = Bench::new();
    for (system, component) in [(2, 1), (1, 190)] {
        let foreign = MISSION_COUNT_DATA {
            target_system: system,
            target_component: component,
            ..count(5, MISSION)
        };
        let seen = bench.ask(&foreign);
        assert!(requested(&seen).is_empty() && results(&seen).is_empty());
    }
    bench.ask(&count(5, MISSION));
    let foreign = MISSION_ITEM_INT_DATA {
        target_system: 2,
        ..item_data(&plan(1, 0)[0], 3, MISSION)
    };
    assert!(results(&bench.ask(&foreign)).is_empty(), "the upload goes on");
    assert!(requested(&bench.run(500_000)).contains(&0));
}

#[test]
fn an_item_in_degrees_is_taken_from_old_clients() {
    let mut bench = Bench::new();
    bench.ask(&count(1, MISSION));
    let item = MISSION_ITEM_DATA {
        x: 47.5,
        y: -8.25,
        z: 30.0,
        target_system: 1,
        target_component: 1,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        ..MISSION_ITEM_DATA::DEFAULT
    };
    assert_eq!(results(&bench.ask(&item)), [R::MAV_MISSION_ACCEPTED]);
    let stored = bench.vehicle.store.items(PlanKind::Mission)[0];
    assert_eq!((stored.x, stored.y, stored.z), (475_000_000, -82_500_000, 30.0));
}

#[test]
fn progress_is_told_when_it_changes() {
    let mut bench = Bench::new();
    upload(&mut bench, &plan(6, 0), MISSION);
    bench.run(1_000_000);
    bench.vehicle.telemetry.mode = Mode::Mission;
    bench.vehicle.telemetry.mission.current = 3;
    bench.vehicle.link.item_reached(2);
    let seen = bench.run(STEP);
    let current: Vec<MISSION_CURRENT_DATA> = all(&seen);
    assert_eq!(
        (current[0].seq, current[0].total, current[0].mission_mode),
        (3, 6, 1)
    );
    let crc = bench.vehicle.store.committed(PlanKind::Mission).crc;
    assert_eq!(current[0].mission_id, crc);
    let reached: Vec<MISSION_ITEM_REACHED_DATA> = all(&seen);
    assert_eq!((reached.len(), reached[0].seq), (1, 2));
}

#[test]
fn the_current_item_is_set_if_there_is_one() {
    let mut bench = Bench::new();
    upload(&mut bench, &plan(6, 0), MISSION);
    for seq in [4, 6] {
        bench.run(300_000);
        let asked = MISSION_SET_CURRENT_DATA {
            seq,
            target_system: 1,
            target_component: 1,
        };
        // A number that is not the one asked for would be taken for a refusal, or asked for again.
        let seen = bench.ask(&asked);
        assert_eq!(all::<MISSION_CURRENT_DATA>(&seen), []);
    }
    assert_eq!(bench.vehicle.requests(), [Request::SetCurrentItem { index: 4 }]);
    bench.vehicle.telemetry.mission.current = 4;
    let told: Vec<u16> = all(&bench.run(STEP))
        .iter()
        .map(|current: &MISSION_CURRENT_DATA| current.seq)
        .collect();
    assert_eq!(told, [4]);
}

/// If this failed, a client that clears and uploads in one go would be refused, for the short time
/// that a plan takes from the link to the core.
#[test]
fn a_plan_that_follows_another_one_closely_waits_for_its_turn() {
    let mut bench = Bench::new();
    let clear = MISSION_CLEAR_ALL_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: MISSION,
    };
    bench.vehicle.store.is_settling = true;
    let mut seen = bench.ask(&clear);
    seen.extend(bench.ask(&count(2, MISSION)));
    // Repeated by the network.
    seen.extend(bench.ask(&count(2, MISSION)));
    seen.extend(bench.run(100_000));
    assert_eq!((results(&seen), requested(&seen)), (vec![], vec![]));
    bench.vehicle.store.is_settling = false;
    let seen = bench.run(STEP);
    assert_eq!(
        (results(&seen), requested(&seen)),
        (vec![R::MAV_MISSION_ACCEPTED], vec![0])
    );
    // Whoever never settles does not keep a client waiting.
    bench.vehicle.store.is_settling = true;
    bench.ask(&clear);
    assert_eq!(results(&bench.run(600_000)), [R::MAV_MISSION_ACCEPTED]);
}

/// Found by a million frames: after an upload that failed, the item before item 0 of none was taken
/// for its last one, and acknowledged as accepted.
#[test]
fn no_item_is_the_last_one_of_an_upload_that_failed() {
    let mut bench = Bench::new();
    bench.ask(&count(3, MISSION));
    bench.ask(&item_data(&plan(3, 0)[0], 2, MISSION));
    bench.run(2_000_000);
    let seen = bench.ask(&item_data(&plan(3, 0)[0], u16::MAX, MISSION));
    assert_eq!(results(&seen), [R::MAV_MISSION_ERROR]);
}
