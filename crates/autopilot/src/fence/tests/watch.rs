//! The stopping point.

use proptest::prelude::*;

use super::oracle::star_around;
use super::*;

const DT: f32 = 0.004;
const ACCELERATION: f32 = 5.0;
const REACTION: f32 = 0.3;

fn seen(fence: &Fence, parameters: &FenceParameters, position: Vector3, velocity: Vector3) -> Option<Breach> {
    fence.watch(
        parameters,
        Vector3::zeros(),
        position,
        velocity,
        ACCELERATION,
        REACTION,
    )
}

fn limits(distance_max: f32, altitude_max: f32) -> FenceParameters {
    FenceParameters {
        distance_max,
        altitude_max,
        ..FenceParameters::default()
    }
}

/// Flies on until something is seen, then for the reaction time, then brakes: where the vehicle
/// comes to rest, and the least clearance on the way.
fn fly(
    fence: &Fence,
    parameters: &FenceParameters,
    mut position: Vector3,
    velocity: Vector3,
) -> (Vector3, f32) {
    let speed = windhover_math::scalar::norm(velocity);
    let direction = velocity / speed;
    let mut least = fence.clearance(position);
    for _ in 0..100_000 {
        if seen(fence, parameters, position, velocity).is_some() {
            break;
        }
        position += velocity * DT;
        least = min(least, fence.clearance(position));
    }
    let way = speed * REACTION + speed * speed / (2.0 * ACCELERATION);
    for n in 1..=100 {
        let there = position + direction * (way * n as f32 / 100.0);
        least = min(least, fence.clearance(there));
    }
    (position + direction * way, least)
}

/// Half a metre thick, and passed within 25 ms: the position is never seen in it, and the stopping
/// point lies far beyond.
#[test]
fn a_thin_exclusion_at_full_speed_is_not_jumped_over() {
    let wall = fence(&[&rectangle(false, (50.0, 50.5), (-50.0, 50.0))]);
    let parameters = FenceParameters::default();
    let breach = seen(&wall, &parameters, at(30.0, 0.0), Vector3::new(20.0, 0.0, 0.0));
    let kind = BreachKind::Exclusion;
    assert_eq!(
        breach,
        Some(Breach {
            kind,
            predicted: true
        })
    );
    let (rest, _) = fly(&wall, &parameters, at(-50.0, 7.0), Vector3::new(20.0, 0.0, 0.0));
    assert!((47.8..48.1).contains(&rest.x), "{rest}");
}

#[test]
fn the_vehicle_comes_to_rest_a_margin_before_the_fence() {
    let field = fence(&[&rectangle(true, (-100.0, 100.0), (-100.0, 100.0))]);
    for margin in [0.0, 2.0, 10.0] {
        let parameters = FenceParameters {
            margin,
            ..FenceParameters::default()
        };
        for speed in [1.0, 5.0, 12.0, 20.0] {
            let (rest, _) = fly(&field, &parameters, at(0.0, 0.0), Vector3::new(0.0, speed, 0.0));
            let left = field.clearance(rest);
            let step = speed * DT;
            assert!(
                (left - margin + 0.5 * step).abs() < step + 0.02,
                "{left} {margin} {speed}"
            );
        }
    }
}

/// Along the fence, away from it, and at rest beside it nothing is to be braked.
#[test]
fn what_does_not_lead_out_is_not_seen() {
    let field = fence(&[&rectangle(true, (-100.0, 100.0), (-100.0, 100.0))]);
    let parameters = FenceParameters::default();
    for velocity in [[0.0, 10.0], [-10.0, 0.0], [0.0, 0.0], [0.05, -0.05]] {
        let velocity = Vector3::new(velocity[0], velocity[1], 0.0);
        assert_eq!(
            seen(&field, &parameters, at(99.5, 0.0), velocity),
            None,
            "{velocity}"
        );
    }
}

#[test]
fn without_prediction_only_what_is_outside() {
    let field = fence(&[&rectangle(true, (-100.0, 100.0), (-100.0, 100.0))]);
    let parameters = FenceParameters {
        predict: 0.0,
        ..limits(0.0, 50.0)
    };
    let fast = Vector3::new(20.0, 0.0, -5.0);
    assert_eq!(seen(&field, &parameters, at(99.9, 0.0), fast), None);
    let predicted = false;
    let kind = BreachKind::Boundary;
    assert_eq!(
        seen(&field, &parameters, at(100.1, 0.0), -fast),
        Some(Breach { kind, predicted })
    );
    let kind = BreachKind::Altitude;
    let high = Vector3::new(0.0, 0.0, -50.1);
    assert_eq!(
        seen(&field, &parameters, high, -fast),
        Some(Breach { kind, predicted })
    );
}

#[test]
fn distance_and_height_need_no_shapes() {
    let parameters = limits(200.0, 50.0);
    let none = Fence::default();
    let breach = |position, velocity| seen(&none, &parameters, position, velocity);
    let rest = Vector3::zeros();
    let some = |kind, predicted| Some(Breach { kind, predicted });
    assert_eq!(breach(at(140.0, 140.0), rest), None);
    assert_eq!(breach(at(142.0, 142.0), rest), some(BreachKind::Distance, false));
    assert_eq!(
        breach(at(0.0, -190.0), Vector3::new(0.0, -8.0, 0.0)),
        some(BreachKind::Distance, true)
    );
    assert_eq!(breach(at(0.0, -190.0), Vector3::new(0.0, 8.0, 0.0)), None);
    assert_eq!(
        breach(Vector3::new(0.0, 0.0, -51.0), rest),
        some(BreachKind::Altitude, false)
    );
    let climbing = Vector3::new(0.0, 0.0, -4.0);
    // 1.2 m until the brakes act, 1.6 m of braking, 2 m of margin.
    assert_eq!(breach(Vector3::new(0.0, 0.0, -45.1), climbing), None);
    assert_eq!(
        breach(Vector3::new(0.0, 0.0, -45.3), climbing),
        some(BreachKind::Altitude, true)
    );
    assert_eq!(breach(Vector3::new(0.0, 0.0, -49.0), -climbing), None);
    let unlimited = limits(0.0, 0.0);
    let far = Vector3::new(1e5, 0.0, -1e4);
    assert_eq!(seen(&none, &unlimited, far, climbing), None);
}

/// Nonsense is a breach or none, but always an answer.
#[test]
fn what_is_not_a_number_ends() {
    let field = fence(&[
        &rectangle(true, (-100.0, 100.0), (-100.0, 100.0)),
        &[circle(true, 0.0, 0.0, 50.0)],
    ]);
    let parameters = limits(200.0, 50.0);
    for bad in [f32::NAN, f32::INFINITY, f32::MAX, -1.0, 0.0] {
        let wild = Vector3::repeat(bad);
        let _ = field.watch(&parameters, Vector3::zeros(), wild, at(1.0, 0.0), bad, bad);
        let _ = field.watch(&parameters, Vector3::zeros(), at(1.0, 0.0), wild, bad, bad);
        assert!(!field.clearance(wild).is_nan(), "{bad}");
    }
    assert!(!field.is_inside(Vector3::repeat(f32::NAN)));
}

proptest! {
    /// Whatever the fence and the direction: braking when it is said to keeps the vehicle inside.
    #[test]
    fn who_brakes_then_stays_inside(
        (centre, outer) in star_around(),
        hole in (-30.0_f32..30.0, -30.0_f32..30.0, 1.0_f32..5.0),
        start in (-20.0_f32..20.0, -20.0_f32..20.0),
        course in -3.0_f32..3.0,
        speed in 0.5_f32..15.0,
    ) {
        let outer: Vec<_> = outer.iter().map(|v| (4.0 * v.0, 4.0 * v.1)).collect();
        let items = [polygon(true, &outer), std::vec![circle(false, hole.0, hole.1, hole.2)]].concat();
        let fence = compile(&items).unwrap();
        let (sin, cos) = windhover_math::sin_cos(course);
        let velocity = Vector3::new(speed * cos, speed * sin, 0.0);
        let start = at(4.0 * centre.0 + start.0, 4.0 * centre.1 + start.1);
        let parameters = FenceParameters::default();
        prop_assume!(seen(&fence, &parameters, start, velocity).is_none());
        let (rest, least) = fly(&fence, &parameters, start, velocity);
        prop_assert!(least > -0.02, "{} at rest {}", least, rest);
        prop_assert!(fence.is_inside(rest));
    }
}
