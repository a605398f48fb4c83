//! Missions at random, flown by an ideal vehicle: each ends, and the way there is one that a
//! vehicle can follow.

use proptest::prelude::*;
use windhover_autopilot::Mode;
use windhover_autopilot::mission::action::{Action, command};
use windhover_autopilot::mission::route::{Cursor, Stored};
use windhover_autopilot::mission::{MissionEvent, MissionItem, MissionParameters, check};
use windhover_math::{Vector3, max, scalar, sqrt};

use super::walk::{STEP, Walk, walk};
use super::{HOME, item, item_at};

const DT: f32 = STEP as f32 * 1e-6;

/// A waypoint, a quarter of them with a hold, some with a heading.
fn any_waypoint() -> impl Strategy<Value = MissionItem> {
    let heading = prop_oneof![3 => Just(f32::NAN), 1 => -180.0f32..180.0];
    let hold = prop_oneof![3 => Just(0.0f32), 1 => 0.1f32..2.0];
    let place = (-40.0f32..40.0, -40.0f32..40.0, 3.0f32..15.0);
    (place, hold, 0.3f32..5.0, heading).prop_map(|((north, east, height), hold, radius, heading)| {
        item_at(
            command::NAV_WAYPOINT,
            [hold, radius, 0.0, heading],
            north,
            east,
            height,
        )
    })
}

/// Something to do between two waypoints.
fn any_task() -> impl Strategy<Value = MissionItem> {
    let plain = |command, params| Just(item(command, params));
    prop_oneof![
        4 => plain(command::IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0]),
        1 => plain(command::IMAGE_START_CAPTURE, [0.0, 0.7, 3.0, 0.0]),
        1 => plain(command::IMAGE_STOP_CAPTURE, [0.0; 4]),
        1 => plain(command::DO_SET_ROI_NONE, [0.0; 4]),
        1 => plain(command::SET_CAMERA_MODE, [0.0; 4]),
        2 => (0.5f32..8.0).prop_map(|v| item(command::DO_CHANGE_SPEED, [1.0, v, -1.0, 0.0])),
        1 => (0.0f32..1.5).prop_map(|t| item(command::NAV_DELAY, [t, 0.0, 0.0, 0.0])),
        1 => (0.0f32..20.0).prop_map(|d| item(command::DO_SET_CAM_TRIGG_DIST, [d, 0.0, 1.0, 0.0])),
        1 => (-40.0f32..40.0).prop_map(|n| item_at(command::DO_SET_ROI_LOCATION, [0.0; 4], n, 5.0, 0.0)),
    ]
}

/// Whole missions: perhaps a takeoff, waypoints with tasks, jumps back, perhaps a landing.
fn any_mission() -> impl Strategy<Value = Vec<MissionItem>> {
    let part = prop_oneof![
        4 => any_waypoint().prop_map(Part::Item),
        3 => any_task().prop_map(Part::Item),
        1 => (any::<prop::sample::Index>(), 0u8..3).prop_map(|(to, times)| Part::Jump(to, times)),
    ];
    let end = prop_oneof![
        Just(None),
        Just(Some(item(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]))),
        (-10.0f32..10.0).prop_map(|n| Some(item_at(command::NAV_LAND, [0.0; 4], n, 3.0, 0.0))),
    ];
    let middle = prop::collection::vec(part, 1..10);
    (any::<bool>(), any_waypoint(), middle, end).prop_map(|(takeoff, first, middle, end)| {
        let mut items = Vec::new();
        if takeoff {
            items.push(item(command::NAV_TAKEOFF, [0.0; 4]));
        }
        items.push(first);
        let mut jumps = 0;
        for part in middle {
            match part {
                Part::Item(item) => items.push(item),
                Part::Jump(to, times) if jumps < 2 => {
                    jumps += 1;
                    let to = to.index(items.len()) as f32;
                    items.push(item(command::DO_JUMP, [to, f32::from(times), 0.0, 0.0]));
                }
                Part::Jump(..) => {}
            }
        }
        items.extend(end);
        items
    })
}

#[derive(Clone, Debug)]
enum Part {
    Item(MissionItem),
    Jump(prop::sample::Index, u8),
}

fn stored(items: &[MissionItem]) -> Stored {
    Stored {
        slot: 0,
        count: items.len() as u16,
    }
}

/// The items in the order in which they come up.
fn route(items: &[MissionItem]) -> Vec<(u16, Action)> {
    let mut cursor = Cursor::default();
    core::iter::from_fn(|| cursor.advance(items, stored(items))).collect()
}

fn horizontal(v: Vector3) -> f32 {
    sqrt(v.x * v.x + v.y * v.y)
}

/// Photos at rest once for every time that their item comes up; waypoints reached in order.
fn assert_events(items: &[MissionItem], walked: &Walk) -> Result<(), TestCaseError> {
    let route = route(items);
    let photos = |events: &[MissionEvent]| -> Vec<u16> {
        let at_rest = events.iter().filter_map(|event| match event {
            MissionEvent::Photo {
                item,
                target: Some(_),
                ..
            } => Some(*item),
            _ => None,
        });
        at_rest.collect()
    };
    let wanted = route.iter().filter(|(_, action)| *action == Action::Photo);
    let wanted: Vec<u16> = wanted.map(|(item, _)| *item).collect();
    let events = walked.events();
    prop_assert_eq!(photos(&events), wanted);
    let reached = events.iter().filter_map(|event| match event {
        MissionEvent::Reached(item) => Some(*item),
        _ => None,
    });
    let waypoints = route
        .iter()
        .filter(|(_, action)| matches!(action, Action::Waypoint { .. }));
    let waypoints: Vec<u16> = waypoints.map(|(item, _)| *item).collect();
    prop_assert_eq!(reached.collect::<Vec<_>>(), waypoints);
    prop_assert_eq!(events.last(), Some(&MissionEvent::Finished));
    let follows = match items.last().map(|item| item.command) {
        Some(command::NAV_RETURN_TO_LAUNCH) => Mode::Return,
        Some(command::NAV_LAND) => Mode::Land,
        _ => Mode::Hold,
    };
    prop_assert_eq!(walked.outcome, Some(follows));
    Ok(())
}

/// Continuous, inside the limits, and each derivative that of the one before.
fn assert_way(items: &[MissionItem], walked: &Walk, p: &MissionParameters) -> Result<(), TestCaseError> {
    let speeds = items
        .iter()
        .filter(|item| item.command == command::DO_CHANGE_SPEED);
    let speed = speeds.map(|item| item.params[1]).fold(p.cruise_speed, max);
    let climb = max(p.climb_speed, p.takeoff_speed);
    let descend = max(p.descend_speed, p.land_speed);
    for pair in walked.setpoints.windows(2) {
        let [last, now] = pair else { unreachable!() };
        prop_assert!(now.is_finite(), "{now:?}");
        let moved = now.position - last.position;
        prop_assert!(horizontal(moved) <= speed * DT * 1.05, "{last:?} to {now:?}");
        prop_assert!(-moved.z <= climb * DT * 1.05 && moved.z <= descend * DT * 1.05);
        prop_assert!(horizontal(now.velocity) <= speed * 1.02, "{now:?}");
        prop_assert!(horizontal(now.acceleration) <= p.acceleration * 1.01, "{now:?}");
        prop_assert!(
            now.acceleration.z.abs() <= p.vertical_acceleration * 1.01,
            "{now:?}"
        );
        let drift = moved - (now.velocity + last.velocity) * (0.5 * DT);
        prop_assert!(scalar::norm(drift) < 1e-3, "{last:?} to {now:?}");
        let sped = now.velocity - last.velocity;
        prop_assert!(
            horizontal(sped) <= p.acceleration * DT * 1.1 + 1e-3,
            "{last:?} to {now:?}"
        );
        prop_assert!(now.heading_rate.abs() <= p.yaw_rate * 1.001);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn every_mission_ends_and_can_be_followed(items in any_mission()) {
        let parameters = MissionParameters::default();
        prop_assume!(check(items.as_slice(), stored(&items), Some(HOME), &parameters).is_ok());
        let walked = walk(&items, &parameters);
        assert_events(&items, &walked)?;
        assert_way(&items, &walked, &parameters)?;
    }
}
