//! What is hashed of a result changes its hash: a replay that differs in it is found. What is not
//! hashed stands with [`result_hash`].

use windhover_autopilot::battery::Charge;
use windhover_autopilot::mission::{MissionEvent, PlanKind, Reason, Refusal};
use windhover_autopilot::{
    Blocker, Blockers, Command, InnerParameters, MissionCommit, Mode, MotorState, Outer, OuterConfig,
    OuterReport, OuterResult, ParameterWrite, Parameters, Phase, Refused, Row, Why,
};
use windhover_control::TrajectorySetpoint;
use windhover_flight_log::result_hash;
use windhover_math::Vector3;

type Change = fn(&mut OuterReport);

const COMMIT: Command = Command::Commit(
    PlanKind::Fence,
    MissionCommit {
        slot: 1,
        count: 2,
        crc: 3,
    },
);

fn refuses(report: &mut OuterReport, command: Command, why: Why) {
    let _ = report.refusals.push(Refused::Command(command, why));
}

const REASON: Refusal = Refusal {
    field: "place",
    reason: Reason::Fence,
};

/// Changes of what is hashed of the report; where fields are sets or choices, several.
const CHANGES: &[Change] = &[
    |r| r.phase = Phase::Armed,
    |r| r.phase = Phase::Landed,
    |r| r.mode = Mode::Return,
    |r| r.failsafe = Some(Row::ALL[0]),
    |r| r.failsafe = Some(Row::ALL[1]),
    |r| r.active.0 = 1,
    |r| r.blockers = Blockers::of(Blocker::Stopped),
    |r| r.blockers = Blockers::of(Blocker::StorageDamaged),
    |r| r.home.x = 1.0,
    |r| r.home.z = 1.0,
    |r| r.mission.count = 1,
    |r| r.mission.current = 1,
    |r| r.mission.begun = true,
    |r| r.battery.voltage = Some(0.0),
    |r| r.battery.voltage = Some(14.0),
    |r| r.battery.current = Some(0.0),
    |r| r.battery.current = Some(14.0),
    |r| r.battery.remaining = Some(0.0),
    |r| r.battery.remaining = Some(1.0),
    |r| r.battery.drawn = 14.0,
    |r| (r.battery.drawn, r.battery.voltage) = (14.0, Some(14.0)),
    |r| r.battery.charge = Charge::Low,
    |r| r.battery.arming_voltage = 14.0,
    |r| r.estimate.position.y = 1.0,
    |r| r.estimate.known.height ^= true,
    |r| r.estimate.velocity.y = 1.0,
    |r| r.estimate.attitude.x = 1.0,
    |r| r.estimate.accel_bias.y = 1.0,
    |r| r.estimate.accuracy.horizontal = 1.0,
    |r| r.estimate.accuracy.heading = 1.0,
    |r| r.sensors.rejected = 1,
    |r| r.handover.position.x = 1.0,
    |r| r.handover.velocity.x = 1.0,
    |r| r.handover.heading = 1.0,
    |r| r.leg_end = Some(Vector3::zeros()),
    |r| r.trajectory = Some(TrajectorySetpoint::at_rest(Vector3::zeros(), 0.0)),
    |r| r.disturbance.x = 1.0,
    |r| r.thrust_scale = 1.5,
    |r| r.events.push(MissionEvent::Landed).unwrap(),
    |r| r.events.push(MissionEvent::Finished).unwrap(),
    |r| refuses(r, Command::Arm, Why::Blocked(Blockers::of(Blocker::Tilted))),
    |r| refuses(r, Command::Arm, Why::Blocked(Blockers::of(Blocker::NoSticks))),
    |r| {
        refuses(
            r,
            Command::ForceArm,
            Why::Blocked(Blockers::of(Blocker::NoSticks)),
        )
    },
    |r| refuses(r, Command::Fly(Mode::Hold), Why::Failsafe(Row::ALL[1])),
    |r| refuses(r, Command::Fly(Mode::Land), Why::Failsafe(Row::ALL[1])),
    |r| refuses(r, Command::Fly(Mode::Land), Why::Failsafe(Row::ALL[2])),
    |r| refuses(r, Command::Disarm, Why::InFlight),
    |r| refuses(r, Command::Disarm, Why::OnGround),
    |r| refuses(r, Command::Disarm, Why::NotANumber),
    |r| refuses(r, Command::Disarm, Why::Place(REASON)),
    |r| refuses(r, COMMIT, Why::Mission(1, REASON)),
    |r| refuses(r, COMMIT, Why::Mission(2, REASON)),
    |r| refuses(r, Command::SetSpeed(Some(f32::NAN)), Why::NotANumber),
    |r| {
        let write = ParameterWrite { index: 1, value: 2.0 };
        let _ = r
            .refusals
            .push(Refused::Parameter(write, windhover_parameters::Refusal::Unknown));
    },
];

#[test]
fn what_is_hashed_of_a_report_counts() {
    let mut hashes = vec![result_hash(&OuterResult::default())];
    for (index, change) in CHANGES.iter().enumerate() {
        let mut result = OuterResult::default();
        change(&mut result.report);
        let hash = result_hash(&result);
        let like = hashes.iter().position(|other| *other == hash);
        assert_eq!(like, None, "change {index} hashes like the one before {like:?}");
        hashes.push(hash);
    }
}

/// Some parameters of the inner step.
fn parameters() -> InnerParameters {
    let outer = Outer::new(Parameters::default(), &OuterConfig::default());
    outer.expect("a vehicle that flies").inner_parameters()
}

#[test]
fn what_the_inner_step_adopts_counts() {
    let changes: [fn(&mut OuterResult); 11] = [
        |r| r.tick = 1,
        |r| r.attitude.x = 1.0,
        |r| r.landed ^= true,
        |r| r.motors = MotorState::Idle,
        |r| r.motors = MotorState::Run,
        |r| r.setpoint.attitude.x = 1.0,
        |r| r.setpoint.thrust = 1.0,
        |r| r.setpoint.rate.z = 1.0,
        |r| r.gyro_bias.y = 1.0,
        |r| r.motor_gain = 1.5,
        |r| r.parameters = Some(parameters()),
    ];
    let before = result_hash(&OuterResult::default());
    for (index, change) in changes.iter().enumerate() {
        let mut result = OuterResult::default();
        change(&mut result);
        assert_ne!(result_hash(&result), before, "change {index}");
    }
}
