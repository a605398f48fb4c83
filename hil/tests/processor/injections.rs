//! What tests do to a program from outside, and what they count.

use crate::scenario::Scenario;
use crate::tester::{finish, machine};
use windhover_hil::time::MICROSECOND;

const FUNCTION: &str = "known_function";
/// Ten NOPs and the return.
const INSTRUCTIONS: u64 = 11;

#[test]
fn a_probe_counts_the_instructions_of_each_call_without_those_of_interrupts() {
    let mut machine = machine(Scenario::Known, 1);
    let probe = machine.count(FUNCTION).unwrap();
    let handled = finish(&mut machine).unwrap()[0];
    let calls = machine.calls(probe);
    assert!(handled > 10, "{handled} interrupts");
    assert_eq!(calls.count, 5_000);
    assert_eq!(
        (calls.instructions.min, calls.instructions.max),
        (INSTRUCTIONS, INSTRUCTIONS)
    );
    assert_eq!((calls.cycles.min, calls.cycles.max), (13, 13));
}

#[test]
fn a_probe_counts_a_handler() {
    let mut machine = machine(Scenario::Known, 1);
    let probe = machine.count("DefaultHandler").unwrap();
    let handled = finish(&mut machine).unwrap()[0];
    let calls = machine.calls(probe);
    assert_eq!(calls.count, u64::from(handled));
    assert!(calls.instructions.max < 300, "{calls:?}");
}

fn duration(prepare: impl FnOnce(&mut windhover_hil::machine::Machine<crate::tester::Tester>)) -> u64 {
    let mut machine = machine(Scenario::Calls, 1);
    prepare(&mut machine);
    while !machine.bus().finished {
        let until = machine.now() + MICROSECOND;
        machine.run(until).unwrap();
    }
    machine.now()
}

#[test]
fn a_stall_lasts_as_long_as_it_is_told() {
    let without = duration(|_| {});
    let with = duration(|machine| machine.stall(FUNCTION, 500 * MICROSECOND).unwrap());
    assert!(
        (with - without).abs_diff(500 * MICROSECOND) <= 2 * MICROSECOND,
        "{}",
        with - without
    );
}

#[test]
fn a_repeated_stall_acts_each_time() {
    let without = duration(|_| {});
    let with = duration(|machine| {
        machine
            .stall_by(FUNCTION, |arrival| if arrival % 2 == 0 { MICROSECOND } else { 0 })
            .unwrap();
    });
    assert!(
        (with - without).abs_diff(2_500 * MICROSECOND) <= 2 * MICROSECOND,
        "{}",
        with - without
    );
}

#[test]
fn a_stall_for_ever_lets_interrupts_through_and_nothing_else() {
    let mut machine = machine(Scenario::Known, 1);
    machine.stall(FUNCTION, u64::MAX).unwrap();
    let handlers = machine.count("DefaultHandler").unwrap();
    machine.run(10_000 * MICROSECOND).unwrap();
    assert!(!machine.bus().finished);
    assert!(machine.calls(handlers).count > 100);
}

#[test]
fn a_jump_goes_elsewhere() {
    let mut machine = machine(Scenario::Calls, 1);
    machine
        .jump(FUNCTION, "windhover_torture::faults::undefined")
        .unwrap();
    let reports = finish(&mut machine).unwrap();
    assert_eq!(
        reports[0],
        1 << 16,
        "CFSR of an undefined instruction: {reports:x?}"
    );
}

#[test]
fn a_stack_pointer_can_be_set() {
    let mut machine = machine(Scenario::Order, 1);
    machine
        .set_sp("windhover_torture::threads::order", 0x1000_0008)
        .unwrap();
    let reports = finish(&mut machine).unwrap();
    assert_ne!(
        reports[0] & 1 << 9,
        0,
        "CFSR of a push into nothing: {reports:x?}"
    );
}

#[test]
fn a_name_that_is_not_there_is_an_error() {
    let mut machine = machine(Scenario::Calls, 1);
    assert_eq!(
        machine.count("no_such_function").unwrap_err().to_string(),
        "no symbol is called no_such_function"
    );
}
