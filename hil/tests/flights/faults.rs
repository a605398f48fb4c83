//! What goes wrong: motors go off or follow the rule, and the next start names the cause.

use windhover_flight_log::wire::MAGIC;
use windhover_hil::flight::Flight;
use windhover_hil::time::SECOND;
use windhover_hil::trouble::OUTER_STEP;

use crate::station::Station;
use crate::{fly, fly_after, off_since, plan};

/// When it goes wrong, s since power-on: well in the air.
const AT: f64 = 10.5;

/// Frames of the motors' pulses, s: what is commanded within 20 ms is in the pulses one later.
const FRAME: f64 = 0.0025;

/// The log's largest transfer, bytes: what is under way at the end does not count yet.
const TRANSFER: usize = 4096 + 1;

fn said(flight: &Flight, text: &str) -> bool {
    flight.lines.iter().any(|line| line.message.contains(text))
}

/// Flies into trouble inside the processor: the firmware starts anew once, names the cause over
/// defmt and in its log, and stays disarmed. Ground stations are told, where it is no loss of power, with
/// how far the log had come. Returns how long motors turned on, s.
fn ends_in_a_restart(trouble: &str, cause: &str) -> f64 {
    let mut plan = plan(7.0);
    plan.troubles = vec![format!("{trouble}@{AT}").parse().expect("a trouble")];
    let (flight, figures) = fly(&plan);
    assert!(figures.outcome.height > 3.0, "{trouble}: it was to fly first");
    assert_eq!(figures.resets, 1, "{trouble}");
    assert!(
        figures.reset_cause.contains(cause),
        "{trouble}: {}",
        figures.reset_cause
    );
    assert!(
        said(&flight, &format!("started by: {}", figures.reset_cause)),
        "{trouble}"
    );
    assert!(figures.replays(), "{trouble}: {:?}", figures.replay);
    let after = off_since(&flight).expect("the motors are off") - AT;
    let logged = log_before(&flight);
    let told = Station::beside(flight).told_of_last_run();
    if cause == "power-on" {
        assert_eq!(told, "", "{trouble}");
    } else {
        assert_eq!(told, figures.reset_cause, "{trouble}");
        let position = log_position(&told);
        assert!(
            (position..position + TRANSFER).contains(&logged),
            "{trouble}: {position} of {logged} bytes"
        );
    }
    after
}

/// Bytes of the log before the last restart.
fn log_before(flight: &Flight) -> usize {
    let bus = flight.machine.bus();
    let mut starts = bus.wiring.log().windows(MAGIC.len());
    starts.rposition(|window| window == MAGIC).expect("a log begins")
}

/// The log's last position, as a cause names it.
fn log_position(cause: &str) -> usize {
    let (_, rest) = cause.split_once("log at ").expect("it is named");
    let (bytes, _) = rest.split_once(" bytes").expect("in bytes");
    bytes.parse().expect("a number")
}

#[test]
fn a_panic_stops_the_motors_and_is_named() {
    // Whoever uses the lock next.
    let after = ends_in_a_restart("panics", "RefCell already borrowed; in the ");
    assert!(after < 0.02, "{after} s");
}

#[test]
fn a_stack_overflow_faults_and_is_named() {
    let after = ends_in_a_restart("stack-overflows", "stack overflow; in the outer loop, tick ");
    assert!(after < 0.02, "{after} s");
}

/// However long it takes to say why, the motors are off before, and their timers too.
#[test]
fn a_panic_that_takes_its_time_to_be_named_stops_the_motors_first() {
    let mut plan = plan(7.0);
    plan.troubles = vec![format!("panics@{AT}").parse().expect("a trouble")];
    let (flight, figures) = fly_after(&plan, |flight| {
        let stall = flight.machine.stall("core::fmt::write", SECOND / 10);
        stall.expect("the panic's text is formatted");
    });
    assert!(figures.outcome.height > 3.0, "it was to fly first");
    assert!(figures.reset_cause.contains("panic at src/shared.rs"));
    let after = off_since(&flight).expect("the motors are off") - AT;
    assert!(after < 0.02, "{after} s");
}

/// Naming it uses the log that was interrupted half-way, at a time when no watchdog runs yet.
#[test]
fn a_stack_overflow_in_the_middle_of_a_message_is_named() {
    let (flight, figures) = fly_after(&plan(3.0), |flight| {
        let inside = "defmt::export::str";
        let nearly_full = 0x1000_0010;
        let set = flight.machine.set_sp(inside, nearly_full);
        set.expect("the firmware names its board");
    });
    assert_eq!(figures.resets, 1);
    assert!(
        figures.reset_cause.starts_with("stack overflow"),
        "{}",
        figures.reset_cause
    );
    assert!(said(&flight, "started by: stack overflow"));
    assert!(figures.replays(), "{:?}", figures.replay);
}

/// Control that runs away into registers: the frame says where to, and from where.
#[test]
fn a_fault_names_its_address_and_registers() {
    const NO_CODE: u32 = 0x4000_0000;
    let (flight, figures) = fly_after(&plan(3.0), |flight| {
        let jump = flight.machine.jump(OUTER_STEP, NO_CODE);
        jump.expect("the firmware has an outer step");
    });
    let cause = &figures.reset_cause;
    assert_eq!(figures.resets, 1, "{cause}");
    assert!(
        cause.starts_with("memory fault at 0x40000000; in the outer loop, tick "),
        "{cause}"
    );
    let (_, lr) = cause.split_once(", lr 0x").expect("the frame was stacked");
    assert!(lr.starts_with("80"), "it came from the program: {cause}");
    assert_eq!(Station::beside(flight).told_of_last_run(), *cause);
}

#[test]
fn an_outer_step_that_spins_ends_at_the_watchdog() {
    let after = ends_in_a_restart("outer-spins", "watchdog: the outer loop stood still");
    assert!(after < 0.27, "{after} s");
}

#[test]
fn an_inner_step_that_spins_ends_at_the_watchdog() {
    let after = ends_in_a_restart("inner-spins", "watchdog: the inner loop stood still");
    assert!(after < 0.27, "{after} s");
}

#[test]
fn a_power_cut_ends_disarmed() {
    let after = ends_in_a_restart("power-cut", "power-on");
    assert!(after < 0.02, "{after} s");
}

/// A thread that spins takes the log and the command port with it, but not the loops: without new
/// setpoints the vehicle levels and descends, and no watchdog throws it out of the air.
#[test]
fn a_thread_that_spins_does_not_touch_the_loops() {
    let mut plan = plan(13.0);
    plan.troubles = vec![format!("thread-spins@{AT}").parse().expect("a trouble")];
    let (flight, figures) = fly(&plan);
    assert_eq!(figures.resets, 0);
    let truth = flight.truth();
    assert!(truth.attitude.down_axis().z > 0.999, "level");
    assert!(
        -truth.position.z > 3.0 && truth.velocity.z > 0.0,
        "in the air, going down"
    );
    assert!(figures.replays(), "{:?}", figures.replay);
}

/// 20 ms without a sample, and the motors stop; the inner loop keeps its ticks.
#[test]
fn inertial_sensors_lost_in_flight() {
    for fault in [
        "imu-unplugged",
        "spi-stuck-low",
        "spi-stuck-high",
        "spi-repeats",
        "data-ready-lost",
    ] {
        let mut plan = plan(6.5);
        plan.rig.faults = vec![format!("{fault}@{AT}").parse().expect("a fault")];
        let (flight, figures) = fly(&plan);
        assert!(figures.outcome.height > 3.0, "{fault}: it was to fly first");
        let after = off_since(&flight).expect("the motors are off") - AT;
        assert!(after < 0.0225 + FRAME, "{fault}: {after} s");
        assert_eq!(figures.resets, 0, "{fault}");
        // Ticks go on, one each 1.5 periods; the sums in the log are of the last whole second.
        let lost = flight.begin() + plan.seconds - AT - 1.0;
        let missing = figures.counts.expect("once a second").missing;
        assert!(
            f64::from(missing) > 0.9 * lost / 0.0015,
            "{fault}: {missing} in {lost} s"
        );
        assert!(figures.replays(), "{fault}: {:?}", figures.replay);
        assert!(said(&flight, "inertial sensors"), "{fault}: {:?}", flight.lines);
    }
}

#[test]
fn absent_inertial_sensors_are_named_and_nothing_arms() {
    let mut plan = plan(3.0);
    plan.rig.faults = vec!["imu-absent".parse().expect("a fault")];
    let (flight, figures) = fly(&plan);
    assert!(said(&flight, "inertial sensors: absent (identity 0xff)"));
    assert_eq!((figures.resets, figures.outcome.height), (0, 0.0));
    assert_eq!(
        flight
            .machine
            .bus()
            .wiring
            .motor_commands()
            .map(|c| c.unwrap_or(0)),
        [0; 4]
    );
    assert!(figures.replays(), "{:?}", figures.replay);
}

/// Sensors that come back are set up again: the next flight needs no restart.
#[test]
fn inertial_sensors_that_come_back_are_used_again() {
    let mut plan = plan(6.0);
    plan.rig.faults = vec!["imu-unplugged@0.5+0.7".parse().expect("a fault")];
    let (_, figures) = fly(&plan);
    assert!(
        figures.outcome.height > 3.0 && figures.outcome.stopped,
        "{:?}",
        figures.outcome
    );
    assert!(figures.replays(), "{:?}", figures.replay);
}
