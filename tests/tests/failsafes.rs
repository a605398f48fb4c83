//! A flight for every row of the failsafes' table, on sensors: the fault is injected, the named
//! action follows within its time, and the vehicle ends where it should.

use rayon::prelude::*;
use windhover_autopilot::{Mode, Row, Station};
use windhover_math::Vector3;
use windhover_model::mean_wind_from;
use windhover_model::sensor::fault::SensorFault;
use windhover_sim::closed_loop::ClosedLoop;
use windhover_sim::flight::Setup;
use windhover_sim::mission_file::MissionFile;
use windhover_sim::sensors::Receiver::Rtk;
use windhover_tests::failsafe::{Story, choose, every, fly, guide, once};
use windhover_tests::plan::Plan;
use windhover_tests::{on_sensors, with_parameter, write};

/// When most faults begin, s: the vehicle flies between two stops.
const AT: f64 = 40.0;

fn faulty(faults: &[&str]) -> Setup {
    let mut setup = on_sensors(Rtk);
    if let Some(sensors) = &mut setup.sensors {
        sensors.faults = faults
            .iter()
            .map(|fault| fault.parse::<SensorFault>().expect("a fault"))
            .collect();
    }
    setup
}

/// A battery of this charge whose voltage drops by a volt, as if a part of it were suddenly gone.
fn sagging(charge: f64) -> Setup {
    let mut setup = with_parameter(faulty(&["battery-bias-step@40"]), "BAT1_CAPACITY", -1.0);
    if let Some(sensors) = &mut setup.sensors {
        sensors.charge = Some(charge);
    }
    setup
}

/// In a light breeze: a vehicle that comes down without a position touches down as fast as it
/// blows.
fn breeze(mut setup: Setup) -> Setup {
    setup.conditions.wind = mean_wind_from(1.0, 180.0);
    setup.conditions.gust = 0.2;
    setup
}

/// Pressed down until the rotors give all they can.
fn pushed_down() -> Setup {
    let mut setup = on_sensors(Rtk);
    setup.conditions.pushes = vec![windhover_model::Push {
        start: AT,
        force: Vector3::new(0.0, 0.0, 11.9),
        duration: 6.0,
    }];
    setup
}

/// In wind that the tilt it may fly with does not hold.
fn windy() -> Setup {
    let mut setup = with_parameter(on_sensors(Rtk), "POS_TILT_MAX", 0.25);
    setup.conditions.wind = mean_wind_from(6.6, 180.0);
    setup.conditions.gust = 0.0;
    setup
}

/// With a pilot.
fn remote(mut setup: Setup) -> Setup {
    if let Some(sensors) = &mut setup.sensors {
        sensors.remote = true;
    }
    setup
}

/// Out and back at 20 m, with a stop 60 m north, and a minute's hold there.
fn mission() -> MissionFile {
    Plan::new()
        .takeoff(20.0)
        .waypoint(1.0, 0.5, 60.0, 0.0, 20.0)
        .photo()
        .waypoint(60.0, 0.5, 60.0, 40.0, 20.0)
        .photo()
        .file()
}

/// Where a flight should end.
#[derive(Clone, Copy, Debug)]
enum End {
    /// Landed at home.
    Home,
    /// Landed somewhere along its way, or where the wind took it.
    Somewhere,
    /// With the motors off, wherever it was.
    MotorsOff,
    /// The mission was flown to its end, and the vehicle landed.
    Completed,
}

use End::{Completed, Home, MotorsOff, Somewhere};

struct Case {
    row: Row,
    setup: Setup,
    mission: MissionFile,
    /// When the fault begins; the action follows within the second number, s.
    at: f64,
    within: f64,
    /// The mode that acts, where it is one.
    mode: Option<Mode>,
    end: End,
    meddle: fn(&mut ClosedLoop, f64),
}

fn case(row: Row, setup: Setup, within: f64, mode: Option<Mode>, end: End) -> Case {
    Case {
        row,
        setup,
        mission: mission(),
        at: AT,
        within,
        mode,
        end,
        meddle: |_, _| {},
    }
}

fn parameter(flown: &mut ClosedLoop, name: &str, value: f32) {
    flown.mailboxes.queues.parameter.push(write(name, value));
}

fn cases() -> Vec<Case> {
    let groups = [
        motion(),
        position(),
        battery(),
        thrust(),
        links(),
        sensors(),
        fence(),
    ];
    groups.into_iter().flatten().collect()
}

/// What moves it, and what measures that.
fn motion() -> Vec<Case> {
    vec![
        case(
            Row::ImuMissing,
            faulty(&["imu-dropout@40"]),
            0.03,
            None,
            MotorsOff,
        ),
        Case {
            meddle: |flown, time| flown.dead_rotor = (time > AT).then_some(0),
            ..case(
                Row::TumbleLow,
                [
                    ("FD_FAIL_HEIGHT", 30.0),
                    ("FD_FAIL_TILT", 0.9),
                    ("FD_FAIL_TIME", 0.1),
                ]
                .into_iter()
                .fold(on_sensors(Rtk), |setup, (name, value)| {
                    with_parameter(setup, name, value)
                }),
                4.0,
                None,
                MotorsOff,
            )
        },
        Case {
            meddle: |flown, time| {
                flown.dead_rotor = (AT..AT + 1.0).contains(&time).then_some(0);
                if once(time, AT + 15.0) {
                    choose(flown, Mode::Return);
                }
            },
            ..case(Row::TumbleHigh, on_sensors(Rtk), 4.0, Some(Mode::Hold), Home)
        },
        Case {
            meddle: |flown, time| {
                if once(time, AT) {
                    parameter(flown, "EST_GYRO_NOISE", 0.2);
                }
            },
            ..case(
                Row::AttitudeUnknown,
                breeze(faulty(&["gnss-dropout@40"])),
                5.0,
                Some(Mode::Descend),
                Somewhere,
            )
        },
    ]
}

/// Where it is.
fn position() -> Vec<Case> {
    vec![
        case(
            Row::HeightUnknown,
            breeze(faulty(&["gnss-dropout@40", "baro-dropout@40"])),
            5.5,
            Some(Mode::Descend),
            Somewhere,
        ),
        case(
            Row::PositionLost,
            faulty(&["gnss-dropout@40,30"]),
            10.5,
            Some(Mode::Altitude),
            Completed,
        ),
        case(
            Row::PositionGone,
            breeze(faulty(&["gnss-dropout@40"])),
            70.5,
            Some(Mode::Descend),
            Somewhere,
        ),
        case(
            Row::ImuUnreliable,
            faulty(&["accel-freeze@40,8"]),
            2.5,
            Some(Mode::Land),
            Somewhere,
        ),
    ]
}

/// The battery.
fn battery() -> Vec<Case> {
    vec![
        case(
            Row::BatteryEmergency,
            sagging(0.50),
            12.0,
            Some(Mode::Land),
            Somewhere,
        ),
        case(
            Row::BatteryCritical,
            sagging(0.745),
            12.0,
            Some(Mode::Return),
            Home,
        ),
        case(Row::BatteryLow, sagging(0.80), 12.0, None, Completed),
        Case {
            // So far out the charge is just enough for the way home.
            at: 79.0,
            mission: Plan::new()
                .takeoff(20.0)
                .speed(8.0)
                .waypoint(0.0, 2.0, 1500.0, 0.0, 20.0)
                .file(),
            ..case(
                Row::RangeShort,
                with_parameter(on_sensors(Rtk), "BAT1_CAPACITY", 500.0),
                2.0,
                Some(Mode::Return),
                Home,
            )
        },
    ]
}

/// What the rotors can do.
fn thrust() -> Vec<Case> {
    vec![
        case(
            Row::MotorSaturated,
            pushed_down(),
            6.0,
            Some(Mode::Land),
            Somewhere,
        ),
        Case {
            at: 5.0,
            ..case(Row::WindTooStrong, windy(), 20.0, Some(Mode::Land), Somewhere)
        },
    ]
}

/// Who tells it what to do.
fn links() -> Vec<Case> {
    vec![
        case(
            Row::RcLost,
            remote(faulty(&["rc-dropout@40"])),
            0.6,
            Some(Mode::Return),
            Home,
        ),
        Case {
            meddle: |flown, time| {
                if time < AT && every(time, 1000) {
                    flown.mailboxes.queues.station.push(Station { system: 255 });
                }
            },
            ..case(
                Row::StationLost,
                with_parameter(on_sensors(Rtk), "NAV_DLL_ACT", 2.0),
                12.0,
                Some(Mode::Return),
                Home,
            )
        },
        Case {
            meddle: |flown, time| {
                if (AT - 5.0..AT).contains(&time) && every(time, 100) {
                    guide(flown, 0.0, 2.0);
                }
                if once(time, AT - 4.5) {
                    choose(flown, Mode::Offboard);
                }
                if once(time, AT + 10.0) {
                    choose(flown, Mode::Return);
                }
            },
            ..case(Row::OffboardLost, on_sensors(Rtk), 0.6, Some(Mode::Hold), Home)
        },
    ]
}

/// Sensors that it can do without for a while, and the outer step.
fn sensors() -> Vec<Case> {
    vec![
        case(
            Row::CompassFault,
            faulty(&["compass-dropout@40"]),
            3.5,
            Some(Mode::Return),
            Home,
        ),
        case(
            Row::BarometerFault,
            faulty(&["baro-dropout@40"]),
            4.5,
            Some(Mode::Return),
            Home,
        ),
        case(
            Row::GnssLost,
            faulty(&["gnss-dropout@40,6"]),
            2.0,
            None,
            Completed,
        ),
        Case {
            meddle: |flown, time| {
                if once(time, AT) {
                    flown.delay = 40;
                }
            },
            ..case(Row::OuterSilent, on_sensors(Rtk), 0.3, None, Completed)
        },
    ]
}

/// The fence.
fn fence() -> Vec<Case> {
    vec![Case {
        meddle: |flown, time| {
            if (AT..AT + 20.0).contains(&time) && every(time, 100) {
                guide(flown, 10.0, 0.0);
            }
            if once(time, AT + 0.5) {
                choose(flown, Mode::Offboard);
            }
            if once(time, AT + 30.0) {
                choose(flown, Mode::Return);
            }
        },
        ..case(
            Row::Fence,
            with_parameter(
                with_parameter(on_sensors(Rtk), "GF_MAX_HOR_DIST", 120.0),
                "MPC_VEL_MANUAL",
                10.0,
            ),
            20.0,
            Some(Mode::Hold),
            Home,
        )
    }]
}

/// What is wrong with how it went, if anything is.
fn judge(case: &Case, story: &Story) -> Result<String, String> {
    let turn = story.acted(case.row).ok_or("it does not act")?;
    let after = turn.time - case.at;
    if !(0.0..=case.within).contains(&after) {
        return Err(format!("acts after {after:.2} s, at most {} s", case.within));
    }
    if let Some(mode) = case.mode {
        let flew = story
            .flew(mode, turn.time)
            .ok_or(format!("{mode:?} does not fly"))?;
        if flew.time > turn.time + 0.01 {
            return Err(format!(
                "{mode:?} flies only {:.2} s later",
                flew.time - turn.time
            ));
        }
    }
    let home = story.ended_at(0.0, 0.0);
    let good = match case.end {
        Home => story.landed() && home < 1.0,
        Somewhere => story.landed(),
        MotorsOff => story.disarmed(),
        Completed => story.landed() && story.finished() && story.trace.photos().len() == 2,
    };
    if !good {
        return Err(format!(
            "does not end as {:?}: {home:.1} m from home, {:?}",
            case.end, story.crash
        ));
    }
    let mode = case.mode.map_or("-", Mode::name);
    Ok(format!(
        "{after:8.2} s  {mode:10} {:?}, {home:.1} m from home",
        case.end
    ))
}

/// If this failed for a row, that fault would go unnoticed, or be answered late or wrongly.
#[test]
fn every_row_of_the_table_in_flight() {
    let cases = cases();
    for row in Row::ALL {
        assert!(cases.iter().any(|case| case.row == *row), "no flight for {row:?}");
    }
    let stories: Vec<(String, Result<String, String>, Story)> = cases
        .into_par_iter()
        .map(|case| {
            let story = fly(&case.setup, &case.mission, case.meddle);
            let name = case.row.watched().name.to_owned();
            (name, judge(&case, &story), story)
        })
        .collect();
    println!("{:20} {:>8}    mode       end", "failsafe", "acts after");
    let mut wrong = Vec::new();
    for (name, verdict, story) in stories {
        match verdict {
            Ok(line) => println!("{name:20} {line}"),
            Err(why) => {
                println!("{name:20} WRONG: {why}");
                wrong.push(format!(
                    "{name}: {why}\n{:#?}",
                    story
                        .turns()
                        .iter()
                        .map(|t| format!(
                            "{:.2} {:?} {:?} {:?} {:.1}/{:.1}/{:.1}",
                            t.time, t.phase, t.mode, t.failsafe, t.position.x, t.position.y, t.position.z
                        ))
                        .collect::<Vec<_>>()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
