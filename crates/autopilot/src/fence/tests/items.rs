//! What is refused, and with which words.

use super::*;
use std::string::ToString;

const SQUARE: [(f32, f32); 4] = [(0.0, 0.0), (50.0, 0.0), (50.0, 50.0), (0.0, 50.0)];

fn refused(items: &[MissionItem]) -> (u16, FenceRefusal) {
    let refusal = compile(items).unwrap_err();
    let text = refusal.1.to_string();
    assert!(
        text.contains(": ") && text.len() > 20 && !text.ends_with('.'),
        "{text}"
    );
    refusal
}

#[test]
fn places_are_where_the_items_say() {
    let fence = fence(&[&polygon(true, &SQUARE), &[circle(false, 900.0, -900.0, 12.5)]]);
    for (vertex, (north, east)) in fence.vertices.iter().zip(SQUARE) {
        let error = vertex - Point::new(north, east);
        assert!(shape::length(error) < 0.02, "{vertex}");
    }
    let Form::Circle { centre, radius } = fence.shapes[1].form else {
        panic!();
    };
    assert!(shape::length(centre - Point::new(900.0, -900.0)) < 0.02 && radius == 12.5);
}

/// Clockwise or not, and with the first vertex once more at the end, a polygon is the same.
#[test]
fn order_and_repeats_do_not_matter() {
    let mut reversed = SQUARE;
    reversed.reverse();
    let closed: Vec<_> = SQUARE.into_iter().chain([SQUARE[3], SQUARE[0]]).collect();
    for vertices in [&SQUARE[..], &reversed, &closed] {
        let fence = fence(&[&polygon(true, vertices)]);
        assert_eq!(fence.vertices.len(), 4);
        assert!((fence.clearance(at(20.0, 30.0)) - 20.0).abs() < 0.02);
    }
}

#[test]
fn a_return_point_is_taken_and_not_used() {
    let fence = fence(&[
        &[item(command::RETURN_POINT, 0.0, 5.0, 5.0)],
        &polygon(true, &SQUARE),
    ]);
    assert_eq!(fence.shapes.len(), 1);
    assert!(compile(&[]).unwrap().is_empty());
}

#[test]
fn vertices_that_do_not_make_up_a_polygon() {
    let square = polygon(true, &SQUARE);
    assert_eq!(
        refused(&square[..3]),
        (0, FenceRefusal::VertexCount { said: 4.0, found: 3 })
    );
    let mut mixed = [polygon(false, &SQUARE), square.clone()].concat();
    mixed[6].command = command::POLYGON_VERTEX_EXCLUSION;
    assert_eq!(
        refused(&mixed),
        (4, FenceRefusal::VertexCount { said: 4.0, found: 2 })
    );
    let mut two = polygon(true, &SQUARE[..2]);
    assert_eq!(refused(&two), (0, FenceRefusal::TooFewVertices));
    for wrong in [f32::NAN, -1.0, 2.5, 1e9, f32::INFINITY] {
        two[0].params[0] = wrong;
        assert!(
            matches!(refused(&two), (0, FenceRefusal::VertexCount { .. })),
            "{wrong}"
        );
    }
    let twice = [SQUARE[0], SQUARE[0], SQUARE[1], SQUARE[1]];
    assert_eq!(refused(&polygon(true, &twice)), (0, FenceRefusal::TooFewVertices));
}

#[test]
fn more_than_is_stored() {
    let ring = |count: usize| -> Vec<_> {
        let corner = |n| {
            let (sin, cos) = windhover_math::sin_cos(core::f32::consts::TAU * n as f32 / count as f32);
            (100.0 * cos, 100.0 * sin)
        };
        (0..count).map(corner).collect()
    };
    assert!(compile(&polygon(true, &ring(MAX_VERTICES))).is_ok());
    assert_eq!(
        refused(&polygon(true, &ring(MAX_VERTICES + 1))),
        (0, FenceRefusal::TooManyVertices)
    );
    let two = [polygon(true, &ring(80)), polygon(true, &ring(5))].concat();
    assert_eq!(refused(&two), (80, FenceRefusal::TooManyVertices));
    let circles = [circle(false, 0.0, 0.0, 5.0); MAX_SHAPES + 1];
    assert!(compile(&circles[1..]).is_ok());
    assert_eq!(
        refused(&circles),
        (MAX_SHAPES as u16, FenceRefusal::TooManyShapes)
    );
}

/// Ten teeth across ten teeth.
#[test]
fn crossings_that_are_more_than_is_stored() {
    let teeth: Vec<_> = (0..20)
        .map(|n| (if n % 2 == 0 { 0.0 } else { 100.0 }, 5.0 * n as f32))
        .chain([(-10.0, 95.0), (-10.0, 0.0)])
        .collect();
    let across: Vec<_> = teeth.iter().map(|&(north, east)| (east, north)).collect();
    let items = [polygon(true, &teeth), polygon(true, &across)].concat();
    assert_eq!(refused(&items), (22, FenceRefusal::TooManyCrossings));
}

#[test]
fn circles_and_places_out_of_range() {
    for radius in [0.99, 10_001.0, -5.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(
            refused(&[circle(true, 0.0, 0.0, radius)]),
            (0, FenceRefusal::Radius(_))
        ));
    }
    assert!(compile(&[circle(true, 0.0, 0.0, 1.0), circle(true, 0.0, 0.0, 10_000.0)]).is_ok());
    let mut square = polygon(true, &SQUARE);
    square[2].x = 900_000_001;
    assert!(matches!(refused(&square), (0, FenceRefusal::Place(_))));
    let mut round = circle(true, 0.0, 0.0, 5.0);
    round.frame = 1;
    assert!(matches!(refused(&[round]), (0, FenceRefusal::Place(_))));
    for frame in [0, 3, 5, 6] {
        let z = f32::NAN;
        assert!(
            compile(&[MissionItem {
                frame,
                z,
                ..circle(true, 0.0, 0.0, 5.0)
            }])
            .is_ok()
        );
    }
    let odd = [circle(true, 0.0, 0.0, 5.0), item(16, 0.0, 0.0, 0.0)];
    assert_eq!(refused(&odd), (1, FenceRefusal::Command(16)));
}

#[test]
fn polygons_that_cross_themselves_or_are_nothing() {
    let bow = [SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]];
    assert_eq!(refused(&polygon(true, &bow)), (0, FenceRefusal::SelfCrossing));
    let small = [(0.0, 0.0), (1.9, 0.0), (1.9, 1.9), (0.0, 1.9)];
    let after_a_circle = [std::vec![circle(true, 0.0, 0.0, 5.0)], polygon(false, &small)].concat();
    assert!(matches!(refused(&after_a_circle), (1, FenceRefusal::Small(_))));
}

/// Every order of five corners: refused if and only if two edges cross, tried in double precision.
#[test]
fn crossing_edges_are_found_in_every_order() {
    let corners = [(0.0, 0.0), (31.0, 4.0), (40.0, 37.0), (17.0, 21.0), (-9.0, 33.0)];
    let side =
        |a: (f64, f64), b: (f64, f64), c: (f64, f64)| (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1);
    let mut refusals = 0;
    for order in 0..120 {
        let (mut left, mut rest) = (corners.to_vec(), order);
        let mut loop_ = Vec::new();
        for size in (1..=5).rev() {
            loop_.push(left.remove(rest % size));
            rest /= size;
        }
        let edge = |n: usize| (loop_[n % 5], loop_[(n + 1) % 5]);
        let crosses = (0..5).any(|n| {
            let ((a, b), (c, d)) = (edge(n), edge(n + 2));
            side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
        });
        let vertices: Vec<_> = loop_.iter().map(|v| (v.0 as f32, v.1 as f32)).collect();
        assert_eq!(compile(&polygon(true, &vertices)).is_err(), crosses, "{loop_:?}");
        refusals += u32::from(crosses);
    }
    assert!(refusals > 0 && refusals < 120);
}

/// Fewer items in storage than were committed.
#[test]
fn an_item_that_is_missing() {
    let items = [circle(true, 0.0, 0.0, 5.0)];
    let plans = Plans {
        fence: &items,
        ..Plans::default()
    };
    assert_eq!(check(&plans, 0, 2), Err((1, FenceRefusal::Missing)));
    assert_eq!(check(&items[..], 0, 1), Err((0, FenceRefusal::Missing)));
}

fn rally(items: &[MissionItem]) -> Result<Rally, (u16, FenceRefusal)> {
    let plans = Plans {
        rally: items,
        ..Plans::default()
    };
    let count = items.len() as u16;
    let compiled = Rally::compile(&plans, 0, count, &LocalFrame::new(HOME));
    assert_eq!(compiled.is_ok(), Rally::check(&plans, 0, count).is_ok());
    compiled
}

fn rally_point(north: f32, east: f32, frame: u8, z: f32) -> MissionItem {
    MissionItem {
        frame,
        z,
        ..item(command::RALLY_POINT, 0.0, north, east)
    }
}

#[test]
fn the_nearest_place_to_return_to() {
    let points = [
        rally_point(100.0, 0.0, 3, 20.0),
        rally_point(0.0, 100.0, 0, 513.0),
    ];
    let rally = rally(&points).unwrap();
    let near = |to: Vector3, wanted: Vector3| {
        let error = windhover_math::scalar::norm(to - wanted);
        assert!(error < 0.02, "{to} {wanted}");
    };
    near(
        rally.destination(at(60.0, 10.0), Vector3::zeros()),
        Vector3::new(100.0, 0.0, -20.0),
    );
    near(
        rally.destination(at(10.0, 60.0), Vector3::zeros()),
        Vector3::new(0.0, 100.0, -25.0),
    );
    near(
        rally.destination(at(40.0, 40.0), Vector3::zeros()),
        Vector3::zeros(),
    );
    near(
        rally.nearest(at(40.0, 0.0)).unwrap().position,
        Vector3::new(100.0, 0.0, -20.0),
    );
    let home = Vector3::new(1.0, -2.0, 3.0);
    assert_eq!(Rally::default().destination(at(1e3, 0.0), home), home);
    // Home is where it was put: nearer than a rally point, it is the place.
    let home = Vector3::new(60.0, 0.0, 4.0);
    assert_eq!(rally.destination(at(60.0, 10.0), home), home);
    assert_eq!(Rally::default().nearest(at(0.0, 0.0)), None);
}

#[test]
fn rally_points_that_are_refused() {
    let good = rally_point(10.0, 0.0, 6, 20.0);
    assert!(rally(&[good; MAX_RALLY]).is_ok());
    let most = MAX_RALLY as u16;
    assert_eq!(
        rally(&[good; MAX_RALLY + 1]),
        Err((most, FenceRefusal::TooManyRallyPoints))
    );
    let refused = |item| rally(&[good, item]).unwrap_err();
    assert!(matches!(
        refused(rally_point(0.0, 0.0, 1, 0.0)),
        (1, FenceRefusal::Place(_))
    ));
    assert!(matches!(
        refused(rally_point(0.0, 0.0, 3, f32::NAN)),
        (1, FenceRefusal::Place(_))
    ));
    assert_eq!(refused(item(16, 0.0, 0.0, 0.0)), (1, FenceRefusal::Command(16)));
}
