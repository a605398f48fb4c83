//! How far it is to the fence.
//!
//! The outline of several inclusions that overlap is not the outlines of each: what lies within
//! another one is no boundary. From a point inside, the nearest place of an edge counts if what is
//! just outside of it is in no other inclusion. Where that is so, the nearest place of the edge
//! that does count lies where it comes out of the other inclusion: such crossings are found once,
//! when the fence is compiled.

use windhover_math::{Vector3, max, min, sqrt};

use super::shape::{HAIR, Outline, Point, circle_crossings, edges, length, outward, squared, unit};
use super::{Fence, ground};

/// How far beside an outline it is looked whether another inclusion is there, m.
const NUDGES: [f32; 4] = [HAIR, 0.5 * HAIR, 0.25 * HAIR, 0.125 * HAIR];

/// There are more crossings than are kept: this inclusion, counted among inclusions, has the first
/// that is one too many.
#[derive(Clone, Copy)]
pub(super) struct TooManyCrossings(pub usize);

impl Fence {
    /// Signed distance of a position, NED in m, from the nearest place of the fence: positive
    /// inside; outside the negative way that is left to get out of the worst breach. `f32::MAX`
    /// without shapes.
    ///
    /// Where exclusions overlap one another or the fence's edge, the way back inside may be
    /// longer than said.
    pub fn clearance(&self, position: Vector3) -> f32 {
        let point = ground(position);
        let mut clearance = self.inside_clearance(point);
        for outline in self.outlines(false) {
            let (inside, square) = outline.measure(point, |_, _| true);
            let distance = sqrt(square);
            clearance = min(clearance, if inside { -distance } else { distance });
        }
        clearance
    }

    /// The same for the inclusions alone.
    fn inside_clearance(&self, point: Point) -> f32 {
        let several = self.outlines(true).nth(1).is_some();
        let (mut bounded, mut inside) = (false, false);
        let mut least = f32::MAX;
        for (index, outline) in self.outlines(true).enumerate() {
            let (within, square) = if several {
                outline.measure(point, |place, out| self.is_free(index, outline, place, out))
            } else {
                outline.measure(point, |_, _| true)
            };
            bounded = true;
            inside |= within;
            least = min(least, square);
        }
        if !bounded {
            return f32::MAX;
        }
        for corner in &self.corners {
            least = min(least, squared(corner - point));
        }
        if inside { sqrt(least) } else { -sqrt(least) }
    }

    /// Whether what lies just outside of an inclusion, at a place of its outline, is in no other
    /// one. Where the inclusion itself lies just across, as in a notch that narrows, it is looked
    /// nearer by.
    fn is_free(&self, index: usize, own: Outline<'_>, place: Point, out: Point) -> bool {
        for nudge in NUDGES {
            let beside = place + out * nudge;
            let mut others = self.outlines(true).enumerate();
            if others.any(|(other, outline)| other != index && outline.contains(beside)) {
                return false;
            }
            if !own.contains(beside) {
                return true;
            }
        }
        false
    }

    /// Whether something just beside a point, in the direction out of two inclusions that cross
    /// there, is in none.
    fn is_corner(&self, point: Point, out: Point) -> bool {
        let included = |point| self.outlines(true).any(|outline| outline.contains(point));
        NUDGES.iter().any(|nudge| !included(point + out * *nudge))
    }

    /// Finds the inner corners, once all shapes are there.
    pub(super) fn find_corners(&mut self) -> Result<(), TooManyCrossings> {
        let mut corners = core::mem::take(&mut self.corners);
        let mut found = Ok(());
        for (index, first) in self.outlines(true).enumerate() {
            for (other, second) in self.outlines(true).enumerate().skip(index + 1) {
                crossings(first, second, |corner, out| {
                    let near = |known: &Point| squared(known - corner) < HAIR * HAIR;
                    if self.is_corner(corner, unit(out)) && !corners.iter().any(near) {
                        found = found.and(corners.push(corner).map_err(|_| TooManyCrossings(other)));
                    }
                });
            }
        }
        self.corners = corners;
        found
    }
}

/// Gives every point where two outlines cross, with a direction that leads out of both.
fn crossings(first: Outline<'_>, second: Outline<'_>, mut found: impl FnMut(Point, Point)) {
    match (first, second) {
        (Outline::Polygon(first), Outline::Polygon(second)) => {
            for edge in edges(first) {
                for other in edges(second) {
                    if let Some(point) = edges_cross(edge, other) {
                        found(point, unit(outward(edge.1)) + unit(outward(other.1)));
                    }
                }
            }
        }
        (Outline::Polygon(vertices), Outline::Circle { centre, radius })
        | (Outline::Circle { centre, radius }, Outline::Polygon(vertices)) => {
            for (from, along) in edges(vertices) {
                circle_crossings(centre - from, radius, along, |share| {
                    if on_edge(share, along) {
                        let point = from + along * share;
                        found(point, unit(outward(along)) + unit(point - centre));
                    }
                });
            }
        }
        (
            Outline::Circle { centre, radius },
            Outline::Circle {
                centre: other,
                radius: other_radius,
            },
        ) => circles_cross((centre, radius), (other, other_radius), found),
    }
}

/// Where two edges cross; parallel ones do not.
fn edges_cross(first: (Point, Point), second: (Point, Point)) -> Option<Point> {
    let ((a, along_a), (b, along_b)) = (first, second);
    let across = along_a.perp(&along_b);
    if across == 0.0 {
        return None;
    }
    let gap = b - a;
    let (share_a, share_b) = (gap.perp(&along_b) / across, gap.perp(&along_a) / across);
    (on_edge(share_a, along_a) && on_edge(share_b, along_b)).then(|| a + along_a * share_a)
}

/// Whether a share of an edge lies on it, a hair beyond its ends included: a corner of one polygon
/// on the edge of another must not slip through.
fn on_edge(share: f32, along: Point) -> bool {
    let slack = HAIR / max(length(along), HAIR);
    share >= -slack && share <= 1.0 + slack
}

/// Where two circles cross, each a middle and a radius.
fn circles_cross(first: (Point, f32), second: (Point, f32), mut found: impl FnMut(Point, Point)) {
    let ((centre, radius), (other, other_radius)) = (first, second);
    let way = other - centre;
    let distance = length(way);
    if distance < HAIR {
        return;
    }
    // How far from the first middle the line through both crossings lies.
    let foot = 0.5 * (distance + (radius - other_radius) * (radius + other_radius) / distance);
    let rest = (radius - foot) * (radius + foot);
    if rest < 0.0 {
        return;
    }
    let ahead = way * (foot / distance);
    let aside = outward(way) * (sqrt(rest) / distance);
    for point in [centre + ahead + aside, centre + ahead - aside] {
        found(point, unit(point - centre) + unit(point - other));
    }
}
