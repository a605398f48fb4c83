//! How fast the emulated processor is, without the peripherals of the real board.

#[path = "../torture/src/scenario.rs"]
mod scenario;
#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../tests/processor/tester.rs"]
mod tester;

use scenario::Scenario;
use std::time::Instant;
use windhover_hil::time::SECOND;

fn main() {
    for (what, scenario) in [
        ("computing under a storm of interrupts", Scenario::Storm),
        ("computing without interrupts to speak of", Scenario::Compute),
        ("sleeping between interrupts", Scenario::Wfi),
    ] {
        let mut machine = tester::machine(scenario, 1);
        let start = Instant::now();
        tester::finish(&mut machine).expect("the scenario ends");
        let wall = start.elapsed().as_secs_f64();
        let virtual_time = machine.now() as f64 / SECOND as f64;
        println!(
            "{what}: {:.0} million instructions a second, {:.1} times real time, {:.2} cycles an instruction",
            machine.instructions() as f64 / wall / 1e6,
            virtual_time / wall,
            (machine.load().total() - machine.load().asleep) as f64 / 2.0 / machine.instructions() as f64,
        );
    }
}
