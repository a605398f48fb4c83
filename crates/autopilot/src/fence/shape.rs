//! Outlines in the plane: what lies within them, where a segment crosses them, how far they are.
//!
//! Points are north and east in m. Everything is computed relative to the point that is asked
//! about, so that rounding stays at a millimetre 10 km from home. Which side of an edge a point
//! lies on is the sign of one product whose factors always come in the same order: two polygons
//! that share an edge share what lies on it, each point to one of them.

use windhover_math::sqrt;

/// North and east, m.
pub(super) type Point = nalgebra::Vector2<f32>;

/// What is thinner than this counts as not there, m. Vertices come in steps of 1.1 cm.
pub(super) const HAIR: f32 = 0.01;

/// The outline of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outline<'a> {
    /// Its corners, clockwise seen from above: the inside lies to the right of each edge.
    Polygon(&'a [Point]),
    /// A circle.
    Circle {
        /// Its middle.
        centre: Point,
        /// Its radius, m.
        radius: f32,
    },
}

/// Each edge of a polygon: where it begins, and the way to its end.
pub(super) fn edges(vertices: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    let last = vertices.last().copied().unwrap_or_default();
    vertices.iter().scan(last, |previous, vertex| {
        let from = core::mem::replace(previous, *vertex);
        Some((from, vertex - from))
    })
}

/// Twice the area of a polygon, m²; negative when its corners come in the other order.
pub(super) fn doubled_area(vertices: &[Point]) -> f32 {
    let first = vertices.first().copied().unwrap_or_default();
    edges(vertices)
        .map(|(from, along)| (from - first).perp(&along))
        .sum()
}

/// Square of the length.
pub(super) fn squared(v: Point) -> f32 {
    v.x * v.x + v.y * v.y
}

/// Length.
pub(super) fn length(v: Point) -> f32 {
    sqrt(squared(v))
}

/// Whether the edge between two points, seen from the origin, is crossed by the way west.
#[inline(always)]
fn crosses_west(a: Point, b: Point) -> bool {
    if (a.x > 0.0) == (b.x > 0.0) {
        return false;
    }
    let (low, high) = if a.x > b.x { (b, a) } else { (a, b) };
    low.perp(&high) > 0.0
}

/// The direction of a vector; that of nothing is nothing.
pub(super) fn unit(v: Point) -> Point {
    let length = length(v);
    if length > 0.0 { v / length } else { v }
}

/// The last vertex but one, and the last.
fn last_two(vertices: &[Point]) -> [Point; 2] {
    match vertices {
        [.., before, last] => [*before, *last],
        _ => [Point::zeros(); 2],
    }
}

/// The way out of a polygon across an edge, of the edge's length.
pub(super) fn outward(along: Point) -> Point {
    Point::new(along.y, -along.x)
}

/// The least of distances that were offered, as a square.
struct Nearest(f32);

impl Nearest {
    /// Takes a distance if it is less and what it leads to is `visible`, which is asked last.
    #[inline(always)]
    fn offer(&mut self, square: f32, visible: impl FnOnce() -> bool) {
        if square < self.0 && visible() {
            self.0 = square;
        }
    }
}

impl Outline<'_> {
    /// Whether a point lies within.
    pub fn contains(&self, point: Point) -> bool {
        match *self {
            Self::Polygon(vertices) => {
                let mut inside = false;
                let mut a = vertices.last().copied().unwrap_or_default() - point;
                for vertex in vertices {
                    let b = vertex - point;
                    inside ^= crosses_west(a, b);
                    a = b;
                }
                inside
            }
            Self::Circle { centre, radius } => squared(point - centre) <= radius * radius,
        }
    }

    /// Whether a point lies within, and the square of its distance from the outline, in m². Only
    /// those places of the outline count that are visible: `visible` is given the place and the
    /// direction out of the shape there. `f32::MAX` if none is.
    pub fn measure(&self, point: Point, visible: impl Fn(Point, Point) -> bool) -> (bool, f32) {
        let mut nearest = Nearest(f32::MAX);
        match *self {
            Self::Polygon(vertices) => {
                let mut inside = false;
                let [before, last] = last_two(vertices);
                let (mut a, mut before) = (last - point, last - before);
                for vertex in vertices {
                    let b = vertex - point;
                    let along = b - a;
                    inside ^= crosses_west(a, b);
                    let (part, whole) = (-a.dot(&along), squared(along));
                    // Beyond the end the next edge is nearer, or as near with its beginning.
                    if part < whole {
                        let share = if part > 0.0 { part / whole } else { 0.0 };
                        let foot = a + along * share;
                        nearest.offer(squared(foot), || {
                            let out = unit(outward(along));
                            let at_corner = unit(outward(before)) + out;
                            visible(point + foot, if share > 0.0 { out } else { unit(at_corner) })
                        });
                    }
                    (a, before) = (b, along);
                }
                (inside, nearest.0)
            }
            Self::Circle { centre, radius } => {
                let out = point - centre;
                let distance = length(out);
                let rest = radius - distance;
                // From the very middle every place is as near as any other: north.
                let out = if distance > 0.0 {
                    out * (radius / distance)
                } else {
                    Point::new(radius, 0.0)
                };
                nearest.offer(rest * rest, || visible(centre + out, out / radius));
                (distance <= radius, nearest.0)
            }
        }
    }

    /// Gives every share of the way from `from` along `way` at which the outline is crossed,
    /// in no order. Where the way touches without crossing it may be given or not.
    pub fn crossings(&self, from: Point, way: Point, mut found: impl FnMut(f32)) {
        match *self {
            Self::Polygon(vertices) => {
                let mut a = vertices.last().copied().unwrap_or_default() - from;
                let mut side_a = way.perp(&a);
                for vertex in vertices {
                    let b = vertex - from;
                    let side_b = way.perp(&b);
                    let apart = (side_a > 0.0 && side_b > 0.0) || (side_a < 0.0 && side_b < 0.0);
                    let along = b - a;
                    let across = way.perp(&along);
                    if !apart && across != 0.0 {
                        found(a.perp(&along) / across);
                    }
                    (a, side_a) = (b, side_b);
                }
            }
            Self::Circle { centre, radius } => circle_crossings(centre - from, radius, way, found),
        }
    }
}

/// Shares of the way from the origin along `way` at which a circle is crossed.
pub(super) fn circle_crossings(centre: Point, radius: f32, way: Point, mut found: impl FnMut(f32)) {
    let square = squared(way);
    if square > 0.0 {
        let foot = centre.dot(&way) / square;
        let rest = radius * radius - squared(centre - way * foot);
        if rest > 0.0 {
            let half = sqrt(rest / square);
            found(foot - half);
            found(foot + half);
        }
    }
}

/// Whether two segments, each a point and the way to its end, have a point in common.
pub(super) fn meet(first: (Point, Point), second: (Point, Point)) -> bool {
    let ((a, along_a), (b, along_b)) = (first, second);
    let gap = b - a;
    let overlap = |gap: f32, a: f32, b: f32| {
        let (low_a, high_a) = if a < 0.0 { (a, 0.0) } else { (0.0, a) };
        let (low_b, high_b) = if b < 0.0 { (gap + b, gap) } else { (gap, gap + b) };
        low_a <= high_b && low_b <= high_a
    };
    let differ = |x: f32, y: f32| (x <= 0.0 && y >= 0.0) || (x >= 0.0 && y <= 0.0);
    overlap(gap.x, along_a.x, along_b.x)
        && overlap(gap.y, along_a.y, along_b.y)
        && differ(along_a.perp(&gap), along_a.perp(&(gap + along_b)))
        && differ(along_b.perp(&-gap), along_b.perp(&(along_a - gap)))
}
