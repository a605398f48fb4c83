//! One motor of a disarmed vehicle turns for a test: guarded in the outer step and in the inner one.

use windhover_autopilot::{Command, MotorCommand, MotorState, MotorTest, Phase, Stop, Urgent, Why};

use super::flight::Flight;
use super::inner::Stool;

const TEST: MotorTest = MotorTest {
    rotor: 2,
    share: 0.1,
    duration: 1.0,
};

const TURNING: MotorState = MotorState::Test {
    rotor: 2,
    command: 6553,
};

fn testing() -> Flight {
    let mut flight = Flight::new();
    flight.step();
    flight.obey(Command::TestMotor(TEST));
    assert_eq!(flight.result.motors, TURNING);
    flight
}

#[test]
fn it_ends_with_its_time() {
    let mut flight = testing();
    flight.run(0.95);
    assert_eq!(flight.result.motors, TURNING);
    flight.run(0.1);
    assert_eq!(flight.result.motors, MotorState::Disarmed);
}

#[test]
fn another_test_takes_its_place_and_a_share_of_nothing_ends_it() {
    let mut flight = testing();
    flight.obey(Command::TestMotor(MotorTest { rotor: 0, ..TEST }));
    assert!(matches!(flight.result.motors, MotorState::Test { rotor: 0, .. }));
    flight.obey(Command::TestMotor(MotorTest { share: 0.0, ..TEST }));
    flight.step();
    assert_eq!(flight.result.motors, MotorState::Disarmed);
}

#[test]
fn an_armed_vehicle_refuses_it_and_arming_ends_it() {
    let mut flight = testing();
    flight.obey(Command::Arm);
    assert_eq!(flight.result.motors, MotorState::Idle);
    assert_eq!(flight.refused(Command::TestMotor(TEST)), Why::Armed);
    flight.obey(Command::Disarm);
    flight.step();
    assert_eq!(flight.result.motors, MotorState::Disarmed, "it does not go on");
    let mut flight = Flight::new().hovering(5.0);
    assert_eq!(flight.refused(Command::TestMotor(TEST)), Why::Armed);
    assert_eq!(flight.report().phase, Phase::Flying);
}

#[test]
fn whatever_stops_the_motors_ends_it() {
    for stop in [Stop::Commanded(Urgent::Kill), Stop::ImuMissing] {
        let mut flight = testing();
        flight.stopped = Some(stop);
        flight.step();
        flight.step();
        assert_eq!(flight.result.motors, MotorState::Disarmed);
        assert!(matches!(
            flight.refused(Command::TestMotor(TEST)),
            Why::Blocked(_)
        ));
        flight.stopped = None;
        flight.step();
        assert_eq!(
            flight.result.motors,
            MotorState::Disarmed,
            "it does not begin again"
        );
    }
}

#[test]
fn what_is_no_test_is_refused() {
    let mut flight = Flight::new();
    flight.step();
    for test in [
        MotorTest { rotor: 4, ..TEST },
        MotorTest { share: 1.01, ..TEST },
        MotorTest { share: -0.1, ..TEST },
        MotorTest {
            share: f32::NAN,
            ..TEST
        },
        MotorTest {
            duration: MotorTest::LONGEST + 1.0,
            ..TEST
        },
        MotorTest {
            duration: f32::NAN,
            ..TEST
        },
    ] {
        // What is no number is not equal to itself: looked at by its effect.
        let _ = flight.inputs.command.push(Command::TestMotor(test));
        flight.step();
        assert_eq!(flight.report().refusals.len(), 1, "{test:?}");
        assert_eq!(flight.result.motors, MotorState::Disarmed, "{test:?}");
    }
}

/// The inner step turns the one motor, and only of a vehicle that stands.
#[test]
fn the_inner_step_looks_for_itself() {
    let only = MotorCommand::Run([0, 0, 6553, 0]);
    let mut stool = Stool::new(1000);
    stool.run_to_boundary();
    stool.answer_landed(TURNING, true);
    stool.run_to_boundary();
    assert_eq!(stool.tick(None), only);
    // A kill acts in its tick, and the test does not come back by the outer step's word.
    stool.run_to_boundary();
    stool.answer_landed(TURNING, true);
    assert_eq!(stool.tick(Some(Urgent::Kill)), MotorCommand::Disarmed);
    assert_eq!(stool.run_to_boundary(), MotorCommand::Disarmed);

    let mut aloft = Stool::new(1000);
    aloft.run_to_boundary();
    aloft.answer_landed(TURNING, false);
    aloft.run_to_boundary();
    assert_eq!(aloft.tick(None), MotorCommand::Disarmed);
}

/// An outer step that says nothing more ends the test after 100 ms.
#[test]
fn silence_ends_it() {
    let mut stool = Stool::new(1000);
    stool.run_to_boundary();
    stool.answer_landed(TURNING, true);
    stool.run_to_boundary();
    for tick in 0..200 {
        let turns = stool.tick(None) != MotorCommand::Disarmed;
        assert!(turns || tick >= 95, "ends at {tick} ms");
        assert!(!turns || tick <= 110, "turns at {tick} ms");
    }
}
