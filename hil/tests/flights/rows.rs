//! Parts that are missing at the start or fail in flight, by the name of the fault: arming is
//! refused with the reason, and in flight the supervisor's row acts.

use std::sync::OnceLock;

use mavlink::dialects::common::{HEARTBEAT_DATA, MavCmd, MavResult};
use windhover_autopilot::{Blocker, Row};
use windhover_hil::figures::Figures;
use windhover_hil::flight::{Flight, Outcome, Plan};
use windhover_hil::parts::rc::Protocol;
use windhover_hil::rig::fault::Fault;
use windhover_hil::time::SECOND;
use windhover_math::{acos, max, min};

use crate::journal::{image, put_image};
use crate::station::Station;
use crate::{CALIBRATED, firmware, is_long, on_sensors};

/// Missing parts are plugged in at this time, s since power-on: later than a whole vehicle needs to
/// be ready.
const PLUGGED: f64 = 9.0;

/// Parts fail at this time: while the vehicle hovers.
const AT: f64 = 13.0;

/// So long that it does not end.
const FOR_GOOD: f64 = 1000.0;

/// How high it hovers and returns, m.
const HEIGHT: f32 = 4.0;

/// The longest that a sample may take to the motors, µs.
const LATENCY: u32 = 150;

/// Faults that begin at some time, and last.
fn faults(names: &[&str], times: &str) -> Vec<Fault> {
    let fault = |name: &&str| format!("{name}@{times}").parse().expect("a fault");
    names.iter().map(fault).collect()
}

/// A journal as of a vehicle that is calibrated, flies low, and samples at this rate.
fn prepared(rate: u32) -> &'static [u8] {
    static IMAGES: [OnceLock<Vec<u8>>; 2] = [const { OnceLock::new() }; 2];
    IMAGES[usize::from(rate != 1000)].get_or_init(|| {
        let mut station = Station::new(&on_sensors(1000, 1));
        station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
        for name in CALIBRATED {
            station.set_parameter(name, 1.0);
        }
        station.set_parameter("MIS_TAKEOFF_ALT", HEIGHT);
        station.set_parameter("RTL_RETURN_ALT", HEIGHT);
        station.set_parameter("IMU_GYRO_RATEMAX", rate as f32);
        station.run(1.5);
        image(&station.flight)
    })
}

/// At power-on, with parameters stored already.
fn station(plan: &Plan, rate: u32) -> Station {
    let mut flight = Flight::new(firmware(), plan).expect("the firmware runs");
    put_image(&mut flight, prepared(rate));
    let mut station = Station::beside(flight);
    station.wait::<HEARTBEAT_DATA>(2.0, |_| true);
    station
}

/// What the log says; it is to be whole and to replay equal.
fn figures(station: &mut Station, what: &str) -> Figures {
    let log = station.flight.flight_log();
    let outcome = Outcome {
        stopped: station.flight.stopped(),
        ..Outcome::default()
    };
    let figures = Figures::new(&mut station.flight, outcome, &log, 1.0);
    println!("{what}: {}", figures.text());
    assert!(figures.replays(), "{what}: {:?}", figures.replay);
    assert_eq!(station.flight.machine.bus().wiring.imu_misuse(), [], "{what}");
    figures
}

/// Whether all deadlines were kept since the figures before.
fn keeps_deadlines(before: &Figures, now: &Figures, what: &str) {
    let [before, counts] = [before, now].map(|figures| figures.counts.expect("once a second"));
    let since = (counts.missed - before.missed, counts.missing - before.missing);
    assert_eq!(since, (0, 0), "{what}: deadlines missed, ticks without a sample");
    let latency = now.health.expect("once a second").latency_max;
    assert!(latency <= LATENCY, "{what}: {latency} us");
}

fn ask_to_arm(station: &mut Station, arm: bool) -> MavResult {
    let arm = [f32::from(u8::from(arm)), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    station.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm)
}

/// Parts that are not there at power-on.
struct Absent {
    names: &'static [&'static str],
    /// What arming is refused for; none where it does without.
    blockers: &'static [Blocker],
    /// What the firmware says by defmt.
    said: &'static [&'static str],
    /// Whether a remote control is required.
    remote: bool,
}

const ABSENT: [Absent; 9] = [
    Absent {
        names: &["baro-absent", "compass-absent", "gnss-absent"],
        blockers: &[
            Blocker::BarometerFault,
            Blocker::CompassFault,
            Blocker::PositionUnknown,
        ],
        said: &[
            "barometer: Absent",
            "compass: Absent",
            "satellite receiver: Absent",
        ],
        remote: false,
    },
    Absent {
        names: &["rc-absent", "battery-absent"],
        blockers: &[Blocker::RcMissing],
        said: &[],
        remote: true,
    },
    Absent {
        names: &["i2c-data-low"],
        blockers: &[Blocker::BarometerFault, Blocker::CompassFault],
        said: &["barometer: BusFault", "compass: BusFault"],
        remote: false,
    },
    Absent {
        names: &["battery-absent"],
        blockers: &[],
        said: &[],
        remote: false,
    },
    Absent {
        names: &["rc-absent"],
        blockers: &[],
        said: &[],
        remote: false,
    },
    Absent {
        names: &["baro-absent"],
        blockers: &[Blocker::BarometerFault],
        said: &["barometer: Absent"],
        remote: false,
    },
    Absent {
        names: &["compass-absent"],
        blockers: &[Blocker::CompassFault],
        said: &["compass: Absent"],
        remote: false,
    },
    Absent {
        names: &["gnss-absent"],
        blockers: &[Blocker::PositionUnknown],
        said: &["satellite receiver: Absent"],
        remote: false,
    },
    Absent {
        names: &["i2c-clock-low"],
        blockers: &[Blocker::BarometerFault, Blocker::CompassFault],
        said: &["barometer: BusFault", "compass: BusFault"],
        remote: false,
    },
];

/// It starts without, names what is missing, refuses to arm for that, and arms once all is there.
fn starts_without(absent: &Absent) {
    let what = absent.names.join(", ");
    let mut plan = on_sensors(1000, 1);
    plan.rig.remote = absent.remote.then_some(Protocol::Crsf);
    plan.rig.faults = faults(absent.names, &format!("0+{PLUGGED}"));
    let mut station = station(&plan, 1000);
    if absent.remote {
        station.set_parameter("COM_RC_IN_MODE", 0.0);
    }
    station.run(2.0);
    let begun = figures(&mut station, &what);
    station.run(PLUGGED - 1.0 - station.time());
    station.texts.clear();
    let answer = ask_to_arm(&mut station, true);
    station.run(0.3);
    if absent.blockers.is_empty() {
        assert_eq!(
            answer,
            MavResult::MAV_RESULT_ACCEPTED,
            "{what}: {:#?}",
            station.texts
        );
        assert!(station.texts.iter().any(|text| text == "Armed"), "{what}");
    } else {
        assert_ne!(answer, MavResult::MAV_RESULT_ACCEPTED, "{what}");
        let refused: Vec<_> = station
            .texts
            .iter()
            .filter(|text| text.contains("refused: "))
            .collect();
        for blocker in absent.blockers {
            assert!(
                refused.iter().any(|text| text.ends_with(blocker.text())),
                "{what}: {blocker:?}: {refused:#?}"
            );
        }
    }
    ask_to_arm(&mut station, false);
    for said in absent.said {
        let mut lines = station.said().iter();
        assert!(
            lines.any(|line| line.message == *said),
            "{what}: {said}: {:#?}",
            station.said()
        );
    }
    station.run(PLUGGED - station.time());
    station.arm(30.0);
    println!(
        "{what}: armed {:.1} s after all was there",
        station.time() - PLUGGED
    );
    let now = figures(&mut station, &what);
    keeps_deadlines(&begun, &now, &what);
}

#[test]
fn a_start_without_parts_names_them_and_goes_on_once_they_are_there() {
    let most = if is_long() { ABSENT.len() } else { 3 };
    ABSENT[..most].iter().for_each(starts_without);
}

/// How a flight goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// In the air for so long, s, where it was, as far as it can know that: so many m.
    Stays(f64, f64),
    /// To where it armed, lands there and disarms.
    Returns,
}

/// Parts that fail in flight.
struct Failing {
    names: &'static [&'static str],
    /// Rows that the pilot is told.
    rows: &'static [Row],
    /// The row that acts first, if one does.
    acts: Option<Row>,
    end: End,
    /// Whether there is a remote control.
    remote: bool,
    /// How long it lasts, s.
    lasts: f64,
}

const FAILING: [Failing; 10] = [
    Failing {
        names: &["gnss-unplugged"],
        rows: &[Row::GnssLost, Row::PositionLost],
        acts: Some(Row::PositionLost),
        end: End::Stays(13.0, 6.0),
        remote: false,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["baro-unplugged"],
        rows: &[Row::BarometerFault],
        acts: Some(Row::BarometerFault),
        end: End::Returns,
        remote: false,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["compass-unplugged"],
        rows: &[Row::CompassFault],
        acts: Some(Row::CompassFault),
        end: End::Returns,
        remote: false,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["i2c-data-low"],
        rows: &[Row::CompassFault, Row::BarometerFault],
        acts: Some(Row::CompassFault),
        end: End::Returns,
        remote: false,
        lasts: 6.0,
    },
    Failing {
        names: &["babble-usart1", "babble-usart2", "babble-usart6"],
        rows: &[Row::GnssLost],
        acts: Some(Row::RcLost),
        end: End::Returns,
        remote: true,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["i2c-clock-low"],
        rows: &[Row::CompassFault, Row::BarometerFault],
        acts: Some(Row::CompassFault),
        end: End::Returns,
        remote: false,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["rc-unplugged"],
        rows: &[Row::RcLost],
        acts: Some(Row::RcLost),
        end: End::Returns,
        remote: true,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["battery-unplugged"],
        rows: &[],
        acts: None,
        end: End::Stays(8.0, 3.0),
        remote: false,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["gnss-unplugged", "baro-unplugged"],
        rows: &[Row::GnssLost, Row::BarometerFault],
        acts: Some(Row::BarometerFault),
        end: End::Returns,
        remote: false,
        lasts: FOR_GOOD,
    },
    Failing {
        names: &["gnss-unplugged", "rc-unplugged"],
        rows: &[Row::GnssLost, Row::RcLost],
        acts: Some(Row::RcLost),
        end: End::Returns,
        remote: true,
        lasts: FOR_GOOD,
    },
];

/// Looks on for some time, or until it disarms: the attitude is kept, and the ground is touched
/// gently.
fn look_on(station: &mut Station, seconds: f64, what: &str) {
    let until = station.time() + seconds;
    let (mut before, mut fastest, mut tilt) = (station.flight.truth(), 0.0f64, 1.0f64);
    while station.time() < until && station.armed {
        station.run(0.05);
        let truth = station.flight.truth();
        tilt = min(tilt, truth.attitude.down_axis().z);
        let touches = -before.position.z > 0.02 && -truth.position.z <= 0.02;
        fastest = if touches {
            max(fastest, before.velocity.z)
        } else {
            fastest
        };
        before = truth;
    }
    let tilt = acos(tilt as f32).to_degrees();
    println!("{what}: tilted by {tilt:.1} deg at most, down on the ground at {fastest:.2} m/s");
    assert!(tilt < 25.0, "{what}: tilted by {tilt} deg");
    assert!(fastest < 1.5, "{what}: down at {fastest} m/s");
}

/// Takes off, and hovers when the time has come.
fn hover(station: &mut Station, what: &str) {
    station.arm(8.0);
    station.flight.begin_figures();
    let takeoff = station.command(MavCmd::MAV_CMD_NAV_TAKEOFF, [f32::NAN; 7]);
    assert_eq!(
        takeoff,
        MavResult::MAV_RESULT_ACCEPTED,
        "{what}: {:#?}",
        station.texts
    );
    station.until(5.0, "armed", |station| station.armed);
    println!("{what}: armed after {:.1} s", station.time());
    station.run(AT - station.time());
    let height = -station.flight.truth().position.z;
    assert!(
        (height - f64::from(HEIGHT)).abs() < 1.0,
        "{what}: at {height} m: {:#?}",
        station.texts
    );
    station.texts.clear();
}

/// How long a way is on the ground, m.
fn across(north: f64, east: f64) -> f64 {
    (north * north + east * east).sqrt()
}

/// It stays in the air for so long, and within so many m across.
fn stays(station: &mut Station, seconds: f64, drift: f64, what: &str) {
    let begin = station.flight.truth().position;
    look_on(station, seconds, what);
    assert!(station.armed, "{what}: {:#?}", station.texts);
    let moved = station.flight.truth().position - begin;
    let (across, down) = (across(moved.x, moved.y), moved.z);
    println!("{what}: moved by {across:.2} m, {down:.2} m down");
    assert!(
        across < drift && down.abs() < 1.5,
        "{what}: {across} m, {down} m down"
    );
}

/// It lands upright where it armed, and disarms.
fn returns(station: &mut Station, what: &str) {
    look_on(station, 30.0, what);
    assert!(!station.armed, "{what}: it does not land: {:#?}", station.texts);
    let truth = station.flight.truth();
    let away = across(truth.position.x, truth.position.y);
    let took = station.time() - AT;
    println!("{what}: on the ground {away:.2} m away, after {took:.1} s");
    assert!(
        away < 4.0 && -truth.position.z < 0.1,
        "{what}: {:?}",
        truth.position
    );
    assert!(truth.attitude.down_axis().z > 0.99, "{what}: it stands");
}

/// The pilot is told of each row, and of the one that acts first as of a failsafe.
fn is_told(texts: &[String], failing: &Failing, what: &str) {
    println!("{what}: {texts:#?}");
    let told = |prefix: &str, row: Row| {
        let text = format!("{prefix}{}", row.watched().text);
        texts.iter().any(|told| told.starts_with(&text))
    };
    for row in failing.rows {
        let is_told = told("Warning: ", *row) || told("Failsafe: ", *row);
        assert!(is_told, "{what}: {row:?}: {texts:#?}");
    }
    let first = texts.iter().find_map(|text| text.strip_prefix("Failsafe: "));
    let acts = failing.acts.map(|row| row.watched().text);
    assert_eq!(first.is_some(), acts.is_some(), "{what}: {texts:#?}");
    assert!(
        first.unwrap_or_default().starts_with(acts.unwrap_or_default()),
        "{what}: {first:?}"
    );
}

/// The bus was lost for its parts, and works again.
fn works_again(station: &Station, what: &str) {
    let since = (AT * SECOND as f64) as u64;
    for said in [
        "barometer: BusFault",
        "compass: BusFault",
        "barometer: works",
        "compass: works",
    ] {
        let mut lines = station.said().iter().filter(|line| line.time > since);
        assert!(lines.any(|line| line.message == said), "{what}: {said}");
    }
}

/// It hovers, parts fail, and it does what the row promises.
fn fails_in_flight(failing: &Failing, rate: u32) {
    let what = format!("{} at {rate} Hz", failing.names.join(", "));
    let mut plan = on_sensors(rate, 1);
    plan.rig.remote = failing.remote.then_some(Protocol::Crsf);
    plan.rig.faults = faults(failing.names, &format!("{AT}+{}", failing.lasts));
    let mut station = station(&plan, rate);
    hover(&mut station, &what);
    let begun = figures(&mut station, &what);
    match failing.end {
        End::Stays(seconds, drift) => stays(&mut station, seconds, drift, &what),
        End::Returns => returns(&mut station, &what),
    }
    is_told(&station.texts, failing, &what);
    if failing.lasts < FOR_GOOD {
        works_again(&station, &what);
    }
    let now = figures(&mut station, &what);
    keeps_deadlines(&begun, &now, &what);
}

#[test]
fn what_fails_in_flight_is_told_and_its_row_acts() {
    let most = if is_long() { FAILING.len() } else { 5 };
    for failing in &FAILING[..most] {
        fails_in_flight(failing, 1000);
    }
}

/// Random bytes on every port, one behind the other at the rate of its other end: the loops keep
/// all deadlines, the log is whole, and what the firmware sends still comes.
fn bears_babble(rate: u32) {
    let what = format!("babble at {rate} Hz");
    let mut plan = on_sensors(rate, 1);
    plan.rig.remote = Some(Protocol::Crsf);
    plan.rig.faults = faults(FAILING[4].names, &format!("4+{FOR_GOOD}"));
    let mut station = station(&plan, rate);
    station.run(3.5 - station.time());
    let begun = figures(&mut station, &what);
    station.run(8.0);
    station.wait::<HEARTBEAT_DATA>(2.0, |_| true);
    let now = figures(&mut station, &what);
    keeps_deadlines(&begun, &now, &what);
}

#[test]
fn babble_on_every_port_takes_nothing_from_the_loops() {
    [1000, 4000].into_iter().for_each(bears_babble);
    if is_long() {
        fails_in_flight(&FAILING[4], 4000);
    }
}
