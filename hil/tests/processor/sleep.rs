//! Sleep and what ends it, and the counters of time.

use crate::scenario::Scenario;
use crate::tester::{finish, machine, reports, stop};
use windhover_hil::machine::Stop;

#[test]
fn wfi_sleeps_until_an_interrupt_and_then_goes_on() {
    let mut machine = machine(Scenario::Wfi, 1);
    let [woke, handled] = finish(&mut machine).unwrap()[..] else {
        panic!()
    };
    assert_eq!(woke, 1000);
    assert!(
        (1000..1100).contains(&handled),
        "one interrupt or rarely two for each: {handled}"
    );
    let load = machine.load();
    assert!(load.asleep * 2 > load.total(), "asleep most of the time");
}

#[test]
fn wfe_does_not_sleep_after_sev_and_sleeps_without() {
    let [after_event, after_sleep, handled] = reports(Scenario::Wfe, 1)[..] else {
        panic!()
    };
    assert!(after_event < 100, "{after_event} cycles");
    assert!(
        (1_680..2_000).contains(&after_sleep),
        "ten microseconds and some more: {after_sleep} cycles"
    );
    assert_eq!(handled, 1);
}

#[test]
fn wfi_ends_also_for_an_interrupt_that_primask_holds() {
    assert_eq!(reports(Scenario::WfiPrimask, 1), [0, 1]);
}

#[test]
fn wfe_ends_for_a_held_interrupt_with_sevonpend() {
    assert_eq!(reports(Scenario::SevOnPend, 1), [0, 1]);
}

#[test]
fn with_sleeponexit_the_thread_does_not_run_after_a_handler() {
    let mut machine = machine(Scenario::SleepOnExit, 1);
    machine.run(windhover_hil::time::SECOND / 10).unwrap();
    assert!(machine.bus().reports.is_empty());
    assert!(machine.load().asleep > 0);
}

#[test]
fn yield_does_nothing() {
    assert_eq!(reports(Scenario::Yield, 1), [1000]);
}

#[test]
fn systick_counts_its_periods() {
    let mut machine = machine(Scenario::SysTick, 1);
    let [exceptions, wrapped_again] = finish(&mut machine).unwrap()[..] else {
        panic!()
    };
    assert_eq!(exceptions, 100);
    assert_eq!(wrapped_again, 0, "COUNTFLAG is cleared by reading");
    let cycles = (machine.load().total() - machine.load().asleep) / 2;
    assert!(
        (101_000..115_000).contains(&cycles),
        "a hundred and one periods and the start: {cycles}"
    );
}

#[test]
fn the_cycle_counter_stands_in_sleep() {
    let [awake, asleep] = reports(Scenario::CycleCounter, 1)[..] else {
        panic!()
    };
    assert!((500..2_000).contains(&awake), "{awake}");
    assert!(asleep < 300, "ten microseconds are 1680 cycles: {asleep}");
}

#[test]
fn nothing_runs_while_flash_is_busy() {
    let [microseconds, handled] = reports(Scenario::FlashBusy, 1)[..] else {
        panic!()
    };
    assert!((1_000..1_010).contains(&microseconds), "{microseconds}");
    assert_eq!(handled, 1, "the interrupt of meanwhile comes first");
}

#[test]
fn all_time_is_accounted_for() {
    let mut machine = machine(Scenario::Wfi, 1);
    finish(&mut machine).unwrap();
    let now = machine.now();
    let load = machine.load();
    assert_eq!(load.total(), now);
    let handlers: u64 = (16..24).map(|number| load.exception(number)).sum();
    assert_eq!(load.exception(0) + handlers + load.asleep, now);
}

#[test]
fn sleep_without_end_is_an_error_when_nothing_limits_the_run() {
    let mut machine = machine(Scenario::SleepForEver, 1);
    let stop = machine.run(windhover_hil::time::NEVER).unwrap_err();
    assert!(matches!(stop, Stop::AsleepForEver { .. }), "{stop}");
}

#[test]
fn a_register_that_does_not_exist_stops_the_run_and_is_named() {
    let message = stop(Scenario::UnknownRegister).to_string();
    assert!(
        message.contains("write of unknown register 0x40007000 (tester)"),
        "{message}"
    );
    assert!(
        message.contains("pc 0x0803") && message.contains("windhover_torture::"),
        "{message}"
    );
}
