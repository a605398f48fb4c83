//! What keeps motors still, and what happens when parts of the system fall silent.

use windhover_autopilot::{
    Blocker, Blockers, Command, Mode, MotorCommand, Phase, Preset, Refused, Urgent, Why,
};
use windhover_math::scalar::norm;
use windhover_model::ModelKind;
use windhover_sim::flight::Setup;
use windhover_tests::bench::Bench;
use windhover_tests::plan::{Plan, short};
use windhover_tests::{calm, setup};

/// A hover at 20 m that lasts as long as any test here.
fn hover() -> windhover_sim::mission_file::MissionFile {
    Plan::new()
        .takeoff(20.0)
        .waypoint(600.0, 0.5, 3.0, 0.0, 20.0)
        .file()
}

/// In the hover.
fn hovering(setup: &Setup) -> Bench {
    let bench = Bench::in_mission(setup, &hover(), 25.0);
    assert!(bench.height() > 19.0, "{} m", bench.height());
    bench
}

fn refusals(bench: &Bench, from: usize) -> Vec<Refused> {
    bench.steps[from..]
        .iter()
        .flat_map(|step| step.refusals.clone())
        .collect()
}

fn is_running(command: MotorCommand) -> bool {
    matches!(command, MotorCommand::Run(_))
}

/// Nothing but arming moves a motor: not a mission, not a setpoint, not time.
#[test]
fn motors_are_still_while_disarmed() {
    let mut bench = Bench::new(&calm(), &short());
    bench.run(0.5);
    bench.command(bench.commit());
    bench.command(Command::Fly(Mode::Mission));
    bench.command(Command::Fly(Mode::Offboard));
    bench.run(2.0);
    assert!(bench.motors.iter().all(|c| *c == MotorCommand::Disarmed));
    bench.command(Command::Arm);
    bench.run(1.0);
    assert!(matches!(bench.last(), MotorCommand::Idle(idle) if idle > 1000));
    bench.command(Command::Disarm);
    bench.run(0.1);
    assert_eq!(bench.last(), MotorCommand::Disarmed);
}

fn stops_at_once(urgent: Urgent, imu_rate: u32) {
    let mut bench = Bench::in_mission(&Setup { imu_rate, ..calm() }, &hover(), 8.0);
    // In the middle between two boundaries.
    while bench.inner.schedule().at_boundary() || bench.motors.len().is_multiple_of(2) {
        bench.tick();
    }
    assert!(is_running(bench.last()));
    let from = bench.motors.len();
    bench.urgent = Some(urgent);
    assert_eq!(bench.tick(), MotorCommand::Disarmed, "{urgent:?} in its own tick");
    // The operator's other wishes do not start them again.
    bench.command(Command::Fly(Mode::Mission));
    bench.run(0.5);
    assert!(
        bench.motors[from..].iter().all(|c| *c == MotorCommand::Disarmed),
        "{urgent:?}"
    );
    assert_eq!(bench.last_step().phase, Phase::Disarmed);
    assert!(bench.height() > 0.0, "still falling");
    bench.command(Command::Arm);
    bench.run(0.1);
    assert!(bench.last() != MotorCommand::Disarmed, "armed again");
}

/// Kill and disarm stop the motors in their own tick, at any phase of the schedule, and only
/// arming makes them turn again.
#[test]
fn urgent_commands_stop_the_motors_in_their_tick() {
    for rate in [1000, 4000] {
        stops_at_once(Urgent::Kill, rate);
        stops_at_once(Urgent::Disarm, rate);
    }
}

/// An arm command that was on its way when the kill came does not undo it.
#[test]
fn a_kill_outlives_an_arm_command_of_the_same_moment() {
    let mut bench = Bench::in_mission(&calm(), &hover(), 8.0);
    let (tick, step) = (bench.motors.len(), bench.steps.len());
    bench.command(Command::Arm);
    bench.urgent = Some(Urgent::Kill);
    bench.run(0.5);
    assert!(bench.motors[tick..].iter().all(|c| *c == MotorCommand::Disarmed));
    assert_eq!(
        refusals(&bench, step),
        [Refused::Command(
            Command::Arm,
            Why::Blocked(Blockers::of(Blocker::Stopped))
        )]
    );
}

/// A kill while the outer step is stuck holds until the outer step has seen it.
#[test]
fn a_kill_holds_while_the_outer_step_is_stuck() {
    let mut bench = hovering(&calm());
    bench.outer_alive = false;
    bench.run(0.05);
    let from = bench.motors.len();
    bench.urgent = Some(Urgent::Kill);
    bench.run(0.05);
    // The result that now comes was made before the kill, and says "run".
    bench.outer_alive = true;
    bench.run(0.3);
    assert!(bench.motors[from..].iter().all(|c| *c == MotorCommand::Disarmed));
}

/// `gap` ms without a sample; how long after its beginning the motors stopped, if they did, ms.
fn stopped_after(gap: u64, imu_rate: u32) -> Option<u64> {
    let mut bench = Bench::in_mission(&Setup { imu_rate, ..calm() }, &hover(), 12.0);
    let per_ms = u64::from(imu_rate) / 1000;
    let from = bench.motors.len() as u64;
    bench.imu_alive = false;
    for _ in 0..gap * per_ms {
        bench.tick();
    }
    bench.imu_alive = true;
    bench.run(3.0);
    let stopped = bench.motors[from as usize..]
        .iter()
        .position(|command| !is_running(*command));
    if stopped.is_none() {
        assert!(norm(bench.world.truth().velocity) < 3.0, "flies on");
    } else {
        assert_eq!(bench.last(), MotorCommand::Disarmed, "for good");
    }
    stopped.map(|tick| tick as u64 / per_ms)
}

/// Without a sample for 20 ms the motors stop; a shorter gap is flown through.
#[test]
fn a_dead_imu_stops_the_motors_after_20_ms() {
    for rate in [1000, 4000] {
        for gap in [1, 5, 19] {
            assert_eq!(stopped_after(gap, rate), None, "{gap} ms at {rate} Hz");
        }
        let stopped = stopped_after(40, rate);
        assert!(
            stopped.is_some_and(|after| (19..=21).contains(&after)),
            "{stopped:?} at {rate} Hz"
        );
    }
}

/// Arming without an IMU moves no motor, not even for a tick.
#[test]
fn a_dead_imu_does_not_arm() {
    let mut bench = Bench::new(&calm(), &hover());
    bench.run(0.5);
    bench.imu_alive = false;
    bench.run(0.5);
    bench.command(Command::Arm);
    bench.run(0.5);
    assert!(bench.motors.iter().all(|c| *c == MotorCommand::Disarmed));
    let refused = Refused::Command(Command::Arm, Why::Blocked(Blockers::of(Blocker::Stopped)));
    assert_eq!(refusals(&bench, 0), [refused]);
    bench.imu_alive = true;
    bench.run(0.1);
    bench.command(Command::Arm);
    bench.run(0.1);
    assert!(bench.last() != MotorCommand::Disarmed, "well again");
}

/// An outer step that falls silent for more than 100 ms: level and sinking, never fast, also in
/// the middle of an acceleration; and the mission goes on when it comes back.
#[test]
fn a_silent_outer_step_means_level_and_down() {
    for (seconds, preset) in [(25.0, Preset::Windhover), (21.5, Preset::Paper)] {
        let setup = Setup { preset, ..calm() };
        let mut bench = Bench::in_mission(&setup, &hover(), seconds);
        bench.outer_alive = false;
        bench.run(0.09);
        let commands = bench.motors[bench.motors.len() - 20..].to_vec();
        assert!(commands.iter().all(|c| is_running(*c)));
        bench.run(0.6);
        let tilt = |bench: &Bench| libm::acos(bench.world.truth().attitude.cos_tilt()).to_degrees();
        assert!(tilt(&bench) < 2.0, "{}°", tilt(&bench));
        let before = bench.height();
        bench.run(1.5);
        let truth = bench.world.truth();
        assert!(tilt(&bench) < 2.0, "{}°", tilt(&bench));
        assert!(bench.height() < before, "it sinks");
        assert!((0.1..2.5).contains(&truth.velocity.z), "{} m/s", truth.velocity.z);
        bench.outer_alive = true;
        bench.run(8.0);
        assert!(bench.height() > 19.5, "back at {} m", bench.height());
        let off = bench.world.truth().position - windhover_math::Vector3::new(3.0, 0.0, -20.0);
        assert!(norm(off) < 0.5, "{off}");
    }
}

/// A silence of less than 100 ms is not taken for one: the last setpoint is kept.
#[test]
fn a_short_silence_is_flown_through() {
    let mut bench = hovering(&calm());
    let mut lowest = bench.height();
    for _ in 0..20 {
        bench.outer_alive = false;
        bench.run(0.09);
        bench.outer_alive = true;
        bench.run(0.1);
        lowest = windhover_math::min(lowest, bench.height());
    }
    assert!(lowest > 19.95, "{lowest} m");
}

/// No word on the position and the height: level and down; and back where it was interrupted when
/// there is one again.
#[test]
fn a_lost_position_means_level_and_down() {
    let windy = setup("os4", Preset::Windhover, ModelKind::Rigid);
    let mut bench = hovering(&windy);
    bench.estimate_alive = false;
    bench.run(0.4);
    assert!(bench.height() > 19.0, "carried on by the IMU for a while");
    bench.run(2.5);
    let cos_tilt = bench.world.truth().attitude.cos_tilt();
    assert!(libm::acos(cos_tilt).to_degrees() < 3.0);
    let sinking = bench.world.truth().velocity.z;
    assert!((0.1..3.0).contains(&sinking), "{sinking} m/s");
    assert!(is_running(bench.last()));
    assert_eq!(bench.last_step().mode, Mode::Descend);
    bench.estimate_alive = true;
    bench.run(25.0);
    assert_eq!(bench.last_step().mode, Mode::Mission);
    let off = bench.world.truth().position - windhover_math::Vector3::new(3.0, 0.0, -20.0);
    assert!(norm(off) < 0.5, "{off}");
}

/// Every refusal names its reasons, all of them, and nothing changes by what was refused.
#[test]
fn refusals_name_their_reasons_and_change_nothing() {
    let mut bench = Bench::new(&calm(), &hover());
    bench.estimate_alive = false;
    bench.run(0.1);
    let expect = |bench: &mut Bench, command, why| {
        let (from, before) = (bench.steps.len(), bench.last_step().clone());
        bench.command(command);
        bench.run(0.02);
        assert_eq!(refusals(bench, from), [Refused::Command(command, why)]);
        let after = bench.last_step();
        assert_eq!(
            (after.phase, after.mode),
            (before.phase, before.mode),
            "{command:?}"
        );
    };
    let blocked = |blockers: &[Blocker]| {
        let all = blockers
            .iter()
            .fold(Blockers::default(), |set, one| set.with(*one, true));
        Why::Blocked(all)
    };
    let mission = Command::Fly(Mode::Mission);
    let unknown = [
        Blocker::AttitudeUnknown,
        Blocker::HeightUnknown,
        Blocker::PositionUnknown,
    ];
    expect(&mut bench, Command::Arm, blocked(&unknown));
    bench.estimate_alive = true;
    bench.run(0.1);
    expect(&mut bench, mission, blocked(&[Blocker::NoMission]));
    expect(
        &mut bench,
        Command::Fly(Mode::Offboard),
        blocked(&[Blocker::NoSetpoint]),
    );
    expect(
        &mut bench,
        Command::Fly(Mode::Position),
        blocked(&[Blocker::NoSticks]),
    );
    expect(&mut bench, Command::Fly(Mode::Land), Why::OnGround);
    let from = bench.steps.len();
    bench.command(Command::Arm);
    bench.run(1.1);
    assert_eq!(refusals(&bench, from), []);
    expect(&mut bench, mission, blocked(&[Blocker::NoMission]));
    let commit = bench.commit();
    bench.command(commit);
    bench.run(0.02);
    bench.command(mission);
    bench.run(10.0);
    let height = bench.height();
    expect(&mut bench, Command::Disarm, Why::InFlight);
    expect(&mut bench, Command::Fly(Mode::Takeoff), Why::InFlight);
    expect(&mut bench, commit, Why::InFlight);
    bench.run(0.5);
    assert!(bench.height() >= height && is_running(bench.last()));
}

/// However often it is asked, the outer step does not disarm in flight.
#[test]
fn disarming_in_flight_is_refused_every_time() {
    let mut bench = hovering(&calm());
    let from = bench.steps.len();
    for _ in 0..5 {
        bench.command(Command::Disarm);
        bench.run(0.1);
    }
    assert_eq!(refusals(&bench, from).len(), 5);
    assert!(bench.height() > 19.0);
}
