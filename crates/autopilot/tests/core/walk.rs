//! Missions flown by an ideal vehicle, which is always where it should be.

use windhover_autopilot::Mode;
use windhover_autopilot::mission::action::command;
use windhover_autopilot::mission::executor::{MissionEstimate, Surroundings};
use windhover_autopilot::mission::route::Stored;
use windhover_autopilot::mission::{
    MissionEvent, MissionEvents, MissionExecutor, MissionItem, MissionParameters,
};
use windhover_control::TrajectorySetpoint;
use windhover_math::Vector3;
use windhover_math::geodesy::LocalFrame;

use super::{HOME, item, item_at, waypoint};

/// Length of a step, µs.
pub const STEP: u32 = 4000;

/// What an ideal vehicle did.
#[derive(Default)]
pub struct Walk {
    /// What happened, and in which step.
    pub events: Vec<(usize, MissionEvent)>,
    /// Where it should have been, step by step.
    pub setpoints: Vec<TrajectorySetpoint>,
    /// The mode that follows.
    pub outcome: Option<Mode>,
}

/// Walks a mission to its end with an ideal vehicle on flat ground. Panics when there is no end.
pub fn walk(items: &[MissionItem], parameters: &MissionParameters) -> Walk {
    let frame = LocalFrame::new(HOME);
    let stored = Stored {
        slot: 0,
        count: items.len() as u16,
    };
    let mut walk = Walk::default();
    let mut estimate = MissionEstimate {
        position: Vector3::zeros(),
        shift: Vector3::zeros(),
        velocity: Vector3::zeros(),
        landed: true,
    };
    let around = |estimate| Surroundings {
        source: items,
        frame: &frame,
        home: Vector3::zeros(),
        parameters,
        estimate,
    };
    let mut executor = MissionExecutor::start(stored, &around(estimate), 0, estimate.position, 0.0)
        .expect("somewhere to go");
    while walk.outcome.is_none() {
        assert!(walk.setpoints.len() < 1_000_000, "an hour, and no end");
        let mut events = MissionEvents::new();
        let setpoint = executor.step(&around(estimate), STEP, &mut events);
        let step = walk.setpoints.len();
        walk.events.extend(events.into_iter().map(|event| (step, event)));
        walk.setpoints.push(setpoint);
        estimate.position = setpoint.position;
        estimate.velocity = setpoint.velocity;
        if estimate.position.z >= 0.0 {
            // The ground.
            estimate.position.z = 0.0;
            estimate.velocity.z = 0.0;
        }
        estimate.landed &= estimate.position.z > -0.3;
        walk.outcome = executor.outcome();
    }
    walk
}

impl Walk {
    /// What happened, in order.
    pub fn events(&self) -> Vec<MissionEvent> {
        self.events.iter().map(|(_, event)| *event).collect()
    }

    fn seconds_between(&self, from: MissionEvent, to: MissionEvent) -> f32 {
        let at = |wanted| self.events.iter().find(|(_, event)| *event == wanted).unwrap().0;
        (at(to) - at(from)) as f32 * STEP as f32 * 1e-6
    }
}

fn local(items: &[MissionItem], index: usize) -> Vector3 {
    let item = &items[index];
    let frame = LocalFrame::new(HOME);
    let place = windhover_math::geodesy::GlobalPosition {
        latitude: item.x,
        longitude: item.y,
        altitude: HOME.altitude,
    };
    let ground = frame.to_local(place);
    Vector3::new(ground.x, ground.y, -item.z)
}

fn photo() -> MissionItem {
    item(command::IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0])
}

/// Everything once, in the order of the mission.
#[test]
fn events_come_in_the_order_of_the_items() {
    let items = [
        item(command::NAV_TAKEOFF, [0.0; 4]),
        waypoint(10.0, 0.0, 10.0),
        photo(),
        waypoint(10.0, 10.0, 10.0),
        waypoint(0.0, 10.0, 10.0),
        item(command::DO_JUMP, [3.0, 1.0, 0.0, 0.0]),
        photo(),
        photo(),
        item(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]),
    ];
    let walked = walk(&items, &MissionParameters::default());
    let photo_at = |item: u16, waypoint: usize| MissionEvent::Photo {
        item,
        target: Some(local(&items, waypoint)),
        settled: true,
    };
    use MissionEvent::{Finished, Reached};
    assert_eq!(
        walked.events(),
        [
            Reached(1),
            photo_at(2, 1),
            Reached(3),
            Reached(4),
            Reached(3),
            Reached(4),
            photo_at(6, 4),
            photo_at(7, 4),
            Finished
        ]
    );
    assert_eq!(walked.outcome, Some(Mode::Return), "who brings it home");
}

/// Delays and holds take their time and no more.
#[test]
fn holds_and_delays_add_up() {
    use MissionEvent::{Finished, Reached};
    let hold = |seconds| item_at(16, [seconds, 0.0, 0.0, f32::NAN], 5.0, 0.0, 10.0);
    let delay = |seconds| item(command::NAV_DELAY, [seconds, 0.0, 0.0, 0.0]);
    for (items, wanted) in [
        (vec![hold(0.0)], 0.0),
        (vec![hold(4.0)], 4.0),
        (vec![hold(0.0), delay(3.0)], 3.0),
        (vec![hold(2.0), delay(3.0), delay(0.5)], 5.5),
    ] {
        let walked = walk(&items, &MissionParameters::default());
        let seconds = walked.seconds_between(Reached(0), Finished);
        assert!(
            (wanted..wanted + 0.05).contains(&seconds),
            "{seconds} s for {wanted}"
        );
    }
}

/// Two waypoints at the same place, and a mission at the very place where it starts.
#[test]
fn legs_without_length_end() {
    let items = [
        waypoint(5.0, 5.0, 10.0),
        waypoint(5.0, 5.0, 10.0),
        waypoint(5.0, 5.0, 10.0),
        waypoint(0.0, 0.0, 10.0),
    ];
    let walked = walk(&items, &MissionParameters::default());
    let reached: Vec<MissionEvent> = (0..4).map(MissionEvent::Reached).collect();
    assert_eq!(walked.events()[..4], reached[..]);
}

/// A jump back to before the first waypoint, with a speed that the repeat sets again.
#[test]
fn a_repeat_flies_with_the_speed_that_it_sets() {
    let speed = |value| item(command::DO_CHANGE_SPEED, [1.0, value, -1.0, 0.0]);
    let items = [
        speed(1.0),
        waypoint(20.0, 0.0, 5.0),
        speed(5.0),
        waypoint(0.0, 0.0, 5.0),
        item(command::DO_JUMP, [0.0, 1.0, 0.0, 0.0]),
    ];
    let walked = walk(&items, &MissionParameters::default());
    let fastest = |north: bool| {
        let speeds = walked.setpoints.iter().map(|s| s.velocity.x);
        speeds.fold(0.0f32, |most, v| {
            if (v > 0.0) == north {
                windhover_math::max(most, v.abs())
            } else {
                most
            }
        })
    };
    assert!((fastest(true) - 1.0).abs() < 0.01, "{}", fastest(true));
    assert!(
        fastest(false) > 3.0 && fastest(false) <= 5.01,
        "{}",
        fastest(false)
    );
}

/// A mission that is torn off in flight ends; it does not go on with what it no longer has.
#[test]
fn a_mission_without_a_point_does_not_start() {
    let frame = LocalFrame::new(HOME);
    let parameters = MissionParameters::default();
    let items: &[MissionItem] = &[item(command::IMAGE_STOP_CAPTURE, [0.0; 4])];
    let around = Surroundings {
        source: items,
        frame: &frame,
        home: Vector3::zeros(),
        parameters: &parameters,
        estimate: MissionEstimate {
            position: Vector3::zeros(),
            shift: Vector3::zeros(),
            velocity: Vector3::zeros(),
            landed: true,
        },
    };
    for count in [0, 1, 5] {
        let stored = Stored { slot: 0, count };
        assert!(
            MissionExecutor::start(stored, &around, 0, Vector3::zeros(), 0.0).is_none(),
            "{count}"
        );
    }
}

/// Off the ground with the takeoff's speed, in the air with the climb's, down with the descent's. The
/// way down to the ground is the mode's that follows: `outer_modes`.
#[test]
fn each_vertical_leg_has_its_speed() {
    let parameters = MissionParameters::default();
    let items = [
        item(command::NAV_TAKEOFF, [0.0; 4]),
        item_at(16, [0.5, 0.0, 0.0, f32::NAN], 0.0, 0.0, 25.0),
        item_at(16, [0.5, 0.0, 0.0, f32::NAN], 0.0, 0.0, 12.0),
        item(command::NAV_LAND, [0.0; 4]),
    ];
    let walked = walk(&items, &parameters);
    let fastest = |from: f32, to: f32, up: f32| {
        let part = walked
            .setpoints
            .iter()
            .filter(|s| (from..to).contains(&-s.position.z) && s.velocity.z * up <= 0.0);
        part.map(|s| s.velocity.z.abs()).fold(0.0f32, windhover_math::max)
    };
    let close = |a: f32, b: f32| (a - b).abs() < 0.01;
    assert!(close(fastest(1.0, 9.0, 1.0), parameters.takeoff_speed));
    assert!(close(fastest(13.0, 24.0, 1.0), parameters.climb_speed));
    assert!(close(fastest(13.0, 24.0, -1.0), parameters.descend_speed));
    assert_eq!(walked.outcome, Some(Mode::Land));
}

/// A mission without an end of its own ends where its last waypoint is; one that lands at a place
/// goes above it first. Otherwise the vehicle would come down where the mission did not say.
#[test]
fn the_outcome_names_the_mode_that_follows() {
    let first = waypoint(10.0, 0.0, 10.0);
    let ends = [
        (None, Mode::Hold, 10.0),
        (
            Some(item(command::NAV_RETURN_TO_LAUNCH, [0.0; 4])),
            Mode::Return,
            10.0,
        ),
        (
            Some(item_at(command::NAV_LAND, [0.0; 4], 25.0, 0.0, 0.0)),
            Mode::Land,
            25.0,
        ),
    ];
    for (end, mode, north) in ends {
        let items: Vec<MissionItem> = core::iter::once(first).chain(end).collect();
        let walked = walk(&items, &MissionParameters::default());
        assert_eq!(walked.outcome, Some(mode));
        let last = walked.setpoints.last().expect("a way").position;
        assert!(
            (last - Vector3::new(north, 0.0, -10.0)).amax() < 0.05,
            "{mode:?} at {last}"
        );
        assert_eq!(walked.events().last(), Some(&MissionEvent::Finished));
    }
}
