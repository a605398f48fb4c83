//! What the program says by defmt.

use crate::scenario::Scenario;
use crate::tester::{finish, machine};
use windhover_hil::log::{Line, Log};

fn lines(scenario: Scenario) -> Vec<Line> {
    let mut machine = machine(scenario, 1);
    finish(&mut machine).unwrap();
    let mut log = Log::new(machine.elf()).unwrap().expect("the program uses defmt");
    let lines = machine
        .take_log()
        .iter()
        .flat_map(|(time, bytes)| log.decode(*time, bytes))
        .collect();
    assert_eq!(log.malformed, 0);
    lines
}

#[test]
fn messages_are_decoded_with_level_and_place() {
    let [line] = &lines(Scenario::Log)[..] else {
        panic!("one line")
    };
    assert_eq!((line.level, line.message.as_str()), ("info", "3 of four"));
    assert!(
        line.place
            .as_ref()
            .is_some_and(|place| place.contains("main.rs:")),
        "{line}"
    );
}

#[test]
fn what_was_said_just_before_a_reset_is_not_lost() {
    let [line] = &lines(Scenario::LogReset)[..] else {
        panic!("one line")
    };
    assert_eq!(
        line.to_string().split(" (").next(),
        Some("0.000 error last words")
    );
}
