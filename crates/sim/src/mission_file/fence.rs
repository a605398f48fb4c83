//! The geofence and the rally points of a plan, as the items that QGroundControl uploads: the
//! vertices of polygons, circles and the return point after a breach, in this order (its
//! `GeoFenceManager`), and rally points with heights above home (its `RallyPointManager`).

use windhover_autopilot::fence::items::command;
use windhover_autopilot::fence::{MAX_RALLY, MAX_SHAPES, MAX_VERTICES};

use super::MissionFile;
use super::convert::{self, RawItem};
use super::error::{Place, Problem};
use super::json::Json;
use super::plan::Node;

/// MAVLink's frames with heights above the sea, and above home.
const GLOBAL: u8 = 0;
const GLOBAL_RELATIVE: u8 = 3;

/// Reads `geoFence`; absent, null and an empty one of an old format all say that there is none.
pub(super) fn fence(top: &Node, file: &mut MissionFile) -> Result<(), Problem> {
    let is_empty = |json: &Json| {
        let no_return = matches!(json.get("breachReturn"), None | Some(Json::Null));
        no_return && are_empty(json, &["polygons", "circles", "polygon"])
    };
    let Some(section) = section(top, "geoFence", is_empty)? else {
        return Ok(());
    };
    let [polygons, circles] = [section.list("polygons")?, section.list("circles")?];
    let shapes = polygons.1 + circles.1;
    if shapes > MAX_SHAPES {
        return Err(too_many(shapes, MAX_SHAPES, "shapes in its geofence"));
    }
    for (index, json) in polygons.0.iter().enumerate() {
        let number = index + 1;
        polygon(&Node::new(json, Place::Polygon(number)), number, file)?;
    }
    for (index, json) in circles.0.iter().enumerate() {
        circle(&Node::new(json, Place::Circle(index + 1)), file)?;
    }
    match section.json.get("breachReturn") {
        None | Some(Json::Null) => Ok(()),
        Some(json) => breach_return(&Node::new(json, Place::BreachReturn), file),
    }
}

/// Reads `rallyPoints`.
pub(super) fn rally(top: &Node, file: &mut MissionFile) -> Result<(), Problem> {
    let Some(section) = section(top, "rallyPoints", |json| are_empty(json, &["points"]))? else {
        return Ok(());
    };
    let (points, count) = section.list("points")?;
    if count > MAX_RALLY {
        return Err(too_many(count, MAX_RALLY, "rally points"));
    }
    for (index, json) in points.iter().enumerate() {
        let node = Node::new(json, Place::Rally(index + 1));
        let [latitude, longitude, height] = node.position("position", json, true)?;
        let raw = RawItem {
            command: command::RALLY_POINT,
            frame: GLOBAL_RELATIVE,
            autocontinue: false,
            params: [0.0, 0.0, 0.0, 0.0, latitude, longitude, height],
        };
        file.rally.push(convert::item(&raw, &node.place)?);
    }
    Ok(())
}

/// A part of the plan beside its mission, unless it is empty: version 2 of it. A fence in a format
/// that is not read must not be left out without a word.
fn section<'a>(
    top: &Node<'a>,
    name: &str,
    is_empty: impl Fn(&Json) -> bool,
) -> Result<Option<Node<'a>>, Problem> {
    let json = match top.json.get(name) {
        None | Some(Json::Null) => return Ok(None),
        Some(json @ Json::Object(_)) => json,
        Some(other) => return Err(top.wrong(name, other, "an object")),
    };
    if is_empty(json) {
        return Ok(None);
    }
    let node = Node::new(json, Place::File);
    node.version("version", &format!("{name} version"), &[2.0], "version 2")?;
    Ok(Some(node))
}

fn are_empty(json: &Json, lists: &[&str]) -> bool {
    lists.iter().all(|list| match json.get(list) {
        None | Some(Json::Null) => true,
        Some(Json::List { len, .. }) => *len == 0,
        Some(_) => false,
    })
}

fn polygon(node: &Node, polygon: usize, file: &mut MissionFile) -> Result<(), Problem> {
    shape_version(node)?;
    let inclusion = node.boolean("inclusion")?;
    let (vertices, count) = node.list("polygon")?;
    if count < 3 {
        return Err(Problem::TooFewVertices {
            place: Box::new(node.place.clone()),
            count,
        });
    }
    // Polygons are read first.
    let all = count + file.fence.len();
    if all > MAX_VERTICES {
        return Err(too_many(all, MAX_VERTICES, "vertices in its geofence"));
    }
    for (index, json) in vertices.iter().enumerate() {
        let vertex = index + 1;
        let node = Node::new(json, Place::Vertex { polygon, vertex });
        let command = if inclusion {
            command::POLYGON_VERTEX_INCLUSION
        } else {
            command::POLYGON_VERTEX_EXCLUSION
        };
        let [latitude, longitude, _] = node.position("position", json, false)?;
        file.push_fence(
            RawItem {
                command,
                frame: GLOBAL,
                autocontinue: false,
                params: [count as f64, 0.0, 0.0, 0.0, latitude, longitude, 0.0],
            },
            node.place,
        )?;
    }
    Ok(())
}

fn circle(node: &Node, file: &mut MissionFile) -> Result<(), Problem> {
    shape_version(node)?;
    let inclusion = node.boolean("inclusion")?;
    let inner = Node::new(node.need("circle")?, node.place.clone());
    let centre = inner.need("center")?;
    let [latitude, longitude, _] = inner.position("position", centre, false)?;
    let radius = match inner.need("radius")? {
        Json::Number(radius) => *radius,
        other => return Err(inner.wrong("radius", other, "a number")),
    };
    let command = if inclusion {
        command::CIRCLE_INCLUSION
    } else {
        command::CIRCLE_EXCLUSION
    };
    let raw = RawItem {
        command,
        frame: GLOBAL,
        autocontinue: false,
        params: [radius, 0.0, 0.0, 0.0, latitude, longitude, 0.0],
    };
    file.push_fence(raw, inner.place)
}

/// Uploaded as any other item; a return leads home or to a rally point all the same.
fn breach_return(node: &Node, file: &mut MissionFile) -> Result<(), Problem> {
    let [latitude, longitude, height] = node.position("position", node.json, true)?;
    let note = "the plan's breach return point is not used: a return leads home or to a rally point";
    file.notes.push(note.into());
    let raw = RawItem {
        command: command::RETURN_POINT,
        frame: GLOBAL_RELATIVE,
        autocontinue: false,
        params: [0.0, 0.0, 0.0, 0.0, latitude, longitude, height],
    };
    file.push_fence(raw, node.place.clone())
}

/// The version of one polygon or circle; older plans have none.
fn shape_version(node: &Node) -> Result<(), Problem> {
    match node.json.get("version") {
        None => Ok(()),
        Some(_) => node.version("version", "version", &[1.0], "version 1"),
    }
}

fn too_many(count: usize, most: usize, what: &'static str) -> Problem {
    Problem::TooMany { count, most, what }
}
