//! What happens when storage is slower than the log.

mod common;

use common::{Bench, Flown, Plot, Random};
use windhover_autopilot::InnerInput;
use windhover_flight_log::reader::{Entry, Log, Step};

/// Periods of a log and its gaps, held against the inputs that there were.
struct Read {
    periods: usize,
    with_outputs: usize,
    gaps: Vec<(u32, u32)>,
    dropouts: usize,
    first_without_outputs: Option<u32>,
}

fn read(bytes: &[u8], inputs: &[InnerInput]) -> Read {
    let log = Log::open(bytes).unwrap();
    let mut read = Read {
        periods: 0,
        with_outputs: 0,
        gaps: Vec::new(),
        dropouts: log
            .entries()
            .filter(|entry| matches!(entry, Entry::Dropout(_)))
            .count(),
        first_without_outputs: None,
    };
    let mut tick = 0;
    for step in log.periods() {
        match step {
            Step::Period(period) => {
                assert_eq!(period.record.tick, tick);
                let flown = &inputs[tick as usize..][..period.ticks.len()];
                assert_eq!(period.ticks.as_slice(), flown);
                read.periods += 1;
                match &period.outputs {
                    Some(_) => read.with_outputs += 1,
                    None => {
                        read.first_without_outputs.get_or_insert(tick);
                    }
                }
                tick = period.next_tick();
            }
            Step::Gap { from, until } => {
                assert_eq!(from, tick, "a gap begins where the inputs end");
                assert!(until > from);
                read.gaps.push((from, until));
                tick = until;
            }
        }
    }
    read
}

#[test]
fn outputs_go_first_then_a_gap_then_all_is_well_again() {
    let plot = Plot::disrupted(3, 1000, 0);
    let mut flown = Flown::new(common::header_bytes(1000, &common::mission()));
    let mut bench = Bench::<8192>::new(plot);
    // Nobody takes anything: half the ring fills with all, the other half with inputs.
    for tick in 0..1000 {
        bench.tick(tick, &mut flown);
    }
    assert!(bench.logger.dropped_outputs() > 0);
    assert!(bench.logger.dropped_inputs() > 0);
    bench.drain(&mut flown.log);
    for tick in 1000..2000 {
        bench.tick(tick, &mut flown);
        bench.drain(&mut flown.log);
    }
    bench.logger.finish();
    bench.drain(&mut flown.log);
    let read = read(&flown.log, &flown.inputs);
    assert_eq!(read.gaps.len(), 1);
    let (from, until) = read.gaps[0];
    let outputs_end = read.first_without_outputs.unwrap();
    assert!(
        outputs_end < from,
        "outputs end at {outputs_end}, inputs at {from}"
    );
    assert_eq!(until, 1000);
    assert!(read.dropouts >= 1);
    // After the gap every period has its outputs again.
    assert_eq!(read.with_outputs, outputs_end as usize / 4 + 250);
    assert_eq!(read.periods, from as usize / 4 + 250);
}

#[test]
fn inputs_alone_get_through_a_slow_storage() {
    // 30 kB/s: enough for the inputs, not for all.
    let plot = Plot::calm(1000, 0);
    let mut flown = Flown::new(common::header_bytes(1000, &common::mission()));
    let mut bench = Bench::<8192>::new(plot);
    let mut buffer = [0; 30];
    for tick in 0..5000 {
        bench.tick(tick, &mut flown);
        let count = bench.logger.drain(&mut buffer);
        flown.log.extend_from_slice(&buffer[..count]);
    }
    bench.logger.finish();
    bench.drain(&mut flown.log);
    assert_eq!(bench.logger.dropped_inputs(), 0);
    let read = read(&flown.log, &flown.inputs);
    assert_eq!((read.periods, read.gaps.len()), (1250, 0));
    assert!(read.with_outputs < 1250 && read.with_outputs > 100);
    assert!(read.dropouts > 0);
}

#[test]
fn whatever_storage_does_nothing_false_is_logged() {
    for seed in 0..60 {
        let mut random = Random::new(seed + 100);
        let rate = [250, 1000, 4000][random.below(3)];
        let mut flown = Flown::new(common::header_bytes(rate, &common::mission()));
        let mut bench = Bench::<2048>::new(Plot::disrupted(seed, rate, 0));
        let mut stall = 0;
        for tick in 0..4000 {
            bench.tick(tick, &mut flown);
            if stall > 0 {
                stall -= 1;
            } else if random.below(100) == 0 {
                stall = random.below(400);
            } else {
                let mut buffer = [0; 200];
                let share = random.below(200);
                let count = bench.logger.drain(&mut buffer[..share]);
                flown.log.extend_from_slice(&buffer[..count]);
            }
        }
        bench.logger.finish();
        let dropped = bench.logger.dropped_inputs();
        bench.drain(&mut flown.log);
        let read = read(&flown.log, &flown.inputs);
        assert!(read.periods > 0);
        assert!(read.gaps.is_empty() || dropped > 0, "a gap and nothing dropped");
    }
}

/// A rate whose periods are longer than any that is logged: no input is lost without a word.
#[test]
fn a_rate_too_high_is_a_gap_from_the_start() {
    let mut flown = Flown::new(Vec::new());
    let mut bench = Bench::<8192>::new(Plot::calm(8000, 0));
    for tick in 0..320 {
        bench.tick(tick, &mut flown);
    }
    assert!(bench.logger.dropped_inputs() > 0);
}
