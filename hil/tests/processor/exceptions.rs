//! Exceptions: what they keep, who preempts whom, and in which order.

use crate::scenario::Scenario;
use crate::tester::reports;

const SEEDS: std::ops::RangeInclusive<u64> = 1..=4;

#[test]
fn interrupts_keep_all_registers_and_flags_of_what_they_preempt() {
    for seed in SEEDS {
        let [wrong, handled, deepest, _] = reports(Scenario::Storm, seed)[..] else {
            panic!()
        };
        assert_eq!(wrong, 0, "computations that went wrong, seed {seed}");
        assert!(
            handled > 1_000 && deepest >= 4,
            "{handled} interrupts, {deepest} deep, seed {seed}"
        );
    }
}

#[test]
fn the_preempted_computation_is_the_same_whatever_the_seed() {
    let result = |seed| reports(Scenario::Storm, seed)[3];
    assert_eq!(result(1), result(2));
}

#[test]
fn interrupts_between_any_two_halfwords_of_a_page_keep_everything() {
    for seed in SEEDS {
        let [wrong, handled] = reports(Scenario::Pages, seed)[..] else {
            panic!()
        };
        assert_eq!(wrong, 0, "computations that went wrong, seed {seed}");
        assert!(handled > 500, "{handled} interrupts, seed {seed}");
    }
}

#[test]
fn a_thread_on_the_process_stack_is_kept_too() {
    for seed in SEEDS {
        let [wrong, handled] = reports(Scenario::ProcessStack, seed)[..] else {
            panic!()
        };
        assert_eq!(wrong, 0, "computations that went wrong, seed {seed}");
        assert!(handled > 100, "{handled} interrupts, seed {seed}");
    }
}

#[test]
fn floats_are_kept_in_a_context_whose_first_float_instruction_was_skipped() {
    let [wrong, handled] = reports(Scenario::SkippedFloat, 1)[..] else {
        panic!()
    };
    assert_eq!(wrong, 0);
    assert!(handled > 100, "{handled} interrupts");
}

#[test]
fn primask_holds_all_interrupts_until_it_is_cleared() {
    let [before, after] = reports(Scenario::Primask, 1)[..] else {
        panic!()
    };
    assert_eq!(before, 0);
    assert!(after >= 8, "all eight lines waited: {after}");
}

#[test]
fn basepri_holds_its_own_priority_and_lower_ones_only() {
    let reports = reports(Scenario::Basepri, 1);
    let (held, after) = (&reports[..8], reports[8]);
    assert!(
        held[..4].iter().all(|&count| count > 10),
        "more urgent ones: {held:?}"
    );
    assert_eq!(held[4..], [0; 4], "less urgent ones");
    assert!(after >= 4, "they run when it is cleared: {after}");
}

#[test]
fn faultmask_holds_interrupts_and_ends_with_the_handler_that_set_it() {
    assert_eq!(reports(Scenario::Faultmask, 1), [0, 1, 0]);
}

#[test]
fn svc_is_taken_before_the_next_instruction() {
    assert_eq!(reports(Scenario::Supervisor, 1), [0, 100]);
}

#[test]
fn pending_exceptions_run_in_the_order_of_their_priorities() {
    // Line 1 preempts 3; 2 and then PendSV are chained behind it.
    assert_eq!(
        reports(Scenario::Order, 1),
        [3, 1, 0x81, 0x83, 2, 0x82, 0x40, 0xC0]
    );
}

#[test]
fn a_subpriority_orders_but_does_not_preempt() {
    assert_eq!(
        reports(Scenario::Subpriority, 1),
        [3, 0x83, 1, 0x81, 2, 0x82, 0x40, 0xC0]
    );
}

#[test]
fn a_handler_can_change_the_order_of_those_that_wait() {
    // Line 1 has run before its priority changes.
    assert_eq!(
        reports(Scenario::Reprioritise, 1),
        [3, 1, 0x81, 0x83, 2, 0x82, 0x40, 0xC0]
    );
}

#[test]
fn software_sets_and_clears_pending() {
    assert_eq!(reports(Scenario::Pend, 1), [0, 1, 1]);
}

#[test]
fn a_line_that_stays_high_brings_its_handler_back() {
    assert_eq!(reports(Scenario::Level, 1), [3]);
}

#[test]
fn nmi_preempts_priority_zero() {
    assert_eq!(reports(Scenario::Nmi, 1), [0, 0x20, 0x80]);
}

#[test]
fn vectors_come_from_where_vtor_says() {
    let reports = reports(Scenario::VectorTable, 1);
    assert_eq!(reports, [0x77, 1]);
}

#[test]
fn atomics_lose_nothing_to_handlers() {
    for seed in SEEDS {
        let [sum, expected] = reports(Scenario::Exclusive, seed)[..] else {
            panic!()
        };
        assert_eq!(sum, expected, "seed {seed}");
        assert!(expected > 20_100, "handlers ran: {expected}");
    }
}

#[test]
fn flash_holds_what_the_flash_controller_makes_of_a_store() {
    assert_eq!(reports(Scenario::FlashProgram, 1), [0xFFFF_FFFF, 0xF0F0_1200]);
}

/// The engine once took the condition of such an access along into the code behind the branch.
#[test]
fn accesses_in_conditional_blocks_leave_no_condition_behind() {
    let [ram, registers, flash] = reports(Scenario::Conditional, 1)[..] else {
        panic!()
    };
    assert_eq!((ram, registers, flash), (0, 0, 0), "went wrong");
}
