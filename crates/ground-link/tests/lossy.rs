//! Whole transfers over a channel that loses a fifth of all frames in both directions, delays them
//! by up to 30 ms so that they overtake each other, and repeats 2 %.
#![allow(deprecated)]

mod common;

use common::*;
use mavlink::dialects::common::*;
use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::{CommandResult, Config, PlanKind, Request};

const MISSION: MavMissionType = MavMissionType::MAV_MISSION_TYPE_MISSION;

/// A station, a vehicle, and a channel each way.
struct Field {
    vehicle: Vehicle,
    station: Station,
    up: Channel,
    down: Channel,
    now: u64,
}

impl Field {
    fn new(up: Channel, down: Channel) -> Self {
        Self {
            vehicle: Vehicle::new(),
            station: Station::new(255),
            up,
            down,
            now: 1_000_000,
        }
    }

    fn send<M: mavlink::MessageData>(&mut self, message: &M) {
        let frame = self.station.frame(message);
        self.up.send(self.now, frame);
    }

    /// One step of time: what arrives at the station.
    fn step(&mut self) -> Vec<Seen> {
        for frame in self.up.arrived(self.now) {
            self.vehicle.receive(&frame, self.now);
        }
        for frame in self.vehicle.poll(self.now) {
            self.down.send(self.now, frame);
        }
        let frames = self.down.arrived(self.now);
        self.now += STEP;
        self.station.read(&frames)
    }
}

/// Uploads as a client does that answers requests, and repeats its last word when it hears nothing.
/// The result and the time that it took.
fn upload(field: &mut Field, items: &[MissionItem], limit: u64) -> (Option<MavMissionResult>, u64) {
    let began = field.now;
    let first = count(items.len() as u16, MISSION);
    field.send(&first);
    let (mut last, mut heard) = (None, field.now);
    while field.now - began < limit {
        for seen in field.step() {
            if let Some(request) = seen.read::<MISSION_REQUEST_INT_DATA>() {
                let item = &items[usize::from(request.seq)];
                field.send(&item_data(item, request.seq, MISSION));
                (last, heard) = (Some(request.seq), field.now);
            }
            if let Some(ack) = seen.read::<MISSION_ACK_DATA>() {
                return (Some(ack.mavtype), field.now - began);
            }
        }
        if field.now - heard > 700_000 {
            heard = field.now;
            match last {
                None => field.send(&first),
                Some(seq) => field.send(&item_data(&items[usize::from(seq)], seq, MISSION)),
            }
        }
    }
    (None, field.now - began)
}

/// Downloads as a client does that repeats its last word when it hears nothing.
fn download(field: &mut Field, limit: u64) -> (Option<Vec<MissionItem>>, u64) {
    let began = field.now;
    let (mut total, mut items) = (None, Vec::new());
    let mut asked = 0;
    while field.now - began < limit {
        if asked == 0 || field.now - asked > 300_000 {
            asked = field.now;
            ask_next(field, total, items.len());
        }
        for seen in field.step() {
            if let Some(count) = seen.read::<MISSION_COUNT_DATA>()
                && total.is_none()
            {
                total = Some(usize::from(count.count));
                asked = 0;
            }
            if let Some(item) = seen.read::<MISSION_ITEM_INT_DATA>()
                && usize::from(item.seq) == items.len()
            {
                items.push(item_of(&item));
                asked = 0;
            }
        }
        if total == Some(items.len()) {
            return (Some(items), field.now - began);
        }
    }
    (None, field.now - began)
}

fn ask_next(field: &mut Field, total: Option<usize>, have: usize) {
    if total.is_none() {
        field.send(&MISSION_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
            mission_type: MISSION,
        });
    } else {
        field.send(&MISSION_REQUEST_INT_DATA {
            seq: have as u16,
            target_system: 1,
            target_component: 1,
            mission_type: MISSION,
        });
    }
}

fn equal(items: &[MissionItem], others: &[MissionItem]) -> bool {
    items.iter().map(bits).eq(others.iter().map(bits))
}

#[test]
fn on_a_clean_link_250_items_go_up_and_down_within_5_s_each() {
    let mut field = Field::new(Channel::clean(), Channel::clean());
    let items = plan(250, 0);
    let (result, up) = upload(&mut field, &items, 5_000_000);
    assert_eq!(result, Some(MavMissionResult::MAV_MISSION_ACCEPTED), "{up} µs");
    let (back, down) = download(&mut field, 5_000_000);
    assert!(equal(&back.expect("in time"), &items), "{down} µs");
    println!("250 items: up in {up} µs, down in {down} µs");
}

#[test]
fn on_a_bad_link_250_items_arrive_and_come_back_bit_for_bit() {
    for seed in 1..=20 {
        let mut field = Field::new(Channel::bad(seed), Channel::bad(seed + 1000));
        let items = plan(250, seed as u32);
        let (result, up) = upload(&mut field, &items, 300_000_000);
        assert_eq!(
            result,
            Some(MavMissionResult::MAV_MISSION_ACCEPTED),
            "seed {seed}"
        );
        assert!(
            equal(field.vehicle.store.items(PlanKind::Mission), &items),
            "seed {seed}"
        );
        let (back, down) = download(&mut field, 300_000_000);
        assert!(equal(&back.expect("in time"), &items), "seed {seed}");
        assert_eq!(field.vehicle.store.commits, 1, "seed {seed}");
        println!("seed {seed}: up in {up} µs, down in {down} µs");
    }
}

/// A client like MAVSDK, which never repeats an item: the vehicle's own retries carry it.
#[test]
fn at_5_percent_loss_a_client_that_repeats_nothing_uploads_250_items() {
    let mut done = 0;
    for seed in 1..=10 {
        let channel = |seed| Channel::new(5, 0, 1_000, 5_000, seed);
        let mut field = Field::new(channel(seed), channel(seed + 77));
        let items = plan(250, 0);
        field.send(&count(250, MISSION));
        let mut result = None;
        for _ in 0..60_000_000 / STEP {
            for seen in field.step() {
                if let Some(request) = seen.read::<MISSION_REQUEST_INT_DATA>() {
                    let item = &items[usize::from(request.seq)];
                    field.send(&item_data(item, request.seq, MISSION));
                }
                result = seen.read::<MISSION_ACK_DATA>().map(|ack| ack.mavtype).or(result);
            }
        }
        let stored = equal(field.vehicle.store.items(PlanKind::Mission), &items);
        // The first word or the last may be lost: those only the client could repeat.
        done += u32::from(stored && result == Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    }
    assert!(done >= 7, "{done} of 10");
}

/// Stopped anywhere, by silence or by its word, an upload leaves the plan as it was; afterwards
/// another one succeeds.
#[test]
fn an_interrupted_upload_leaves_the_stored_plan_alone() {
    for seed in 1..=10 {
        let mut field = Field::new(Channel::bad(seed), Channel::bad(seed + 500));
        let old = plan(20, 7);
        assert!(upload(&mut field, &old, 100_000_000).0.is_some());
        let before = field.vehicle.store.bits();
        let new = plan(60, 1000);
        let (result, _) = upload(&mut field, &new, 1_000_000 + seed * 200_000);
        assert_eq!(result, None);
        assert_eq!(field.vehicle.store.bits(), before);
        for _ in 0..15_000_000 / STEP {
            field.step();
        }
        assert_eq!(field.vehicle.store.bits(), before);
        assert!(upload(&mut field, &new, 100_000_000).0.is_some());
        assert!(equal(field.vehicle.store.items(PlanKind::Mission), &new));
    }
}

/// A client that raises `confirmation` until it hears an answer: the vehicle acts once.
#[test]
fn a_command_that_is_repeated_until_it_is_acknowledged_acts_once() {
    for seed in 1..=50 {
        let mut field = Field::new(Channel::bad(seed), Channel::bad(seed + 500));
        field.vehicle.answer = |_| Some(CommandResult::Denied);
        let mut command = long(
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
            [1.0, 0.0, NAN, NAN, NAN, NAN, NAN],
        );
        let (mut sent, mut result) = (0, None);
        for _ in 0..10_000_000 / STEP {
            if field.now - sent > 200_000 && result.is_none() {
                sent = field.now;
                field.send(&command);
                command.confirmation += 1;
            }
            for seen in field.step() {
                result = seen.read::<COMMAND_ACK_DATA>().map(|ack| ack.result).or(result);
            }
        }
        assert_eq!(result, Some(MavResult::MAV_RESULT_DENIED), "seed {seed}");
        assert_eq!(
            field.vehicle.requests(),
            [Request::Arm { force: false }],
            "seed {seed}"
        );
    }
}

/// The list of parameters with gaps that are read one by one, as every client does.
#[test]
fn all_parameters_arrive_on_a_bad_link() {
    let count = windhover_autopilot::Parameters::COUNT;
    for seed in 1..=10 {
        let mut field = Field::new(Channel::bad(seed), Channel::bad(seed + 500));
        let mut values = vec![None; count];
        let mut asked = 0;
        let began = field.now;
        while values.contains(&None) {
            assert!(field.now - began < 60_000_000, "seed {seed}");
            if field.now - asked > 1_000_000 {
                asked = field.now;
                ask_parameters(&mut field, &values);
            }
            for seen in field.step() {
                if let Some(value) = seen.read::<PARAM_VALUE_DATA>() {
                    assert_eq!(usize::from(value.param_count), count);
                    values[usize::from(value.param_index)] = Some(value.param_value);
                }
            }
        }
        for (index, value) in values.iter().enumerate() {
            assert_eq!(*value, field.vehicle.parameters.get(index));
        }
    }
}

fn ask_parameters(field: &mut Field, values: &[Option<f32>]) {
    if values.iter().all(Option::is_none) {
        return field.send(&PARAM_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
        });
    }
    let missing = values.iter().enumerate().filter(|(_, value)| value.is_none());
    for (index, _) in missing.take(10) {
        field.send(&PARAM_REQUEST_READ_DATA {
            param_index: index as i16,
            target_system: 1,
            target_component: 1,
            ..PARAM_REQUEST_READ_DATA::DEFAULT
        });
    }
}

/// On a narrow channel a plan still comes through, and the rate is kept.
#[test]
fn a_narrow_channel_carries_no_more_than_its_bytes() {
    let mut field = Field::new(Channel::clean(), Channel::clean());
    field.vehicle = Vehicle::with(Config {
        bandwidth: 600,
        ..Config::default()
    });
    field.vehicle.telemetry.attitude = Some(windhover_math::Quaternion::IDENTITY);
    field.vehicle.telemetry.global = Some(windhover_math::geodesy::GlobalPosition::default());
    let (mut bytes, mut heartbeats) = (0, 0);
    for _ in 0..20_000_000 / STEP {
        for frame in field.vehicle.poll(field.now) {
            bytes += frame.len();
            heartbeats += u32::from(frame[7] == 0 && frame[8] == 0);
        }
        field.now += STEP;
    }
    assert!((11_500..=12_700).contains(&bytes), "{bytes} bytes in 20 s");
    assert!(heartbeats >= 20, "{heartbeats}");
    assert!(field.vehicle.link.counters().left_out > 0);
    let items = plan(30, 0);
    let (result, _) = upload(&mut field, &items, 30_000_000);
    assert_eq!(result, Some(MavMissionResult::MAV_MISSION_ACCEPTED));
}
