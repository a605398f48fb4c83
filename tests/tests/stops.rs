//! Stops of a mission: photos, holds, delays, and the ends of flights.

use windhover_autopilot::Phase;
use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::mission::action::command;
use windhover_math::scalar::norm;
use windhover_tests::bench::Bench;
use windhover_tests::plan::{Plan, UNSET, item_at, short};
use windhover_tests::trace::Trace;
use windhover_tests::{calm, mission, monitoring, setup, traced, with_parameter};

/// Two photo points, flown three times by a jump that repeats them twice.
fn jumping() -> Plan {
    Plan::new()
        .takeoff(5.0)
        .waypoint(0.0, 0.5, 4.0, 0.0, 5.0)
        .photo()
        .waypoint(1.0, 0.5, 4.0, 4.0, 5.0)
        .photo()
        .then(command::DO_JUMP, [1.0, 2.0, 0.0, 0.0])
        .waypoint(0.0, 0.5, 0.0, 0.0, 5.0)
}

/// A photo item takes one photo each time that the mission comes by, no more and no less.
#[test]
fn a_photo_is_taken_once_for_every_time_that_its_item_comes_up() {
    let (flight, trace) = traced(&calm(), &jumping().file());
    assert!(flight.figures.completed, "{}", flight.figures.ended);
    assert_eq!(trace.photo_items(), [2, 4, 2, 4, 2, 4]);
    assert_eq!(trace.reached(), [1, 3, 1, 3, 1, 3, 6]);
}

/// In gusts too the shutter waits until the vehicle has been near and slow for the dwell time,
/// and fires when it has been: the step before it would have been too early.
#[test]
fn a_photo_waits_until_the_vehicle_has_settled() {
    let setup = setup(
        "os4",
        windhover_autopilot::Preset::Windhover,
        windhover_model::ModelKind::Rigid,
    );
    let (_, trace) = traced(&setup, &monitoring());
    let photos = trace.photos();
    assert_eq!(photos.len(), 10);
    for (shutter, item, settled) in photos {
        assert!(settled, "item {item}");
        let target = shutter.trajectory.unwrap().position.map(f64::from);
        // Bounds of the parameters, and what the estimate is off between two words from outside.
        let still = |step: &windhover_tests::trace::Step| {
            norm(step.position - target) <= 0.105 && norm(step.velocity) <= 0.105
        };
        for step in trace.between(shutter.time - 0.19, shutter.time) {
            assert!(still(step), "item {item}: {step:?}");
        }
    }
}

/// A vehicle that never settles takes its photo all the same, and says that it had not settled.
#[test]
fn a_photo_that_cannot_settle_is_taken_late_and_marked() {
    let impossible = with_parameter(
        setup(
            "os4",
            windhover_autopilot::Preset::Windhover,
            windhover_model::ModelKind::Rigid,
        ),
        "PHOTO_SPEED",
        0.01,
    );
    let impossible = with_parameter(impossible, "PHOTO_DWELL", 5.0);
    let impossible = with_parameter(impossible, "PHOTO_WAIT", 3.0);
    let plan = Plan::new().takeoff(5.0).waypoint(0.0, 0.5, 4.0, 0.0, 5.0).photo();
    let (flight, trace) = traced(&impossible, &plan.file());
    assert!(flight.figures.completed);
    let [(shutter, 2, false)] = trace.photos()[..] else {
        panic!("{:?}", trace.photos());
    };
    let waited = shutter.time - trace.time_of(MissionEvent::Reached(1));
    assert!((2.9..3.3).contains(&waited), "{waited} s");
}

/// When the setpoint leaves the place where it is at `time`.
fn leaves(trace: &Trace, time: f64) -> f64 {
    let moving = trace
        .flying()
        .find(|step| step.time > time && norm(step.trajectory.unwrap().velocity) > 0.0);
    moving.expect("it goes on").time
}

/// Holds and delays last as long as the mission says, and the vehicle stays meanwhile.
#[test]
fn holds_and_delays_last_as_long_as_they_say() {
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(2.5, 0.5, 4.0, 0.0, 5.0)
        .waypoint(7.0, 0.5, 4.0, 4.0, 5.0)
        .waypoint(0.0, 0.5, 0.0, 4.0, 5.0)
        .then(command::NAV_DELAY, [4.0, -1.0, -1.0, -1.0])
        .with(item_at(
            command::NAV_LOITER_TIME,
            [3.0, 0.0, 0.0, UNSET],
            0.0,
            0.0,
            5.0,
        ))
        .then(command::CONDITION_DELAY, [2.0, 0.0, 0.0, 0.0])
        .waypoint(0.0, 0.5, 0.0, -3.0, 5.0);
    let (flight, trace) = traced(&calm(), &plan.file());
    assert!(flight.figures.completed);
    for (item, wanted) in [(1, 2.5), (2, 7.0), (3, 4.0), (5, 5.0)] {
        let reached = trace.time_of(MissionEvent::Reached(item));
        let stayed = leaves(&trace, reached) - reached;
        assert!(
            (wanted - 0.01..wanted + 0.1).contains(&stayed),
            "item {item}: {stayed} s"
        );
        for step in trace.between(reached + 0.5, reached + wanted) {
            let off = step.position - step.trajectory.unwrap().position.map(f64::from);
            assert!(norm(off) < 0.2, "item {item} at {}: {off}", step.time);
        }
    }
}

/// A stop counts as reached when the vehicle is there, not on the way in.
#[test]
fn a_stop_is_reached_at_its_end() {
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(1.0, 3.0, 12.0, 0.0, 5.0)
        .waypoint(1.0, 3.0, 12.0, 6.0, 5.0);
    let (_, trace) = traced(&calm(), &plan.file());
    let (step, _) = trace
        .events()
        .find(|(_, event)| *event == MissionEvent::Reached(1))
        .unwrap();
    assert!(step.distance(12.0, 0.0, 5.0) < 0.3, "{step:?}");
}

/// A point that the vehicle is kept away from is given up after the time that a parameter says,
/// reported as missed, and the mission goes on.
#[test]
fn a_stop_that_cannot_be_reached_is_given_up() {
    let mut setup = setup(
        "os4",
        windhover_autopilot::Preset::Paper,
        windhover_model::ModelKind::Rigid,
    );
    setup.conditions.gust = 0.0;
    let setup = with_parameter(setup, "MIS_ARRIVE_WAIT", 4.0);
    // Without an integral worth its name the paper's gains stand off in the wind.
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(0.5, 0.06, 4.0, 0.0, 5.0)
        .waypoint(0.0, 2.0, 4.0, 4.0, 5.0);
    let (flight, trace) = traced(&setup, &plan.file());
    assert!(flight.figures.completed);
    assert_eq!(trace.reached(), [2]);
    let missed = trace.time_of(MissionEvent::Missed(1));
    let arrived = trace
        .flying()
        .find(|step| step.time > 5.0 && norm(step.trajectory.unwrap().position.xy_to(4.0, 0.0)) < 1e-3);
    let waited = missed - arrived.unwrap().time;
    assert!((3.9..4.3).contains(&waited), "{waited} s");
}

/// Horizontal way to a point.
trait To {
    fn xy_to(&self, north: f32, east: f32) -> windhover_math::Vector3;
}

impl To for windhover_math::Vector3 {
    fn xy_to(&self, north: f32, east: f32) -> windhover_math::Vector3 {
        windhover_math::Vector3::new(self.x - north, self.y - east, 0.0)
    }
}

/// Return: up to the return height, home, down, motors off.
#[test]
fn a_return_lands_at_home() {
    let setup = with_parameter(calm(), "RTL_RETURN_ALT", 12.0);
    let plan = Plan::new()
        .takeoff(5.0)
        .waypoint(0.0, 0.5, 20.0, 10.0, 5.0)
        .home();
    let (flight, trace) = traced(&setup, &plan.file());
    assert!(flight.figures.completed, "{}", flight.figures.ended);
    let last = trace.steps.last().unwrap();
    assert!(last.distance(0.0, 0.0, 0.0) < 0.3, "{last:?}");
    assert_eq!(last.phase, Phase::Disarmed);
    assert!(trace.events().any(|(_, event)| event == MissionEvent::Landed));
    // Above the last waypoint first, then home at that height.
    assert!(trace.nearest(20.0, 10.0, 12.0) < 0.3);
    assert!(trace.nearest(10.0, 5.0, 12.0) < 0.3);
    assert!(trace.nearest(0.0, 0.0, 12.0) < 0.3);
}

/// Landing at a place that the item names, and landing where it is.
#[test]
fn landings_end_where_the_mission_says() {
    let there = item_at(command::NAV_LAND, [0.0, 0.0, 0.0, UNSET], -6.0, 3.0, 0.0);
    let base = || Plan::new().takeoff(5.0).waypoint(0.0, 0.5, 5.0, 0.0, 5.0);
    for (plan, north, east) in [(base().with(there), -6.0, 3.0), (base().land(), 5.0, 0.0)] {
        let (flight, trace) = traced(&calm(), &plan.file());
        assert!(flight.figures.completed, "{}", flight.figures.ended);
        let last = trace.steps.last().unwrap();
        assert!(last.distance(north, east, 0.0) < 0.2, "{last:?}");
        assert_eq!(last.phase, Phase::Disarmed);
    }
}

/// After a landing the motors are off for good, also with the gains that push hardest; the
/// touchdown is soft, and no rotor is driven to its end while the legs hold the vehicle.
#[test]
fn a_landed_vehicle_stops_its_motors() {
    use windhover_autopilot::{MotorCommand, Preset};
    for preset in [Preset::Paper, Preset::Windhover] {
        let setup = setup("os4", preset, windhover_model::ModelKind::Rigid);
        let mut bench = Bench::in_mission(&setup, &short(), 60.0);
        assert_eq!(bench.world.crash(), None);
        assert_eq!(bench.last_step().phase, Phase::Disarmed, "{preset:?}");
        bench.run(2.0);
        let ticks = bench.motors.len();
        assert!(
            bench.motors[ticks - 2000..]
                .iter()
                .all(|command| *command == MotorCommand::Disarmed)
        );
        let touchdown = bench
            .steps
            .iter()
            .rposition(|step| step.position.z < -0.02)
            .unwrap();
        let off = bench
            .steps
            .iter()
            .position(|step| step.events.contains(&MissionEvent::Landed))
            .unwrap();
        // Before that the mixer already knows that the ground is there.
        let held = &bench.steps[off - 75..off];
        assert!(held.iter().all(|step| step.landed && step.phase == Phase::Flying));
        let level = |step: &windhover_tests::trace::Step| step.attitude_setpoint.attitude.cos_tilt();
        assert!(
            held.iter().all(|step| level(step) > 0.999),
            "and no tilt is demanded"
        );
        let seconds = (off - touchdown) as f64 * 0.004;
        assert!(seconds < 2.0, "{preset:?}: off {seconds} s after touchdown");
    }
}

/// The files that ground stations really save fly to their end.
#[test]
fn sample_files_of_ground_stations_fly() {
    let folder = "crates/sim/tests/data";
    for (file, waypoints) in [
        ("qgroundcontrol_sample.plan", 3),
        ("qgroundcontrol_sample_with_survey.plan", 8),
        ("mission_planner_sample.txt", 2),
    ] {
        let (flight, trace) = traced(&calm(), &mission(&format!("{folder}/{file}")));
        assert!(flight.figures.completed, "{file}: {}", flight.figures.ended);
        assert_eq!(flight.figures.waypoints_reached, waypoints, "{file}");
        assert!(
            trace.events().all(|(_, e)| !matches!(e, MissionEvent::Missed(_))),
            "{file}"
        );
    }
}
