//! Missions that are refused as a whole, each with the item and the field that is at fault.

use windhover_autopilot::mission::action::{Reason, command};
use windhover_autopilot::mission::route::{MAX_JUMPS, Stored};
use windhover_autopilot::mission::{
    MAX_ITEMS, MissionItem, MissionParameters, MissionSource, PlanKind, Refusal, check,
};

use super::{HOME, item, item_at, waypoint};

fn checked(items: &[MissionItem]) -> Result<(), (u16, Refusal)> {
    let stored = Stored {
        slot: 0,
        count: items.len() as u16,
    };
    check(items, stored, Some(HOME), &MissionParameters::default())
}

/// Index of the item and name of the field.
fn refused(items: &[MissionItem]) -> (u16, &'static str) {
    let (item, refusal) = checked(items).expect_err("refused");
    (item, refusal.field)
}

fn jump(to: f32) -> MissionItem {
    item(command::DO_JUMP, [to, 1.0, 0.0, 0.0])
}

#[test]
fn a_good_mission_passes() {
    let items = [
        item(command::NAV_TAKEOFF, [0.0; 4]),
        waypoint(100.0, -50.0, 30.0),
        jump(1.0),
        waypoint(-100.0, 50.0, -20.0),
        item(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]),
    ];
    assert_eq!(checked(&items), Ok(()));
}

#[test]
fn the_item_at_fault_is_named() {
    let way = waypoint(10.0, 0.0, 10.0);
    let north_of_the_pole = MissionItem {
        x: 910_000_000,
        ..way
    };
    assert_eq!(refused(&[way, way, north_of_the_pole]), (2, "latitude"));
    assert_eq!(refused(&[way, waypoint(0.0, 0.0, 500.5)]), (1, "altitude"));
    assert_eq!(refused(&[way, waypoint(0.0, 0.0, -500.5)]), (1, "altitude"));
    assert_eq!(refused(&[way, waypoint(0.0, 5100.0, 10.0)]), (1, "position"));
    let far_landing = item_at(command::NAV_LAND, [0.0; 4], -5100.0, 0.0, 0.0);
    assert_eq!(refused(&[way, far_landing]), (1, "position"));
    let other_side = MissionItem {
        x: -473_977_419,
        y: -945_455_938,
        ..way
    };
    assert_eq!(refused(&[way, other_side]), (1, "position"));
    assert_eq!(refused(&[way, item(84, [0.0; 4])]), (1, "command"));
    let nan = MissionItem { z: f32::NAN, ..way };
    assert_eq!(refused(&[way, nan]), (1, "altitude"));
    let low = MissionItem {
        z: 0.2,
        ..item(command::NAV_TAKEOFF, [0.0; 4])
    };
    assert_eq!(refused(&[low, way]), (0, "altitude"));
    let high = MissionItem {
        z: 501.0,
        ..item(command::NAV_TAKEOFF, [0.0; 4])
    };
    assert_eq!(refused(&[high, way]), (0, "altitude"));
    // Just inside.
    assert_eq!(checked(&[waypoint(0.0, 4990.0, 499.5)]), Ok(()));
}

/// Altitudes above the sea are judged above home, which lies at 488 m.
#[test]
fn altitudes_above_the_sea_count_from_home() {
    let at = |z| MissionItem {
        frame: 0,
        z,
        ..waypoint(10.0, 0.0, 0.0)
    };
    assert_eq!(checked(&[at(980.0)]), Ok(()));
    assert_eq!(refused(&[at(990.0)]), (0, "altitude"));
    assert_eq!(refused(&[at(-20.0)]), (0, "altitude"));
}

#[test]
fn nothing_to_fly_to() {
    for items in [
        &[][..],
        &[item(command::NAV_TAKEOFF, [0.0; 4])],
        &[item(command::IMAGE_STOP_CAPTURE, [0.0; 4]), jump(0.0)],
    ] {
        let (_, refusal) = checked(items).unwrap_err();
        assert_eq!(refusal.reason, Reason::NoWaypoint);
        assert_eq!(refusal.field, "mission");
    }
}

#[test]
fn jumps_out_of_the_mission_or_too_many() {
    let way = waypoint(10.0, 0.0, 10.0);
    assert_eq!(refused(&[way, jump(2.0)]), (1, "jump target"));
    assert_eq!(checked(&[way, jump(1.0)]), Ok(()));
    let mut items = vec![way];
    items.extend([jump(0.0); MAX_JUMPS]);
    assert_eq!(checked(&items), Ok(()));
    items.push(jump(0.0));
    assert_eq!(refused(&items), (MAX_JUMPS as u16 + 1, "jump target"));
}

#[test]
fn more_items_than_are_stored() {
    let way = waypoint(10.0, 0.0, 10.0);
    assert_eq!(checked(&[way; MAX_ITEMS]), Ok(()));
    let (_, refusal) = checked(&[way; MAX_ITEMS + 1]).unwrap_err();
    assert_eq!(refusal.reason, Reason::TooMany(MAX_ITEMS + 1));
}

/// Fewer items in storage than were committed: whatever else that is, it is not that mission.
#[test]
fn a_mission_that_is_not_all_there_is_refused() {
    struct Torn;
    impl MissionSource for Torn {
        fn item(&self, _kind: PlanKind, _slot: u8, index: u16) -> Option<MissionItem> {
            (index < 3).then(|| waypoint(10.0, 0.0, 10.0))
        }
    }
    let stored = Stored { slot: 0, count: 5 };
    let (item, refusal) = check(&Torn, stored, Some(HOME), &MissionParameters::default()).unwrap_err();
    assert_eq!((item, refusal.reason), (3, Reason::Missing));
}
