//! How long a start takes, in virtual time from power-on.

use windhover_hil::flight::Flight;
use windhover_hil::time::{MICROSECOND, SECOND};
use windhover_hil::trouble::{INNER_STEP, OUTER_STEP};

use crate::{firmware, on_sensors};

/// Bounds, s.
const FIRST_SAMPLE: f64 = 0.150;
const READY_TO_ALIGN: f64 = 1.0;

/// A board that is new writes its option bytes once, s (data sheet: a sector of the smallest size).
const OPTION_BYTES: f64 = 0.250;

fn said(flight: &Flight, since: u64, message: &str) -> bool {
    let mut lines = flight.lines.iter().filter(|line| line.time >= since);
    lines.any(|line| line.message == message)
}

/// The first step of the inner loop behind a data-ready, and the first of the outer loop with
/// inertial sensors, barometer and compass at work.
#[test]
fn a_cold_start_is_fast() {
    let mut flight = Flight::new(firmware(), &on_sensors(1000, 1)).expect("the firmware runs");
    let [inner, outer] = [INNER_STEP, OUTER_STEP].map(|step| flight.machine.count(step).expect("a step"));
    for (start, once) in [("as delivered", OPTION_BYTES), ("later", 0.0)] {
        let begin = flight.machine.now();
        let since = |flight: &Flight| (flight.machine.now() - begin) as f64 / SECOND as f64;
        let wait = |flight: &mut Flight, what: &str, holds: &dyn Fn(&Flight) -> bool| {
            while !holds(flight) {
                let until = flight.machine.now() + 100 * MICROSECOND;
                flight.run(until).expect("nothing that it must not do");
                assert!(since(flight) < 3.0, "{start}: {what}: {:#?}", flight.lines);
            }
            since(flight)
        };
        let samples = flight.machine.bus().wiring.record().data_ready.len();
        wait(&mut flight, "data-ready", &|flight| {
            flight.machine.bus().wiring.record().data_ready.len() > samples
        });
        let steps = flight.machine.calls(inner).count;
        let first = wait(&mut flight, "an inner step", &|flight| {
            flight.machine.calls(inner).count > steps
        });
        wait(&mut flight, "all sensors", &|flight| {
            let said = |message| said(flight, begin, message);
            said("inertial sensors: ready") && said("barometer: works") && said("compass: works")
        });
        let steps = flight.machine.calls(outer).count;
        let ready = wait(&mut flight, "an outer step", &|flight| {
            flight.machine.calls(outer).count > steps
        });
        println!("{start}: first sample used after {first:.3} s, ready to align after {ready:.3} s");
        assert!(first < FIRST_SAMPLE + once, "{start}: {first} s");
        assert!(ready < READY_TO_ALIGN + once, "{start}: {ready} s");
        flight.machine.power_cycle();
    }
}
