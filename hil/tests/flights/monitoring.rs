//! The mission for monitoring, on the board's own sensors, as a ground station has it flown.

use std::time::Instant;

use mavlink::dialects::common::{HEARTBEAT_DATA, MavCmd, MavMissionResult, MavResult};
use windhover_hil::figures::Figures;
use windhover_hil::flight::{Outcome, Plan};
use windhover_hil::time::SECOND;
use windhover_math::max;
use windhover_model::{Conditions, mean_wind_from};

use crate::station::{Station, monitoring};
use crate::{CALIBRATED, is_long, on_sensors};

/// A board with all sensors at the mission's home, in wind.
fn in_wind(rate: u32, seed: u64) -> Plan {
    let mut plan = on_sensors(rate, seed);
    plan.conditions = Conditions {
        wind: mean_wind_from(4.47, 206.6),
        gust: 1.0,
        seed,
        ..plan.conditions
    };
    plan
}

/// From the ground to the ground: ten photos, and all motors off.
fn fly_the_mission(station: &mut Station) -> Figures {
    let begin = (Instant::now(), station.flight.machine.now());
    station.arm(60.0);
    station.flight.begin_figures();
    let start = station.command(MavCmd::MAV_CMD_MISSION_START, [0.0; 7]);
    assert_eq!(start, MavResult::MAV_RESULT_ACCEPTED, "{:#?}", station.texts);
    station.until(10.0, "armed", |station| station.armed);
    station.until(400.0, "the mission's end", |station| {
        station.texts.iter().any(|text| text == "Mission finished")
    });
    if is_long() {
        // Ten minutes in all, the rest of them on hold.
        let flown = (station.flight.machine.now() - begin.1) as f64 / SECOND as f64;
        station.run(max(600.0 - flown, 0.0));
    }
    let home = station.command(MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, [0.0; 7]);
    assert_eq!(home, MavResult::MAV_RESULT_ACCEPTED, "{:#?}", station.texts);
    station.until(120.0, "landed and disarmed", |station| !station.armed);
    station.run(0.5);
    let wall = begin.0.elapsed().as_secs_f64();
    let virtual_s = (station.flight.machine.now() - begin.1) as f64 / SECOND as f64;
    println!(
        "mission: {} photos, {virtual_s:.0} s of virtual time in {wall:.0} s",
        station.photos
    );
    let log = station.flight.flight_log();
    let outcome = Outcome {
        stopped: station.flight.stopped(),
        ..Outcome::default()
    };
    let figures = Figures::new(&mut station.flight, outcome, &log, wall);
    println!("{}", figures.text());
    figures
}

/// It aligns, takes the mission, arms, flies, takes ten photos, returns, lands and disarms; its log
/// replays equal.
#[test]
fn the_flashed_firmware_flies_the_uploaded_mission_on_its_sensors() {
    let mut station = Station::new(&in_wind(1000, 1));
    station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
    for name in CALIBRATED {
        station.set_parameter(name, 1.0);
    }
    assert_eq!(
        station.upload(&monitoring()),
        MavMissionResult::MAV_MISSION_ACCEPTED
    );
    let figures = fly_the_mission(&mut station);
    assert_eq!(station.photos, 10, "{:#?}", station.texts);
    assert!(figures.outcome.stopped);
    assert!(figures.replays(), "{:?}", figures.replay);
    let (counts, health) = (figures.counts.expect("once a second"), figures.health);
    assert_eq!(counts.missed, 0, "deadlines");
    let latency = health.expect("once a second").latency_max;
    assert!(
        latency <= 150,
        "{latency} us from data-ready to the compare registers"
    );
    assert!(figures.load <= 0.6, "{}", figures.load);
}
