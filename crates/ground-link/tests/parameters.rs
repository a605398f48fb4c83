//! The parameter protocol on a clean channel.

mod common;

use common::*;
use mavlink::dialects::common::*;
use windhover_autopilot::Parameters;
use windhover_ground_link::parameters::{Appended, QGROUNDCONTROL};
use windhover_ground_link::{Config, Context, Link, ParameterTable, Request, Signing, Telemetry};

fn set(name: &str, value: f32) -> PARAM_SET_DATA {
    PARAM_SET_DATA {
        param_value: value,
        target_system: 1,
        target_component: 1,
        param_id: name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    }
}

fn read(name: &str, index: i16) -> PARAM_REQUEST_READ_DATA {
    PARAM_REQUEST_READ_DATA {
        param_index: index,
        target_system: 1,
        target_component: 1,
        param_id: name.into(),
    }
}

const LIST: PARAM_REQUEST_LIST_DATA = PARAM_REQUEST_LIST_DATA {
    target_system: 1,
    target_component: 1,
};

#[test]
fn the_list_has_every_parameter_once_as_a_float() {
    let mut bench = Bench::new();
    let mut seen = bench.ask(&LIST);
    seen.extend(bench.run(1_000_000));
    let values: Vec<PARAM_VALUE_DATA> = all(&seen);
    assert_eq!(values.len(), Parameters::COUNT);
    for (index, (value, declaration)) in values.iter().zip(Parameters::declarations()).enumerate() {
        assert_eq!(usize::from(value.param_index), index);
        assert_eq!(value.param_id.to_str(), Ok(declaration.name));
        assert_eq!(value.param_value, declaration.default);
        assert_eq!(value.param_type, MavParamType::MAV_PARAM_TYPE_REAL32);
    }
}

#[test]
fn the_list_goes_at_the_pace_of_the_channel() {
    let bandwidth = 2_000;
    let mut bench = Bench::with(Vehicle::with(Config {
        bandwidth,
        ..Config::default()
    }));
    bench.run(1_000_000);
    let began = bench.now;
    let mut got = all::<PARAM_VALUE_DATA>(&bench.ask(&LIST)).len();
    while got < Parameters::COUNT {
        got += all::<PARAM_VALUE_DATA>(&bench.run(STEP)).len();
        assert!(bench.now - began < 20_000_000);
    }
    let least = (Parameters::COUNT as u64) * 30 * 1_000_000 / u64::from(bandwidth);
    assert!(bench.now - began > least / 2, "{} µs", bench.now - began);
}

#[test]
fn one_is_read_by_name_and_by_index() {
    let mut bench = Bench::new();
    let name = "MOT_IDLE";
    let index = Parameters::find(name).unwrap();
    for asked in [read(name, -1), read("", index as i16)] {
        let values: Vec<PARAM_VALUE_DATA> = all(&bench.ask(&asked));
        assert_eq!(values.len(), 1);
        assert_eq!(
            (usize::from(values[0].param_index), values[0].param_id.to_str()),
            (index, Ok(name))
        );
    }
    for asked in [
        read("NO_SUCH_NAME", -1),
        read("", 30_000),
        read("", -2),
        read("MOT_IDL", -1),
    ] {
        let seen = bench.ask(&asked);
        assert!(all::<PARAM_VALUE_DATA>(&seen).is_empty());
        let errors: Vec<PARAM_ERROR_DATA> = all(&seen);
        assert_eq!(errors.len(), 1, "no silence");
        assert_eq!(
            (errors[0].param_index, errors[0].param_id, errors[0].error),
            (
                asked.param_index,
                asked.param_id,
                MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST
            )
        );
        assert_eq!(errors[0].target_system, 255);
    }
}

#[test]
fn a_value_in_range_is_set_and_what_the_table_then_holds_is_sent_back() {
    let mut bench = Bench::new();
    let values: Vec<PARAM_VALUE_DATA> = all(&bench.ask(&set("MOT_IDLE", 0.125)));
    assert_eq!(values.len(), 1);
    assert_eq!(values[0].param_value, 0.125);
    let index = Parameters::find("MOT_IDLE").unwrap() as u16;
    assert_eq!(
        bench.vehicle.requests(),
        [Request::WriteParameter { index, value: 0.125 }]
    );
    let again: Vec<PARAM_VALUE_DATA> = all(&bench.ask(&set("MOT_IDLE", 0.125)));
    assert_eq!(
        (again.len(), bench.vehicle.orders.len()),
        (1, 1),
        "nothing to be done"
    );
}

#[test]
fn a_value_that_cannot_be_is_answered_with_the_old_one_and_the_range() {
    for value in [0.5, -1.0, f32::NAN, f32::INFINITY, f32::from_bits(5)] {
        let mut bench = Bench::new();
        let mut seen = bench.ask(&set("MOT_IDLE", value));
        seen.extend(bench.run(STEP));
        let values: Vec<PARAM_VALUE_DATA> = all(&seen);
        assert_eq!((values.len(), values[0].param_value), (1, 0.08));
        let text = if value.is_subnormal() {
            "MOT_IDLE: to be sent as REAL32"
        } else {
            "MOT_IDLE: the range is 0.02 to 0.3"
        };
        assert_eq!(texts(&seen), [text]);
        assert!(bench.vehicle.orders.is_empty());
    }
    let mut bench = Bench::new();
    assert_eq!(
        texts(&bench.ask(&set("NOTHING", 1.0))),
        ["NOTHING: there is no such parameter"]
    );
}

#[test]
fn a_write_that_the_vehicle_does_not_take_is_answered_with_what_it_holds() {
    let mut bench = Bench::new();
    bench.vehicle.takes = false;
    assert!(all::<PARAM_VALUE_DATA>(&bench.ask(&set("MOT_IDLE", 0.2))).is_empty());
    let values: Vec<PARAM_VALUE_DATA> = all(&bench.run(500_000));
    assert_eq!((values.len(), values[0].param_value), (1, 0.08));
    // Refused by the vehicle for a reason of its own.
    bench.ask(&set("MOT_IDLE", 0.2));
    let index = Parameters::find("MOT_IDLE").unwrap() as u16;
    let refusal = windhover_parameters::Refusal::Inconsistent;
    let Vehicle { link, parameters, .. } = &mut bench.vehicle;
    link.parameter_refused(index, refusal, parameters, bench.now);
    let seen = bench.run(2 * STEP);
    assert_eq!(all::<PARAM_VALUE_DATA>(&seen)[0].param_value, 0.08);
    assert_eq!(
        texts(&seen),
        ["MOT_IDLE: it does not go with the other parameters"]
    );
}

/// Clients write many at once. If a write that finds no room were answered with the old value, that
/// would look like a refusal, and nobody would send it again.
#[test]
fn a_write_without_room_is_not_answered_and_works_when_it_is_repeated() {
    let mut bench = Bench::new();
    bench.vehicle.takes = false;
    let writes: Vec<PARAM_SET_DATA> = (0..20)
        .map(|index| Parameters::declaration(index).unwrap())
        .map(|of| {
            set(
                of.name,
                of.min + 0.5 * (of.default - of.min) + 0.1 * (of.max - of.min),
            )
        })
        .collect();
    let frames: Vec<u8> = writes
        .iter()
        .flat_map(|write| bench.station.frame(write))
        .collect();
    let early = bench.bytes(&frames);
    let late = bench.run(500_000);
    let answers = [early, late].map(|seen| all::<PARAM_VALUE_DATA>(&seen).len());
    assert_eq!(answers, [0, 8], "what they are after a time");
    assert_eq!(bench.vehicle.link.counters().dropped.requests, 12);
    bench.vehicle.takes = true;
    bench.vehicle.receive(&[], bench.now);
    for write in &writes[8..] {
        let values: Vec<PARAM_VALUE_DATA> = all(&bench.ask(write));
        assert_eq!((values.len(), values[0].param_value), (1, write.param_value));
    }
}

/// CRC-32 as QGroundControl computes it, bit by bit, over names in order.
#[test]
fn the_hash_is_the_one_that_clients_compute_over_what_they_know() {
    let mut bench = Bench::new();
    let mut known: Vec<_> = (0..Parameters::COUNT as u16)
        .map(|index| {
            let table: &dyn ParameterTable = &bench.vehicle.parameters;
            (
                table.declaration(index).unwrap().name,
                table.value(index).unwrap(),
            )
        })
        .collect();
    known.sort_by_key(|(name, _)| *name);
    let mut state = 0u32;
    for (name, value) in known {
        for byte in name.bytes().chain(value.to_le_bytes()) {
            state ^= u32::from(byte);
            for _ in 0..8 {
                state = if state & 1 == 1 {
                    state >> 1 ^ 0xedb8_8320
                } else {
                    state >> 1
                };
            }
        }
    }
    let values: Vec<PARAM_VALUE_DATA> = all(&bench.ask(&read("_HASH_CHECK", -1)));
    assert_eq!((values.len(), values[0].param_value.to_bits()), (1, state));
    // A client that knows all stops the list with it.
    bench.vehicle.link = windhover_ground_link::Link::new(Config {
        bandwidth: 1_000,
        ..Config::default()
    });
    bench.ask(&LIST);
    let hash = f32::from_bits(state);
    let after = bench.ask(&set("_HASH_CHECK", hash));
    let rest = bench.run(20_000_000);
    let got = all::<PARAM_VALUE_DATA>(&after).len() + all::<PARAM_VALUE_DATA>(&rest).len();
    assert!(got < 5, "{got} more");
}

/// What QGroundControl only asks for follows the core's table, and keeps its value.
#[test]
fn constants_are_listed_found_and_never_written() {
    let own = Parameters::default();
    let table = Appended {
        table: &own,
        constants: QGROUNDCONTROL,
    };
    for constant in QGROUNDCONTROL {
        assert_eq!(
            Parameters::find(constant.name),
            None,
            "{} is the core's",
            constant.name
        );
        assert!(constant.name.len() <= 16);
    }
    assert_eq!(
        usize::from(table.count()),
        Parameters::COUNT + QGROUNDCONTROL.len()
    );
    assert_eq!(table.declaration(table.count()), None);
    let mut link = Link::new(Config {
        bandwidth: 1_000_000,
        ..Config::default()
    });
    let (telemetry, mut store, mut signing) = (Telemetry::default(), Store::default(), Signing::default());
    let mut station = Station::new(255);
    let mut ask = |frame: &[u8], station: &mut Station| {
        let mut context = Context {
            telemetry: &telemetry,
            parameters: &table,
            plans: &mut store,
            signing: &mut signing,
        };
        link.receive(frame, 0, &mut context);
        assert_eq!(link.next_request(), None);
        let mut frames = Vec::new();
        for now in 0..100 {
            link.poll(now * STEP, &mut context, &mut |frame| frames.push(frame.to_vec()));
        }
        station.read(&frames)
    };
    let frame = station.frame(&LIST);
    let values: Vec<PARAM_VALUE_DATA> = all(&ask(&frame, &mut station));
    assert_eq!(values.len(), usize::from(table.count()));
    let frame = station.frame(&set("SYS_AUTOSTART", 1.0));
    let seen = ask(&frame, &mut station);
    let values: Vec<PARAM_VALUE_DATA> = all(&seen);
    let last = usize::from(values[0].param_index);
    assert_eq!((values[0].param_value, last >= Parameters::COUNT), (4001.0, true));
    assert_eq!(texts(&seen), ["SYS_AUTOSTART: the range is 4001 to 4001"]);
    let frame = station.frame(&set("SYS_AUTOSTART", 4001.0));
    assert_eq!(all::<PARAM_VALUE_DATA>(&ask(&frame, &mut station)).len(), 1);
}
