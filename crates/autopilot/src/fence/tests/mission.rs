//! Missions held against a fence.

use super::*;
use crate::mission::action::{Reason, command as nav};
use crate::mission::nav::Chart;
use crate::mission::route::Stored;
use crate::mission::{MissionParameters, Refusal};
use std::string::ToString;

fn mission_item(command: u16, params: [f32; 2], north: f32, east: f32, z: f32) -> MissionItem {
    MissionItem {
        frame: 3,
        z,
        params: [params[0], params[1], 0.0, f32::NAN],
        ..item(command, 0.0, north, east)
    }
}

fn takeoff(height: f32) -> MissionItem {
    mission_item(nav::NAV_TAKEOFF, [0.0; 2], 0.0, 0.0, height)
}

fn way(north: f32, east: f32) -> MissionItem {
    mission_item(nav::NAV_WAYPOINT, [0.0; 2], north, east, 30.0)
}

fn jump(to: f32, times: f32) -> MissionItem {
    mission_item(nav::DO_JUMP, [to, times], 0.0, 0.0, 0.0)
}

fn home() -> MissionItem {
    mission_item(nav::NAV_RETURN_TO_LAUNCH, [0.0; 2], 0.0, 0.0, 0.0)
}

fn checked(
    mission: &[MissionItem],
    fence: &Fence,
    rally: &[MissionItem],
    parameters: &FenceParameters,
) -> Result<(), (u16, Refusal)> {
    let plans = Plans {
        mission,
        rally,
        ..Plans::default()
    };
    let frame = LocalFrame::new(HOME);
    let rally = Rally::compile(&plans, 0, rally.len() as u16, &frame).unwrap();
    let chart = Chart {
        source: &plans,
        stored: Stored {
            slot: 0,
            count: mission.len() as u16,
        },
        frame: &frame,
        home: Vector3::zeros(),
        parameters: &MissionParameters::default(),
    };
    check_mission(&chart, fence, &rally, parameters)
}

/// The item and field that a mission is refused for in this fence; `None` if it is accepted.
fn refused(mission: &[MissionItem], fence: &Fence) -> Option<(u16, &'static str)> {
    refused_with(mission, fence, &[], &FenceParameters::default())
}

fn refused_with(
    mission: &[MissionItem],
    fence: &Fence,
    rally: &[MissionItem],
    parameters: &FenceParameters,
) -> Option<(u16, &'static str)> {
    let (index, refusal) = checked(mission, fence, rally, parameters).err()?;
    assert_eq!(refusal.reason, Reason::Fence);
    assert_eq!(
        refusal.to_string(),
        std::format!("{}: leg leaves the geofence; move it or the fence", refusal.field)
    );
    Some((index, refusal.field))
}

/// A yard around home with a wall in it, 20 to 22 m north, from 10 m west to 10 m east.
fn yard() -> Fence {
    fence(&[
        &rectangle(true, (-100.0, 100.0), (-100.0, 100.0)),
        &rectangle(false, (20.0, 22.0), (-10.0, 10.0)),
    ])
}

#[test]
fn legs_are_looked_at_not_only_their_ends() {
    let around = [takeoff(10.0), way(20.0, 30.0), way(50.0, 0.0)];
    assert_eq!(refused(&around, &yard()), None);
    assert_eq!(
        refused(&[takeoff(10.0), way(50.0, 0.0)], &yard()),
        Some((1, "waypoint"))
    );
    assert_eq!(
        refused(&[way(0.0, 50.0), way(0.0, 101.0)], &yard()),
        Some((1, "waypoint"))
    );
    // The way home leads through the wall, or around it.
    assert_eq!(
        refused(&[around[1], around[2], home()], &yard()),
        Some((2, "return"))
    );
    assert_eq!(refused(&[around[1], around[2], around[1], home()], &yard()), None);
    assert_eq!(refused(&[takeoff(10.0), way(0.0, 50.0)], &Fence::default()), None);
}

#[test]
fn home_outside_of_the_fence_is_the_first_legs_fault() {
    let elsewhere = fence(&[&rectangle(true, (50.0, 100.0), (0.0, 100.0))]);
    assert_eq!(
        refused(&[takeoff(10.0), way(60.0, 20.0)], &elsewhere),
        Some((0, "takeoff"))
    );
    assert_eq!(refused(&[way(60.0, 20.0)], &elsewhere), Some((0, "waypoint")));
    let ignored = FenceParameters {
        action: 0.0,
        ..FenceParameters::default()
    };
    assert_eq!(refused_with(&[way(60.0, 20.0)], &elsewhere, &[], &ignored), None);
}

#[test]
fn a_jump_has_a_leg_to_its_target() {
    let (a, b, c) = (way(20.0, 30.0), way(50.0, 0.0), way(0.0, 0.0));
    // From behind the wall straight to its front.
    assert_eq!(
        refused(&[c, a, b, jump(0.0, 1.0), a], &yard()),
        Some((3, "jump target"))
    );
    assert_eq!(refused(&[c, a, b, jump(1.0, 1.0), a], &yard()), None);
    assert_eq!(refused(&[c, a, b, jump(0.0, 0.0), a], &yard()), None);
    // What follows a jump for ever is not flown to from there.
    assert_eq!(refused(&[c, a, b, jump(1.0, -1.0), c], &yard()), None);
    assert_eq!(
        refused(&[c, a, b, jump(1.0, 3.0), c], &yard()),
        Some((4, "waypoint"))
    );
}

#[test]
fn a_landing_is_flown_to() {
    let land = mission_item(nav::NAV_LAND, [0.0; 2], 50.0, 0.0, 0.0);
    assert_eq!(refused(&[way(0.0, 5.0), land], &yard()), Some((1, "landing")));
    assert_eq!(refused(&[way(20.0, 30.0), land], &yard()), None);
}

#[test]
fn a_return_leads_to_the_nearer_rally_point() {
    let mission = [way(20.0, 30.0), way(60.0, 0.0), home()];
    let rally = [mission_item(command::RALLY_POINT, [0.0; 2], 40.0, 0.0, 20.0)];
    let parameters = FenceParameters::default();
    assert_eq!(
        refused_with(&mission, &yard(), &[], &parameters),
        Some((2, "return"))
    );
    assert_eq!(refused_with(&mission, &yard(), &rally, &parameters), None);
}

#[test]
fn height_and_distance_count_with_every_leg() {
    let limits = |distance_max, altitude_max| FenceParameters {
        distance_max,
        altitude_max,
        ..FenceParameters::default()
    };
    let refused =
        |mission: &[MissionItem], parameters| refused_with(mission, &Fence::default(), &[], &parameters);
    let mission = [takeoff(10.0), way(50.0, 0.0)];
    assert_eq!(refused(&mission, limits(51.0, 31.0)), None);
    assert_eq!(refused(&mission, limits(49.0, 31.0)), Some((1, "waypoint")));
    assert_eq!(refused(&mission, limits(0.0, 29.0)), Some((1, "waypoint")));
    assert_eq!(refused(&mission, limits(0.0, 9.0)), Some((0, "takeoff")));
    // The climb before returning is a leg as well.
    let low = mission_item(nav::NAV_WAYPOINT, [0.0; 2], 50.0, 0.0, 10.0);
    assert_eq!(refused(&[low, home()], limits(0.0, 25.0)), Some((1, "return")));
    let above_home = [mission_item(nav::NAV_WAYPOINT, [0.0; 2], 1.0, 0.0, 10.0), home()];
    assert_eq!(refused(&above_home, limits(0.0, 25.0)), None);
}
