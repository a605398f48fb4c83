//! Whole flights in the modes: takeoff in wind, sticks, returns over rally points, the fence at
//! full speed. All on sensors, and each replays equal.

use windhover_autopilot::{Mode, Phase};
use windhover_model::mean_wind_from;
use windhover_sim::closed_loop::ClosedLoop;
use windhover_sim::recording::Recording;
use windhover_sim::sensors::RESTING;
use windhover_sim::sensors::Receiver::Rtk;
use windhover_tests::failsafe::{choose, every, fly, guide, once};
use windhover_tests::plan::{Plan, UNSET, item_at};
use windhover_tests::{on_sensors, with_parameter};

/// If this failed, a takeoff in wind would sweep the vehicle away before it has learnt of the wind.
#[test]
fn a_takeoff_in_8_m_s_of_wind_goes_straight_up() {
    let mut setup = on_sensors(Rtk);
    setup.conditions.wind = mean_wind_from(8.0, 200.0);
    setup.conditions.gust = 1.5;
    setup.conditions.pushes.clear();
    let mission = Plan::new()
        .takeoff(15.0)
        .waypoint(1.0, 1.0, 5.0, 0.0, 15.0)
        .file();
    let mut furthest = 0.0f64;
    let story = fly(&setup, &mission, |flown, _| {
        if flown.outer().supervisor().mode() == Mode::Takeoff {
            let at = flown.world.truth().position;
            furthest = windhover_math::max(furthest, libm::hypot(at.x, at.y));
        }
    });
    println!("takeoff in 8 m/s of wind: at most {furthest:.2} m aside");
    assert!(story.landed() && story.finished(), "{:?}", story.crash);
    assert!(furthest < 1.5, "{furthest} m");
}

/// If this failed, a vehicle called back would fly past the nearer place to land.
#[test]
fn a_return_leads_over_the_nearest_rally_point() {
    let mut mission = Plan::new()
        .takeoff(10.0)
        .waypoint(60.0, 0.5, 80.0, 0.0, 10.0)
        .file();
    mission.rally = vec![
        item_at(5100, [0.0, 0.0, 0.0, UNSET], 60.0, 15.0, 10.0),
        item_at(5100, [0.0, 0.0, 0.0, UNSET], -40.0, 0.0, 10.0),
    ];
    let story = fly(&on_sensors(Rtk), &mission, |flown, time| {
        if once(time, 80.0) {
            choose(flown, Mode::Return);
        }
    });
    assert!(story.landed(), "{:?}", story.crash);
    assert!(
        story.ended_at(60.0, 15.0) < 0.5,
        "{:.1} m off",
        story.ended_at(60.0, 15.0)
    );
    // Up to the height of return on the way, not straight down the slope.
    let land = story.flew(Mode::Land, 80.0).expect("it lands");
    assert!((land.position.z + 30.0).abs() < 0.5, "{}", land.position);
}

/// If this failed, the fence would be a line to look at afterwards: at full speed the vehicle comes
/// to rest inside, and not further from the fence than it has to.
#[test]
fn at_full_speed_the_fence_is_kept() {
    const EDGE: f64 = 150.0;
    for speed in [4.0f32, 8.0, 12.0] {
        let mut mission = Plan::new()
            .takeoff(10.0)
            .waypoint(60.0, 0.5, 10.0, 0.0, 10.0)
            .file();
        let corner = |north, east| item_at(5001, [4.0, 0.0, 0.0, UNSET], north, east, 0.0);
        let edge = EDGE as f32;
        mission.fence = vec![
            corner(-50.0, -80.0),
            corner(-50.0, 80.0),
            corner(edge, 80.0),
            corner(edge, -80.0),
        ];
        let setup = with_parameter(on_sensors(Rtk), "MPC_VEL_MANUAL", f64::from(speed));
        let (mut furthest, mut fastest) = (0.0, 0.0);
        let story = fly(&setup, &mission, |flown, time| {
            if (30.0..75.0).contains(&time) && every(time, 50) {
                guide(flown, speed, 0.0);
            }
            if once(time, 30.5) {
                choose(flown, Mode::Offboard);
            }
            if once(time, 85.0) {
                choose(flown, Mode::Return);
            }
            let truth = flown.world.truth();
            furthest = windhover_math::max(furthest, truth.position.x);
            fastest = windhover_math::max(fastest, truth.velocity.x);
        });
        println!(
            "fence at {fastest:.1} m/s: at rest {:.1} m before it",
            EDGE - furthest
        );
        assert!(story.landed(), "{:?}", story.crash);
        assert!(fastest > f64::from(speed) - 0.5, "{fastest} m/s");
        assert!((0.5..12.0).contains(&(EDGE - furthest)), "{furthest} m");
    }
}

/// A pilot's hands: sticks and switches of one moment.
fn hands(flown: &mut ClosedLoop, sticks: [f64; 4], armed: bool, mode: f64) {
    let mut all = RESTING;
    all[..4].copy_from_slice(&sticks);
    (all[4], all[5]) = (if armed { 1.0 } else { -1.0 }, mode);
    if let Some(sensing) = flown.sensing_mut() {
        sensing.set_sticks(all);
    }
}

/// If this failed, a pilot could not take off, fly and land by hand, or the vehicle would not
/// disarm after it. The mode switch selects position, then altitude, then stabilize.
#[test]
fn a_flight_by_hand_in_every_manual_mode() {
    for (number, mode) in [
        (2.0, Mode::Position),
        (1.0, Mode::Altitude),
        (8.0, Mode::Stabilize),
    ] {
        let setup = with_parameter(on_sensors(Rtk), "COM_FLTMODE1", number);
        let mut setup = with_parameter(setup, "RC_DEADBAND", 0.03);
        if let Some(sensors) = &mut setup.sensors {
            sensors.remote = true;
        }
        setup.conditions.wind = mean_wind_from(0.5, 200.0);
        setup.conditions.gust = 0.1;
        setup.conditions.pushes.clear();
        let mut flown =
            windhover_sim::flight::closed_loop(&setup, &windhover_tests::plan::short()).expect("a vehicle");
        let mut recording = Recording::default();
        let (mut highest, mut furthest, mut seen) = (0.0f64, 0.0f64, false);
        for tick in 0..70_000u64 {
            let time = tick as f64 * 1e-3;
            let truth = flown.world.truth();
            let (height, climb) = (-truth.position.z, -truth.velocity.z);
            // How fast the pilot wants to climb, as a share of the stick's way.
            let wanted = match time {
                t if t < 8.5 => -1.0,
                t if t < 30.0 && height < 6.0 => 0.8,
                t if t < 36.0 => 0.0,
                _ if height > 1.0 => -0.8,
                _ if height > 0.02 => -0.4,
                _ => -1.0,
            };
            // In stabilize the stick is a thrust: the pilot looks how fast it climbs.
            let throttle = match mode {
                Mode::Stabilize if wanted > -1.0 => 0.3 * (wanted - climb),
                _ => wanted,
            };
            let pitch = if (30.0..33.0).contains(&time) { 0.3 } else { 0.0 };
            // Off, to a position that selects nothing, then to the first; on at 7 s.
            let switch = if time < 5.0 { -0.5 } else { -1.0 };
            hands(&mut flown, [0.0, pitch, throttle, 0.0], time > 7.0, switch);
            flown.tick(&mut recording);
            let truth = flown.world.truth();
            highest = windhover_math::max(highest, -truth.position.z);
            furthest = windhover_math::max(furthest, libm::hypot(truth.position.x, truth.position.y));
            let supervisor = flown.outer().supervisor();
            seen |= supervisor.phase() == Phase::Flying && supervisor.mode() == mode;
        }
        assert_eq!(flown.world.crash(), None, "{mode:?}");
        windhover_tests::replay(&setup, &windhover_tests::plan::short(), &recording);
        assert!(seen, "{mode:?} did not fly: {:?}", flown.outer().supervisor());
        assert!(
            highest > 3.0 && furthest > 1.0,
            "{mode:?}: {highest} m up, {furthest} m away"
        );
        let phase = flown.outer().supervisor().phase();
        assert_eq!(
            phase,
            Phase::Disarmed,
            "{mode:?}, {}",
            flown.world.truth().position
        );
    }
}
