//! A receiver is found at any rate, of either generation, whatever happens to it.

use windhover_drivers::health::Health;
use windhover_drivers::ublox::{BAUDS, SILENCE_US, TARGET_BAUD};

use super::receiver::{Bench, Generation, MS, Receiver, SECOND};

const GENERATIONS: [Generation; 3] = [Generation::M8, Generation::Mute, Generation::M10];

/// The longest from power to reports: all rates, a port, five commands that are answered at once.
const FOUND_US: u64 = 8 * SECOND;

fn bench(generation: Generation, baud: u32) -> Bench {
    Bench::new(Some(Receiver::new(generation, baud, 0)))
}

/// Ten reports a second and nothing else on the line, in the air's dynamics.
fn assert_reports(bench: &mut Bench) {
    bench.reports.clear();
    bench.run(SECOND);
    let receiver = bench.receiver.as_ref().expect("there is one");
    let what = format!("{:?}", (receiver.generation, receiver.baud));
    assert!((9..=11).contains(&bench.reports.len()), "{what}");
    assert_eq!(receiver.baud, TARGET_BAUD, "{what}");
    assert!(!receiver.sentences, "{what}");
    assert_eq!(bench.setup.health(), Health::Working, "{what}");
}

#[test]
fn a_receiver_is_found_at_every_rate() {
    for generation in GENERATIONS {
        for baud in BAUDS {
            let mut bench = bench(generation, baud);
            bench.run(FOUND_US);
            assert_reports(&mut bench);
            assert_eq!(bench.receiver.as_ref().map(|receiver| receiver.dynamics), Some(8));
        }
    }
}

/// As they leave the factory: M10 at 38,400 baud, M8 at 9,600.
#[test]
fn the_usual_ones_report_soon() {
    for (generation, baud, most) in [
        (Generation::M10, 38_400, 2_000 * MS),
        (Generation::M8, 9_600, 4_000 * MS),
    ] {
        let mut bench = bench(generation, baud);
        bench.run(most);
        assert!(!bench.reports.is_empty(), "{generation:?}");
    }
}

/// The power of the receiver alone fails: what it was told is gone.
#[test]
fn a_receiver_that_forgot_is_configured_anew() {
    for generation in GENERATIONS {
        for baud in BAUDS {
            let mut bench = bench(generation, baud);
            bench.run(FOUND_US);
            let now = bench.now;
            bench.receiver.as_mut().expect("there is one").power_cycle(now);
            bench.run(SILENCE_US + FOUND_US);
            assert_reports(&mut bench);
        }
    }
}

/// Power fails at any moment of the search and of the configuration.
#[test]
fn whenever_power_fails_it_ends_well() {
    for generation in GENERATIONS {
        for moment in (0..4_000).step_by(37) {
            let mut bench = bench(generation, 9_600);
            bench.run(moment * MS);
            let now = bench.now;
            bench.receiver.as_mut().expect("there is one").power_cycle(now);
            bench.run(SILENCE_US + 2 * FOUND_US);
            assert_reports(&mut bench);
        }
    }
}

/// The board alone starts again: the receiver is where it was left.
#[test]
fn a_receiver_that_is_configured_is_found_at_once() {
    for generation in GENERATIONS {
        let mut first = bench(generation, 9_600);
        first.run(FOUND_US);
        let mut bench = Bench::new(first.receiver);
        bench.now = first.now;
        bench.run(2 * SECOND);
        assert_reports(&mut bench);
    }
}

#[test]
fn no_receiver_is_told_and_one_that_comes_is_found() {
    let mut bench = Bench::new(None);
    bench.run(20 * SECOND);
    assert_eq!(bench.setup.health(), Health::Absent);
    bench.receiver = Some(Receiver::new(Generation::M10, 38_400, bench.now));
    bench.run(FOUND_US);
    assert_reports(&mut bench);
    bench.receiver = None;
    bench.run(SILENCE_US + SECOND);
    assert_eq!(bench.setup.health(), Health::Absent);
}

/// It answers everything and refuses to report.
#[test]
fn a_receiver_that_does_not_report_is_said_to_be_stuck_all_the_time() {
    let mut bench = bench(Generation::M8, 9_600);
    bench.receiver.as_mut().expect("there is one").refuses = Some([6, 1]);
    bench.run(FOUND_US + SILENCE_US);
    for _ in 0..200 {
        bench.run(100 * MS);
        assert_eq!(bench.setup.health(), Health::Stuck);
    }
    assert!(bench.reports.is_empty());
}

/// One command that is refused does not hinder the others.
#[test]
fn a_receiver_without_dynamics_reports_all_the_same() {
    let mut bench = bench(Generation::M8, 9_600);
    bench.receiver.as_mut().expect("there is one").refuses = Some([6, 0x24]);
    bench.run(FOUND_US);
    assert_reports(&mut bench);
}
