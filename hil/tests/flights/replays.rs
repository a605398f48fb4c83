//! What the firmware did on the board, the desktop repeats bit for bit.

use windhover_hil::time::SECOND;
use windhover_hil::trouble::Slow;
use windhover_model::random::Random;

use crate::{fly, fly_after, is_long, plan};

/// Whole flights: attitudes are held, loads and latency keep their bounds (estimates by the cost
/// model), and the log replays equal.
fn holds_and_replays(rate: f32, seconds: f64) {
    let plan = plan(seconds)
        .with_parameter("IMU_GYRO_RATEMAX", rate)
        .expect("a rate");
    let (_, figures) = fly(&plan);
    assert!(figures.replays(), "{:?}", figures.replay);
    assert!(
        figures.outcome.stopped && figures.outcome.height > 5.0,
        "{:?}",
        figures.outcome
    );
    assert!(
        figures
            .outcome
            .attitude_error
            .is_some_and(|error| error < 1f64.to_radians()),
        "{:?}",
        figures.outcome
    );
    let health = figures.health.expect("once a second");
    assert!(health.latency_max <= 150, "{} us", health.latency_max);
    assert!(
        figures.load_inner <= if rate < 2000.0 { 0.2 } else { 0.5 },
        "{}",
        figures.load_inner
    );
    // Stored before a restart, flown after it.
    assert_eq!(
        (figures.resets, figures.reset_cause.as_str()),
        (1, "restart by command")
    );
}

#[test]
fn at_1_khz() {
    holds_and_replays(1000.0, if is_long() { 60.0 } else { 15.0 });
}

#[test]
fn at_4_khz() {
    holds_and_replays(4000.0, if is_long() { 60.0 } else { 20.0 });
}

/// An outer step that takes up to three periods misses boundaries; nothing about that is lost.
#[test]
fn with_an_outer_step_slowed_until_deadlines_are_missed() {
    let seeds = if is_long() { 8 } else { 2 };
    for seed in 1..=seeds {
        let rate = if seed % 2 == 0 { 4000.0 } else { 1000.0 };
        let mut plan = plan(8.0)
            .with_parameter("IMU_GYRO_RATEMAX", rate)
            .expect("a rate");
        plan.slow = Some(Slow {
            most: 0.012,
            share: 1.0,
            seed,
        });
        let (_, figures) = fly(&plan);
        assert!(figures.replays(), "seed {seed}: {:?}", figures.replay);
        assert!(
            figures.counts.is_some_and(|counts| counts.missed > 100),
            "seed {seed}"
        );
        // One restart with the parameter: no miss, however often, is the watchdog's business.
        assert_eq!(figures.resets, 1, "seed {seed}");
        // Whoever did not hear the command to arm holds no attitude.
        assert!(
            figures.outcome.height > 5.0
                && figures.outcome.stopped
                && figures
                    .outcome
                    .attitude_error
                    .is_some_and(|error| error < 5f64.to_radians()),
            "seed {seed}: {:?}",
            figures.outcome
        );
    }
}

/// Behind an outer step that leaves next to no time, commands are heard and no input is missing
/// from the log.
#[test]
fn with_an_outer_step_that_takes_nearly_all_of_the_time() {
    let mut plan = plan(5.0)
        .with_parameter("IMU_GYRO_RATEMAX", 4000.0)
        .expect("a rate");
    plan.slow = Some(Slow {
        most: 0.06,
        share: 1.0,
        seed: 1,
    });
    let (_, figures) = fly(&plan);
    assert!(figures.replays(), "{:?}", figures.replay);
    assert!(
        figures.outcome.height > 3.0 && figures.outcome.stopped,
        "{:?}",
        figures.outcome
    );
}

/// A command port that babbles as fast as it can takes nothing from the inner loop, and what comes
/// behind is understood.
#[test]
fn after_babble_on_the_command_port() {
    let plan = plan(4.0)
        .with_parameter("IMU_GYRO_RATEMAX", 4000.0)
        .expect("a rate");
    let quiet = fly(&plan).1.counts.expect("once a second");
    let (_, figures) = fly_after(&plan, |flight| {
        flight.prepare().expect("it boots");
        let mut random = Random::new(1, 1);
        // Some begin like a frame.
        let babble: Vec<u8> = (0..30_000)
            .map(|_| match random.bits() % 300 {
                byte @ 0..=255 => byte as u8,
                _ => 0xA5,
            })
            .collect();
        let now = flight.machine.now();
        flight.machine.bus().wiring.send(now, &babble);
        flight.run(now + 3 * SECOND).expect("it bears it");
    });
    assert!(figures.replays(), "{:?}", figures.replay);
    assert!(
        figures.outcome.height > 2.0 && figures.outcome.stopped,
        "{:?}",
        figures.outcome
    );
    let (counts, health) = (figures.counts.expect("once a second"), figures.health);
    assert_eq!((counts.missing, counts.missed), (quiet.missing, quiet.missed));
    assert!(health.is_some_and(|health| health.latency_max <= 150));
}

/// Data-ready is lost for 5 to 500 ms, again and again, from in flight on.
#[test]
fn with_data_ready_lost_at_random() {
    let seeds = if is_long() { 10 } else { 2 };
    for seed in 1..=seeds {
        let rate = if seed % 2 == 0 { 4000.0 } else { 1000.0 };
        let mut plan = plan(8.0)
            .with_parameter("IMU_GYRO_RATEMAX", rate)
            .expect("a rate");
        plan.rig.faults = vec!["data-ready-random@10.5".parse().expect("a fault")];
        plan.rig.seed = seed;
        let (_, figures) = fly(&plan);
        assert!(figures.replays(), "seed {seed}: {:?}", figures.replay);
        assert!(
            figures.counts.is_some_and(|counts| counts.missing > 100),
            "seed {seed}"
        );
    }
}

/// Equal inputs, equal bits: also of the whole machine.
#[test]
fn a_flight_repeats() {
    let flown = || {
        let (flight, _) = fly(&plan(3.0));
        (flight.flight_log(), flight.machine.trace_hash())
    };
    let (first, second) = std::thread::scope(|scope| {
        let second = scope.spawn(flown);
        (flown(), second.join().expect("it flies"))
    });
    assert!(first == second, "two equal flights differ");
}

/// The sensors' oscillator is off by up to 2 %: samples drift against the board's time-outs, and
/// lost ones meet them in every phase.
#[test]
fn with_sensors_whose_clock_is_off() {
    for (rate, ppm) in [
        (1000.0, 20_000),
        (1000.0, -20_000),
        (4000.0, 20_000),
        (4000.0, -20_000),
    ] {
        let mut plan = plan(5.0)
            .with_parameter("IMU_GYRO_RATEMAX", rate)
            .expect("a rate");
        plan.rig.imu_clock_ppm = ppm;
        let quiet = fly(&plan).1;
        assert!(quiet.replays(), "{rate} {ppm}: {:?}", quiet.replay);
        assert!(quiet.outcome.height > 3.0, "{rate} {ppm}: {:?}", quiet.outcome);
        plan.rig.faults = vec!["data-ready-random@9.5".parse().expect("a fault")];
        let (_, lossy) = fly(&plan);
        assert!(lossy.replays(), "{rate} {ppm}: {:?}", lossy.replay);
        let [few, many] = [quiet, lossy].map(|figures| figures.counts.expect("sums").missing);
        assert!(
            few < 200 && many > few,
            "{rate} {ppm}: {few} and {many} without a sample"
        );
    }
}
