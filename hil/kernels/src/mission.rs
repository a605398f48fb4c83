//! The outer step in a mission, of a vehicle that is told each time where it is: just where it
//! should be. So there is all of the step but the filter.

use core::hint::black_box;

use windhover_autopilot::mission::{MissionEvent, MissionItem, PlanKind};
use windhover_autopilot::{
    Command, ExternalEstimate, Increments, MissionCommit, Mode, Outer, OuterConfig, OuterInputs, OuterResult,
    Parameters, Phase, Snapshot,
};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{GRAVITY, Quaternion, Vector3};

use crate::require;

const HOME: GlobalPosition = GlobalPosition {
    latitude: 473_977_419,
    longitude: 85_455_938,
    altitude: 488_000,
};

/// Corners of the flight, NED, m.
const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [15.0, 0.0], [15.0, 10.0], [-5.0, 10.0]];
const HEIGHT: f32 = 5.0;

/// Most steps of the flight: 60 s. It ends with the mission: hovering behind it costs less.
const STEPS: u32 = 15_000;
const INTERVAL: f32 = 0.004;

pub fn fly() {
    let config = OuterConfig {
        home: Some(HOME),
        ..OuterConfig::default()
    };
    let Some(mut outer) = Outer::new(Parameters::default(), &config) else {
        return require(false);
    };
    let frame = LocalFrame::new(HOME);
    let items = CORNERS.map(|corner| waypoint(&frame, corner));
    let mut estimate = ExternalEstimate {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Quaternion::IDENTITY,
    };
    let mut result = OuterResult::default();
    let mut steps = 0;
    for step in 0..STEPS {
        let snapshot = snapshot(step, &estimate);
        if is_flying(&outer) {
            steps += 1;
            outer_step(&mut outer, black_box(&snapshot), &items, &mut result);
        } else {
            // The same, but not counted.
            outer.step_into(black_box(&snapshot), &items[..], &mut result);
        }
        if result.report.events.contains(&MissionEvent::Finished) {
            break;
        }
        let Some(there) = &result.report.trajectory else {
            continue;
        };
        estimate.position = there.position;
        estimate.velocity = there.velocity;
        estimate.attitude = result.setpoint.attitude;
    }
    require(steps > 1000);
}

/// Whether this step is one of a vehicle that is in the air on its mission.
fn is_flying(outer: &Outer) -> bool {
    let supervisor = outer.supervisor();
    let height = -outer.estimation().estimate().position.z;
    (supervisor.phase(), supervisor.mode()) == (Phase::Flying, Mode::Mission) && height > 1.0
}

fn waypoint(frame: &LocalFrame, [north, east]: [f32; 2]) -> MissionItem {
    let place = frame.to_global(Vector3::new(north, east, 0.0));
    MissionItem {
        command: 16,
        frame: 3,
        autocontinue: true,
        params: [0.0, 0.0, 0.0, f32::NAN],
        x: place.latitude,
        y: place.longitude,
        z: HEIGHT,
    }
}

/// What there is to know at a step, and what the operator wants in the first ones.
fn snapshot(step: u32, estimate: &ExternalEstimate) -> Snapshot {
    let mut inputs = OuterInputs::default();
    let _ = inputs.external.push(*estimate);
    let command = match step {
        1 => Some(Command::Commit(
            PlanKind::Mission,
            MissionCommit {
                slot: 0,
                count: CORNERS.len() as u16,
                crc: 0,
            },
        )),
        2 => Some(Command::StartMission(0)),
        3 => Some(Command::Arm),
        _ => None,
    };
    if let Some(command) = command {
        let _ = inputs.command.push(command);
    }
    Snapshot {
        tick: 4 * step,
        time: u64::from(step) * 4000,
        increments: Increments {
            rotation: Quaternion::IDENTITY,
            velocity: Vector3::new(0.0, 0.0, -GRAVITY * INTERVAL),
            thrust: Parameters::default().vehicle.mass * GRAVITY * INTERVAL,
            duration: INTERVAL,
            ticks: 4,
            ..Increments::default()
        },
        stopped: None,
        inputs,
    }
}

/// What is counted.
#[inline(never)]
fn outer_step(outer: &mut Outer, snapshot: &Snapshot, items: &[MissionItem], result: &mut OuterResult) {
    outer.step_into(snapshot, items, result);
}
