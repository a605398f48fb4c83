//! The outer step: from a snapshot to an attitude and a thrust, 250 times a second.
//!
//! It sees nothing but its snapshot and the stored missions, so that the same snapshots give the
//! same results wherever and however slowly it runs.

use heapless::Vec;
use windhover_control::TrajectorySetpoint;
use windhover_control::VehicleParameters;
use windhover_control::observer::{DisturbanceObserver, ThrustScale};
use windhover_control::position::{AttitudeSetpoint, PositionController, PositionEstimate};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{GRAVITY, Quaternion, Vector3};

use crate::estimation::handover::Handover;
use crate::estimation::{Estimate, Estimation, OuterConfig, SensorReport};
use crate::inner::{InnerParameters, MotorState, Snapshot};
use crate::mission::executor::{MissionEstimate, Surroundings};
use crate::mission::route::Stored;
use crate::mission::{MissionEvent, MissionEvents, MissionExecutor, MissionSource, check};
use crate::parameters::Parameters;
use crate::queue::{Command, MissionCommit, ParameterWrite};
use crate::schedule::OUTER_RATE;

/// Without an attitude from outside for so long, it is not followed any more, µs.
const ATTITUDE_TIMEOUT: u32 = 500_000;

/// Above the place of arming by so much, the vehicle flies, m.
const AIRBORNE_HEIGHT: f32 = 0.3;

/// What the inner step adopts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OuterResult {
    /// Tick of the snapshot that it was made from.
    pub tick: u32,
    /// Attitude at that tick.
    pub attitude: Quaternion,
    /// Gyro bias, rad/s.
    pub gyro_bias: Vector3,
    /// Whether the motors may turn.
    pub motors: MotorState,
    /// Whether the vehicle is on the ground.
    pub landed: bool,
    /// What attitude control is to reach.
    pub setpoint: AttitudeSetpoint,
    /// New parameters of the inner step, when they have changed.
    pub parameters: Option<InnerParameters>,
    /// What is told to those who watch.
    pub report: OuterReport,
}

/// What the outer step tells those who watch: log, ground station, desktop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OuterReport {
    /// Phase of flight.
    pub phase: Phase,
    /// The estimate that control worked with.
    pub estimate: Estimate,
    /// Where positions count from, once that is known.
    pub origin: Option<GlobalPosition>,
    /// How the sensors do.
    pub sensors: SensorReport,
    /// What the setpoint is shifted by since the estimate made a step.
    pub handover: Handover,
    /// The point of the path that control followed; `None` when it followed none.
    pub trajectory: Option<TrajectorySetpoint>,
    /// Where the leg that is being flown leads, NED, m; `None` outside missions.
    pub leg_end: Option<Vector3>,
    /// The disturbance as observed, NED, m/s².
    pub disturbance: Vector3,
    /// Acceleration that the rotors give over what the parameters say.
    pub thrust_scale: f32,
    /// What happened in the mission.
    pub events: MissionEvents,
    /// Commands and writes that were refused.
    pub refusals: Vec<Refused, 8>,
}

/// Phase of flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// Motors may not turn.
    #[default]
    Disarmed,
    /// Motors idle on the ground.
    Armed,
    /// Flying a mission.
    Mission,
    /// Following setpoints from outside.
    Offboard,
    /// Following attitude and thrust from outside.
    Attitude,
}

/// Something that was asked for and not done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// A command, and why.
    Command(Command, Blocker),
    /// A write to the parameter table, and why.
    Parameter(ParameterWrite, windhover_parameters::Refusal),
}

/// A named reason not to do something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blocker {
    /// Position and attitude are not known.
    NoEstimate,
    /// The motors are not armed.
    NotArmed,
    /// The vehicle is in flight.
    InFlight,
    /// There is no mission that can be flown.
    NoMission,
    /// No setpoint has come from outside.
    NoSetpoint,
    /// The inner step keeps the motors stopped.
    Stopped,
}

/// The outer step with its memory.
#[derive(Clone, Debug)]
pub struct Outer {
    parameters: Parameters,
    inner: InnerParameters,
    stored: Option<Stored>,
    phase: Phase,
    landed: bool,
    /// Height (down, m) at which the vehicle was armed.
    ground: f32,
    mission: Option<MissionExecutor>,
    offboard: Option<TrajectorySetpoint>,
    /// The last attitude from outside, and how old it is, µs.
    attitude: Option<(AttitudeSetpoint, u32)>,
    estimation: Estimation,
    observer: DisturbanceObserver,
    thrust_scale: ThrustScale,
    position: PositionController,
    time: Option<u64>,
    inner_changed: bool,
}

impl Outer {
    /// Disarmed, nothing known of where. `None` when the parameters describe no vehicle that flies.
    pub fn new(parameters: Parameters, config: &OuterConfig) -> Option<Self> {
        Some(Self {
            inner: InnerParameters::new(&parameters)?,
            parameters,
            stored: None,
            phase: Phase::Disarmed,
            landed: true,
            ground: 0.0,
            mission: None,
            offboard: None,
            attitude: None,
            estimation: Estimation::new(config),
            observer: DisturbanceObserver::default(),
            thrust_scale: ThrustScale::default(),
            position: PositionController::default(),
            time: None,
            inner_changed: false,
        })
    }

    /// The inner step's parameters as they are now.
    pub fn inner_parameters(&self) -> InnerParameters {
        self.inner
    }

    /// The parameter table as it is now.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The estimate with all that it follows from.
    pub fn estimation(&self) -> &Estimation {
        &self.estimation
    }

    fn estimate(&self) -> &Estimate {
        self.estimation.estimate()
    }

    /// One step on one snapshot.
    #[inline]
    pub fn step<S: MissionSource + ?Sized>(&mut self, snapshot: &Snapshot, source: &S) -> OuterResult {
        let mut result = OuterResult::default();
        self.step_into(snapshot, source, &mut result);
        result
    }

    /// The same, for whoever has a place for the result: all of it is written anew. Moving a result
    /// costs half as much as making it.
    pub fn step_into<S: MissionSource + ?Sized>(
        &mut self,
        snapshot: &Snapshot,
        source: &S,
        result: &mut OuterResult,
    ) {
        let report = &mut result.report;
        report.events.clear();
        report.refusals.clear();
        let dt = self.elapsed(snapshot.time);
        for write in &snapshot.inputs.parameter {
            self.write_parameter(write, &mut report.refusals);
        }
        let before = *self.estimate();
        self.estimation.step(&self.parameters, snapshot, dt, self.landed);
        self.observe(&before, snapshot);
        if let Some(setpoint) = snapshot
            .inputs
            .setpoint
            .iter()
            .rev()
            .find(|setpoint| setpoint.is_finite())
        {
            self.offboard = Some(*setpoint);
        }
        self.take_attitude(snapshot, dt);
        if snapshot.stopped.is_some() {
            self.disarm();
        }
        for command in &snapshot.inputs.command {
            if let Err(blocker) = self.command(*command, source, snapshot.stopped.is_some()) {
                let _ = report.refusals.push(Refused::Command(*command, blocker));
            }
        }
        report.trajectory = self.trajectory(source, dt, &mut report.events);
        result.setpoint = self.control(report.trajectory.as_ref(), snapshot, dt);
        result.tick = snapshot.tick;
        self.tell(result);
    }

    /// Writes what follows from the state after the step.
    fn tell(&mut self, result: &mut OuterResult) {
        let estimate = self.estimation.estimate();
        result.attitude = estimate.attitude;
        result.gyro_bias = estimate.gyro_bias;
        result.motors = self.motors();
        result.landed = self.landed || self.has_contact();
        let report = &mut result.report;
        report.phase = self.phase;
        report.estimate = *estimate;
        report.origin = self.estimation.frame().map(LocalFrame::origin);
        report.sensors = *self.estimation.sensors();
        report.handover = *self.estimation.handover();
        report.leg_end = self.mission.as_ref().map(MissionExecutor::leg_end);
        report.disturbance = self.observer.disturbance(&self.parameters.observer);
        report.thrust_scale = self.thrust_scale.scale();
        result.parameters = None;
        if core::mem::take(&mut self.inner_changed) {
            result.parameters = Some(self.inner);
        }
    }

    fn motors(&self) -> MotorState {
        let waits = self
            .mission
            .as_ref()
            .is_some_and(MissionExecutor::waits_on_ground);
        match self.phase {
            Phase::Disarmed => MotorState::Disarmed,
            Phase::Armed => MotorState::Idle,
            Phase::Mission if waits => MotorState::Idle,
            Phase::Mission | Phase::Offboard | Phase::Attitude => MotorState::Run,
        }
    }

    /// Time since the last snapshot, µs.
    fn elapsed(&mut self, time: u64) -> u32 {
        let nominal = 1_000_000 / OUTER_RATE;
        let elapsed = self
            .time
            .map_or(nominal, |last| time.saturating_sub(last).min(1_000_000) as u32);
        self.time = Some(time);
        elapsed.max(nominal / 4)
    }

    fn write_parameter(&mut self, write: &ParameterWrite, refusals: &mut Vec<Refused, 8>) {
        let old = self.parameters;
        let outcome = self.parameters.set(usize::from(write.index), write.value);
        let outcome = outcome.and_then(|()| {
            InnerParameters::new(&self.parameters).ok_or(windhover_parameters::Refusal::Inconsistent)
        });
        match outcome {
            Ok(inner) => {
                self.position.retune(&old.position, &self.parameters.position);
                self.inner_changed |= inner != self.inner;
                self.inner = inner;
            }
            Err(refusal) => {
                self.parameters = old;
                let _ = refusals.push(Refused::Parameter(*write, refusal));
            }
        }
    }

    /// Keeps the newest attitude from outside, while it is fresh. Without a position, a thrust
    /// above the weight is what says that the vehicle has left the ground.
    fn take_attitude(&mut self, snapshot: &Snapshot, dt: u32) {
        let newest = snapshot
            .inputs
            .attitude
            .iter()
            .rev()
            .find(|setpoint| setpoint.is_valid());
        self.attitude = match (newest, self.attitude) {
            (Some(setpoint), _) => Some((*setpoint, 0)),
            (None, Some((setpoint, age))) if age < ATTITUDE_TIMEOUT => {
                Some((setpoint, age.saturating_add(dt)))
            }
            (None, _) => None,
        };
        if let (Phase::Attitude, Some((setpoint, _))) = (self.phase, &self.attitude)
            && setpoint.thrust > self.parameters.vehicle.mass * GRAVITY
        {
            self.landed = false;
        }
    }

    /// Tells the observer what was measured while the vehicle turned from the last attitude to
    /// this one.
    fn observe(&mut self, before: &Estimate, snapshot: &Snapshot) {
        let increments = &snapshot.increments;
        if self.landed || self.has_contact() || !before.known.attitude || increments.duration <= 0.0 {
            self.observer.reset();
            return;
        }
        if increments.blind > 0 {
            // Nothing is measured of the forces: the wind goes on as it did.
            return;
        }
        let per_second = 1.0 / increments.duration;
        let own = increments.velocity * per_second - before.accel_bias;
        let force = before.attitude.rotate(own);
        let down = (before.attitude.down_axis() + self.estimate().attitude.down_axis()) * 0.5;
        let thrust = increments.thrust * per_second / self.parameters.vehicle.mass;
        self.thrust_scale
            .step(&self.parameters.observer, -own.z, thrust, increments.duration);
        let thrust = down * (-thrust * self.thrust_scale.scale());
        self.observer
            .step(&self.parameters.observer, force, thrust, increments.duration);
    }

    /// Does what the operator wants, or says why not.
    fn command<S: MissionSource + ?Sized>(
        &mut self,
        command: Command,
        source: &S,
        stopped: bool,
    ) -> Result<(), Blocker> {
        match command {
            Command::Arm if stopped => Err(Blocker::Stopped),
            Command::Arm if !self.may_arm() => Err(Blocker::NoEstimate),
            Command::Arm if self.phase == Phase::Disarmed => {
                self.phase = Phase::Armed;
                self.ground = self.estimate().position.z;
                self.estimation.forget_steps();
                Ok(())
            }
            Command::Arm => Ok(()),
            Command::Disarm if !self.landed => Err(Blocker::InFlight),
            Command::Disarm => {
                self.disarm();
                Ok(())
            }
            Command::StartMission => self.start_mission(source),
            Command::StartOffboard if self.phase == Phase::Disarmed => Err(Blocker::NotArmed),
            Command::StartOffboard if !self.estimate().known.position => Err(Blocker::NoEstimate),
            Command::StartOffboard if self.offboard.is_none() => Err(Blocker::NoSetpoint),
            Command::StartOffboard => {
                self.phase = Phase::Offboard;
                Ok(())
            }
            Command::StartAttitude if self.phase == Phase::Disarmed => Err(Blocker::NotArmed),
            Command::StartAttitude if self.attitude.is_none() => Err(Blocker::NoSetpoint),
            Command::StartAttitude => {
                self.phase = Phase::Attitude;
                self.mission = None;
                Ok(())
            }
            Command::CommitMission(commit) => self.commit_mission(&commit, source),
        }
    }

    /// Whether enough is known: the position, or the attitude where that is all that is asked for.
    fn may_arm(&self) -> bool {
        let known = &self.estimate().known;
        known.position || (known.attitude && self.attitude.is_some())
    }

    /// Whether the ground already holds a vehicle that comes down to land.
    fn has_contact(&self) -> bool {
        self.mission.as_ref().is_some_and(MissionExecutor::has_contact)
    }

    fn disarm(&mut self) {
        self.phase = Phase::Disarmed;
        self.mission = None;
        self.landed = true;
    }

    fn commit_mission<S: MissionSource + ?Sized>(
        &mut self,
        commit: &MissionCommit,
        source: &S,
    ) -> Result<(), Blocker> {
        if self.phase == Phase::Mission {
            return Err(Blocker::InFlight);
        }
        let stored = Stored {
            slot: commit.slot,
            count: commit.count,
        };
        let home = self.estimation.frame().map(LocalFrame::origin);
        let checked = check(source, stored, home, &self.parameters.mission);
        self.stored = checked.is_ok().then_some(stored);
        checked.map_err(|_| Blocker::NoMission)
    }

    fn start_mission<S: MissionSource + ?Sized>(&mut self, source: &S) -> Result<(), Blocker> {
        if self.phase == Phase::Disarmed {
            return Err(Blocker::NotArmed);
        }
        let estimate = self.estimate();
        let Some(frame) = self.estimation.frame().filter(|_| estimate.known.position) else {
            return Err(Blocker::NoEstimate);
        };
        let stored = self.stored.ok_or(Blocker::NoMission)?;
        // It may have been stored before there was a home.
        check(source, stored, Some(frame.origin()), &self.parameters.mission)
            .map_err(|_| Blocker::NoMission)?;
        let heading = estimate.attitude.heading();
        let around = Surroundings {
            source,
            frame,
            parameters: &self.parameters.mission,
            estimate: mission_estimate(&self.estimation, self.landed),
        };
        let mission = MissionExecutor::start(stored, &around, heading);
        self.mission = Some(mission.ok_or(Blocker::NoMission)?);
        self.phase = Phase::Mission;
        Ok(())
    }

    /// Where the vehicle should be now.
    fn trajectory<S: MissionSource + ?Sized>(
        &mut self,
        source: &S,
        dt: u32,
        events: &mut MissionEvents,
    ) -> Option<TrajectorySetpoint> {
        let flying = matches!(self.phase, Phase::Mission | Phase::Offboard);
        if flying && self.landed && self.estimate().position.z < self.ground - AIRBORNE_HEIGHT {
            self.landed = false;
        }
        match self.phase {
            Phase::Disarmed | Phase::Armed | Phase::Attitude => None,
            Phase::Offboard => self.offboard,
            Phase::Mission => {
                let around = Surroundings {
                    source,
                    frame: self.estimation.frame()?,
                    parameters: &self.parameters.mission,
                    estimate: mission_estimate(&self.estimation, self.landed),
                };
                let setpoint = self.mission.as_mut()?.step(&around, dt, events);
                if events.contains(&MissionEvent::Landed) {
                    self.disarm();
                }
                Some(setpoint)
            }
        }
    }

    /// Attitude and thrust that lead there.
    fn control(
        &mut self,
        trajectory: Option<&TrajectorySetpoint>,
        snapshot: &Snapshot,
        dt: u32,
    ) -> AttitudeSetpoint {
        let Some(trajectory) = trajectory.filter(|_| self.estimate().known.position) else {
            self.position.reset();
            return match self.attitude {
                Some((setpoint, _)) if self.phase == Phase::Attitude => setpoint,
                _ => self.level(self.inner.descent_thrust()),
            };
        };
        let believed = self.estimation.estimate();
        let handover = self.estimation.handover();
        let trajectory = handover.shifted(trajectory);
        let estimate = PositionEstimate {
            position: believed.position,
            velocity: believed.velocity - handover.velocity,
            attitude: believed.attitude,
            disturbance: self.observer.disturbance(&self.parameters.observer),
        };
        // As heavy as the thrust feels it to be.
        let vehicle = VehicleParameters {
            mass: self.parameters.vehicle.mass / self.thrust_scale.scale(),
            ..self.parameters.vehicle
        };
        let shortfall = snapshot.increments.thrust_shortfall;
        let mean_shortfall = if snapshot.increments.duration > 0.0 {
            shortfall / snapshot.increments.duration
        } else {
            0.0
        };
        let setpoint = self.position.step(
            &self.parameters.position,
            &vehicle,
            &trajectory,
            &estimate,
            if self.landed { 0.0 } else { mean_shortfall },
            dt as f32 * 1e-6,
        );
        if self.has_contact() {
            // The legs hold the vehicle where it is: a tilt demanded now would only topple it.
            return self.level(setpoint.thrust);
        }
        setpoint
    }

    /// Upright, with the heading kept.
    fn level(&self, thrust: f32) -> AttitudeSetpoint {
        AttitudeSetpoint {
            attitude: Quaternion::from_heading(self.estimate().attitude.heading()),
            rate: Vector3::zeros(),
            thrust,
        }
    }
}

fn mission_estimate(estimation: &Estimation, landed: bool) -> MissionEstimate {
    let estimate = estimation.estimate();
    MissionEstimate {
        position: estimate.position,
        shift: estimation.handover().position,
        velocity: estimate.velocity,
        landed,
    }
}
