//! The ground link of a vehicle that refuses all that can be refused: noise and valid frames with
//! any content make it accept no plan and ask for no write out of range, and afterwards it still
//! answers.
#![no_main]
#![allow(deprecated)]

#[path = "../../crates/ground-link/tests/common/mod.rs"]
mod common;
mod input;

use common::{Bench, STEP, Station, accepted_plans};
use input::{Input, any_frame, pass, still_answers};
use libfuzzer_sys::fuzz_target;
use windhover_ground_link::CommandResult;

fuzz_target!(|bytes: &[u8]| {
    let mut input = Input(bytes);
    let mut bench = Bench::new();
    bench.vehicle.answer = |_| Some(CommandResult::Denied);
    bench.vehicle.store.refuse_commit = true;
    let mut accepted = 0;
    let mut stations = [Station::new(255), Station::new(1)];
    while let Some(what) = input.byte() {
        let station = &mut stations[usize::from(what >> 7)];
        match what & 0x7f {
            0..=15 => bench.vehicle.receive(input.bytes(what), bench.now),
            16..=31 => bench.vehicle.receive_packet(input.bytes(what), bench.now),
            32..=39 => accepted += accepted_plans(&pass(&mut bench, STEP << (what & 7))),
            _ => {
                let frame = any_frame(station, &mut input);
                bench.vehicle.receive(&frame, bench.now);
            }
        }
    }
    accepted += accepted_plans(&bench.run(STEP));
    assert_eq!(accepted, 0, "the store takes no plan");
    bench.vehicle.valid_writes();
    still_answers(&mut bench);
});
