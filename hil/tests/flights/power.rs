//! Power that fails while the firmware writes to its flash.

use windhover_hil::flight::{Flight, FlightError};
use windhover_hil::log::Line;
use windhover_hil::machine::Stop;
use windhover_hil::pilot;
use windhover_hil::time::SECOND;

use crate::{firmware, is_long, plan};

const NAME: &str = "MPC_Z_V_AUTO_UP";

/// A board on which a parameter is stored, ready to store another value of it.
fn stored() -> Flight {
    let mut flight = Flight::new(firmware(), &plan(1.0)).expect("the firmware runs");
    flight.prepare().expect("nothing that it must not do");
    flight.send(&pilot::set(NAME, 2.5));
    flight
        .run(flight.machine.now() + 2 * SECOND)
        .expect("it is stored");
    flight
}

/// In the middle of each operation of a write: the run stops there, and on what the flash holds then
/// the firmware boots, with one value or the other, and says nothing of corruption.
#[test]
fn power_that_fails_during_a_write_leaves_a_board_that_boots() {
    let before = {
        let mut flight = stored();
        let before = flight.machine.bus().flash_operations();
        assert!(before > 0, "the first value is stored");
        flight.send(&pilot::set(NAME, 3.5));
        flight
            .run(flight.machine.now() + 2 * SECOND)
            .expect("it is stored");
        let count = flight.machine.bus().flash_operations() - before;
        assert!(count > 0, "a write is an operation");
        before..before + count
    };
    let every = if is_long() { 1 } else { 3 };
    for operation in before.step_by(every) {
        let mut flight = stored();
        flight.machine.bus().cut_power_at(operation);
        flight.send(&pilot::set(NAME, 3.5));
        let stop = flight.run(flight.machine.now() + 2 * SECOND);
        assert!(
            matches!(stop, Err(FlightError::Stop(Stop::PowerFailure { .. }))),
            "{operation}: {stop:?}"
        );
        flight.machine.power_cycle();
        flight.run(flight.machine.now() + 2 * SECOND).expect("it boots");
        let resets = flight.machine.resets().len();
        let boots = |line: &Line| line.message.ends_with("started by: power-on");
        let boot = flight.lines.iter().rposition(boots).expect("it says so");
        let said = &flight.lines[boot..];
        assert!(
            said.iter().all(|line| line.level != "error"),
            "{operation}: {said:?}"
        );
        let loaded = |line: &Line| line.message == "1 parameters from flash";
        assert!(said.iter().any(loaded), "{operation}: {said:?}");
        assert!(resets < 5, "{operation}: it restarts again and again");
    }
}
