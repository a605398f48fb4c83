//! Commands act in the step that brings them, and what is no number changes nothing.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::mission::action::command::NAV_TAKEOFF;
use windhover_autopilot::mission::action::{Altitude, Place};
use windhover_autopilot::mode::Target;
use windhover_autopilot::{Command, Mode, MotorState, Phase, Row, Sticks, Stop, Urgent, Why};
use windhover_control::TrajectorySetpoint;
use windhover_math::Vector3;

use super::flight::{Flight, frame};
use super::{HOME, item, waypoint};

fn place(altitude: Altitude) -> Place {
    let there = waypoint(3.0, 4.0, 0.0);
    Place {
        latitude: there.x,
        longitude: there.y,
        altitude,
    }
}

fn aloft() -> Flight {
    let mission = [item(NAV_TAKEOFF, [0.0; 4]), waypoint(30.0, 0.0, 10.0)];
    let mut flight = Flight::with_mission(&mission);
    flight.steady.sticks = Some(Sticks::default());
    flight.steady.setpoint = Some(TrajectorySetpoint::at_rest(Vector3::new(0.0, 0.0, -10.0), 0.0));
    flight.hovering(10.0)
}

/// The result of the very step has it; the inner step adopts that at the next boundary.
#[test]
fn every_command_acts_in_its_own_step() {
    let mut flight = Flight::new();
    flight.step();
    flight.obey(Command::Arm);
    assert_eq!(
        (flight.report().phase, flight.result.motors),
        (Phase::Armed, MotorState::Idle)
    );
    flight.obey(Command::Disarm);
    assert_eq!(flight.result.motors, MotorState::Disarmed);
    flight.obey(Command::ForceArm);
    assert_eq!(flight.result.motors, MotorState::Idle);
    let start = aloft();
    for mode in Mode::ALL {
        let mut flight = start.clone();
        if mode == Mode::Takeoff {
            flight.refused(Command::Fly(mode));
        } else {
            flight.obey(Command::Fly(mode));
            assert_eq!(flight.report().mode, mode);
        }
    }
    let mut flight = start;
    flight.obey(Command::StartMission(1));
    assert_eq!(flight.report().mode, Mode::Mission);
    flight.obey(Command::GoTo(Target::default()));
    assert_eq!(flight.report().mode, Mode::Hold);
    flight.obey(Command::TakePhoto);
    assert!(matches!(
        flight.report().events[..],
        [MissionEvent::Photo { target: None, .. }]
    ));
    flight.obey(Command::SetHome(Some(place(Altitude::Home(1.0)))));
    assert!((flight.report().home - Vector3::new(3.0, 4.0, -1.0)).amax() < 0.05);
    let sea = HOME.altitude as f32 * 1e-3 + 2.0;
    flight.obey(Command::SetHome(Some(place(Altitude::SeaLevel(sea)))));
    assert!(
        (flight.report().home.z + 2.0).abs() < 0.05,
        "{}",
        flight.report().home
    );
    flight.obey(Command::SetHome(None));
    assert!((flight.report().home - flight.position).amax() < 0.01);
}

/// What is refused for a number that is none leaves everything as it would have been.
#[test]
fn what_is_no_number_changes_nothing() {
    let target = |change: fn(&mut Target)| {
        let mut target = Target::default();
        change(&mut target);
        Command::GoTo(target)
    };
    let commands = |bad: f32| {
        [
            Command::SetSpeed(Some(bad)),
            Command::SetHome(Some(place(Altitude::Home(bad)))),
            Command::SetHome(Some(place(Altitude::SeaLevel(bad)))),
            Command::LookAt(Some(place(Altitude::Home(bad)))),
            Command::Takeoff(Some(Altitude::Home(bad)), None),
            Command::Takeoff(Some(Altitude::SeaLevel(bad)), Some(0.0)),
            Command::Takeoff(None, Some(bad)),
            Command::Takeoff(Some(Altitude::Home(5.0)), Some(bad)),
        ]
    };
    let targets: [fn(&mut Target); 5] = [
        |t| t.altitude = Some(Altitude::Home(f32::NAN)),
        |t| t.altitude = Some(Altitude::SeaLevel(f32::INFINITY)),
        |t| t.heading = Some(f32::NAN),
        |t| (t.altitude, t.heading) = (Some(Altitude::Home(3.0)), Some(f32::NEG_INFINITY)),
        |t| t.speed = Some(f32::NAN),
    ];
    let mut all: Vec<Command> = [f32::NAN, f32::INFINITY].into_iter().flat_map(commands).collect();
    all.extend(targets.map(target));
    let mut ground = Flight::with_mission(&[item(NAV_TAKEOFF, [0.0; 4]), waypoint(9.0, 0.0, 10.0)]);
    ground.obey(Command::Arm);
    let mut mission = aloft();
    mission.obey(Command::Fly(Mode::Mission));
    mission.run(2.0);
    for start in [ground, mission] {
        for command in &all {
            let (mut with, mut without) = (start.clone(), start.clone());
            let why = with.refused(*command);
            let expected = [Why::NotANumber, Why::InFlight, Why::OnGround];
            assert!(expected.contains(&why), "{command:?}: {why:?}");
            without.step();
            for _ in 0..50 {
                with.step();
                assert_eq!(with.result, *without.step(), "{command:?}");
            }
        }
    }
}

/// The kill switch and the latch stop the motors in the air, in the step that sees them; and a switch
/// that is let go does not start them.
#[test]
fn kill_stops_the_motors_at_once() {
    let mut flight = aloft();
    flight.write("RC_MAP_KILL_SW", 7.0);
    flight.steady.rc = Some(frame(1000));
    flight.run(0.5);
    assert!(flight.is_flying());
    flight.steady.rc = Some(frame(2000));
    flight.step();
    // Two frames alike make a position.
    flight.step();
    assert_eq!(
        (flight.report().phase, flight.result.motors),
        (Phase::Disarmed, MotorState::Disarmed)
    );
    assert!(matches!(flight.refused(Command::ForceArm), Why::Blocked(_)));
    flight.steady.rc = Some(frame(1000));
    for _ in 0..250 {
        assert_eq!(flight.step().motors, MotorState::Disarmed);
    }
    for stop in [
        Stop::Commanded(Urgent::Kill),
        Stop::Commanded(Urgent::Disarm),
        Stop::ImuMissing,
    ] {
        let mut flight = aloft();
        flight.stopped = Some(stop);
        flight.step();
        assert_eq!(
            (flight.report().phase, flight.result.motors),
            (Phase::Disarmed, MotorState::Disarmed)
        );
        // Motors that stop by themselves are named, and stay so while it lasts and after.
        let named = (stop == Stop::ImuMissing).then_some(Row::ImuMissing);
        assert_eq!(flight.report().failsafe, named, "{stop:?}");
        assert_eq!(flight.report().active.contains(Row::ImuMissing), named.is_some());
        flight.run(0.1);
        flight.stopped = None;
        flight.run(0.1);
        assert_eq!(flight.report().failsafe, named, "{stop:?}");
    }
}

/// Switches of the remote control are commands like others.
#[test]
fn switches_arm_and_choose_modes() {
    let mut flight = Flight::new();
    flight.steady.rc = Some(frame(1000));
    flight.run(0.2);
    let mut on = frame(1000);
    on.channels[4] = 2000;
    flight.steady.rc = Some(on);
    flight.run(0.02);
    assert_eq!(flight.report().phase, Phase::Armed);
    // The middle of the mode switch is the mission, which there is none of.
    on.channels[5] = 1000;
    flight.steady.rc = Some(on);
    flight.run(0.02);
    assert_eq!(flight.report().mode, Mode::Position);
    flight.steady.rc = Some(frame(1000));
    flight.run(0.02);
    assert_eq!(flight.report().phase, Phase::Disarmed);
}

/// An order in the step in which a mode is done: what the operator has chosen stays.
#[test]
fn an_order_is_not_overwritten_by_what_was_to_follow() {
    let mut start = aloft();
    start.obey(Command::StartMission(1));
    start.until(60.0, |flight| flight.position.x > 29.0);
    let mut end = start.clone();
    end.until(60.0, |flight| {
        flight.report().events.contains(&MissionEvent::Finished)
    });
    let last = (end.tick - start.tick) / 4;
    for steps in last - 3..last + 3 {
        let mut flight = start.clone();
        for _ in 0..steps {
            flight.step();
        }
        flight.obey(Command::Fly(Mode::Position));
        for _ in 0..3 {
            assert_eq!(flight.report().mode, Mode::Position, "{steps} of {last}");
            flight.step();
        }
    }
}

/// Setpoints from outside that stop: the failsafe acts and is named, at whatever step the last one came.
/// The vehicle fell back to level flight in four of five cases, and drifted off.
#[test]
fn lost_setpoints_are_held_at_whatever_step() {
    for late in 0..5 {
        for (action, mode) in [(1.0, Mode::Hold), (2.0, Mode::Return), (3.0, Mode::Land)] {
            let mut flight = aloft();
            flight.write("OFFB_LOSS_ACT", action);
            flight.obey(Command::Fly(Mode::Offboard));
            for _ in 0..late {
                flight.step();
            }
            flight.steady.setpoint = None;
            flight.run(0.6);
            let report = flight.report();
            assert_eq!(
                (report.mode, report.failsafe),
                (mode, Some(Row::OffboardLost)),
                "{late}"
            );
        }
    }
}

/// An item that is selected is flown next: at once by a mission that flies, else when it is started.
#[test]
fn a_selected_item_is_flown_next() {
    let mut flight = aloft();
    flight.obey(Command::SelectItem(1));
    assert_eq!(
        (flight.report().mode, flight.report().mission.current),
        (Mode::Hold, 1)
    );
    assert!(matches!(flight.refused(Command::SelectItem(2)), Why::Blocked(_)));
    assert_eq!(flight.report().mission.current, 1);
    flight.obey(Command::Fly(Mode::Mission));
    flight.step();
    assert_eq!(flight.report().mission.current, 1);
    flight.obey(Command::SelectItem(0));
    flight.step();
    assert_eq!(flight.report().mode, Mode::Mission);
    assert!(flight.report().mission.begun);
    let mut none = Flight::new();
    none.step();
    assert!(matches!(none.refused(Command::SelectItem(0)), Why::Blocked(_)));
}
