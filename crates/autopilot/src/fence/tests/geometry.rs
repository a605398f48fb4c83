//! In and out, distances, and ways.

use proptest::prelude::*;

use super::oracle::{Oracle, any_fence, star_around};
use super::*;

/// Corners at whole metres, edges along both axes, and two that are oblique.
const COMB: [(f32, f32); 11] = [
    (0.0, 0.0),
    (6.0, 0.0),
    (6.0, 2.0),
    (2.0, 2.0),
    (2.0, 4.0),
    (6.0, 4.0),
    (6.0, 6.0),
    (2.0, 6.0),
    (4.0, 8.0),
    (6.0, 10.0),
    (0.0, 10.0),
];

/// A ray through a corner, or along an edge, would count it twice or not at all.
#[test]
fn in_and_out_beside_corners_and_along_edges() {
    for reversed in [false, true] {
        let mut corners = COMB;
        if reversed {
            corners.reverse();
        }
        let fence = exact(&[(true, &corners)]);
        let oracle = Oracle::new(&fence);
        for n in -4..=28 {
            for e in -4..=44 {
                let (north, east) = (n as f32 * 0.25, e as f32 * 0.25);
                if fence.clearance(at(north, east)).abs() < 1e-4 {
                    continue;
                }
                assert_eq!(
                    fence.is_inside(at(north, east)),
                    oracle.is_inside((north.into(), east.into())),
                    "{north} {east}"
                );
            }
        }
    }
}

/// Four squares around a point, and a half beside them: on the seams there would be a gap.
#[test]
fn neighbours_share_every_point_of_their_edges() {
    let tiles: [&[(f32, f32)]; 5] = [
        &[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)],
        &[(4.0, 4.0), (4.0, 0.0), (8.0, 0.0), (8.0, 4.0)],
        &[(0.0, 4.0), (4.0, 4.0), (4.0, 8.0), (0.0, 8.0)],
        &[(4.0, 4.0), (8.0, 4.0), (8.0, 8.0), (4.0, 8.0)],
        &[(0.0, 8.0), (8.0, 8.0), (4.0, 12.0), (0.0, 12.0)],
    ];
    let tiled = exact(&tiles.map(|tile| (true, tile)));
    let each = tiles.map(|tile| exact(&[(true, tile)]));
    for n in 1..32 {
        for e in 1..40 {
            let point = at(n as f32 * 0.25, e as f32 * 0.25);
            let times = each.iter().filter(|tile| tile.is_inside(point)).count();
            let inside = point.y <= 8.0 || point.x < 16.0 - point.y;
            if tiled.clearance(point).abs() > 1e-3 {
                assert_eq!(times, usize::from(inside), "{point}");
            }
        }
    }
    assert_eq!(tiled.clearance(at(4.0, 4.0)), 4.0);
    let along_a_seam = tiled.leaves(
        &FenceParameters::default(),
        Vector3::zeros(),
        at(4.0, 1.0),
        at(4.0, 11.0),
    );
    assert!(!along_a_seam);
}

/// A boundary inside of the fence would stop the vehicle there, a lost one would let it out.
#[test]
fn what_lies_in_another_inclusion_is_no_boundary() {
    let fence = fence(&[
        &rectangle(true, (-10.0, 10.0), (-100.0, 20.0)),
        &rectangle(true, (-30.0, 30.0), (0.0, 100.0)),
    ]);
    let near = |position, wanted: f32| {
        let clearance = fence.clearance(position);
        assert!((clearance - wanted).abs() < 0.03, "{clearance} {wanted}");
    };
    near(at(0.0, 10.0), windhover_math::sqrt(200.0));
    near(at(0.0, 0.0), 10.0);
    near(at(0.0, 20.0), windhover_math::sqrt(500.0));
    near(at(0.0, 50.0), 30.0);
    near(at(20.0, -5.0), -5.0);
    near(at(0.0, -130.0), -30.0);
}

/// From its middle no place of a circle is nearer than another.
#[test]
fn circles_from_their_middle_and_across_each_other() {
    let round = fence(&[&[circle(true, 0.0, 0.0, 50.0)]]);
    assert!((round.clearance(at(0.0, 0.0)) - 50.0).abs() < 0.02);
    let two = fence(&[&[circle(true, 0.0, 0.0, 50.0), circle(true, 60.0, 0.0, 50.0)]]);
    // Where they cross, 40 m east and west of the middle between the two.
    assert!((two.clearance(at(30.0, 0.0)) - 40.0).abs() < 0.03);
    assert!((two.clearance(at(0.0, 0.0)) - 50.0).abs() < 0.03);
    assert_eq!(Fence::default().clearance(at(1e6, 0.0)), f32::MAX);
    assert!(Fence::default().is_inside(at(1e6, 0.0)));
}

/// A spike that reaches in is the nearest place from almost everywhere.
#[test]
fn a_spike_into_the_fence_is_not_lost_beside_another_inclusion() {
    let spiked = polygon(
        true,
        &[
            (0.0, 0.0),
            (100.0, 0.0),
            (100.0, 49.0),
            (20.0, 50.0),
            (100.0, 51.0),
            (100.0, 100.0),
            (0.0, 100.0),
        ],
    );
    let fence = fence(&[&spiked, &rectangle(true, (0.0, 100.0), (-50.0, 10.0))]);
    let clearance = fence.clearance(at(15.0, 50.0));
    assert!((clearance - 5.0).abs() < 0.02, "{clearance}");
}

proptest! {
    #[test]
    fn in_out_and_distance_as_by_brute_force(
        fence in any_fence(),
        places in prop::collection::vec((-100.0_f32..100.0, -100.0_f32..100.0), 20),
    ) {
        let oracle = Oracle::new(&fence);
        for (north, east) in places {
            let ideal = (north.into(), east.into());
            let (clearance, wanted) = (fence.clearance(at(north, east)), oracle.clearance(ideal));
            if wanted.is_infinite() {
                prop_assert_eq!(clearance, f32::MAX);
            } else {
                prop_assert!((f64::from(clearance) - wanted).abs() < 0.15, "{} {}", clearance, wanted);
            }
            if clearance.abs() > 1e-3 {
                prop_assert_eq!(fence.is_inside(at(north, east)), oracle.is_inside(ideal));
                prop_assert_eq!(fence.is_inside(at(north, east)), clearance > 0.0);
            }
        }
    }

    /// No sample of a way that is said to be inside lies outside, and of one that is not, one does.
    #[test]
    fn ways_as_by_dense_sampling(
        fence in any_fence(),
        ends in prop::collection::vec((-80.0_f32..80.0, -80.0_f32..80.0), 8),
    ) {
        for pair in ends.windows(2) {
            let (from, to) = (at(pair[0].0, pair[0].1), at(pair[1].0, pair[1].1));
            let way = to - from;
            let count = (windhover_math::scalar::norm(way) / 0.02) as usize + 1;
            let sample = |n: usize| fence.clearance(from + way * (n as f32 / count as f32));
            let least = (0..=count).map(sample).fold(f32::MAX, windhover_math::min);
            if fence.leaves(&FenceParameters::default(), Vector3::zeros(), from, to) {
                prop_assert!(least < 0.03, "{}", least);
            } else {
                prop_assert!(least > -0.02, "{}", least);
            }
        }
    }

    /// Two polygons along a seam are the one that they were cut from.
    #[test]
    fn a_polygon_cut_in_two_is_the_same_fence(
        (centre, whole) in star_around(),
        corner in 0_usize..100,
        places in prop::collection::vec((-100.0_f32..100.0, -100.0_f32..100.0), 10),
    ) {
        let cut = 1 + corner % (whole.len() - 1);
        let mut first = std::vec![centre];
        first.extend(&whole[..=cut]);
        let mut second = std::vec![centre];
        second.extend(&whole[cut..]);
        second.push(whole[0]);
        let one = compile(&polygon(true, &whole)).unwrap();
        let two = compile(&[polygon(true, &first), polygon(true, &second)].concat()).unwrap();
        for pair in places.windows(2) {
            let [from, to] = [0, 1].map(|n| at(pair[n].0, pair[n].1));
            let (whole, cut) = (one.clearance(from), two.clearance(from));
            prop_assert!((whole - cut).abs() < 0.03, "{} {}", whole, cut);
            let parameters = FenceParameters::default();
            prop_assert_eq!(one.leaves(&parameters, Vector3::zeros(), from, to), two.leaves(&parameters, Vector3::zeros(), from, to));
        }
    }
}
