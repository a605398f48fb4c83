//! Missions flown by vehicles that are not where they should be.

use windhover_autopilot::mission::action::command;
use windhover_autopilot::mission::executor::{MissionEstimate, Surroundings};
use windhover_autopilot::mission::route::Stored;
use windhover_autopilot::mission::{
    MissionEvent, MissionEvents, MissionExecutor, MissionItem, MissionParameters,
};
use windhover_control::TrajectorySetpoint;
use windhover_math::geodesy::LocalFrame;
use windhover_math::{Vector3, scalar};

use super::{HOME, item, item_at, waypoint};

const DT: f32 = 0.004;

/// Where the mission starts: in flight.
const START: Vector3 = Vector3::new(0.0, 0.0, -10.0);

/// Setpoints and events of each step.
type Flown = Vec<(TrajectorySetpoint, Vec<MissionEvent>)>;

/// Flies for so many seconds with a vehicle that is where `follow` puts it, told the time and
/// where it should be.
fn fly(
    items: &[MissionItem],
    parameters: &MissionParameters,
    seconds: f32,
    follow: &dyn Fn(f32, &TrajectorySetpoint) -> (Vector3, Vector3),
) -> Flown {
    let frame = LocalFrame::new(HOME);
    let stored = Stored {
        slot: 0,
        count: items.len() as u16,
    };
    let around = |position, velocity| Surroundings {
        source: items,
        frame: &frame,
        home: Vector3::zeros(),
        parameters,
        estimate: MissionEstimate {
            position,
            shift: Vector3::zeros(),
            velocity,
            landed: false,
        },
    };
    let mut at = (START, Vector3::zeros());
    let mut executor = MissionExecutor::start(stored, &around(at.0, at.1), 0, at.0, 0.0).unwrap();
    let mut flown = Flown::new();
    for step in 0..(seconds / DT) as u32 {
        let mut events = MissionEvents::new();
        let setpoint = executor.step(&around(at.0, at.1), 4000, &mut events);
        at = follow(step as f32 * DT, &setpoint);
        flown.push((setpoint, events.to_vec()));
    }
    flown
}

fn exactly(_: f32, setpoint: &TrajectorySetpoint) -> (Vector3, Vector3) {
    (setpoint.position, setpoint.velocity)
}

fn events(flown: &Flown) -> Vec<MissionEvent> {
    flown.iter().flat_map(|(_, events)| events.clone()).collect()
}

/// The path does not run away from a vehicle that cannot follow: it slows down, then waits, and
/// goes on when the vehicle comes.
#[test]
fn the_path_waits_for_a_vehicle_that_is_held_back() {
    let parameters = MissionParameters::default();
    let items = [waypoint(50.0, 0.0, 10.0)];
    let flown = fly(&items, &parameters, 60.0, &|time, setpoint| {
        if time < 30.0 {
            (START, Vector3::zeros())
        } else {
            exactly(time, setpoint)
        }
    });
    let ahead = |seconds: f32| scalar::norm(flown[(seconds / DT) as usize].0.position - START);
    assert!(
        (2.5..=parameters.stop_error).contains(&ahead(29.9)),
        "{}",
        ahead(29.9)
    );
    let speed = |seconds: f32| scalar::norm(flown[(seconds / DT) as usize].0.velocity);
    assert!(speed(29.9) < 0.05, "{} m/s", speed(29.9));
    assert!((speed(34.0) - parameters.cruise_speed).abs() < 0.01, "it goes on");
    assert_eq!(events(&flown), [MissionEvent::Reached(0), MissionEvent::Finished]);
}

/// What the photo of a vehicle that hangs `off` metres beside the point is like: when, after the
/// stop, and whether settled.
fn photo_of(follow: &dyn Fn(f32, &TrajectorySetpoint) -> (Vector3, Vector3)) -> (f32, bool) {
    let items = [
        item_at(16, [0.0, 1.0, 0.0, f32::NAN], 4.0, 0.0, 10.0),
        item(command::IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0]),
    ];
    let flown = fly(&items, &MissionParameters::default(), 30.0, follow);
    let find = |wanted: &dyn Fn(&MissionEvent) -> bool| {
        let step = flown.iter().position(|(_, events)| events.iter().any(wanted));
        step.expect("it happened") as f32 * DT
    };
    let reached = find(&|event| *event == MissionEvent::Reached(0));
    let taken = find(&|event| matches!(event, MissionEvent::Photo { .. }));
    let settled = find(&|event| {
        matches!(
            event,
            MissionEvent::Photo { settled: true, .. } | MissionEvent::Finished
        )
    });
    (taken - reached, settled == taken)
}

/// Near and slow, for long enough without a break: each of the three is needed.
#[test]
fn a_photo_needs_nearness_and_stillness_without_a_break() {
    let p = MissionParameters::default();
    let beside = |off: f32, speed: f32| {
        move |_: f32, setpoint: &TrajectorySetpoint| {
            let east = Vector3::y();
            (setpoint.position + east * off, setpoint.velocity + east * speed)
        }
    };
    let (soon, settled) = photo_of(&beside(0.9 * p.photo_error, 0.9 * p.photo_speed));
    assert!(
        settled && (p.photo_dwell..p.photo_dwell + 0.1).contains(&soon),
        "{soon}"
    );
    for (off, speed) in [(1.1 * p.photo_error, 0.0), (0.0, 1.1 * p.photo_speed)] {
        let (late, settled) = photo_of(&beside(off, speed));
        assert!(!settled, "{off} m, {speed} m/s");
        assert!(
            (late - p.photo_wait).abs() < 0.1,
            "{off} m, {speed} m/s: {late} s"
        );
    }
    // Still for nine tenths of the dwell time, again and again.
    let restless = |time: f32, setpoint: &TrajectorySetpoint| {
        let period = 1.1 * p.photo_dwell;
        let moving = time % period > 0.9 * p.photo_dwell;
        let speed = if moving { 2.0 * p.photo_speed } else { 0.0 };
        (setpoint.position, setpoint.velocity + Vector3::y() * speed)
    };
    let (late, settled) = photo_of(&restless);
    assert!(!settled && (late - p.photo_wait).abs() < 0.1, "{late} s");
}

/// Waypoints that are passed too far away are missed, each once and in order, and none twice.
#[test]
fn waypoints_passed_too_far_away_are_missed() {
    let parameters = MissionParameters {
        slow_error: 50.0,
        stop_error: 100.0,
        arrival_wait: 2.0,
        ..Default::default()
    };
    let items = [
        waypoint(10.0, 0.0, 10.0),
        waypoint(20.0, 5.0, 10.0),
        waypoint(30.0, 0.0, 10.0),
        waypoint(40.0, 5.0, 10.0),
    ];
    let beside =
        |_: f32, setpoint: &TrajectorySetpoint| (setpoint.position + Vector3::z() * 2.5, setpoint.velocity);
    let flown = fly(&items, &parameters, 60.0, &beside);
    use MissionEvent::{Finished, Missed};
    assert_eq!(
        events(&flown),
        [Missed(0), Missed(1), Missed(2), Missed(3), Finished]
    );
}

/// The last waypoint before a stop is missed too, where the stop itself is reached.
#[test]
fn a_waypoint_missed_before_a_stop_is_told() {
    let parameters = MissionParameters {
        slow_error: 50.0,
        stop_error: 100.0,
        ..Default::default()
    };
    let items = [waypoint(10.0, 0.0, 10.0), waypoint(30.0, 0.0, 10.0)];
    let beside_at_first = |_: f32, setpoint: &TrajectorySetpoint| {
        let off = if setpoint.position.x < 20.0 { 2.5 } else { 0.0 };
        (setpoint.position + Vector3::z() * off, setpoint.velocity)
    };
    let flown = fly(&items, &parameters, 60.0, &beside_at_first);
    use MissionEvent::{Finished, Missed, Reached};
    assert_eq!(events(&flown), [Reached(1), Missed(0), Finished]);
}

/// When the mission is over, so are its photos by time.
#[test]
fn the_end_of_a_mission_ends_its_photos() {
    let items = [
        item(command::IMAGE_START_CAPTURE, [0.0, 1.0, 0.0, 0.0]),
        waypoint(10.0, 0.0, 10.0),
    ];
    let flown = fly(&items, &MissionParameters::default(), 60.0, &exactly);
    let end = events(&flown)
        .iter()
        .position(|event| *event == MissionEvent::Finished)
        .unwrap();
    assert!(end > 5, "photos on the way");
    assert_eq!(events(&flown).len(), end + 1, "and none after the end");
}
