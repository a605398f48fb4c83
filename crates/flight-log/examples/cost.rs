//! What the log costs: time a tick, and bytes a second by topic.
//!
//! `cargo run --release -p windhover-flight-log --features reader --example cost [LOG]` prints it,
//! and writes the log of a disrupted flight of 20 s where a path is given.

#[path = "../tests/common/mod.rs"]
mod common;

use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Instant;

use common::{Plot, fly};
use windhover_autopilot::{InnerInput, MotorCommand, OuterResult, ScheduleRecord, Snapshot};
use windhover_flight_log::reader::Messages;
use windhover_flight_log::{Logger, LoggerConfig, topics, wire};

const SECONDS: usize = 20;

/// Runs of which the fastest counts.
const RUNS: usize = 100;

fn main() {
    for imu_rate in [1000, 4000] {
        bytes(imu_rate);
        time(imu_rate);
    }
    if let Some(path) = std::env::args().nth(1) {
        let flown = fly::<16384>(Plot::disrupted(7, 1000, 1000 * SECONDS));
        std::fs::write(&path, flown.log).expect("cannot write the log");
    }
}

fn bytes(imu_rate: u32) {
    let flown = fly::<16384>(Plot::calm(imu_rate, imu_rate as usize * SECONDS));
    let (mut messages, _) = Messages::new(&flown.log).expect("a log");
    let mut sums = BTreeMap::new();
    while let Ok(message) = messages.next_message() {
        if message.offset < flown.header {
            continue;
        }
        let id = message.body.first_chunk().map(|id| u16::from_le_bytes(*id));
        let topic = topics::all().find(|topic| message.kind == wire::kind::DATA && Some(topic.id) == id);
        let name = topic.map_or("(other)", |topic| topic.name);
        let sum = sums.entry(name).or_insert((0, 0));
        *sum = (sum.0 + 1, sum.1 + message.body.len() + wire::MESSAGE_HEADER);
    }
    let total = (flown.log.len() - flown.header) / SECONDS;
    println!(
        "{imu_rate} Hz: header {} bytes, then {total} bytes/s",
        flown.header
    );
    for (name, (count, bytes)) in sums {
        println!(
            "  {name:32} {:8.2} /s {:8.1} bytes/s",
            count as f64 / SECONDS as f64,
            bytes as f64 / SECONDS as f64
        );
    }
}

/// One tick as the logger is told of it.
type Told = (
    InnerInput,
    MotorCommand,
    Option<ScheduleRecord>,
    Option<Box<(Snapshot, OuterResult)>>,
);

/// Flies once, and then has only the logger work on what it was told.
fn time(imu_rate: u32) {
    let told = told(imu_rate);
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let config = LoggerConfig::new(common::config(imu_rate), &common::parameters());
        let mut logger = Logger::<8192>::new(config);
        let mut buffer = vec![0; 1 << 16];
        let start = Instant::now();
        for (input, motors, record, outer) in &told {
            logger.tick(input, *motors, *record);
            if let Some(outer) = outer {
                let (snapshot, result) = outer.as_ref();
                logger.inputs(&snapshot.inputs, snapshot.tick);
                logger.result(snapshot, result);
                if logger.waiting() > 2048 {
                    black_box(logger.drain(&mut buffer));
                }
            }
        }
        let elapsed = start.elapsed().as_secs_f64();
        assert_eq!(logger.dropped_outputs(), 0);
        if elapsed < best {
            best = elapsed;
        }
    }
    println!("  {:.1} ns a tick", best * 1e9 / told.len() as f64);
}

fn told(imu_rate: u32) -> Vec<Told> {
    let mut bench = common::Bench::<16384>::new(Plot::calm(imu_rate, 0));
    (0..imu_rate as usize)
        .map(|tick| {
            let input = bench.input(tick);
            let output = bench.inner.tick(&input, &mut bench.mailboxes);
            let outer = bench.mailboxes.snapshot.take().map(|snapshot| {
                let result = bench.outer.step(&snapshot, bench.mission.as_slice());
                bench.mailboxes.result = Some(result.clone());
                Box::new((snapshot, result))
            });
            (input, output.motors, output.record, outer)
        })
        .collect()
}
