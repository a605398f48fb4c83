//! The core from outside, part by part: missions without a vehicle, the two steps without a world.

mod action;
mod check;
mod flight;
mod inner;
mod inner_motion;
mod lag;
mod motor_test;
mod outer;
mod outer_arming;
mod outer_blockers;
mod outer_bumpless;
mod outer_commands;
mod outer_interrupted;
mod outer_modes;
mod walk;
mod walk_random;

use windhover_autopilot::mission::MissionItem;
use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};

/// Home of all missions here.
const HOME: GlobalPosition = GlobalPosition {
    latitude: 473_977_419,
    longitude: 85_455_938,
    altitude: 488_000,
};

/// An item at home, 10 m above it.
fn item(command: u16, params: [f32; 4]) -> MissionItem {
    MissionItem {
        command,
        frame: 3,
        autocontinue: true,
        params,
        x: HOME.latitude,
        y: HOME.longitude,
        z: 10.0,
    }
}

/// An item so many metres north and east of home, and above it.
fn item_at(command: u16, params: [f32; 4], north: f32, east: f32, height: f32) -> MissionItem {
    let place = LocalFrame::new(HOME).to_global(Vector3::new(north, east, 0.0));
    MissionItem {
        x: place.latitude,
        y: place.longitude,
        z: height,
        ..item(command, params)
    }
}

/// A waypoint that is passed, with the default radius.
fn waypoint(north: f32, east: f32, height: f32) -> MissionItem {
    item_at(16, [0.0, 0.0, 0.0, f32::NAN], north, east, height)
}
