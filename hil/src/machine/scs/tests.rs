//! Registers of the system control space, one statement a test.

use super::*;

fn control() -> (SystemControl, Clock) {
    (SystemControl::new(false), Clock::new(2))
}

#[test]
fn priorities_are_bytes() {
    let (mut control, clock) = control();
    control.write(0xE000_E405, 1, 0xA7, &clock).unwrap();
    control.write(0xE000_ED22, 2, 0xF0E0, &clock).unwrap();
    assert_eq!(control.read(0xE000_E404, 4, 0, &clock), Ok(0xA000));
    assert_eq!(control.exceptions.priority(PEND_SV), 0xE0);
    assert_eq!(control.exceptions.priority(SYS_TICK), 0xF0);
}

#[test]
fn fault_status_is_cleared_by_ones_also_by_its_parts() {
    let (mut control, clock) = control();
    control.cfsr = 0x0003_8200;
    control.write(0xE000_ED29, 1, 0x80, &clock).unwrap();
    assert_eq!(control.read(0xE000_ED28, 4, 0, &clock), Ok(0x0003_0200));
    control.write(0xE000_ED2A, 2, 0x1, &clock).unwrap();
    assert_eq!(control.read(0xE000_ED2A, 2, 0, &clock), Ok(2));
}

#[test]
fn a_reset_needs_the_key() {
    let (mut control, clock) = control();
    assert!(control.write(0xE000_ED0C, 4, 4, &clock).is_err());
    assert!(!control.reset_requested);
    control.write(0xE000_ED0C, 4, 0x05FA_0004, &clock).unwrap();
    assert!(control.reset_requested);
}

#[test]
fn interrupt_state_names_active_and_pending() {
    let (mut control, clock) = control();
    control.write(0xE000_ED04, 4, 1 << 28, &clock).unwrap();
    assert_eq!(
        control.read(0xE000_ED04, 4, 22, &clock),
        Ok(22 | 1 << 11 | 14 << 12 | 1 << 28)
    );
    control.write(0xE000_ED04, 4, 1 << 27, &clock).unwrap();
    assert_eq!(control.read(0xE000_ED04, 4, 0, &clock), Ok(1 << 11));
}

#[test]
fn unknown_registers_traps_and_half_words_are_mistakes() {
    let (mut control, clock) = control();
    assert!(control.read(0xE000_ED3C, 4, 0, &clock).is_err());
    assert!(control.write(0xE000_ED3C, 4, 0, &clock).is_err());
    assert!(control.write(0xE000_ED14, 4, 1 << 4, &clock).is_err());
    assert!(control.write(0xE000_E100, 2, 1, &clock).is_err());
}

#[test]
fn the_cycle_counter_counts_with_both_enables_only() {
    let (mut control, clock) = control();
    control.write(0xE000_1000, 4, 1, &clock).unwrap();
    clock.spend(100);
    assert_eq!(control.read(0xE000_1004, 4, 0, &clock), Ok(0));
    control.write(0xE000_EDFC, 4, TRCENA, &clock).unwrap();
    clock.spend(70);
    assert_eq!(control.read(0xE000_1004, 4, 0, &clock), Ok(70));
}
