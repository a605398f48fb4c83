//! What is no number, or a number out of all reason, does not reach a motor.

use windhover_autopilot::{Command, ExternalEstimate, Mode, ParameterWrite, Parameters, Refused};
use windhover_control::TrajectorySetpoint;
use windhover_math::{Quaternion, Vector3, scalar::norm};
use windhover_tests::bench::{Bench, estimate};
use windhover_tests::plan::Plan;
use windhover_tests::{calm, write};

const WRONG: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn hovering() -> Bench {
    let mission = Plan::new().takeoff(5.0).waypoint(600.0, 0.5, 3.0, 0.0, 5.0);
    Bench::in_mission(&calm(), &mission.file(), 12.0)
}

/// The vehicle still hovers, and everything in the core is finite.
fn assert_unmoved(bench: &Bench, what: &str) {
    let step = bench.last_step();
    let off = bench.world.truth().position - Vector3::new(3.0, 0.0, -5.0);
    assert!(norm(off) < 0.3, "{what}: {off}");
    let setpoint = &step.attitude_setpoint;
    assert!(
        setpoint.attitude.is_finite() && setpoint.thrust.is_finite(),
        "{what}: {setpoint:?}"
    );
}

fn quaternion(q: [f32; 4]) -> Quaternion {
    Quaternion::new(q[0], q[1], q[2], q[3])
}

/// Every number of an estimate made wrong in every way, between good ones.
#[test]
fn wrong_estimates_stay_outside() {
    let mut bench = hovering();
    for wrong in WRONG {
        for number in 0..10 {
            let good = estimate(&bench.world.truth());
            let q = good.attitude;
            let mut attitude = [q.w, q.x, q.y, q.z];
            let mut bad: ExternalEstimate = good;
            match number {
                0..=2 => bad.position[number] = wrong,
                3..=5 => bad.velocity[number - 3] = wrong,
                n => {
                    attitude[n - 6] = wrong;
                    bad.attitude = quaternion(attitude);
                }
            }
            for _ in 0..10 {
                bench.mailboxes.queues.external.push(bad);
                bench.run(0.004);
                assert_unmoved(&bench, &format!("{wrong} as number {number}"));
            }
            bench.run(0.1);
        }
    }
    // A quaternion that turns nothing.
    bench.mailboxes.queues.external.push(ExternalEstimate {
        attitude: quaternion([0.0; 4]),
        ..estimate(&bench.world.truth())
    });
    bench.run(0.5);
    assert_unmoved(&bench, "a quaternion of norm 0");
}

/// A finite estimate that overflows when it is squared passes, as it must: nobody knows better.
/// It may move the vehicle, but leaves nothing behind that is not a number.
#[test]
fn an_absurd_estimate_leaves_no_trace() {
    for absurd in [1e19, -1e30, 3e38] {
        let mut bench = hovering();
        for axis in 0..3 {
            let mut bad = estimate(&bench.world.truth());
            bad.position[axis] = absurd;
            bad.velocity[axis] = -absurd;
            bench.mailboxes.queues.external.push(bad);
            bench.run(0.004);
        }
        bench.run(6.0);
        assert_unmoved(&bench, &format!("{absurd:e}"));
    }
}

/// The same for setpoints from outside.
#[test]
fn wrong_setpoints_stay_outside() {
    let mut bench = hovering();
    let good = TrajectorySetpoint::at_rest(Vector3::new(3.0, 0.0, -5.0), 0.0);
    bench.mailboxes.queues.setpoint.push(good);
    bench.command(Command::Fly(Mode::Offboard));
    bench.run(1.0);
    for wrong in WRONG {
        for number in 0..14 {
            let mut bad = good;
            match number {
                0..=2 => bad.position[number] = wrong,
                3..=5 => bad.velocity[number - 3] = wrong,
                6..=8 => bad.acceleration[number - 6] = wrong,
                9..=11 => bad.jerk[number - 9] = wrong,
                12 => bad.heading = wrong,
                _ => bad.heading_rate = wrong,
            }
            bench.mailboxes.queues.setpoint.push(bad);
            bench.run(0.05);
            assert_unmoved(&bench, &format!("{wrong} as number {number}"));
        }
    }
    for absurd in [1e19, 3e38] {
        let bad = TrajectorySetpoint {
            position: Vector3::new(absurd, -absurd, absurd),
            velocity: Vector3::new(absurd, -absurd, absurd),
            acceleration: Vector3::new(-absurd, absurd, absurd),
            jerk: Vector3::new(absurd, absurd, -absurd),
            heading: absurd,
            heading_rate: absurd,
        };
        bench.mailboxes.queues.setpoint.push(bad);
        bench.run(0.008);
        bench.mailboxes.queues.setpoint.push(good);
        bench.run(8.0);
        assert_unmoved(&bench, &format!("{absurd:e}"));
    }
}

/// Each parameter in turn written with what is no number or out of range: refused, each time, and
/// the table is as it was.
#[test]
fn wrong_parameter_writes_are_refused() {
    let mut bench = hovering();
    let before = *bench.outer.parameters();
    let writes = Parameters::declarations()
        .enumerate()
        .flat_map(|(index, declaration)| {
            let values = [
                WRONG[0],
                WRONG[1],
                WRONG[2],
                declaration.max * 2.0 + 1.0,
                declaration.min - 1.0,
            ];
            values.map(|value| ParameterWrite {
                index: index as u16,
                value,
            })
        });
    let unknown = ParameterWrite {
        index: u16::MAX,
        value: 1.0,
    };
    for write in writes.chain([unknown]) {
        let from = bench.steps.len();
        bench.mailboxes.queues.parameter.push(write);
        bench.run(0.008);
        let refused: Vec<Refused> = bench.steps[from..]
            .iter()
            .flat_map(|s| s.refusals.clone())
            .collect();
        assert!(
            matches!(refused[..], [Refused::Parameter(by, _)] if by.index == write.index),
            "{write:?}: {refused:?}"
        );
    }
    assert_eq!(*bench.outer.parameters(), before);
    assert_unmoved(&bench, "refused writes");
}

/// A good write is taken, and the vehicle does not jump.
#[test]
fn a_good_parameter_write_is_taken_in_flight() {
    let mut bench = hovering();
    for (name, value) in [("POS_N_P", 6.0), ("ATT_TILT_P", 9.0), ("POS_D_D", 8.0)] {
        bench.mailboxes.queues.parameter.push(write(name, value));
        bench.run(1.0);
        assert_unmoved(&bench, name);
        let index = Parameters::find(name).unwrap();
        assert_eq!(bench.outer.parameters().get(index), Some(value));
    }
}
