//! Pulses as a board makes them, against the model of the controllers that read them.

use windhover_drivers::pulse;
use windhover_model::esc::pulse_command;

/// Timers of 21 and 28 counts in a microsecond have steps of 3.1 and 2.3 commands; rounding is
/// down on one side and to the nearest on the other.
#[test]
fn a_controller_reads_the_command_that_was_sent() {
    for (per_microsecond, step) in [(21_u16, 4), (28, 3)] {
        let per_millisecond = 1000 * per_microsecond;
        for command in 0..=u16::MAX {
            let counts = pulse::counts(command, per_millisecond);
            let read = pulse_command(counts.into(), per_microsecond.into()).unwrap_or(0);
            let short = i32::from(command) - i32::from(read);
            assert!((0..=step).contains(&short), "{command} is read as {read}");
        }
    }
}

#[test]
fn the_pulse_that_stops_a_motor_does() {
    assert_eq!(pulse_command(pulse::stop(21_000).into(), 21), None);
}
