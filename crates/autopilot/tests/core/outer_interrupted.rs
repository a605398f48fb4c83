//! A mission that is interrupted, by an operator or a failsafe, at any moment, and taken up again.

use windhover_autopilot::mission::action::command::*;
use windhover_autopilot::mission::{MissionEvent, MissionItem, PlanKind};
use windhover_autopilot::{Command, Mode, MotorState, Phase, Why};
use windhover_math::{Vector3, scalar};

use super::flight::{DT, Flight, commit};
use super::{item, item_at, waypoint};

const MISSION: Command = Command::Fly(Mode::Mission);

fn photo() -> MissionItem {
    item(IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0])
}

/// Every state of the executor: legs, a corner that is passed, a stop with a hold, photos that have to
/// settle, a delay.
fn items() -> Vec<MissionItem> {
    vec![
        item(NAV_TAKEOFF, [0.0; 4]),
        waypoint(8.0, 0.0, 10.0),
        item_at(NAV_WAYPOINT, [1.5, 0.0, 0.0, f32::NAN], 8.0, 8.0, 10.0),
        photo(),
        photo(),
        item(NAV_DELAY, [1.0, 0.0, 0.0, 0.0]),
        waypoint(0.0, 8.0, 12.0),
        photo(),
        waypoint(0.0, 2.0, 10.0),
    ]
}

/// On the way with the mission, so many seconds after take-off began.
fn under_way(items: &[MissionItem]) -> Flight {
    let mut flight = Flight::with_mission(items);
    flight.obey(MISSION);
    flight.obey(Command::Arm);
    flight.until(10.0, |flight| flight.result.motors == MotorState::Run);
    flight
}

fn is_over(flight: &Flight) -> bool {
    flight
        .events
        .iter()
        .any(|(_, event)| *event == MissionEvent::Finished)
}

fn reached(flight: &Flight) -> Vec<u16> {
    let reached = flight.events.iter().filter_map(|(_, event)| match event {
        MissionEvent::Reached(item) => Some(*item),
        MissionEvent::Missed(item) => panic!("missed {item}"),
        _ => None,
    });
    reached.collect()
}

/// A step more for the mission at its stop, s.
fn stands(flight: &Flight) -> f32 {
    let off = scalar::norm(flight.position - Vector3::new(8.0, 8.0, -10.0));
    let there = off < 0.3 && flight.report().mode == Mode::Mission;
    if there { DT } else { 0.0 }
}

/// Flies the mission to its end; for how long the vehicle stood at the stop, s.
fn to_the_end(flight: &mut Flight, mut step: impl FnMut(&mut Flight)) -> f32 {
    let mut stood = 0.0;
    while !is_over(flight) {
        let mode = flight.report().mode;
        assert!(flight.tick < 300_000, "no end: {mode:?} {}", flight.position);
        step(flight);
        stood += stands(flight);
    }
    stood
}

fn fly_on(flight: &mut Flight) {
    flight.step();
}

/// At every moment of the mission, half a second apart: hold, somewhere else too, and on. Each photo is
/// taken once, each waypoint told once, and the stop is kept for its whole time.
#[test]
fn nothing_is_left_out_and_nothing_done_twice() {
    let items = items();
    let mut plain = under_way(&items);
    let start = plain.clone();
    let length = {
        let longest = to_the_end(&mut plain, fly_on);
        assert!(longest > 2.5, "{longest}");
        plain.tick - start.tick
    };
    assert_eq!(plain.photos(), [3, 4, 7]);
    assert_eq!(reached(&plain), [1, 2, 6, 8]);
    for moment in (0..length).step_by(500) {
        for aside in [false, true] {
            let mut flight = start.clone();
            let at = flight.tick + moment;
            let mut stood = 0.0;
            while flight.tick < at {
                flight.step();
                stood += stands(&flight);
            }
            if is_over(&flight) || flight.report().phase != Phase::Flying {
                continue;
            }
            flight.obey(Command::Fly(Mode::Hold));
            flight.run(1.0);
            if aside {
                let place = waypoint(3.0, -3.0, 0.0);
                flight.obey(Command::GoTo(windhover_autopilot::mode::Target {
                    ground: Some((place.x, place.y)),
                    ..Default::default()
                }));
                flight.run(8.0);
            }
            let photos = flight.photos().len();
            flight.run(2.0);
            assert_eq!(flight.photos().len(), photos, "no photo while it holds");
            flight.obey(MISSION);
            let what = format!("after {} s, aside {aside}", moment as f32 * 1e-3);
            stood += to_the_end(&mut flight, fly_on);
            assert_eq!(flight.photos(), [3, 4, 7], "{what}");
            assert_eq!(reached(&flight), [1, 2, 6, 8], "{what}");
            let settled = flight
                .events
                .iter()
                .all(|(_, event)| !matches!(event, MissionEvent::Photo { settled: false, .. }));
            assert!(settled, "{what}");
            assert!(stood > 2.5, "{what}: stood for {stood} s");
        }
    }
}

/// Interrupted again and again while it is taken up: it comes to its end all the same.
#[test]
fn interruptions_of_what_is_taken_up_do_no_harm() {
    let mut flight = under_way(&items());
    let mut step = 0u32;
    to_the_end(&mut flight, |flight| {
        step += 1;
        // Longer each time, so that every pause falls elsewhere.
        let period = 1200 + step / 40;
        let flies = flight.is_flying();
        match step % period {
            0 if flies => flight.obey(Command::Fly(Mode::Hold)),
            100 if flies && flight.report().mode == Mode::Hold => flight.obey(MISSION),
            _ => {
                flight.step();
            }
        }
    });
    assert_eq!(flight.photos(), [3, 4, 7]);
    assert_eq!(reached(&flight), [1, 2, 6, 8]);
}

/// A mission that was landed out of goes on straight up: the legs are not dragged over the ground.
#[test]
fn from_the_ground_it_goes_straight_up_first() {
    let mut flight = under_way(&items());
    flight.until(60.0, |flight| flight.position.x > 3.0);
    flight.obey(Command::Fly(Mode::Land));
    flight.write("COM_DISARM_LAND", 30.0);
    flight.until(60.0, |flight| flight.report().phase == Phase::Landed);
    let place = flight.position;
    flight.obey(MISSION);
    while flight.position.z > -5.0 {
        flight.step();
        let aside = flight.position - place;
        assert!(windhover_math::max(aside.x.abs(), aside.y.abs()) < 0.1, "{aside}");
        assert!(flight.report().phase != Phase::Disarmed);
    }
    to_the_end(&mut flight, fly_on);
    assert_eq!(flight.photos(), [3, 4, 7]);
}

/// The lowest thrust of a second, as a share of the weight.
fn least_thrust(flight: &mut Flight, seconds: f32) -> f32 {
    let weight = flight.mass() * windhover_math::GRAVITY;
    let steps = (0..(seconds / DT) as u32).map(|_| flight.step().setpoint.thrust / weight);
    steps.fold(f32::MAX, windhover_math::min)
}

/// A mission that waited on the ground, for its first photo, when a takeoff came between: taken up in
/// the air it asked for motors at rest.
#[test]
fn a_mission_that_waited_on_the_ground_flies_when_it_is_taken_up_in_the_air() {
    let items = [
        item(NAV_DELAY, [5.0, 0.0, 0.0, 0.0]),
        item(NAV_TAKEOFF, [0.0; 4]),
        waypoint(5.0, 0.0, 10.0),
    ];
    let mut flight = Flight::with_mission(&items);
    flight.obey(MISSION);
    flight.obey(Command::Arm);
    flight.run(3.0);
    assert_eq!(flight.result.motors, MotorState::Idle);
    flight.obey(Command::Fly(Mode::Takeoff));
    flight.until(20.0, |flight| flight.report().mode == Mode::Hold);
    flight.run(2.0);
    flight.obey(MISSION);
    assert!(least_thrust(&mut flight, 4.0) > 0.7);
    flight.until(30.0, is_over);
}

/// A start behind the last waypoint, in the air: there is nothing to fly to, and it stays.
#[test]
fn a_mission_without_a_way_stays_where_it_is() {
    let mut items = items();
    items.push(photo());
    let mut flight = Flight::with_mission(&items).hovering(8.0);
    let place = flight.position;
    let last = items.len() as u16 - 1;
    let weight = flight.mass() * windhover_math::GRAVITY;
    let thrust = flight.command(Command::StartMission(last)).setpoint.thrust;
    assert!(thrust > 0.9 * weight, "{thrust} N");
    assert!(least_thrust(&mut flight, 1.0) > 0.9);
    assert_eq!(flight.report().mode, Mode::Hold);
    assert!(scalar::norm(flight.position - place) < 0.1);
}

/// Without a local frame nobody knows where its places are.
#[test]
fn a_mission_needs_a_frame() {
    let mut flight = Flight::with(windhover_autopilot::Parameters::default(), None);
    flight.step();
    flight.store(&items());
    let Why::Blocked(blockers) = flight.refused(MISSION) else {
        panic!("another reason");
    };
    assert!(!blockers.is_empty());
}

/// While a failsafe interrupts it no other mission takes its place, to be flown when that is over; while
/// the operator does, one may, and what flies meanwhile does not notice.
#[test]
fn a_mission_is_not_exchanged_behind_a_failsafe() {
    let mut flight = under_way(&items());
    flight.until(60.0, |flight| flight.position.x > 3.0);
    flight.seen = false;
    flight.run(0.52);
    assert_eq!(flight.outer.supervisor().interrupted(), Some(Mode::Mission));
    assert_eq!(flight.refused(commit(PlanKind::Mission, 2)), Why::InFlight);
    let mut flight = under_way(&items());
    flight.until(60.0, |flight| flight.position.x > 3.0);
    let place = waypoint(20.0, 0.0, 0.0);
    flight.obey(Command::GoTo(windhover_autopilot::mode::Target {
        ground: Some((place.x, place.y)),
        ..Default::default()
    }));
    flight.run(1.0);
    flight.store(&items()[..3]);
    flight.run(15.0);
    assert!(
        (flight.position.x - 20.0).abs() < 0.1,
        "on to where it was sent: {}",
        flight.position
    );
}
