//! The modes that bring a vehicle up and home, flown through the outer step.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::mission::action::{Altitude, Place, command};
use windhover_autopilot::mode::Target;
use windhover_autopilot::{Command, Mode, MotorState, Parameters, Phase, Sticks, Why};
use windhover_math::{Vector3, scalar, wrap_pi};

use super::flight::{DT, Flight};
use super::{HOME, item, waypoint};

const RETURN: Command = Command::Fly(Mode::Return);

/// Flies on to the ground and until the motors stop; the heights on the way.
fn down(flight: &mut Flight) -> Vec<f32> {
    let mut heights = Vec::new();
    while flight.report().phase != Phase::Disarmed {
        assert!(heights.len() < 100_000, "never down: {:?}", flight.report().mode);
        flight.step();
        heights.push(-flight.position.z);
    }
    heights
}

fn highest(heights: &[f32]) -> f32 {
    heights.iter().copied().fold(0.0, windhover_math::max)
}

/// The climb of a return: not when it is high enough, nor when home is near. It lands at home.
#[test]
fn a_return_climbs_only_where_it_has_to() {
    let return_from = |north: f32, height: f32| {
        let mut flight = Flight::new().hovering(height);
        flight.write("RTL_RETURN_ALT", 20.0);
        let place = waypoint(north, 0.0, 0.0);
        flight.obey(Command::GoTo(Target {
            ground: Some((place.x, place.y)),
            speed: Some(10.0),
            ..Target::default()
        }));
        flight.run(30.0);
        assert!((flight.position.x - north).abs() < 0.1, "{}", flight.position);
        flight.obey(RETURN);
        let heights = down(&mut flight);
        let off = Vector3::new(flight.position.x, flight.position.y, 0.0);
        assert!(scalar::norm(off) < if north < 2.0 { 2.0 } else { 0.5 }, "{off}");
        highest(&heights)
    };
    let is = |highest: f32, wanted: f32| assert!((highest - wanted).abs() < 0.3, "{highest} for {wanted}");
    is(return_from(50.0, 10.0), 20.0);
    is(return_from(50.0, 25.0), 25.0);
    is(return_from(1.0, 10.0), 10.0);
}

/// A mission that returns is brought home and disarmed, and says so once each.
#[test]
fn a_mission_that_returns_ends_on_the_ground_at_home() {
    let items = [
        item(command::NAV_TAKEOFF, [0.0; 4]),
        waypoint(15.0, 0.0, 10.0),
        item(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]),
    ];
    let mut flight = Flight::with_mission(&items);
    flight.obey(Command::Fly(Mode::Mission));
    flight.obey(Command::Arm);
    down(&mut flight);
    use MissionEvent::{Finished, Landed, Reached};
    let events: Vec<MissionEvent> = flight.events.iter().map(|(_, event)| *event).collect();
    assert_eq!(events, [Reached(1), Finished, Landed]);
    assert!(scalar::norm(flight.position) < 0.5, "{}", flight.position);
    assert_eq!(flight.result.motors, MotorState::Disarmed);
    // The next flight does not start by itself, nor where this one was.
    assert_eq!(flight.report().mode, Mode::Hold);
    flight.obey(Command::Arm);
    flight.run(3.0);
    assert_eq!(flight.result.motors, MotorState::Idle);
}

/// Slower as the ground comes near, held down until the detector knows, then still: `COM_DISARM_LAND`.
#[test]
fn a_landing_slows_down_and_waits_for_the_ground() {
    let mut flight = Flight::new().hovering(25.0);
    let parameters = *flight.outer.parameters();
    flight.obey(Command::Fly(Mode::Land));
    let (mut fastest, mut slowest_below) = (0.0f32, 0.0f32);
    while flight.report().phase == Phase::Flying {
        let height = -flight.position.z;
        let speed = flight
            .step()
            .report
            .trajectory
            .map_or(0.0, |point| point.velocity.z);
        if (12.0..22.0).contains(&height) {
            fastest = windhover_math::max(fastest, speed);
        }
        if (0.2..4.0).contains(&height) {
            slowest_below = windhover_math::max(slowest_below, speed);
        }
        assert!(flight.tick < 200_000);
    }
    assert!(
        (fastest - parameters.mission.descend_speed).abs() < 0.02,
        "{fastest}"
    );
    assert!(
        (slowest_below - parameters.mission.land_speed).abs() < 0.1,
        "{slowest_below}"
    );
    assert_eq!(flight.report().phase, Phase::Landed);
    assert_eq!(flight.result.motors, MotorState::Idle);
    let landed = flight.tick;
    down(&mut flight);
    let seconds = (flight.tick - landed) as f32 * 1e-3;
    assert!(
        (seconds - parameters.safety.disarm_landed).abs() < 0.05,
        "{seconds} s"
    );
}

/// The altitude of a takeoff: above home, above the sea, or none; never downwards. Off the ground it
/// goes with the takeoff's speed.
#[test]
fn a_takeoff_goes_to_the_altitude_that_is_meant() {
    let ground = HOME.altitude as f32 * 1e-3;
    for (altitude, height) in [
        (Some(Altitude::Home(6.0)), 6.0),
        (Some(Altitude::SeaLevel(ground + 7.0)), 7.0),
        (None, Parameters::default().manual.takeoff_altitude),
    ] {
        let mut flight = Flight::new();
        flight.step();
        flight.obey(Command::Takeoff(altitude, Some(0.5)));
        flight.obey(Command::Arm);
        let mut fastest = 0.0f32;
        for _ in 0..(20.0 / DT) as u32 {
            flight.step();
            fastest = windhover_math::max(fastest, -flight.velocity.z);
        }
        assert_eq!(
            (flight.report().phase, flight.report().mode),
            (Phase::Flying, Mode::Hold)
        );
        assert!(
            (flight.position.z + height).abs() < 0.1,
            "{altitude:?}: {}",
            flight.position
        );
        assert!((flight.attitude.heading() - 0.5).abs() < 0.02, "{altitude:?}");
        assert!(
            fastest < flight.outer.parameters().mission.takeoff_speed + 0.2,
            "{fastest}"
        );
        // In the air there is nothing to take off from.
        assert_eq!(flight.refused(Command::Takeoff(altitude, None)), Why::InFlight);
    }
    let mut flight = Flight::new();
    flight.step();
    flight.obey(Command::Takeoff(Some(Altitude::Home(-20.0)), None));
    flight.obey(Command::Arm);
    flight.run(8.0);
    assert!(
        flight.position.z.abs() < 0.1,
        "down is no takeoff: {}",
        flight.position
    );
}

/// A takeoff that was called off does not lend its altitude to the next one.
#[test]
fn an_altitude_is_that_takeoffs_alone() {
    let mut flight = Flight::new();
    flight.step();
    flight.obey(Command::Takeoff(Some(Altitude::Home(40.0)), None));
    flight.obey(Command::Fly(Mode::Hold));
    flight.obey(Command::Fly(Mode::Takeoff));
    flight.obey(Command::Arm);
    flight.run(12.0);
    let height = flight.outer.parameters().manual.takeoff_altitude;
    assert!((flight.position.z + height).abs() < 0.1, "{}", flight.position);
}

/// `GoTo`: each of its parts may be left out.
#[test]
fn a_target_is_flown_to_by_what_it_names() {
    let ground = HOME.altitude as f32 * 1e-3;
    let place = waypoint(12.0, -5.0, 0.0);
    let there = Some((place.x, place.y));
    let up = |altitude| Target {
        altitude: Some(altitude),
        ..Target::default()
    };
    let at = |ground| Target {
        ground,
        ..Target::default()
    };
    for (target, wanted) in [
        (at(there), Vector3::new(12.0, -5.0, -10.0)),
        (up(Altitude::Home(14.0)), Vector3::new(0.0, 0.0, -14.0)),
        (up(Altitude::SeaLevel(ground + 8.0)), Vector3::new(0.0, 0.0, -8.0)),
        (Target::default(), Vector3::new(0.0, 0.0, -10.0)),
        // A ground speed of none, as links send it for "as you like".
        (
            Target {
                speed: Some(-1.0),
                ..at(there)
            },
            Vector3::new(12.0, -5.0, -10.0),
        ),
    ] {
        let mut flight = Flight::new().hovering(10.0);
        flight.obey(Command::GoTo(Target {
            heading: Some(-1.0),
            ..target
        }));
        flight.run(20.0);
        assert!(
            (flight.position - wanted).amax() < 0.1,
            "{target:?}: {}",
            flight.position
        );
        assert!((flight.attitude.heading() + 1.0).abs() < 0.02);
        assert_eq!(flight.report().mode, Mode::Hold);
    }
}

/// If this failed, a mode switch that is moved with the throttle up, after an arming in hold, would make
/// the vehicle leap.
#[test]
fn a_throttle_that_is_up_lifts_nothing_before_it_has_been_down() {
    let throttle = |throttle| {
        Some(Sticks {
            throttle,
            ..Sticks::default()
        })
    };
    for mode in [Mode::Stabilize, Mode::Altitude, Mode::Position] {
        let mut flight = Flight::new();
        flight.steady.sticks = throttle(0.6);
        flight.step();
        flight.obey(Command::Arm);
        flight.obey(Command::Fly(mode));
        flight.run(3.0);
        assert_eq!(flight.result.motors, MotorState::Idle, "{mode:?}");
        assert!(flight.position.z > -0.01, "{mode:?}: {}", flight.position);
        flight.steady.sticks = throttle(-1.0);
        flight.run(0.5);
        flight.steady.sticks = throttle(0.6);
        flight.run(3.0);
        assert!(flight.position.z < -1.0, "{mode:?}: {}", flight.position);
        // In the air a mode takes the throttle as it is.
        flight.obey(Command::Fly(Mode::Hold));
        flight.run(1.0);
        flight.obey(Command::Fly(mode));
        let height = -flight.position.z;
        flight.run(2.0);
        assert!(-flight.position.z > height + 0.5, "{mode:?}: {}", flight.position);
    }
}

/// If this failed, a station that points the camera while the vehicle holds would be told that it was
/// done, and nothing would turn: also on the way somewhere, until it looks ahead or is told a heading.
#[test]
fn hold_looks_at_a_place() {
    let look = |north, east| {
        let there = waypoint(north, east, 0.0);
        Command::LookAt(Some(Place {
            latitude: there.x,
            longitude: there.y,
            altitude: Altitude::Home(0.0),
        }))
    };
    let heads = |flight: &mut Flight, wanted: f32| {
        flight.run(15.0);
        let off = wrap_pi(flight.attitude.heading() - wanted);
        assert!(off.abs() < 0.02, "{off} rad off {wanted}");
    };
    let go = |north, heading| {
        let there = waypoint(north, 0.0, 0.0);
        Command::GoTo(Target {
            ground: Some((there.x, there.y)),
            heading,
            ..Target::default()
        })
    };
    let mut flight = Flight::new().hovering(10.0);
    flight.obey(look(0.0, -20.0));
    heads(&mut flight, -FRAC_PI_2);
    assert!(
        (flight.position + Vector3::new(0.0, 0.0, 10.0)).amax() < 0.1,
        "{}",
        flight.position
    );
    flight.obey(go(20.0, None));
    heads(&mut flight, -3.0 * FRAC_PI_4);
    flight.obey(Command::LookAt(None));
    flight.obey(go(0.0, None));
    heads(&mut flight, -3.0 * FRAC_PI_4);
    // Right above it there is no direction to it.
    flight.obey(look(0.0, 0.0));
    heads(&mut flight, -3.0 * FRAC_PI_4);
    flight.obey(go(20.0, Some(1.0)));
    heads(&mut flight, 1.0);
}

/// On the ground the time to stand idle counts from when it idles: a takeoff at its end is flown.
#[test]
fn a_late_takeoff_is_not_cut_off() {
    for late in [8.5, 9.0, 9.5, 9.9] {
        let mut flight = Flight::new();
        flight.step();
        flight.obey(Command::Arm);
        flight.run(late);
        flight.obey(Command::Fly(Mode::Takeoff));
        flight.run(6.0);
        assert!(flight.is_flying(), "after {late} s: {:?}", flight.report().phase);
    }
    let mut flight = Flight::new();
    flight.step();
    flight.obey(Command::Arm);
    flight.run(10.1);
    assert_eq!(flight.report().phase, Phase::Disarmed, "and idle it disarms");
}
