//! A vehicle for tests of the outer step: a point of mass that turns and pulls as it is told, with
//! short lags, over flat ground.

use windhover_autopilot::mission::{MissionEvent, MissionItem, PlanKind, Plans};
use windhover_autopilot::{
    Command, ExternalEstimate, Increments, MissionCommit, Mode, MotorState, Outer, OuterConfig, OuterInputs,
    OuterReport, OuterResult, ParameterWrite, Parameters, Phase, RcFrame, Refused, Snapshot, Sticks, Stop,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{GRAVITY, Quaternion, Vector3, max};

use super::HOME;

pub const DT: f32 = 0.004;

/// Time constants of attitude and thrust, s.
const ATTITUDE_LAG: f32 = 0.05;
const THRUST_LAG: f32 = 0.03;

/// What comes in with every step.
#[derive(Clone, Default)]
pub struct Steady {
    pub sticks: Option<Sticks>,
    pub rc: Option<RcFrame>,
    pub setpoint: Option<TrajectorySetpoint>,
    pub attitude: Option<AttitudeSetpoint>,
    pub guidance: Option<windhover_autopilot::mode::Guidance>,
}

/// The vehicle with its outer step.
#[derive(Clone)]
pub struct Flight {
    pub outer: Outer,
    pub mission: Vec<MissionItem>,
    pub fence: Vec<MissionItem>,
    pub tick: u32,
    pub position: Vector3,
    pub velocity: Vector3,
    pub attitude: Quaternion,
    pub thrust: f32,
    pub stopped: Option<Stop>,
    /// Ticks of each step that have no sample.
    pub missing: u16,
    /// Whether somebody outside says where the vehicle is.
    pub seen: bool,
    pub inputs: OuterInputs,
    pub steady: Steady,
    pub result: OuterResult,
    /// What happened, and at which tick.
    pub events: Vec<(u32, MissionEvent)>,
}

impl Flight {
    pub fn new() -> Self {
        Self::with(Parameters::default(), Some(HOME))
    }

    pub fn with(parameters: Parameters, home: Option<windhover_math::geodesy::GlobalPosition>) -> Self {
        let config = OuterConfig {
            home,
            ..OuterConfig::default()
        };
        Self {
            outer: Outer::new(parameters, &config).expect("a vehicle that flies"),
            mission: Vec::new(),
            fence: Vec::new(),
            tick: 0,
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            attitude: Quaternion::IDENTITY,
            thrust: 0.0,
            stopped: None,
            missing: 0,
            seen: true,
            inputs: OuterInputs::default(),
            steady: Steady::default(),
            result: OuterResult::default(),
            events: Vec::new(),
        }
    }

    /// Stands on the ground with a mission stored.
    pub fn with_mission(items: &[MissionItem]) -> Self {
        let mut flight = Self::new();
        flight.step();
        flight.store(items);
        flight
    }

    pub fn store(&mut self, items: &[MissionItem]) {
        self.mission = items.to_vec();
        self.obey(commit(PlanKind::Mission, items.len()));
    }

    /// Hovers at a height over home.
    pub fn hovering(mut self, height: f32) -> Self {
        self.step();
        self.obey(Command::Arm);
        self.obey(Command::Takeoff(
            Some(windhover_autopilot::mission::action::Altitude::Home(height)),
            None,
        ));
        self.until(60.0, |flight| flight.report().mode == Mode::Hold);
        self.run(3.0);
        assert!((self.position.z + height).abs() < 0.1, "{}", self.position);
        self
    }

    pub fn report(&self) -> &OuterReport {
        &self.result.report
    }

    pub fn mass(&self) -> f32 {
        self.outer.parameters().vehicle.mass
    }

    pub fn step(&mut self) -> &OuterResult {
        let (before, force) = (self.attitude, self.move_on());
        let mut inputs = core::mem::take(&mut self.inputs);
        if self.seen {
            let _ = inputs.external.push(ExternalEstimate {
                position: self.position,
                velocity: self.velocity,
                attitude: self.attitude,
            });
        }
        inputs.sticks.extend(self.steady.sticks);
        inputs.rc.extend(self.steady.rc);
        inputs.setpoint.extend(self.steady.setpoint);
        inputs.attitude.extend(self.steady.attitude);
        inputs.guidance.extend(self.steady.guidance);
        let snapshot = Snapshot {
            tick: self.tick,
            time: u64::from(self.tick) * 1000,
            increments: Increments {
                rotation: before.conjugate() * self.attitude,
                velocity: before.conjugate().rotate(force) * DT,
                thrust: self.thrust * DT,
                duration: DT,
                ticks: 4,
                missing: self.missing,
                ..Increments::default()
            },
            stopped: self.stopped,
            inputs,
        };
        let plans = Plans {
            mission: &self.mission,
            fence: &self.fence,
            rally: &[],
        };
        self.outer.step_into(&snapshot, &plans, &mut self.result);
        let tick = self.tick;
        let happened = self.result.report.events.iter().map(|event| (tick, *event));
        self.events.extend(happened);
        self.tick += 4;
        &self.result
    }

    /// The vehicle, for a step; the specific force, NED, m/s².
    fn move_on(&mut self) -> Vector3 {
        let setpoint = &self.result.setpoint;
        let runs = self.result.motors == MotorState::Run && self.stopped.is_none();
        let wanted = if runs { setpoint.thrust } else { 0.0 };
        self.thrust += (wanted - self.thrust) * (DT / THRUST_LAG);
        let on_ground = self.position.z >= 0.0;
        if runs && !on_ground {
            let turn = (self.attitude.conjugate() * setpoint.attitude).shortest();
            let part = Vector3::new(turn.x, turn.y, turn.z) * (2.0 * DT / ATTITUDE_LAG);
            self.attitude = (self.attitude * Quaternion::from_rotation_vector(part)).renormalized();
        }
        let mut force = self.attitude.down_axis() * (-self.thrust / self.mass());
        let gravity = Vector3::new(0.0, 0.0, GRAVITY);
        if on_ground && (force + gravity).z >= 0.0 {
            // The ground pushes, and its friction holds.
            force = -gravity;
            self.velocity = Vector3::zeros();
            self.position.z = 0.0;
            if self.result.motors != MotorState::Disarmed {
                self.attitude = Quaternion::from_heading(self.attitude.heading());
            }
        }
        self.velocity += (force + gravity) * DT;
        self.position += self.velocity * DT;
        self.position.z = self.position.z - max(self.position.z, 0.0);
        force
    }

    pub fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds / DT) as u32 {
            self.step();
        }
    }

    /// Steps until something holds. Panics when it does not within so many seconds.
    pub fn until(&mut self, seconds: f32, holds: impl Fn(&Self) -> bool) {
        for _ in 0..(seconds / DT) as u32 {
            if holds(self) {
                return;
            }
            self.step();
        }
        panic!(
            "not within {seconds} s: {:?} {:?} {:?} at {}",
            self.report().phase,
            self.report().mode,
            self.report().failsafe,
            self.position
        );
    }

    /// Gives a command and makes a step.
    pub fn command(&mut self, command: Command) -> &OuterResult {
        self.inputs.command.push(command).expect("room");
        self.step()
    }

    /// Gives a command that is not refused.
    pub fn obey(&mut self, command: Command) {
        let refusals = &self.command(command).report.refusals;
        assert!(refusals.is_empty(), "{refusals:?}");
    }

    /// Gives a command that is refused; why.
    pub fn refused(&mut self, command: Command) -> windhover_autopilot::Why {
        match self.command(command).report.refusals[..] {
            [Refused::Command(refused, why)] if format!("{refused:?}") == format!("{command:?}") => why,
            ref other => panic!("{command:?}: {other:?}"),
        }
    }

    pub fn write(&mut self, name: &str, value: f32) {
        let index = Parameters::find(name).expect(name) as u16;
        self.inputs
            .parameter
            .push(ParameterWrite { index, value })
            .expect("room");
        assert!(self.step().report.refusals.is_empty(), "{name}");
    }

    pub fn photos(&self) -> Vec<u16> {
        let photos = self.events.iter().filter_map(|(_, event)| match event {
            MissionEvent::Photo { item, .. } => Some(*item),
            _ => None,
        });
        photos.collect()
    }

    pub fn is_flying(&self) -> bool {
        self.report().phase == Phase::Flying
    }
}

pub fn commit(kind: PlanKind, count: usize) -> Command {
    let count = count as u16;
    Command::Commit(
        kind,
        MissionCommit {
            slot: 0,
            count,
            crc: 0,
        },
    )
}

/// A receiver's frame; sticks in the middle and throttle low.
pub fn frame(kill: u16) -> RcFrame {
    let mut channels = [1500; 16];
    (channels[2], channels[4], channels[6]) = (1000, 1000, kill);
    RcFrame { channels }
}
