//! A core that is not told the declination, as on a board: the first fix says how far magnetic north
//! is from true north.

use windhover_autopilot::{Blocker, Command, Mode, Phase};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{max, min};
use windhover_model::Conditions;
use windhover_sim::closed_loop::ClosedLoop;
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file::MissionFile;
use windhover_sim::sensors::{EarthField, RESTING, Receiver};
use windhover_tests::plan::{HOME, short};
use windhover_tests::{on_sensors, recorded, seeded, with_parameter};

/// 15° east.
const SEATTLE: GlobalPosition = GlobalPosition {
    latitude: 476_062_000,
    longitude: -1_223_321_000,
    altitude: 50_000,
};
/// 20° east.
const AUCKLAND: GlobalPosition = GlobalPosition {
    latitude: -368_485_000,
    longitude: 1_747_633_000,
    altitude: 20_000,
};
/// 26° west.
const CAPE_TOWN: GlobalPosition = GlobalPosition {
    latitude: -339_249_000,
    longitude: 184_241_000,
    altitude: 15_000,
};

/// The short mission, at another place.
fn short_at(home: GlobalPosition) -> MissionFile {
    let mut mission = short();
    mission.home = Some((home.latitude, home.longitude, home.altitude));
    for item in mission.items.iter_mut().filter(|item| item.x != 0) {
        let planned = GlobalPosition {
            latitude: item.x,
            longitude: item.y,
            ..HOME
        };
        let local = LocalFrame::new(HOME).to_local(planned);
        let place = LocalFrame::new(home).to_global(local);
        (item.x, item.y) = (place.latitude, place.longitude);
    }
    mission
}

/// On sensors, with the declination unknown.
fn untold() -> Setup {
    let mut setup = on_sensors(Receiver::Standard);
    setup.sensors.as_mut().expect("sensors").own_declination = true;
    setup
}

/// The same, with a receiver that is silent for so many seconds from the start.
fn late(seconds: f64) -> Setup {
    let mut setup = untold();
    let fault = format!("gnss-dropout@0,{seconds}");
    setup.sensors.as_mut().expect("sensors").faults = vec![fault.parse().expect("a fault of the list")];
    setup
}

fn declination_at(home: GlobalPosition) -> f64 {
    let earth = EarthField::at(home).expect("a place on Earth");
    f64::from(earth.declination).to_degrees()
}

/// How far the estimated heading is from the true one, which must be known, degrees.
fn heading_error(flown: &ClosedLoop) -> f64 {
    let known = &flown.outer().estimation().estimate().known;
    assert!(known.heading, "the heading is not known");
    heading_of(flown)
}

/// The same, whether it is known or not.
fn heading_of(flown: &ClosedLoop) -> f64 {
    let estimate = flown.outer().estimation().estimate();
    let off = f64::from(estimate.attitude.heading()) - flown.world.truth().attitude.heading();
    (off.to_degrees() + 180.0).rem_euclid(360.0) - 180.0
}

fn run(flown: &mut ClosedLoop, seconds: f64) {
    let ticks = (seconds * f64::from(flown.inner_config().imu_rate)) as u64;
    for _ in 0..ticks {
        flown.tick(&mut ());
    }
}

#[test]
fn missions_are_flown_by_true_north_wherever_they_are_and_replay() {
    for home in [SEATTLE, AUCKLAND, CAPE_TOWN] {
        assert!(declination_at(home).abs() > 14.0, "{home:?} shows nothing");
        for seed in 1..=3 {
            let (flown, _) = recorded(&seeded(&untold(), seed), &short_at(home));
            let figures = flown.figures;
            assert!(figures.completed, "{home:?} {seed}: {}", figures.ended);
            let heading = figures.heading_rmse_deg.expect("a heading");
            assert!(heading < 2.0, "{home:?} {seed}: {heading}°");
        }
    }
}

#[test]
fn a_heading_by_magnetic_north_is_turned_by_the_first_fix_before_a_mission_can_be_armed() {
    for home in [SEATTLE, AUCKLAND, CAPE_TOWN] {
        let mut flown = flight::ready(&late(20.0), &short_at(home)).expect("a vehicle that flies");
        flown.mailboxes.queues.command.push(Command::Fly(Mode::Mission));
        run(&mut flown, 15.0);
        let magnetic = heading_error(&flown) + declination_at(home);
        assert!(magnetic.abs() < 2.0, "{home:?}: {magnetic}° from magnetic north");
        let blockers = flown.outer().blockers();
        assert!(blockers.contains(Blocker::PositionUnknown) && !blockers.contains(Blocker::HeadingUnknown));
        while !flown.outer().estimation().estimate().known.position {
            assert!(flown.world.truth().time < 30.0, "no position");
            flown.tick(&mut ());
        }
        let first = heading_error(&flown);
        assert!(first.abs() < 2.0, "{home:?}: {first}° when the position is known");
        run(&mut flown, 10.0);
        assert!(
            heading_error(&flown).abs() < 2.0,
            "{home:?}: {}°",
            heading_error(&flown)
        );
        assert!(!flown.outer().estimation().is_compass_lost());
    }
}

/// If this failed, a fix that comes in flight would shake the vehicle, or leave it with a wrong north.
#[test]
fn a_first_fix_in_flight_turns_the_heading_and_not_the_vehicle_at_once() {
    // The mode switch selects altitude: that needs no position.
    let mut setup = with_parameter(late(30.0), "COM_FLTMODE1", 1.0);
    setup.sensors.as_mut().expect("sensors").remote = true;
    setup.conditions = Conditions::default();
    let mut flown = flight::closed_loop(&setup, &short_at(AUCKLAND)).expect("a vehicle that flies");
    let (mut fastest, mut tilted) = (0.0f64, 1.0f64);
    let mut before = None;
    while flown.world.truth().time < 45.0 {
        let truth = flown.world.truth();
        let (time, height) = (truth.time, -truth.position.z);
        let climb = match time {
            t if t < 8.5 => -1.0,
            _ if height < 5.0 => 0.6,
            _ => 0.0,
        };
        let mut sticks = RESTING;
        (sticks[2], sticks[4]) = (climb, if time > 7.0 { 1.0 } else { -1.0 });
        sticks[5] = if time < 5.0 { -0.5 } else { -1.0 };
        flown.sensing_mut().expect("sensors").set_sticks(sticks);
        flown.tick(&mut ());
        if flown.outer().estimation().frame().is_none() {
            before = Some((flown.outer().supervisor().phase(), heading_of(&flown)));
        } else {
            fastest = max(fastest, truth.body_rate.z.abs());
            tilted = min(tilted, truth.attitude.cos_tilt());
        }
    }
    assert_eq!(flown.world.crash(), None);
    let (phase, magnetic) = before.expect("a time without a fix");
    assert_eq!(phase, Phase::Flying, "the fix came on the ground");
    assert!((magnetic + declination_at(AUCKLAND)).abs() < 3.0, "{magnetic}°");
    let off = heading_error(&flown);
    assert!(off.abs() < 3.0, "{off}°");
    // The heading's setpoint goes back at 0.1 rad/s.
    assert!(fastest < 0.3, "{fastest} rad/s");
    assert!(tilted > 0.98, "cosine of the tilt {tilted}");
}
