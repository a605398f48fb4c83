//! Logs as evidence: a flight's log alone repeats the flight, bit for bit; and what is missing or
//! forged in it is named.

use rayon::prelude::*;
use windhover_autopilot::{Parameters, Preset};
use windhover_flight_log::reader::{Log, Messages};
use windhover_model::ModelKind;
use windhover_sim::flight::Setup;
use windhover_sim::replay::{Replay, replay, with_parameters};
use windhover_sim::sensors::Sensors;
use windhover_sim::{flight_report, report};
use windhover_tests::plan::short;
use windhover_tests::random::{random_conditions, random_mission};
use windhover_tests::{logged, monitoring, setup};

fn reference() -> Setup {
    setup("os4", Preset::Windhover, ModelKind::Rigid)
}

fn replayed(bytes: &[u8]) -> Replay {
    let log = Log::open(bytes).expect("a log");
    replay(&log).expect("a log of the core's")
}

/// The messages of a log, and where each begins and ends.
fn messages(bytes: &[u8]) -> Vec<(u8, u16, std::ops::Range<usize>)> {
    let (mut messages, _) = Messages::new(bytes).expect("a log");
    let mut found = vec![];
    while let Ok(message) = messages.next_message() {
        let id = message.body.first_chunk().map_or(0, |id| u16::from_le_bytes(*id));
        let end = message.offset + 3 + message.body.len();
        found.push((message.kind, id, message.offset..end));
    }
    found
}

/// Number of the topic `name` in a log: subscriptions name it.
fn topic(bytes: &[u8], name: &str) -> u16 {
    let is_it = |range: &std::ops::Range<usize>| &bytes[range.start + 6..range.end] == name.as_bytes();
    let mut subscriptions = messages(bytes).into_iter().filter(|(kind, ..)| *kind == b'A');
    let (.., range) = subscriptions
        .find(|(.., range)| is_it(range))
        .expect("a subscription");
    u16::from_le_bytes([bytes[range.start + 4], bytes[range.start + 5]])
}

/// Random vehicles, missions, winds, parameter writes, missing samples and late results. With
/// `WINDHOVER_FLIGHTS` in the environment, so many flights instead of 200.
#[test]
fn random_flights_replay_equal_from_their_logs() {
    let asked = std::env::var("WINDHOVER_FLIGHTS")
        .ok()
        .and_then(|text| text.parse().ok());
    let flights: u64 = asked.unwrap_or(200);
    let seconds: f64 = (1..=flights)
        .into_par_iter()
        .map(|seed| {
            let (flight, bytes) = logged(&random_conditions(seed), &random_mission(seed));
            let replay = replayed(&bytes);
            assert_eq!(replay.difference, None, "seed {seed}");
            assert_eq!((replay.missing_from, replay.cut), (None, None), "seed {seed}");
            assert!(
                (replay.seconds - flight.simulated).abs() < 0.01,
                "seed {seed}: all of it"
            );
            assert_eq!(
                u64::from(replay.ticks),
                replay.compared,
                "seed {seed}: every command"
            );
            replay.seconds
        })
        .sum();
    println!(
        "{flights} random flights, {:.1} hours, replayed equal",
        seconds / 3600.0
    );
}

#[test]
fn a_log_stays_below_its_rate() {
    let on_sensors = || Some(Sensors::default());
    for (rate, most, sensors) in [
        (1000, 40_000.0, None),
        (4000, 120_000.0, None),
        (1000, 40_000.0, on_sensors()),
        (4000, 120_000.0, on_sensors()),
    ] {
        let setup = Setup {
            imu_rate: rate,
            sensors,
            ..reference()
        };
        let (flight, bytes) = logged(&setup, &monitoring());
        let found = flight.figures.log_bytes_per_s;
        let source = if setup.sensors.is_some() {
            "sensors"
        } else {
            "truth"
        };
        println!("{rate} Hz, on {source}: {:.1} kB/s", found / 1000.0);
        assert!(found <= most, "{found} bytes/s at {rate} Hz");
        assert_eq!(replayed(&bytes).difference, None);
    }
}

/// Cut anywhere, a log replays up to there, and says that it is cut.
#[test]
fn a_cut_log_replays_up_to_the_cut() {
    let (_, bytes) = logged(&reference(), &short());
    let header = messages(&bytes)
        .iter()
        .find(|(kind, ..)| *kind == b'D')
        .map_or(0, |m| m.2.start);
    let whole = replayed(&bytes);
    let mut last = 0;
    let mut cuts = 0;
    for cut in (header + 20_000..bytes.len()).step_by(bytes.len() / 37) {
        let replay = replayed(&bytes[..cut]);
        assert_eq!(replay.difference, None, "cut at {cut}");
        assert!(
            replay.ticks >= last && replay.ticks <= whole.ticks,
            "cut at {cut}"
        );
        last = replay.ticks;
        cuts += usize::from(replay.cut.is_some());
    }
    assert!(
        last > whole.ticks / 2 && cuts > 20,
        "{last} ticks, {cuts} cuts noticed"
    );
}

/// An input that is lost is missing from its tick on: that is not a difference.
#[test]
fn lost_inputs_are_missing_not_different() {
    let (_, mut bytes) = logged(&reference(), &short());
    let id = topic(&bytes, "imu_batch");
    let batches: Vec<_> = messages(&bytes)
        .into_iter()
        .filter(|m| m.0 == b'D' && m.1 == id)
        .collect();
    bytes.drain(batches[1000].2.clone());
    let replay = replayed(&bytes);
    assert_eq!((replay.missing_from, replay.difference), (Some(4000), None));
}

/// A forged count of the gyro, a forged motor command and a forged view are each found where they
/// are, by name.
#[test]
fn forgeries_are_named() {
    let (_, bytes) = logged(&reference(), &short());
    let forge = |name: &str, number: usize, byte: usize, bit: u8| {
        let id = topic(&bytes, name);
        let found: Vec<_> = messages(&bytes)
            .into_iter()
            .filter(|m| m.0 == b'D' && m.1 == id)
            .collect();
        let mut forged = bytes.clone();
        // Behind size, kind, topic and time.
        forged[found[number].2.start + 13 + byte] ^= 1 << bit;
        replayed(&forged)
            .difference
            .unwrap_or_else(|| panic!("{name} forged, and nothing noticed"))
    };
    let motors = forge("motor_batch", 2500, 8, 3);
    assert_eq!(motors.topic, "motor_batch");
    assert!((10_000..10_004).contains(&motors.tick), "{motors}");
    let attitude = forge("vehicle_attitude", 100, 3, 6);
    assert_eq!(attitude.topic, "vehicle_attitude");
    assert!(attitude.field.starts_with("q["), "{attitude}");
    let gyro = forge("imu_batch", 3000, 20, 7);
    assert!(gyro.tick >= 12_000 && gyro.tick < 12_010, "{gyro}");
}

/// Other parameters change commands; the same ones do not.
#[test]
fn replay_with_another_parameter_tells_the_difference() {
    let (_, bytes) = logged(&reference(), &short());
    let log = Log::open(&bytes).unwrap();
    let with = |name: &str, value: f32| {
        let index = Parameters::find(name).unwrap();
        with_parameters(&log, |parameters| parameters.set(index, value).unwrap()).unwrap()
    };
    let same = with("ATT_TILT_P", Parameters::default().attitude.tilt_p);
    assert_eq!((same.changed, same.largest), (0, 0.0));
    let other = with("ATT_TILT_P", 10.0);
    assert!(other.changed > other.commands / 2 && other.rms > 0.001 && other.largest > other.rms);
    assert!(other.largest < 1.0 && other.largest_time > 0.0);
}

/// A board's log has no truth: the report shows what the vehicle believed.
#[test]
fn a_log_without_truth_makes_a_report() {
    let (flight, bytes) = logged(&reference(), &short());
    let id = topic(&bytes, "truth");
    let mut bare = bytes[..16].to_vec();
    for (kind, of, range) in messages(&bytes) {
        if !(kind == b'D' && of == id) {
            bare.extend_from_slice(&bytes[range]);
        }
    }
    assert!(bare.len() < bytes.len());
    let told = flight_report::report(&Log::open(&bare).unwrap(), "bare");
    assert!(told.samples.len() > 300, "{} samples", told.samples.len());
    assert_eq!(told.photos.len(), flight.figures.photos.len());
    assert!(
        told.figures
            .iter()
            .any(|figure| figure.label.contains("as believed"))
    );
    assert!(report::html(&told).contains("bare"));
}
