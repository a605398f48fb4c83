//! What the items of a fence mean, and why a fence is refused.
//!
//! A polygon comes as one item a vertex, each of which says how many vertices there are; a circle
//! is one item with its radius. The return point of old ground stations is taken and not used.

use core::fmt;

use heapless::Vec;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};

use super::boundary::TooManyCrossings;
use super::shape::{Point, doubled_area, edges, meet};
use super::{Fence, Form, MAX_CROSSINGS, MAX_SHAPES, MAX_VERTICES, Shape, ground};
use crate::mission::action::{Refusal, place};
use crate::mission::{MissionItem, MissionSource, PlanKind};

/// Numbers of the `MAV_CMD`s of fences and rally points.
pub mod command {
    #![allow(missing_docs)]
    pub const RETURN_POINT: u16 = 5000;
    pub const POLYGON_VERTEX_INCLUSION: u16 = 5001;
    pub const POLYGON_VERTEX_EXCLUSION: u16 = 5002;
    pub const CIRCLE_INCLUSION: u16 = 5003;
    pub const CIRCLE_EXCLUSION: u16 = 5004;
    pub const RALLY_POINT: u16 = 5100;
}

/// The smallest area of a polygon, m²: less is a slip of the hand.
const SMALLEST_AREA: u16 = 4;

/// Why an item of a fence, or a rally point, is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FenceRefusal {
    /// The command belongs to neither.
    Command(u16),
    /// The item has no place that is understood.
    Place(Refusal),
    /// The item is not in storage, though the plan should have it.
    Missing,
    /// The polygon has fewer than three vertices.
    TooFewVertices,
    /// The polygon is to have so many vertices, and another number follow one another.
    VertexCount {
        /// As the first vertex says; NaN says unset.
        said: f32,
        /// So many alike follow one another, up to that number.
        found: u16,
    },
    /// There are more vertices than are stored.
    TooManyVertices,
    /// There are more shapes than are stored.
    TooManyShapes,
    /// The outlines of inclusions cross more often than is stored.
    TooManyCrossings,
    /// The radius of the circle, in m, is out of range.
    Radius(f32),
    /// The outline of the polygon crosses or touches itself.
    SelfCrossing,
    /// The polygon has this area, m².
    Small(f32),
    /// There are more rally points than are stored.
    TooManyRallyPoints,
}

impl fmt::Display for FenceRefusal {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Command(command) => write!(f, "command: {command} is not understood here"),
            Self::Place(ref refusal) => write!(f, "{refusal}"),
            Self::Missing => f.write_str("fence: the item is missing; send the plan again"),
            Self::TooFewVertices => f.write_str("polygon: fewer than 3 vertices; add some, or remove it"),
            // Whole numbers: writing floats costs more flash than they tell.
            Self::VertexCount { said, found } => {
                let said = said as i32;
                write!(
                    f,
                    "polygon: {said} vertices announced, {found} found; send the plan again"
                )
            }
            Self::TooManyVertices => {
                write!(
                    f,
                    "polygon: the vehicle stores {MAX_VERTICES} vertices in all; use fewer"
                )
            }
            Self::TooManyShapes => write!(f, "fence: the vehicle stores {MAX_SHAPES} shapes; use fewer"),
            Self::TooManyCrossings => {
                write!(
                    f,
                    "fence: inclusions cross more than {MAX_CROSSINGS} times; join them into one"
                )
            }
            Self::Radius(radius) => {
                let radius = radius as i32;
                write!(f, "circle: a radius of {radius} m is outside 1 to 10000")
            }
            Self::SelfCrossing => f.write_str("polygon: crosses or touches itself; move its vertices apart"),
            Self::Small(area) => {
                let area = area as i32;
                write!(
                    f,
                    "polygon: {area} m^2 is too small, {SMALLEST_AREA} is the least; enlarge it"
                )
            }
            Self::TooManyRallyPoints => {
                let max = super::MAX_RALLY;
                write!(f, "rally point: the vehicle stores {max}; use fewer")
            }
        }
    }
}

/// Refuses a fence before it is accepted, when home need not be known yet.
pub fn check<S: MissionSource + ?Sized>(source: &S, slot: u8, count: u16) -> Result<(), (u16, FenceRefusal)> {
    // Any place of the fence does for its geometry.
    let (x, y) = source
        .item(PlanKind::Fence, slot, 0)
        .map_or((0, 0), |item| (item.x, item.y));
    let frame = LocalFrame::new(GlobalPosition {
        latitude: x,
        longitude: y,
        altitude: 0,
    });
    compile(source, slot, count, &frame).map(|_| ())
}

/// A fence while it is compiled.
struct Reader<'a, S: ?Sized> {
    source: &'a S,
    slot: u8,
    count: u16,
    frame: &'a LocalFrame,
    fence: Fence,
    /// The items with which inclusions begin.
    inclusions: Vec<u16, MAX_SHAPES>,
}

/// See [`Fence::compile`].
pub(super) fn compile<S: MissionSource + ?Sized>(
    source: &S,
    slot: u8,
    count: u16,
    frame: &LocalFrame,
) -> Result<Fence, (u16, FenceRefusal)> {
    let mut reader = Reader {
        source,
        slot,
        count,
        frame,
        fence: Fence::default(),
        inclusions: Vec::new(),
    };
    let mut index = 0;
    while index < count {
        let taken = reader.shape(index).map_err(|refusal| (index, refusal))?;
        index = index.saturating_add(taken);
    }
    let heads = reader.inclusions;
    let refuse = |TooManyCrossings(inclusion)| {
        let head = heads.get(inclusion).copied().unwrap_or_default();
        (head, FenceRefusal::TooManyCrossings)
    };
    reader.fence.find_corners().map_err(refuse)?;
    Ok(reader.fence)
}

impl<S: MissionSource + ?Sized> Reader<'_, S> {
    /// Adds the shape that begins with an item; how many items it has.
    fn shape(&mut self, index: u16) -> Result<u16, FenceRefusal> {
        let head = self.item(index).ok_or(FenceRefusal::Missing)?;
        let (inclusion, (form, taken)) = match head.command {
            command::RETURN_POINT => return Ok(1),
            command::POLYGON_VERTEX_INCLUSION => (true, self.polygon(index, &head)?),
            command::POLYGON_VERTEX_EXCLUSION => (false, self.polygon(index, &head)?),
            command::CIRCLE_INCLUSION => (true, (self.circle(&head)?, 1)),
            command::CIRCLE_EXCLUSION => (false, (self.circle(&head)?, 1)),
            other => return Err(FenceRefusal::Command(other)),
        };
        let shape = Shape { inclusion, form };
        let room = self.fence.shapes.push(shape);
        room.map_err(|_| FenceRefusal::TooManyShapes)?;
        if inclusion {
            let _ = self.inclusions.push(index);
        }
        Ok(taken)
    }

    fn item(&self, index: u16) -> Option<MissionItem> {
        if index >= self.count {
            return None;
        }
        self.source.item(PlanKind::Fence, self.slot, index)
    }

    /// Where an item is; its altitude means nothing.
    fn point(&self, item: &MissionItem) -> Result<Point, FenceRefusal> {
        let grounded = MissionItem { z: 0.0, ..*item };
        let place = place(&grounded).map_err(FenceRefusal::Place)?;
        Ok(ground(place.over_ground(self.frame)))
    }

    fn circle(&self, item: &MissionItem) -> Result<Form, FenceRefusal> {
        let [radius, ..] = item.params;
        if !(1.0..=10_000.0).contains(&radius) {
            return Err(FenceRefusal::Radius(radius));
        }
        let centre = self.point(item)?;
        Ok(Form::Circle { centre, radius })
    }

    /// Adds the vertices of the polygon that begins with the item `head`.
    fn polygon(&mut self, index: u16, head: &MissionItem) -> Result<(Form, u16), FenceRefusal> {
        let count = self.vertex_count(index, head)?;
        let first = self.fence.vertices.len();
        for offset in 0..count {
            let item = self
                .item(index.saturating_add(offset))
                .ok_or(FenceRefusal::Missing)?;
            let point = self.point(&item)?;
            let room = self.fence.vertices.push(point);
            room.map_err(|_| FenceRefusal::TooManyVertices)?;
        }
        let added = self.fence.vertices.get_mut(first..).unwrap_or_default();
        let distinct = without_repeats(added);
        self.fence.vertices.truncate(first + distinct);
        let added = self.fence.vertices.get_mut(first..).unwrap_or_default();
        check_polygon(added)?;
        if doubled_area(added) < 0.0 {
            added.reverse();
        }
        let form = Form::Polygon {
            first,
            count: distinct,
        };
        Ok((form, count))
    }

    /// How many vertices the polygon has, when that many alike do follow one another.
    fn vertex_count(&self, index: u16, head: &MissionItem) -> Result<u16, FenceRefusal> {
        let [said, ..] = head.params;
        let count = said as u16;
        if f32::from(count) != said {
            return Err(FenceRefusal::VertexCount { said, found: 0 });
        }
        if count < 3 {
            return Err(FenceRefusal::TooFewVertices);
        }
        if usize::from(count) > MAX_VERTICES {
            return Err(FenceRefusal::TooManyVertices);
        }
        let alike = |offset: &u16| {
            let item = self.item(index.saturating_add(*offset));
            item.is_some_and(|item| item.command == head.command && item.params.first() == Some(&said))
        };
        let found = (0..count).take_while(alike).count() as u16;
        if found < count {
            return Err(FenceRefusal::VertexCount { said, found });
        }
        Ok(count)
    }
}

/// Moves to the front what differs from the point before it, the last being before the first; how
/// many these are.
fn without_repeats(points: &mut [Point]) -> usize {
    let mut kept = 0;
    let mut previous = points.last().copied();
    for index in 0..points.len() {
        let Some(point) = points.get(index).copied() else {
            continue;
        };
        if previous != Some(point)
            && let Some(place) = points.get_mut(kept)
        {
            *place = point;
            kept += 1;
        }
        previous = Some(point);
    }
    kept
}

fn check_polygon(vertices: &[Point]) -> Result<(), FenceRefusal> {
    let count = vertices.len();
    if count < 3 {
        return Err(FenceRefusal::TooFewVertices);
    }
    for (index, edge) in edges(vertices).enumerate() {
        // Neighbours have a vertex in common, the first edge and the last one too.
        let others = edges(vertices).enumerate().skip(index + 2);
        for (other, against) in others {
            if other - index < count - 1 && meet(edge, against) {
                return Err(FenceRefusal::SelfCrossing);
            }
        }
    }
    let area = 0.5 * doubled_area(vertices).abs();
    if area < f32::from(SMALLEST_AREA) {
        return Err(FenceRefusal::Small(area));
    }
    Ok(())
}
