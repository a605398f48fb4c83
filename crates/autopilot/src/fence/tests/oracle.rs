//! Brute force in double precision, and fences at random.

use proptest::prelude::*;

use super::*;

type Plane = (f64, f64);

/// A shape as the fence has stored it.
pub enum Ideal {
    Polygon(Vec<Plane>),
    Circle(Plane, f64),
}

impl Ideal {
    /// Winding number (Sunday), or distance from the middle.
    pub fn contains(&self, p: Plane) -> bool {
        match self {
            Self::Polygon(vertices) => {
                let mut winding = 0;
                for (i, a) in vertices.iter().enumerate() {
                    let b = vertices[(i + 1) % vertices.len()];
                    let left = (b.0 - a.0) * (p.1 - a.1) - (p.0 - a.0) * (b.1 - a.1);
                    if a.1 <= p.1 && b.1 > p.1 && left > 0.0 {
                        winding += 1;
                    } else if a.1 > p.1 && b.1 <= p.1 && left < 0.0 {
                        winding -= 1;
                    }
                }
                winding != 0
            }
            Self::Circle(centre, radius) => libm::hypot(p.0 - centre.0, p.1 - centre.1) <= *radius,
        }
    }

    /// Points of the outline every `step` m.
    pub fn outline(&self, step: f64) -> Vec<Plane> {
        let mut points = Vec::new();
        match self {
            Self::Polygon(vertices) => {
                for (i, a) in vertices.iter().enumerate() {
                    let b = vertices[(i + 1) % vertices.len()];
                    let way = (b.0 - a.0, b.1 - a.1);
                    let count = libm::ceil(libm::hypot(way.0, way.1) / step) as usize;
                    let share = |n: usize| n as f64 / count as f64;
                    points.extend((0..count).map(|n| (a.0 + way.0 * share(n), a.1 + way.1 * share(n))));
                }
            }
            Self::Circle(centre, radius) => {
                let count = libm::ceil(core::f64::consts::TAU * radius / step) as usize;
                points.extend((0..count).map(|n| {
                    let (sin, cos) = libm::sincos(core::f64::consts::TAU * n as f64 / count as f64);
                    (centre.0 + radius * cos, centre.1 + radius * sin)
                }));
            }
        }
        points
    }
}

/// A fence with its outline sampled.
pub struct Oracle {
    inclusions: Vec<Ideal>,
    exclusions: Vec<Ideal>,
    /// Of the inclusions together.
    boundary: Vec<Plane>,
}

fn distance(p: Plane, points: &[Plane]) -> f64 {
    points
        .iter()
        .map(|q| libm::hypot(q.0 - p.0, q.1 - p.1))
        .fold(f64::INFINITY, libm::fmin)
}

impl Oracle {
    pub const STEP: f64 = 0.1;

    pub fn new(fence: &Fence) -> Self {
        let ideal = |shape: &Shape| match fence.outline(shape) {
            Outline::Polygon(vertices) => {
                Ideal::Polygon(vertices.iter().map(|v| (v.x.into(), v.y.into())).collect())
            }
            Outline::Circle { centre, radius } => {
                Ideal::Circle((centre.x.into(), centre.y.into()), radius.into())
            }
        };
        let of = |inclusion| fence.shapes.iter().filter(move |s| s.inclusion == inclusion);
        let inclusions: Vec<Ideal> = of(true).map(ideal).collect();
        // A place is on the boundary if something 2 cm beside it is in no inclusion.
        let free = |q: &Plane| {
            (0..16).any(|n| {
                let (sin, cos) = libm::sincos(core::f64::consts::FRAC_PI_8 * f64::from(n));
                let beside = (q.0 + 0.02 * cos, q.1 + 0.02 * sin);
                !inclusions.iter().any(|shape| shape.contains(beside))
            })
        };
        let outlines = inclusions.iter().flat_map(|shape| shape.outline(Self::STEP));
        let boundary = outlines.filter(free).collect();
        Self {
            exclusions: of(false).map(ideal).collect(),
            inclusions,
            boundary,
        }
    }

    pub fn is_inside(&self, p: Plane) -> bool {
        let included = |p| self.inclusions.iter().any(|shape| shape.contains(p));
        (self.inclusions.is_empty() || included(p)) && !self.exclusions.iter().any(|shape| shape.contains(p))
    }

    pub fn clearance(&self, p: Plane) -> f64 {
        let signed = |inside: bool, distance: f64| if inside { distance } else { -distance };
        let mut clearance = f64::INFINITY;
        if !self.inclusions.is_empty() {
            let inside = self.inclusions.iter().any(|shape| shape.contains(p));
            clearance = signed(inside, distance(p, &self.boundary));
        }
        for shape in &self.exclusions {
            let way = distance(p, &shape.outline(Self::STEP));
            clearance = libm::fmin(clearance, signed(!shape.contains(p), way));
        }
        clearance
    }
}

/// A polygon that does not cross itself: its corners go once round a centre, which comes first and
/// sees them all.
pub fn star_around() -> impl Strategy<Value = ((f32, f32), Vec<(f32, f32)>)> {
    let centre = (-40.0_f32..40.0, -40.0_f32..40.0);
    let corners = prop::collection::vec((5.0_f32..50.0, 0.5_f32..1.0), 4..10);
    (centre, corners).prop_map(|((north, east), corners)| {
        let whole: f32 = corners.iter().map(|corner| corner.1).sum();
        let mut angle = 0.0;
        let corner = |(radius, share): &(f32, f32)| {
            angle += core::f32::consts::TAU * share / whole;
            let (sin, cos) = windhover_math::sin_cos(angle);
            (north + radius * cos, east + radius * sin)
        };
        ((north, east), corners.iter().map(corner).collect())
    })
}

/// The same without its centre.
pub fn star() -> impl Strategy<Value = Vec<(f32, f32)>> {
    star_around().prop_map(|(_, corners)| corners)
}

/// Items of one shape.
fn shape() -> impl Strategy<Value = Vec<MissionItem>> {
    let round = (any::<bool>(), -40.0_f32..40.0, -40.0_f32..40.0, 3.0_f32..50.0);
    prop_oneof![
        3 => (any::<bool>(), star()).prop_map(|(inclusion, vertices)| polygon(inclusion, &vertices)),
        1 => round.prop_map(|(inclusion, n, e, r)| std::vec![circle(inclusion, n, e, r)]),
    ]
}

/// A fence of up to four shapes that are allowed.
pub fn any_fence() -> impl Strategy<Value = Fence> {
    let shapes = prop::collection::vec(shape(), 1..5);
    shapes.prop_filter_map("too small, or too many crossings", |shapes| {
        compile(&shapes.concat()).ok()
    })
}
