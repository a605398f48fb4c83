//! Where the vehicle may fly, and where it returns to: geofence and rally points.
//!
//! A fence is uploaded as items like a mission's (`common.xml`): polygons and circles, each of
//! which is to be flown in (an *inclusion*) or not to be flown in (an *exclusion*). A place is
//! inside when it lies in at least one inclusion, if there are any, and in no exclusion. Besides,
//! two parameters limit distance and height. Every shape reaches from the ground to the sky.
//!
//! [`items`] reads the items and says why they are refused. [`Fence`] holds the shapes in metres
//! of the local frame; [`watch`] asks it in flight, and foresees where the vehicle comes to rest;
//! [`mission`] asks it about a whole mission before that is accepted. [`Rally`] holds the places
//! to return to that lie nearer than home. What follows from a breach is decided elsewhere.

mod boundary;
pub mod items;
pub mod mission;
pub mod parameters;
pub mod rally;
mod shape;
pub mod watch;

#[cfg(test)]
mod tests;

use heapless::Vec;
use windhover_math::geodesy::LocalFrame;
use windhover_math::{Vector3, max, min};

use crate::mission::MissionSource;
use shape::{HAIR, Outline, Point};

pub use items::{FenceRefusal, check};
pub use mission::check_mission;
pub use parameters::{FenceAction, FenceParameters};
pub use rally::{MAX_RALLY, Rally, RallyPoint};
pub use watch::{Breach, BreachKind};

/// The most vertices that all polygons of a fence have together.
pub const MAX_VERTICES: usize = 84;

/// The most shapes of a fence.
pub const MAX_SHAPES: usize = 16;

/// The most places where the outlines of inclusions cross on the fence's own outline.
pub const MAX_CROSSINGS: usize = 64;

/// A fence in the local frame. Without shapes everything is inside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fence {
    vertices: Vec<Point, MAX_VERTICES>,
    shapes: Vec<Shape, MAX_SHAPES>,
    /// Where outlines of two inclusions cross and something next to it is outside of all: the
    /// inner corners of the fence.
    corners: Vec<Point, MAX_CROSSINGS>,
}

/// One polygon or circle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    inclusion: bool,
    form: Form,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// So many of the fence's vertices, from this one on.
    Polygon { first: usize, count: usize },
    /// A circle, m.
    Circle { centre: Point, radius: f32 },
}

/// North and east of a position.
fn ground(position: Vector3) -> Point {
    Point::new(position.x, position.y)
}

impl Fence {
    /// The fence of the `count` items in a slot, in metres of `frame`; or the item, counted from 0,
    /// for which it is refused.
    pub fn compile<S: MissionSource + ?Sized>(
        source: &S,
        slot: u8,
        count: u16,
        frame: &LocalFrame,
    ) -> Result<Self, (u16, FenceRefusal)> {
        items::compile(source, slot, count, frame)
    }

    /// Whether there are no shapes.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    fn outline(&self, shape: &Shape) -> Outline<'_> {
        match shape.form {
            Form::Polygon { first, count } => {
                Outline::Polygon(self.vertices.get(first..first + count).unwrap_or_default())
            }
            Form::Circle { centre, radius } => Outline::Circle { centre, radius },
        }
    }

    /// The outlines of all inclusions, or of all exclusions.
    fn outlines(&self, inclusion: bool) -> impl Iterator<Item = Outline<'_>> {
        let shapes = self
            .shapes
            .iter()
            .filter(move |shape| shape.inclusion == inclusion);
        shapes.map(|shape| self.outline(shape))
    }

    /// Whether a position, NED in m, is inside. On an outline it may be either, but what two
    /// inclusions share is inside.
    pub fn is_inside(&self, position: Vector3) -> bool {
        self.breach_at(ground(position)).is_none()
    }

    /// What is wrong with a point.
    fn breach_at(&self, point: Point) -> Option<BreachKind> {
        let mut bounded = false;
        let mut inside = false;
        for shape in &self.shapes {
            if inside && shape.inclusion {
                continue;
            }
            let within = self.outline(shape).contains(point);
            if within && !shape.inclusion {
                return Some(BreachKind::Exclusion);
            }
            bounded |= shape.inclusion;
            inside |= within && shape.inclusion;
        }
        (bounded && !inside).then_some(BreachKind::Boundary)
    }

    /// What the way to a point meets first of what lies outside of the fence. It is cut where it
    /// crosses outlines: a piece between two cuts is inside or outside as a whole.
    fn breach_ahead(&self, from: Point, to: Point) -> Option<BreachKind> {
        let way = to - from;
        // An edge is crossed once, a circle twice; the end is the last cut.
        let mut cuts: Vec<f32, { MAX_VERTICES + 2 * MAX_SHAPES }> = Vec::new();
        for shape in &self.shapes {
            self.outline(shape).crossings(from, way, |share| {
                if share > 0.0 && share < 1.0 {
                    let _ = cuts.push(share);
                }
            });
        }
        let hair = HAIR / max(shape::length(way), HAIR);
        let mut begin = 0.0;
        while begin < 1.0 {
            let later = cuts.iter().filter(|cut| **cut > begin);
            let end = later.fold(1.0, |least, cut| min(least, *cut));
            if end - begin > hair
                && let Some(kind) = self.breach_at(from + way * (0.5 * (begin + end)))
            {
                return Some(kind);
            }
            begin = end;
        }
        self.breach_at(to)
    }
}
