//! Legs of a mission: corners, speeds, headings, surveys, and the climb at the beginning.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::mission::action::command;
use windhover_math::{scalar::norm, wrap_pi};
use windhover_tests::bench::{Bench, SPOOL_UP};
use windhover_tests::plan::{Plan, UNSET, item_at};
use windhover_tests::trace::{Step, Trace};
use windhover_tests::{calm, mission, traced, with_parameter};

/// Steps from the first to the last waypoint, by truth.
fn underway(trace: &Trace, first: u16, last: u16) -> Vec<&Step> {
    use windhover_autopilot::mission::MissionEvent::Reached;
    let (from, to) = (trace.time_of(Reached(first)), trace.time_of(Reached(last)));
    trace.between(from, to).collect()
}

fn slowest(steps: &[&Step]) -> f64 {
    let speeds = steps.iter().map(|step| step.ground_speed());
    speeds.fold(f64::INFINITY, windhover_math::min)
}

fn degrees_between(a: f64, b: f64) -> f64 {
    f64::from(wrap_pi((a - b) as f32).to_degrees()).abs()
}

/// A waypoint without a hold is passed within its radius, the corner cut, the speed kept.
#[test]
fn a_corner_is_cut_within_the_radius_and_the_speed_kept() {
    let corner = |radius: f32| {
        let plan = Plan::new()
            .takeoff(5.0)
            .waypoint(0.0, 0.5, 0.0, 10.0, 5.0)
            .waypoint(0.0, radius, 20.0, 10.0, 5.0)
            .waypoint(0.0, 0.5, 20.0, 30.0, 5.0);
        let (flight, trace) = traced(&calm(), &plan.file());
        assert!(flight.figures.completed);
        assert_eq!(trace.reached(), [1, 2, 3]);
        let around: Vec<&Step> = trace
            .flying()
            .filter(|s| s.distance(20.0, 10.0, 5.0) < 3.0)
            .collect();
        (trace.nearest(20.0, 10.0, 5.0), slowest(&around))
    };
    let (near, slow) = corner(3.0);
    assert!(near <= 3.0 && slow > 1.2, "{near} m, {slow} m/s");
    let (nearer, slower) = corner(0.5);
    assert!(nearer <= 0.5 && slower < slow, "{nearer} m, {slower} m/s");
    assert!(near > nearer + 0.2, "a wide radius is made use of: {near} m");
    // A hold stops the vehicle: the difference that passing makes.
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(0.5, 3.0, 20.0, 0.0, 5.0)
        .waypoint(0.0, 3.0, 20.0, 20.0, 5.0);
    let (_, trace) = traced(&calm(), &plan.file());
    let at: Vec<&Step> = trace
        .flying()
        .filter(|s| s.distance(20.0, 0.0, 5.0) < 0.5)
        .collect();
    assert!(slowest(&at) < 0.05);
}

/// A waypoint on a straight line does not slow the vehicle down.
#[test]
fn straight_on_keeps_the_speed() {
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(0.0, 1.0, 15.0, 0.0, 5.0)
        .waypoint(0.0, 1.0, 30.0, 0.0, 5.0)
        .waypoint(0.0, 1.0, 45.0, 0.0, 5.0);
    let (_, trace) = traced(&calm(), &plan.file());
    let middle: Vec<&Step> = trace
        .flying()
        .filter(|s| s.position.x > 5.0 && s.position.x < 40.0)
        .collect();
    assert!(slowest(&middle) > 1.9, "{}", slowest(&middle));
    assert!(
        middle.iter().all(|s| s.ground_speed() < 2.1),
        "and not faster either"
    );
}

/// Our survey: every waypoint passed within its radius, never at rest, a photo every 15 m.
#[test]
fn the_survey_does_not_stop() {
    let (flight, trace) = traced(&calm(), &mission("missions/survey.plan"));
    assert!(flight.figures.completed, "{}", flight.figures.ended);
    let reached = trace.reached();
    assert_eq!(reached.len(), 16, "{reached:?}");
    // The way to the field meets the first lane at an angle so sharp that the speed goes down.
    let all = underway(&trace, reached[0], reached[14]);
    assert!(slowest(&all) > 0.5, "{} m/s", slowest(&all));
    let field = underway(&trace, reached[1], reached[14]);
    assert!(slowest(&field) > 1.8, "{} m/s", slowest(&field));
    let photos = trace.photos();
    assert!(photos.len() > 30, "{} photos", photos.len());
    for pair in photos.windows(2) {
        let [(a, ..), (b, ..)] = pair else { unreachable!() };
        let way = norm(a.position - b.position);
        assert!((14.0..15.5).contains(&way), "{way} m between photos");
    }
}

/// A mission that is started on the ground without a takeoff item climbs straight up before it goes
/// anywhere.
#[test]
fn without_a_takeoff_item_it_climbs_first() {
    let plan = Plan::new()
        .waypoint(0.0, 0.5, 10.0, 0.0, 8.0)
        .waypoint(0.0, 0.5, 0.0, 5.0, 8.0);
    let bench = Bench::in_mission(&calm(), &plan.file(), 30.0);
    let reached = bench.steps.iter().flat_map(|step| &step.events);
    let reached: Vec<_> = reached
        .filter(|event| matches!(event, MissionEvent::Reached(_)))
        .collect();
    assert_eq!(reached, [&MissionEvent::Reached(0), &MissionEvent::Reached(1)]);
    for step in bench.steps.iter().filter(|step| step.position.z > -7.5) {
        let strayed = libm::hypot(step.position.x, step.position.y);
        assert!(strayed < 0.2, "{strayed} m at {}", step.time);
    }
}

/// What stands before the first waypoint happens once, takeoff item or not: the first photo by
/// distance is not taken on the ground and again in the air.
#[test]
fn items_before_the_first_waypoint_happen_once() {
    let trigger = [100.0, 0.0, 1.0, 0.0];
    let first = Plan::new().then(command::DO_SET_CAM_TRIGG_DIST, trigger);
    let without = first.clone().waypoint(0.0, 0.5, 10.0, 0.0, 8.0);
    let with = first.takeoff(8.0).waypoint(0.0, 0.5, 10.0, 0.0, 8.0);
    for plan in [without, with] {
        let (_, trace) = traced(&calm(), &plan.file());
        assert_eq!(trace.photo_items(), [0]);
    }
    // At rest, too: a photo asked for on the ground is a photo.
    let photo = Plan::new()
        .photo()
        .takeoff(8.0)
        .waypoint(0.0, 0.5, 10.0, 0.0, 8.0);
    let (_, trace) = traced(&calm(), &photo.file());
    assert_eq!(trace.photo_items(), [0]);
}

/// Waiting on the ground before the takeoff, of a mission that is started there.
#[test]
fn a_delay_before_the_takeoff_is_kept() {
    let plan = Plan::new()
        .then(command::NAV_DELAY, [5.0, -1.0, -1.0, -1.0])
        .takeoff(5.0)
        .waypoint(0.0, 0.5, 4.0, 0.0, 5.0);
    let mut bench = Bench::in_mission(&calm(), &plan.file(), 4.0);
    // Meanwhile the rotors idle: thrust would make the vehicle light on its legs.
    assert!(matches!(bench.last(), windhover_autopilot::MotorCommand::Idle(_)));
    bench.run(6.0);
    let up = bench.steps.iter().find(|step| step.position.z < -0.5).unwrap();
    let waited = up.time - SPOOL_UP;
    assert!((5.0..7.0).contains(&waited), "in the air after {waited} s");
}

/// Speeds that the mission sets are flown, on the leg after the item and on no other.
#[test]
fn speed_items_set_the_speed_of_the_legs_after_them() {
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(1.0, 0.5, 20.0, 0.0, 5.0)
        .speed(1.0)
        .waypoint(1.0, 0.5, 20.0, 10.0, 5.0)
        .speed(4.0)
        .waypoint(0.0, 1.0, 50.0, 10.0, 5.0)
        .waypoint(1.0, 0.5, 80.0, 10.0, 5.0)
        .speed(-2.0)
        .waypoint(0.0, 0.5, 80.0, -10.0, 5.0);
    let (_, trace) = traced(&calm(), &plan.file());
    let fastest = |on: &dyn Fn(&Step) -> bool| {
        let speeds = trace.flying().filter(|s| on(s)).map(Step::ground_speed);
        speeds.fold(0.0, windhover_math::max)
    };
    for (name, speed, wanted) in [
        (
            "first",
            fastest(&|s| s.position.x < 19.0 && s.position.y < 1.0),
            2.0,
        ),
        (
            "slow",
            fastest(&|s| (18.0..20.5).contains(&s.position.x) && (1.0..9.0).contains(&s.position.y)),
            1.0,
        ),
        ("fast", fastest(&|s| (22.0..48.0).contains(&s.position.x)), 4.0),
        ("fast on", fastest(&|s| (52.0..75.0).contains(&s.position.x)), 4.0),
        (
            "default",
            fastest(&|s| s.position.x > 79.0 && s.position.y < 8.0),
            2.0,
        ),
    ] {
        assert!((speed - wanted).abs() < 0.1, "{name}: {speed} m/s");
    }
}

/// A region of interest keeps the nose at it while the vehicle passes; its end frees the nose.
#[test]
fn a_region_of_interest_holds_the_nose() {
    let roi = item_at(command::DO_SET_ROI_LOCATION, [0.0; 4], 15.0, 8.0, 0.0);
    let plan = Plan::new()
        .takeoff(5.0)
        .with(roi)
        .waypoint(0.0, 1.0, 15.0, 0.0, 5.0)
        .waypoint(4.0, 1.0, 30.0, 0.0, 5.0)
        .then(command::DO_SET_ROI_NONE, [0.0; 4])
        .waypoint(0.0, 1.0, 30.0, -10.0, 5.0);
    let (_, trace) = traced(&calm(), &plan.file());
    let mut seen = 0;
    for step in trace
        .flying()
        .filter(|s| (4.0..29.0).contains(&s.position.x) && s.time < 40.0)
    {
        let wanted = libm::atan2(8.0 - step.position.y, 15.0 - step.position.x);
        let off = degrees_between(step.heading, wanted);
        assert!(off < 9.0, "{off}° at {}", step.time);
        seen += 1;
    }
    assert!(seen > 2000, "it was looked at");
    let last = trace.steps.last().unwrap();
    assert!(degrees_between(last.heading, 0.0) < 3.0, "free again: {last:?}");
}

/// Headings of waypoints are flown; without them the nose stays, or leads along the path.
#[test]
fn headings_of_waypoints_and_of_the_path() {
    let faced = |heading: f32| {
        let east = item_at(command::NAV_WAYPOINT, [4.0, 0.5, 0.0, heading], 8.0, 0.0, 5.0);
        Plan::new()
            .takeoff(5.0)
            .with(east)
            .waypoint(4.0, 0.5, 8.0, 8.0, 5.0)
    };
    let end = |setup, plan: Plan| {
        let (_, trace) = traced(&setup, &plan.file());
        let first = trace.time_of(windhover_autopilot::mission::MissionEvent::Reached(1));
        let at_first = trace.steps.iter().find(|s| s.time > first + 3.5).unwrap().heading;
        (at_first, trace.steps.last().unwrap().heading)
    };
    for degrees in [90.0, -120.0, 200.0] {
        let (first, last) = end(calm(), faced(degrees));
        let wanted = f64::from(degrees).to_radians();
        assert!(degrees_between(first, wanted) < 2.0, "{degrees}°: {first}");
        // The next waypoint gives none: the nose stays.
        assert!(degrees_between(last, wanted) < 2.0, "{degrees}°: {last}");
    }
    let along = with_parameter(calm(), "MIS_YAW_MODE", 1.0);
    let (first, last) = end(along, faced(UNSET));
    assert!(degrees_between(first, 0.0) < 3.0, "north: {first}");
    assert!(
        degrees_between(last, core::f64::consts::FRAC_PI_2) < 3.0,
        "east: {last}"
    );
}

/// Photos by time: so many, so far apart; and none after the stop.
#[test]
fn photos_by_time_and_their_stop() {
    let plan = Plan::new()
        .takeoff(5.0)
        .then(command::IMAGE_START_CAPTURE, [0.0, 2.0, 3.0, 0.0])
        .waypoint(0.0, 0.5, 20.0, 0.0, 5.0)
        .then(command::IMAGE_START_CAPTURE, [0.0, 1.0, 0.0, 0.0])
        .waypoint(0.0, 0.5, 20.0, 10.0, 5.0)
        .then(command::IMAGE_STOP_CAPTURE, [0.0; 4])
        .waypoint(0.0, 0.5, 0.0, 10.0, 5.0);
    let (_, trace) = traced(&calm(), &plan.file());
    let times = |item| -> Vec<f64> {
        let photos = trace.photos();
        let of_item = photos.iter().filter(|(_, by, _)| *by == item);
        of_item.map(|(step, ..)| step.time).collect()
    };
    let counted = times(1);
    assert_eq!(counted.len(), 3);
    assert!(counted.windows(2).all(|t| (t[1] - t[0] - 2.0).abs() < 0.01));
    let endless = times(3);
    assert!((5..9).contains(&endless.len()), "{endless:?}");
    assert!(endless.windows(2).all(|t| (t[1] - t[0] - 1.0).abs() < 0.01));
}
