//! Writes small logs, for other readers and as seeds for fuzzing.
//!
//! `cargo run -p windhover-flight-log --features reader --example sample FOLDER [TICKS]`

#[path = "../tests/common/mod.rs"]
mod common;

use std::path::PathBuf;

use common::{Bench, Flown, Plot, fly};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().expect("a folder"));
    let ticks = arguments
        .next()
        .map_or(40, |ticks| ticks.parse().expect("a number of ticks"));
    let write = |name: &str, log: Vec<u8>| {
        std::fs::write(folder.join(name), log).expect("cannot write the log");
    };
    let truth = Plot {
        truth: true,
        ..Plot::calm(1000, ticks)
    };
    write("calm.ulg", fly::<16384>(truth).log);
    write("disrupted.ulg", fly::<16384>(Plot::disrupted(5, 1000, ticks)).log);
    write("fast.ulg", fly::<16384>(Plot::disrupted(6, 4000, ticks)).log);
    write("gap.ulg", gap(ticks));
}

/// Storage that takes nothing in the first half.
fn gap(ticks: usize) -> Vec<u8> {
    let mut flown = Flown::new(common::header_bytes(1000, &common::mission()));
    let mut bench = Bench::<384>::new(Plot::disrupted(8, 1000, ticks));
    for tick in 0..ticks {
        bench.tick(tick, &mut flown);
        if tick > ticks / 2 {
            bench.drain(&mut flown.log);
        }
    }
    bench.logger.finish();
    bench.drain(&mut flown.log);
    flown.log
}
