//! The fence held against brute force in double precision.

extern crate std;

mod geometry;
mod items;
mod mission;
mod oracle;
mod watch;

use std::vec::Vec;

use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};

use super::items::command;
use super::*;
use crate::mission::{MissionItem, Plans};

const HOME: GlobalPosition = GlobalPosition {
    latitude: 473_977_418,
    longitude: 85_455_938,
    altitude: 488_000,
};

fn at(north: f32, east: f32) -> Vector3 {
    Vector3::new(north, east, -30.0)
}

/// An item at north and east of home, m.
fn item(command: u16, param: f32, north: f32, east: f32) -> MissionItem {
    let place = LocalFrame::new(HOME).to_global(Vector3::new(north, east, 0.0));
    MissionItem {
        command,
        frame: 0,
        autocontinue: true,
        params: [param, 0.0, 0.0, 0.0],
        x: place.latitude,
        y: place.longitude,
        z: 0.0,
    }
}

fn polygon(inclusion: bool, vertices: &[(f32, f32)]) -> Vec<MissionItem> {
    let command = if inclusion {
        command::POLYGON_VERTEX_INCLUSION
    } else {
        command::POLYGON_VERTEX_EXCLUSION
    };
    let count = vertices.len() as f32;
    let vertex = |&(north, east): &(f32, f32)| item(command, count, north, east);
    vertices.iter().map(vertex).collect()
}

fn circle(inclusion: bool, north: f32, east: f32, radius: f32) -> MissionItem {
    let command = if inclusion {
        command::CIRCLE_INCLUSION
    } else {
        command::CIRCLE_EXCLUSION
    };
    item(command, radius, north, east)
}

fn rectangle(inclusion: bool, north: (f32, f32), east: (f32, f32)) -> Vec<MissionItem> {
    polygon(
        inclusion,
        &[
            (north.0, east.0),
            (north.1, east.0),
            (north.1, east.1),
            (north.0, east.1),
        ],
    )
}

fn compile(items: &[MissionItem]) -> Result<Fence, (u16, FenceRefusal)> {
    let plans = Plans {
        fence: items,
        ..Plans::default()
    };
    let count = items.len() as u16;
    let compiled = Fence::compile(&plans, 0, count, &LocalFrame::new(HOME));
    let checked = check(&plans, 0, count);
    assert_eq!(
        compiled.as_ref().map(|_| ()).map_err(|r| r.0),
        checked.map_err(|r| r.0)
    );
    compiled
}

fn fence(shapes: &[&[MissionItem]]) -> Fence {
    compile(&shapes.concat()).unwrap()
}

/// A fence with exactly these coordinates, which no place on Earth has.
fn exact(shapes: &[(bool, &[(f32, f32)])]) -> Fence {
    let mut fence = Fence::default();
    for (inclusion, vertices) in shapes {
        let first = fence.vertices.len();
        let points = vertices.iter().map(|&(north, east)| Point::new(north, east));
        fence.vertices.extend(points);
        if shape::doubled_area(&fence.vertices[first..]) < 0.0 {
            fence.vertices[first..].reverse();
        }
        let form = Form::Polygon {
            first,
            count: vertices.len(),
        };
        let inclusion = *inclusion;
        fence.shapes.push(Shape { inclusion, form }).unwrap();
    }
    assert!(fence.find_corners().is_ok());
    fence
}
