//! Faults: what the handler finds, and what becomes of the processor.

use crate::scenario::Scenario;
use crate::tester::{Tester, finish, machine, machine_with, reports, stop};
use windhover_hil::board::ResetCause;
use windhover_hil::machine::{Machine, Options, Stop};
use windhover_hil::time::{NEVER, SECOND};

const FORCED: u32 = 1 << 30;
const DEBUGEVT: u32 = 1 << 31;
const IACCVIOL: u32 = 1;
const IBUSERR: u32 = 1 << 8;
const PRECISERR: u32 = 1 << 9;
const STKERR: u32 = 1 << 12;
const BFARVALID: u32 = 1 << 15;
const UNDEFINSTR: u32 = 1 << 16;
const INVSTATE: u32 = 1 << 17;
const INVPC: u32 = 1 << 18;
const NOWHERE: u32 = 0x3000_0000;

/// CFSR, HFSR, BFAR, EXC_RETURN and stack pointer in the HardFault handler.
fn hard_fault(scenario: Scenario) -> [u32; 5] {
    reports(scenario, 1)
        .try_into()
        .expect("the HardFault handler ran once")
}

#[test]
fn a_load_from_nowhere_is_a_precise_bus_fault_escalated_to_hard_fault() {
    let [cfsr, hfsr, bfar, ..] = hard_fault(Scenario::UnmappedLoad);
    assert_eq!((cfsr, hfsr, bfar), (PRECISERR | BFARVALID, FORCED, NOWHERE));
}

#[test]
fn a_store_to_nowhere_is_a_bus_fault_escalated_to_hard_fault() {
    let [cfsr, hfsr, bfar, ..] = hard_fault(Scenario::UnmappedStore);
    assert_eq!((cfsr, hfsr, bfar), (PRECISERR | BFARVALID, FORCED, NOWHERE));
}

#[test]
fn an_enabled_bus_fault_handler_gets_the_fault_and_can_go_on() {
    assert_eq!(reports(Scenario::BusFault, 1), [5, PRECISERR | BFARVALID]);
}

#[test]
fn an_undefined_instruction_is_a_usage_fault_escalated_to_hard_fault() {
    let [cfsr, hfsr, ..] = hard_fault(Scenario::Undefined);
    assert_eq!((cfsr, hfsr), (UNDEFINSTR, FORCED));
}

#[test]
fn an_enabled_usage_fault_handler_gets_the_fault_and_can_go_on() {
    assert_eq!(reports(Scenario::UsageFault, 1), [6, UNDEFINSTR]);
}

#[test]
fn a_stack_overflow_reaches_the_hard_fault_handler_with_the_stack_pointer_below_memory() {
    let [cfsr, hfsr, bfar, exc_return, sp] = hard_fault(Scenario::StackOverflow);
    assert_eq!(cfsr, PRECISERR | BFARVALID | STKERR);
    assert_eq!(hfsr, FORCED);
    assert!((0x0FFF_0000..0x1000_0000).contains(&bfar), "{bfar:#x}");
    assert_eq!(exc_return, 0xFFFF_FFE9);
    assert!((0x0FFF_0000..0x1000_0000).contains(&sp), "{sp:#x}");
}

#[test]
fn an_interrupt_on_a_full_stack_becomes_a_hard_fault_by_stacking() {
    let [cfsr, hfsr, _, exc_return, sp] = hard_fault(Scenario::StackFullAtInterrupt);
    assert_eq!((cfsr, hfsr), (STKERR, FORCED));
    assert_eq!(exc_return, 0xFFFF_FFE9);
    assert_eq!(sp, 0x1000_0020 - 0x68);
}

#[test]
fn code_in_ram_faults() {
    for scenario in [Scenario::ExecuteRam, Scenario::ExecuteCcm] {
        let [cfsr, hfsr, ..] = hard_fault(scenario);
        assert_eq!((cfsr, hfsr), (IBUSERR, FORCED), "{scenario:?}");
    }
}

#[test]
fn code_in_a_peripheral_is_an_access_violation() {
    let [cfsr, hfsr, ..] = hard_fault(Scenario::ExecutePeripheral);
    assert_eq!((cfsr, hfsr), (IACCVIOL, FORCED));
}

#[test]
fn a_jump_to_an_even_address_is_an_invalid_state() {
    for scenario in [Scenario::ArmState, Scenario::NullCall] {
        let [cfsr, hfsr, ..] = hard_fault(scenario);
        assert_eq!((cfsr, hfsr), (INVSTATE, FORCED), "{scenario:?}");
    }
}

#[test]
fn a_breakpoint_without_debugger_is_a_hard_fault() {
    let [cfsr, hfsr, ..] = hard_fault(Scenario::Breakpoint);
    assert_eq!((cfsr, hfsr), (0, DEBUGEVT));
}

#[test]
fn a_breakpoint_with_a_debugger_ends_the_run() {
    let mut machine = machine_with(
        Scenario::Breakpoint,
        1,
        Options {
            debugger_attached: true,
        },
    );
    let stop = finish(&mut machine).unwrap_err();
    assert!(matches!(stop, Stop::Breakpoint { .. }), "{stop}");
}

#[test]
fn svc_in_a_more_urgent_handler_is_a_hard_fault() {
    let [cfsr, hfsr, _, exc_return, _] = hard_fault(Scenario::SupervisorInHandler);
    assert_eq!((cfsr, hfsr), (0, FORCED));
    assert_eq!(exc_return, 0xFFFF_FFE1, "from a handler");
}

#[test]
fn a_return_that_does_not_fit_is_an_invalid_pc() {
    let [cfsr, hfsr, ..] = hard_fault(Scenario::InvalidReturn);
    assert_eq!((cfsr, hfsr), (INVPC, FORCED));
}

#[test]
fn a_vector_table_nowhere_is_a_lockup() {
    let mut machine = machine(Scenario::NoVectors, 1);
    let stop = machine.run(NEVER).unwrap_err();
    assert!(matches!(stop, Stop::Lockup { .. }), "{stop}");
}

#[test]
fn a_store_into_locked_flash_stops_the_run_and_is_named() {
    let message = stop(Scenario::FlashStore).to_string();
    assert!(
        message.contains("flash: store to 0x08000000 while locked"),
        "{message}"
    );
    assert!(message.contains("faults::store"), "{message}");
}

#[test]
fn a_fault_in_the_hard_fault_handler_is_a_lockup() {
    let mut machine = machine(Scenario::Lockup, 1);
    let stop = machine.run(NEVER).unwrap_err();
    assert!(matches!(stop, Stop::Lockup { .. }), "{stop}");
    assert!(stop.to_string().contains("handling exception 3"), "{stop}");
}

#[test]
fn a_locked_up_processor_stands_still_until_the_watchdog_resets_it() {
    let mut machine = machine(Scenario::Lockup, 1);
    machine.bus().bite_at(SECOND / 4);
    machine.run(SECOND / 5).unwrap();
    let instructions = machine.instructions();
    assert_eq!(machine.lockups().len(), 1);
    machine.run(SECOND / 4).unwrap();
    assert_eq!(machine.instructions(), instructions);
    machine.run(SECOND / 4 + 1_000).unwrap();
    assert_eq!(machine.resets().len(), 1);
    assert_eq!(machine.resets()[0].cause, ResetCause::IndependentWatchdog);
    assert_eq!(machine.resets()[0].place.time, SECOND / 4);
    assert!(machine.instructions() > instructions);
}

fn run_reset() -> Machine<Tester> {
    let mut machine = machine(Scenario::Reset, 1);
    finish(&mut machine).unwrap();
    machine
}

#[test]
fn ram_survives_a_reset_by_software() {
    let machine = run_reset();
    assert_eq!(machine.bus().reports, [0x5AFE_C0DE; 2]);
    assert_eq!(machine.bus().resets, [ResetCause::Software]);
}

#[test]
fn a_reset_says_where_it_happened() {
    let machine = run_reset();
    let [reset] = machine.resets() else {
        panic!("one reset: {:?}", machine.resets())
    };
    assert_eq!(reset.cause, ResetCause::Software);
    assert!(
        reset
            .place
            .function
            .as_ref()
            .is_some_and(|name| name.contains("sys_reset") || name.contains("reset"))
    );
}

#[test]
fn ram_does_not_survive_a_power_cycle() {
    let mut machine = run_reset();
    machine.power_cycle();
    assert_ne!(machine.read_word(0x2001_FFF0), Some(0x5AFE_C0DE));
    assert_eq!(machine.bus().resets.last(), Some(&ResetCause::PowerOn));
}
