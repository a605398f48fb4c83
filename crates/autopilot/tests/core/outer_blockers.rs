//! What keeps a vehicle from arming: every reason, all at once, and who may arm in spite of it.

use windhover_autopilot::fence::items::command::CIRCLE_INCLUSION;
use windhover_autopilot::mission::PlanKind;
use windhover_autopilot::mission::action::command::NAV_TAKEOFF;
use windhover_autopilot::{
    BarometerSample, BatterySample, Blocker, Blockers, Command, CompassSample, Mode, MotorState, Phase,
    Sticks, Stop, Urgent, Why,
};
use windhover_math::{Quaternion, Vector3};

use super::flight::{Flight, commit, frame};
use super::{item, waypoint};

fn ready() -> Flight {
    let mut flight = Flight::new();
    flight.run(0.2);
    flight
}

/// It stands and knows its attitude by its own sensors, which nobody has calibrated.
fn on_sensors() -> Flight {
    let mut flight = Flight::new();
    flight.seen = false;
    flight.run(6.0);
    flight
}

fn pilot(throttle: f32) -> Sticks {
    Sticks {
        throttle,
        ..Sticks::default()
    }
}

/// A voltage of all cells, V, and hardly any current.
fn battery(flight: &mut Flight, voltage: f32) {
    for _ in 0..600 {
        let sample = BatterySample {
            time: u64::from(flight.tick) * 1000,
            voltage: (voltage / 11.0 / 3.3 * 4095.0) as u16,
            current: 10,
        };
        flight.inputs.battery.push(sample).expect("room");
        flight.step();
    }
}

/// A compass and a barometer that are heard for some seconds and then fall silent.
fn sensors_fall_silent() -> Flight {
    let mut flight = Flight::new();
    flight.seen = false;
    for step in 0..2500u64 {
        let time = step * 4000;
        if step % 5 == 0 {
            let counts = [2100, 0, 4300];
            flight
                .inputs
                .compass
                .push(CompassSample { time, counts })
                .expect("room");
            let pressure = 95_600.0 + (step % 3) as f32;
            flight
                .inputs
                .barometer
                .push(BarometerSample { time, pressure })
                .expect("room");
        }
        flight.step();
    }
    flight.run(12.0);
    flight
}

fn outside_the_fence() -> Flight {
    let mut flight = ready();
    let around = waypoint(100.0, 0.0, 0.0);
    flight.fence = vec![windhover_autopilot::mission::MissionItem {
        command: CIRCLE_INCLUSION,
        frame: 0,
        params: [20.0, 0.0, 0.0, 0.0],
        ..around
    }];
    flight.obey(commit(PlanKind::Fence, 1));
    flight
}

/// Flights that cannot arm, each with the blockers that are meant; others may be there besides.
fn scenes() -> Vec<(Flight, &'static [Blocker])> {
    use Blocker::*;
    let mut stopped = ready();
    stopped.stopped = Some(Stop::Commanded(Urgent::Kill));
    let mut unaligned = Flight::new();
    unaligned.seen = false;
    unaligned.step();
    let mut tilted = ready();
    tilted.attitude = Quaternion::from_rotation_vector(Vector3::new(0.0, 0.7, 0.0));
    let mut deaf = ready();
    deaf.missing = 4;
    deaf.run(3.0);
    let mut empty = ready();
    battery(&mut empty, 13.0);
    let mut alone = ready();
    alone.write("COM_RC_IN_MODE", 0.0);
    let mut lost = ready();
    lost.steady.rc = Some(frame(1000));
    lost.run(0.5);
    lost.obey(Command::Fly(Mode::Stabilize));
    lost.steady.rc = None;
    let mut eager = ready();
    eager.steady.sticks = Some(pilot(0.0));
    eager.step();
    eager.obey(Command::Fly(Mode::Position));
    let mut cleared = ready();
    cleared.store(&[item(NAV_TAKEOFF, [0.0; 4]), waypoint(10.0, 0.0, 10.0)]);
    cleared.obey(Command::Fly(Mode::Mission));
    cleared.obey(commit(PlanKind::Mission, 0));
    let mut unguided = ready();
    unguided.steady.setpoint = Some(windhover_control::TrajectorySetpoint::at_rest(-Vector3::z(), 0.0));
    unguided.step();
    unguided.obey(Command::Fly(Mode::Offboard));
    unguided.steady.setpoint = None;
    let mut damaged = ready();
    damaged.outer = damaged.outer.with_damaged_storage();
    let mut all = vec![
        (stopped, [Stopped].as_slice()),
        (unaligned, &[AttitudeUnknown, HeightUnknown, PositionUnknown]),
        (tilted, &[Tilted]),
        (deaf, &[ImuUnreliable]),
        (
            on_sensors(),
            &[
                GyroUncalibrated,
                AccelerometerUncalibrated,
                CompassUncalibrated,
                CompassFault,
                BarometerFault,
                HeadingUnknown,
                PositionUnknown,
            ],
        ),
        (
            sensors_fall_silent(),
            &[CompassFault, BarometerFault, PositionUnknown],
        ),
        (empty, &[BatteryLow]),
        (alone, &[RcMissing]),
        (lost, &[RcLost, NoSticks]),
        (eager, &[SticksUnsafe]),
        (outside_the_fence(), &[OutsideFence]),
        (cleared, &[NoMission]),
        (unguided, &[NoSetpoint]),
        (damaged, &[StorageDamaged]),
    ];
    for (flight, _) in &mut all {
        flight.run(1.0);
    }
    all
}

fn blockers(flight: &mut Flight) -> Blockers {
    match flight.refused(Command::Arm) {
        Why::Blocked(blockers) => blockers,
        other => panic!("{other:?}"),
    }
}

/// Each blocker is found, is told while disarmed as in the refusal, and whoever insists arms in spite
/// of it: but for motors that are held stopped.
#[test]
fn every_blocker_is_found_and_yields_to_force() {
    let mut found = Blockers::default();
    for (mut flight, meant) in scenes() {
        let told = flight.report().blockers;
        let refused = blockers(&mut flight);
        assert_eq!(told, refused, "{meant:?}");
        for blocker in meant {
            assert!(
                refused.contains(*blocker),
                "{blocker:?}: {:?}",
                refused.iter().collect::<Vec<_>>()
            );
        }
        let text = Why::Blocked(refused).to_string();
        assert!(
            refused.iter().all(|blocker| text.contains(blocker.text())),
            "{text}"
        );
        assert_eq!(flight.report().phase, Phase::Disarmed);
        found = found.or(refused);
        if refused.contains(Blocker::Stopped) {
            let why = flight.refused(Command::ForceArm);
            assert_eq!(why, Why::Blocked(Blockers::of(Blocker::Stopped)));
        } else {
            flight.obey(Command::ForceArm);
            assert_eq!(flight.report().phase, Phase::Armed, "{meant:?}");
            assert_eq!(flight.result.motors, MotorState::Idle, "{meant:?}");
        }
    }
    let missing = Blocker::ALL.iter().filter(|blocker| !found.contains(**blocker));
    // Nothing of the commands makes this one: a stored fence is checked before it counts.
    assert!(missing.eq(&[Blocker::FenceInvalid]), "not produced");
}

/// A fence that is damaged after it was checked: it is not flown with, nor without.
#[test]
fn a_fence_that_cannot_be_read_any_more_blocks() {
    let mut flight = outside_the_fence();
    flight.obey(commit(PlanKind::Fence, 1));
    // Between the commit and the step that brings it into the frame.
    flight.fence[0].command = 16;
    flight.run(1.0);
    assert!(blockers(&mut flight).contains(Blocker::FenceInvalid));
}

/// Not the first reason, but all: otherwise a pilot mends one after the other.
#[test]
fn all_blockers_are_told_at_once() {
    let mut flight = outside_the_fence();
    flight.outer = flight.outer.with_damaged_storage();
    flight.write("COM_RC_IN_MODE", 0.0);
    flight.attitude = Quaternion::from_rotation_vector(Vector3::new(0.7, 0.0, 0.0));
    battery(&mut flight, 13.0);
    let wanted = [
        Blocker::Tilted,
        Blocker::BatteryLow,
        Blocker::RcMissing,
        Blocker::OutsideFence,
        Blocker::StorageDamaged,
    ];
    let all = blockers(&mut flight);
    assert!(all.iter().eq(wanted), "{:?}", all.iter().collect::<Vec<_>>());
}
