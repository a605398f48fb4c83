//! What follows from an order to arm, and what does not.

use windhover_autopilot::mission::PlanKind;
use windhover_autopilot::mission::action::command::NAV_TAKEOFF;
use windhover_autopilot::{Command, Mode, MotorState, Phase, Refused, Stop, Urgent, Why};

use super::flight::{Flight, commit};
use super::{item, waypoint};

fn ready() -> Flight {
    let mut flight = Flight::new();
    flight.run(0.2);
    flight
}

/// `QGroundControl` sets the mode of a disarmed vehicle and then arms it.
#[test]
fn a_mode_that_is_chosen_before_arming_is_flown_after() {
    let mut flight = ready();
    flight.obey(Command::Fly(Mode::Takeoff));
    assert_eq!(flight.report().mode, Mode::Takeoff);
    flight.run(5.0);
    assert_eq!(flight.result.motors, MotorState::Disarmed);
    flight.obey(Command::Arm);
    flight.run(0.9);
    assert_eq!(flight.result.motors, MotorState::Idle, "the rotors start");
    flight.run(6.0);
    assert!(flight.is_flying());
}

/// Whatever was flown before: the next flight begins with hold, and stays on the ground.
#[test]
fn arming_after_a_flight_does_not_take_off() {
    for end in [Command::Disarm, Command::Fly(Mode::Takeoff)] {
        let mut flight = ready();
        flight.obey(Command::Fly(Mode::Takeoff));
        flight.obey(Command::Arm);
        flight.run(0.5);
        if end == Command::Disarm {
            flight.obey(end);
        } else {
            flight.stopped = Some(Stop::Commanded(Urgent::Kill));
            flight.run(0.1);
            // Nor does what is asked for while the motors are held.
            assert!(matches!(flight.refused(end), Why::Blocked(_)));
            flight.stopped = None;
        }
        flight.run(0.1);
        assert_eq!(
            (flight.report().phase, flight.report().mode),
            (Phase::Disarmed, Mode::Hold)
        );
        flight.obey(Command::Arm);
        flight.run(5.0);
        assert_eq!(
            (flight.report().phase, flight.result.motors),
            (Phase::Armed, MotorState::Idle)
        );
        assert!(flight.position.z.abs() < 1e-3);
    }
}

/// What was wrong before is no failsafe of the flight: within two seconds of knowing its attitude the
/// vehicle disarmed in the step that armed it, and said nothing.
#[test]
fn an_accepted_order_to_arm_arms() {
    for wait in 0..40 {
        let mut flight = Flight::new();
        flight.seen = false;
        flight.run(0.1);
        flight.seen = true;
        for _ in 0..=wait {
            flight.step();
        }
        flight.obey(Command::Arm);
        flight.run(1.0);
        assert_eq!(
            flight.report().phase,
            Phase::Armed,
            "{wait} steps: {:?}",
            flight.report().failsafe
        );
    }
}

/// A mission that was chosen first and stored then is held against the fence all the same.
#[test]
fn a_mission_is_checked_when_it_is_armed() {
    let inside = [item(NAV_TAKEOFF, [0.0; 4]), waypoint(10.0, 0.0, 10.0)];
    let outside = [item(NAV_TAKEOFF, [0.0; 4]), waypoint(90.0, 0.0, 10.0)];
    let mut flight = ready();
    flight.write("GF_MAX_HOR_DIST", 50.0);
    flight.store(&inside);
    flight.obey(Command::Fly(Mode::Mission));
    flight.store(&outside);
    let why = flight.refused(Command::Arm);
    assert!(matches!(why, Why::Mission(1, _)), "{why:?}");
    flight.store(&inside);
    flight.obey(Command::Arm);
    // Now it is this one.
    let other = commit(PlanKind::Mission, 2);
    assert_eq!(flight.refused(other), Why::InFlight);
}

/// Descending is what failsafes do; the refusal says so.
#[test]
fn a_refusal_is_never_without_a_reason() {
    let mut flight = ready();
    for mode in Mode::ALL {
        if let Some(Refused::Command(_, why)) = flight.command(Command::Fly(mode)).report.refusals.first() {
            assert!(!why.to_string().is_empty(), "{mode:?}");
        }
    }
    assert_eq!(flight.refused(Command::Fly(Mode::Descend)), Why::OnGround);
}
