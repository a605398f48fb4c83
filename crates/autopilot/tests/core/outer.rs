//! The outer step alone: commands, parameter writes, and the estimate between two words from
//! outside.

use windhover_autopilot::mission::{PlanKind, Reason};
use windhover_autopilot::{
    Blocker, Blockers, Command, ExternalEstimate, Increments, MissionCommit, Mode, MotorState, Outer,
    OuterConfig, OuterInputs, OuterResult, ParameterWrite, Parameters, Phase, Refused, Row, Snapshot, Stop,
    Urgent, Why,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{GRAVITY, Quaternion, Vector3, scalar};
use windhover_parameters::Refusal;

use super::{HOME, waypoint};

const MISSION: fn() -> [windhover_autopilot::mission::MissionItem; 2] =
    || [waypoint(10.0, 0.0, 10.0), waypoint(0.0, 0.0, 10.0)];

/// An outer step that is told what it sees.
struct Desk {
    outer: Outer,
    tick: u32,
    stopped: Option<Stop>,
    /// What comes in at the next step.
    inputs: OuterInputs,
    /// Whether the inputs bring an estimate each step, and where.
    estimate: Option<Vector3>,
    /// Specific force in body axes, m/s².
    force: Vector3,
    /// What the mixer added to the thrust, N.
    shortfall: f32,
    /// What the rotors gave, N.
    thrust: f32,
    /// Attitude from outside.
    attitude: Quaternion,
    /// What an offboard computer sends with every step.
    setpoint: Option<TrajectorySetpoint>,
    tilt: Option<AttitudeSetpoint>,
}

fn at_home() -> OuterConfig {
    OuterConfig {
        home: Some(HOME),
        ..OuterConfig::default()
    }
}

impl Desk {
    fn new() -> Self {
        Self {
            outer: Outer::new(Parameters::default(), &at_home()).expect("the default vehicle"),
            tick: 0,
            stopped: None,
            inputs: OuterInputs::default(),
            estimate: Some(Vector3::zeros()),
            force: Vector3::new(0.0, 0.0, -GRAVITY),
            shortfall: 0.0,
            thrust: 0.0,
            attitude: Quaternion::IDENTITY,
            setpoint: None,
            tilt: None,
        }
    }

    /// It has stood still for long enough to know its attitude, and nothing else.
    fn aligned() -> Self {
        let mut desk = Self::new();
        desk.estimate = None;
        for name in ["CAL_GYRO0_ID", "CAL_ACC0_ID"] {
            desk.write(name, 1.0);
        }
        desk.steps(1300);
        desk
    }

    fn step(&mut self) -> OuterResult {
        let mut inputs = core::mem::take(&mut self.inputs);
        if let Some(position) = self.estimate {
            let _ = inputs.external.push(ExternalEstimate {
                attitude: self.attitude,
                ..at(position)
            });
        }
        inputs.setpoint.extend(self.setpoint);
        inputs.attitude.extend(self.tilt);
        let snapshot = Snapshot {
            tick: self.tick,
            time: u64::from(self.tick) * 1000,
            increments: Increments {
                velocity: self.force * 0.004,
                thrust_shortfall: self.shortfall * 0.004,
                thrust: self.thrust * 0.004,
                duration: 0.004,
                ticks: 4,
                ..Default::default()
            },
            stopped: self.stopped,
            inputs,
        };
        self.tick += 4;
        self.outer.step(&snapshot, MISSION().as_slice())
    }

    fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.step();
        }
    }

    /// Armed, and the motors have idled for long enough.
    fn armed(mut self) -> Self {
        assert!(self.command(Command::Arm).report.refusals.is_empty());
        self.steps(260);
        self
    }

    fn command(&mut self, command: Command) -> OuterResult {
        self.inputs.command.push(command).unwrap();
        self.step()
    }

    fn write(&mut self, name: &str, value: f32) -> OuterResult {
        let index = Parameters::find(name).unwrap() as u16;
        self.inputs
            .parameter
            .push(ParameterWrite { index, value })
            .unwrap();
        self.step()
    }

    /// In offboard flight, at a setpoint that stays.
    fn flying() -> Self {
        let mut desk = Self::new();
        desk.step();
        let mut desk = desk.armed();
        let setpoint = TrajectorySetpoint::at_rest(Vector3::new(0.2, 0.1, -5.0), 0.0);
        desk.setpoint = Some(setpoint);
        assert!(
            desk.command(Command::Fly(Mode::Offboard))
                .report
                .refusals
                .is_empty()
        );
        desk.estimate = Some(Vector3::new(0.0, 0.0, -5.0));
        desk.thrust = desk.outer.parameters().vehicle.mass * GRAVITY;
        desk.steps(20);
        let report = desk.step().report;
        assert_eq!((report.phase, report.mode), (Phase::Flying, Mode::Offboard));
        desk
    }
}

fn at(position: Vector3) -> ExternalEstimate {
    ExternalEstimate {
        position,
        velocity: Vector3::zeros(),
        attitude: Quaternion::IDENTITY,
    }
}

fn commit(count: u16) -> Command {
    let crc = 0;
    Command::Commit(PlanKind::Mission, MissionCommit { slot: 0, count, crc })
}

fn blocked(command: Command, blocker: Blocker) -> Refused {
    Refused::Command(command, Why::Blocked(Blockers::of(blocker)))
}

const MISSION_MODE: Command = Command::Fly(Mode::Mission);

/// The whole way from nothing to a mission, and the motors with it.
#[test]
fn phases_and_motors_go_together() {
    let mut desk = Desk::new();
    let phase = |result: OuterResult| (result.report.phase, result.motors);
    assert_eq!(phase(desk.step()), (Phase::Disarmed, MotorState::Disarmed));
    assert_eq!(
        phase(desk.command(Command::Arm)),
        (Phase::Armed, MotorState::Idle)
    );
    assert_eq!(phase(desk.command(commit(2))), (Phase::Armed, MotorState::Idle));
    // The rotors get their time to start in.
    assert_eq!(
        phase(desk.command(MISSION_MODE)),
        (Phase::Armed, MotorState::Idle)
    );
    desk.steps(240);
    assert_eq!(phase(desk.step()), (Phase::Armed, MotorState::Idle));
    desk.steps(10);
    let result = desk.step();
    assert_eq!(result.report.mode, Mode::Mission);
    assert_eq!(phase(result), (Phase::Armed, MotorState::Run));
    // Arming again changes nothing.
    assert_eq!(phase(desk.command(Command::Arm)), (Phase::Armed, MotorState::Run));
    // Still on the ground: disarming is allowed.
    assert_eq!(
        phase(desk.command(Command::Disarm)),
        (Phase::Disarmed, MotorState::Disarmed)
    );
    // A disarmed vehicle takes note of the mode, and no motor turns.
    let result = desk.command(MISSION_MODE);
    assert!(result.report.refusals.is_empty());
    assert_eq!(phase(result), (Phase::Disarmed, MotorState::Disarmed));
    desk.steps(300);
    assert_eq!(phase(desk.step()), (Phase::Disarmed, MotorState::Disarmed));
    desk.command(Command::Arm);
    desk.steps(260);
    desk.estimate = Some(Vector3::new(0.0, 0.0, -1.0));
    assert_eq!(phase(desk.step()), (Phase::Flying, MotorState::Run));
    // And in the air it is not.
    let result = desk.command(Command::Disarm);
    let refused = Refused::Command(Command::Disarm, Why::InFlight);
    assert_eq!(result.report.refusals[..], [refused]);
    assert_eq!(phase(result), (Phase::Flying, MotorState::Run));
}

/// A mission that is not flown takes the place of none.
#[test]
fn a_commit_that_is_refused_leaves_no_mission() {
    let mut desk = Desk::new();
    desk.step();
    desk.command(Command::Arm);
    assert!(desk.command(commit(2)).report.refusals.is_empty());
    let torn = commit(3);
    let refused = desk.command(torn).report.refusals;
    let [Refused::Command(command, Why::Mission(2, refusal))] = refused[..] else {
        panic!("{refused:?}");
    };
    assert_eq!((command, refusal.reason), (torn, Reason::Missing));
    let result = desk.command(MISSION_MODE);
    let no_mission = blocked(MISSION_MODE, Blocker::NoMission);
    assert_eq!(result.report.refusals[..], [no_mission]);
    assert_eq!(result.motors, MotorState::Idle);
}

/// What the inner step stopped, the outer step disarms, in the very step that sees it.
#[test]
fn a_stop_disarms() {
    for stop in [
        Stop::Commanded(Urgent::Kill),
        Stop::Commanded(Urgent::Disarm),
        Stop::ImuMissing,
    ] {
        let mut desk = Desk::flying();
        desk.stopped = Some(stop);
        let result = desk.command(Command::Arm);
        assert_eq!(
            (result.report.phase, result.motors),
            (Phase::Disarmed, MotorState::Disarmed)
        );
        assert_eq!(
            result.report.refusals[..],
            [blocked(Command::Arm, Blocker::Stopped)]
        );
        desk.stopped = None;
        assert_eq!(desk.step().motors, MotorState::Disarmed, "{stop:?}");
    }
}

/// The estimate is taken from outside when there is word; carried on by the increments when there
/// is none; and forgotten after half a second.
#[test]
fn the_estimate_is_carried_on_and_then_given_up() {
    let mut desk = Desk::flying();
    desk.estimate = None;
    // 1 m/s² north beyond gravity.
    desk.force = Vector3::new(1.0, 0.0, -GRAVITY);
    let mut result = desk.step();
    for _ in 0..99 {
        result = desk.step();
    }
    let estimate = result.report.estimate;
    assert!((estimate.velocity.x - 0.4).abs() < 1e-3, "{estimate:?}");
    assert!((estimate.position.x - 0.08).abs() < 2e-4, "{estimate:?}");
    assert!((estimate.position.z + 5.0).abs() < 1e-3, "{estimate:?}");
    assert!(estimate.known.position, "0.4 s without word");
    let tilt = |result: &OuterResult| {
        let down = result.setpoint.attitude.down_axis();
        windhover_math::sqrt(down.x * down.x + down.y * down.y)
    };
    assert!(tilt(&result) > 0.01, "it still steers");
    while result.report.mode != Mode::Descend {
        assert!(desk.tick < 4000, "still {:?}", result.report.mode);
        result = desk.step();
    }
    let weight = desk.outer.parameters().vehicle.mass * GRAVITY;
    assert!(result.setpoint.thrust < weight && result.setpoint.thrust > 0.8 * weight);
    desk.steps(200);
    assert!(tilt(&desk.step()) < 1e-3, "level");
    // Once it has been known again for two seconds; nobody can have it sooner.
    const OFFBOARD: Command = Command::Fly(Mode::Offboard);
    desk.estimate = Some(Vector3::new(0.0, 0.0, -5.0));
    desk.steps(490);
    let result = desk.command(OFFBOARD);
    let refused = Refused::Command(OFFBOARD, Why::Failsafe(Row::HeightUnknown));
    assert_eq!(result.report.refusals[..], [refused]);
    assert_eq!(result.report.mode, Mode::Descend);
    desk.steps(30);
    let result = desk.step();
    assert_eq!(result.report.mode, Mode::Offboard);
    assert!(tilt(&result) > 0.01, "and steers again");
}

/// Gains that are written in flight act, but do not make demand jump.
#[test]
fn parameter_writes_do_not_jump() {
    for (name, value) in [
        ("POS_N_P", 5.0),
        ("POS_E_P", 4.0),
        ("POS_D_P", 10.0),
        ("POS_N_D", 3.0),
    ] {
        let mut with = Desk::flying();
        let mut without = Desk::flying();
        let (a, b) = (with.write(name, value), without.step());
        assert!(a.report.refusals.is_empty());
        let turn = a.setpoint.attitude.conjugate() * b.setpoint.attitude;
        let jump = scalar::norm(Vector3::new(turn.x, turn.y, turn.z));
        assert!(jump < 1e-3, "{name}: {jump} rad");
        assert!(
            (a.setpoint.thrust - b.setpoint.thrust).abs() < 1e-2,
            "{name}: {} N after {} N",
            a.setpoint.thrust,
            b.setpoint.thrust
        );
        let index = Parameters::find(name).unwrap();
        assert_eq!(with.outer.parameters().get(index), Some(value));
    }
}

/// A vehicle that turns while its rotors pull is not taken for one that is disturbed: thrust
/// points halfway between the two attitudes.
#[test]
fn turning_is_no_disturbance() {
    let mut desk = Desk::flying();
    let specific = 9.0;
    desk.thrust = specific * desk.outer.parameters().vehicle.mass;
    desk.force = Vector3::new(0.0, 0.0, -specific);
    for _ in 0..1000 {
        desk.step();
    }
    let rolled = Quaternion::from_rotation_vector(Vector3::new(0.2, 0.0, 0.0));
    let halfway = (Quaternion::IDENTITY.down_axis() + rolled.down_axis()) * 0.5;
    desk.force = halfway * -specific;
    desk.attitude = rolled;
    let disturbance = desk.step().report.disturbance;
    assert!(scalar::norm(disturbance) < 1e-3, "{disturbance}");
    // The next step brings a push that thrust does not explain.
    desk.force = Vector3::new(1.0, 0.0, -specific);
    desk.step();
    assert!(desk.step().report.disturbance.x > 0.01);
}

/// Thrust that the mixer could not give does not wind the height's integral up; on the ground,
/// where the mixer holds thrust back by intent, it counts for nothing.
#[test]
fn a_thrust_that_is_not_there_does_not_wind_up() {
    let thrust_after = |shortfall: f32, ground: bool| {
        let mut desk = if ground { Desk::new() } else { Desk::flying() };
        if ground {
            desk.step();
            desk = desk.armed();
            let above = TrajectorySetpoint::at_rest(Vector3::new(0.0, 0.0, -0.2), 0.0);
            desk.setpoint = Some(above);
            desk.command(Command::Fly(Mode::Offboard));
        } else {
            desk.estimate = Some(Vector3::new(0.2, 0.1, -4.8));
        }
        desk.write("POS_D_I", 10.0);
        desk.shortfall = shortfall;
        (0..100).map(|_| desk.step().setpoint.thrust).last().unwrap()
    };
    for ground in [false, true] {
        let free = thrust_after(0.0, ground);
        let short = thrust_after(-2.0, ground);
        let wound = free - short;
        assert_eq!(wound > 0.2, !ground, "{free} N and {short} N");
    }
}

/// Inner parameters travel once, with the result of the step that took the write.
#[test]
fn inner_parameters_travel_with_one_result() {
    let mut desk = Desk::flying();
    assert!(desk.step().parameters.is_none());
    assert!(
        desk.write("POS_N_P", 5.0).parameters.is_none(),
        "nothing of the inner step's"
    );
    let travelling = desk.write("ATT_TILT_P", 5.0).parameters;
    assert_eq!(travelling, Some(desk.outer.inner_parameters()));
    assert!(desk.step().parameters.is_none());
    // The same value again is no change.
    assert!(desk.write("ATT_TILT_P", 5.0).parameters.is_none());
}

/// A value in its range that makes the whole inconsistent is refused, and the table stays.
#[test]
fn an_inconsistent_vehicle_is_refused() {
    let mut desk = Desk::flying();
    let before = *desk.outer.parameters();
    // The front rotor behind the centre of mass, like the rear one.
    let result = desk.write("CA_ROTOR0_PX", -0.23);
    let [Refused::Parameter(write, refusal)] = result.report.refusals[..] else {
        panic!("{:?}", result.report.refusals);
    };
    assert_eq!((write.value, refusal), (-0.23, Refusal::Inconsistent));
    assert!(result.parameters.is_none());
    assert_eq!(*desk.outer.parameters(), before);
}

/// Several writes in one step are taken in order; the wrong one among them falls out alone.
#[test]
fn one_wrong_write_does_not_spoil_the_others() {
    let mut desk = Desk::flying();
    for (name, value) in [("POS_N_P", 5.0), ("POS_N_P", f32::NAN), ("POS_E_P", 6.0)] {
        let index = Parameters::find(name).unwrap() as u16;
        desk.inputs
            .parameter
            .push(ParameterWrite { index, value })
            .unwrap();
    }
    let result = desk.step();
    assert_eq!(result.report.refusals.len(), 1);
    let position = desk.outer.parameters().position;
    assert_eq!((position.north_p, position.east_p), (5.0, 6.0));
}

/// The newest good estimate of a step counts, wherever bad ones stand.
#[test]
fn the_newest_good_estimate_counts() {
    let mut desk = Desk::new();
    desk.estimate = None;
    let bad = at(Vector3::new(f32::NAN, 0.0, 0.0));
    for estimate in [at(Vector3::x()), bad, at(Vector3::x() * 2.0), bad] {
        desk.inputs.external.push(estimate).unwrap();
    }
    assert_eq!(desk.step().report.estimate.position, Vector3::x() * 2.0);
}

fn tilted(thrust: f32) -> AttitudeSetpoint {
    AttitudeSetpoint {
        attitude: Quaternion::from_rotation_vector(Vector3::new(0.2, 0.0, 0.0)),
        rate: Vector3::zeros(),
        thrust,
    }
}

fn refusal(result: &OuterResult) -> Blockers {
    match result.report.refusals[..] {
        [Refused::Command(_, Why::Blocked(blockers))] => blockers,
        _ => panic!("{:?}", result.report.refusals),
    }
}

/// Without a position there is one way to fly without sticks, and only that one. The attitude must be
/// known: from two seconds at rest, and three of waiting for a compass that is not there.
#[test]
fn attitude_from_outside_needs_no_position() {
    const OFFBOARD: Command = Command::Fly(Mode::Offboard);
    let mut desk = Desk::new();
    desk.estimate = None;
    desk.tilt = Some(tilted(9.0));
    assert!(refusal(&desk.command(OFFBOARD)).contains(Blocker::AttitudeUnknown));
    let mut desk = Desk::aligned();
    let blockers = refusal(&desk.command(Command::Arm));
    for blocker in [
        Blocker::PositionUnknown,
        Blocker::HeadingUnknown,
        Blocker::CompassUncalibrated,
    ] {
        assert!(blockers.contains(blocker), "{blocker:?}");
    }
    assert!(!blockers.contains(Blocker::AttitudeUnknown));
    desk.tilt = Some(tilted(9.0));
    assert!(desk.command(OFFBOARD).report.refusals.is_empty());
    let mut desk = desk.armed();
    for mode in [Mode::Mission, Mode::Hold, Mode::Takeoff, Mode::Position] {
        let result = desk.command(Command::Fly(mode));
        assert!(refusal(&result).contains(Blocker::PositionUnknown), "{mode:?}");
    }
    let result = desk.step();
    assert_eq!(
        (result.report.mode, result.motors),
        (Mode::Offboard, MotorState::Run)
    );
    assert_eq!(result.setpoint, tilted(9.0));
}

/// Half a second without a new attitude: level, and the climb ends.
#[test]
fn an_attitude_from_outside_grows_old() {
    let mut desk = Desk::aligned();
    desk.tilt = Some(tilted(9.0));
    desk.command(Command::Fly(Mode::Offboard));
    let mut desk = desk.armed();
    let mass = desk.outer.parameters().vehicle.mass;
    let lift = 1.05 * GRAVITY;
    (desk.thrust, desk.force) = (lift * mass, Vector3::new(0.0, 0.0, -lift));
    desk.steps(400);
    assert_eq!(desk.step().report.phase, Phase::Flying);
    desk.tilt = None;
    let steps = (0..200)
        .take_while(|_| desk.step().setpoint == tilted(9.0))
        .count();
    assert!((120..=127).contains(&steps), "{steps} steps of 4 ms");
    desk.steps(250);
    let result = desk.step();
    assert!(result.report.active.contains(Row::OffboardLost));
    // Hold, without a position and a height.
    assert_eq!(result.report.mode, Mode::Descend);
    assert!(result.setpoint.attitude.down_axis().z > 0.999);
    assert!(result.setpoint.thrust < mass * GRAVITY);
    assert_eq!(result.motors, MotorState::Run);
}

/// What is no attitude stays outside, and does not keep an old one fresh either.
#[test]
fn an_attitude_that_is_none_stays_outside() {
    let no_number = |change: fn(&mut AttitudeSetpoint)| {
        let mut setpoint = tilted(5.0);
        change(&mut setpoint);
        setpoint
    };
    for bad in [
        no_number(|s| s.thrust = -0.1),
        no_number(|s| s.thrust = f32::NAN),
        no_number(|s| s.thrust = f32::INFINITY),
        no_number(|s| s.rate.y = f32::NAN),
        no_number(|s| s.attitude.w = f32::NAN),
        no_number(|s| s.attitude = Quaternion::new(0.0, 0.0, 0.0, 0.0)),
    ] {
        let mut desk = Desk::new();
        desk.step();
        desk.inputs.attitude.push(tilted(5.0)).unwrap();
        desk.step();
        desk.tilt = Some(bad);
        desk.steps(130);
        let blockers = refusal(&desk.command(Command::Fly(Mode::Offboard)));
        assert_eq!(blockers, Blockers::of(Blocker::NoSetpoint), "{bad:?}");
    }
}
