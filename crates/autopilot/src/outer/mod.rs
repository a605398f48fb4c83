//! The outer step: from a snapshot to an attitude and a thrust, 250 times a second.
//!
//! It sees nothing but its snapshot and the stored plans, so that the same snapshots give the same
//! results wherever and however slowly it runs. In this order: parameters; the estimate; what comes
//! from pilots, setpoints, battery and stations; commands; what is watched; the supervisor, which
//! decides phase and mode; the mode, to a demand; control, to attitude and thrust.

mod command;
mod control;
mod plans;
mod report;

use windhover_control::mixer::FULL_COMMAND;
use windhover_control::observer::{DisturbanceObserver, ThrustScale};
use windhover_control::position::{AttitudeSetpoint, PositionController};
use windhover_math::geodesy::LocalFrame;
use windhover_math::{GRAVITY, Vector3, min, sqrt};

use crate::battery::Battery;
use crate::blocker::Blockers;
use crate::estimation::{Estimate, Estimation, OuterConfig};
use crate::fence::FenceAction;
use crate::inner::{InnerParameters, MotorState, Snapshot};
use crate::landing::LandDetector;
use crate::mission::{MissionEvent, MissionEvents, MissionSource};
use crate::mode::{Around, Demand, Mode, Modes, Need, Needs, Outside, Setpoints, available};
use crate::parameters::Parameters;
use crate::queue::{MotorTest, ParameterWrite};
use crate::rc::{Events, Remote};
use crate::schedule::OUTER_RATE;
use crate::supervisor::{Actions, Facts, Phase, RowSet, Supervisor};
use crate::watch::{Seen, Wanted, Watch, is_position_known, time_to_return};

pub use command::NO_ITEM;
pub use report::{BatteryReport, MissionReport, OuterReport, OuterResult, Refusals, Refused, Why};

/// Less thrust than this share of the weight does not hold a vehicle in the air.
const LIGHT: f32 = 0.85;

/// Of the time until a failsafe brakes: estimate, look, attitude, s.
const REACTION: f32 = 0.5;

/// Fence and range are looked at every so many looks of the watch.
const SLOW: u8 = 5;

/// The outer step with its memory.
#[derive(Clone, Debug)]
pub struct Outer {
    parameters: Parameters,
    inner: InnerParameters,
    actions: Actions,
    plans: plans::Plans,
    supervisor: Supervisor,
    watch: Watch,
    modes: Modes,
    landing: LandDetector,
    /// Home, NED, m from the origin.
    home: Vector3,
    /// Whether an operator has put it there.
    home_is_set: bool,
    /// How long an armed vehicle stands on the ground, s.
    on_ground: f32,
    /// Whether the motors idled at the last step.
    idles: bool,
    /// What the mode gave at the last step.
    next: Option<Mode>,
    /// Whether a mode was ordered in this step.
    ordered: bool,
    contact: bool,
    blockers: Blockers,
    remote: Remote,
    switches: Events,
    setpoints: Setpoints,
    battery: Battery,
    /// Time since a ground station was heard, µs.
    station: Option<u32>,
    breach: bool,
    range_short: bool,
    looks: u8,
    storage_damaged: bool,
    /// The motor that is turned while disarmed, and for how long still.
    motor_test: Option<MotorTest>,
    wanted: Wanted,
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
            actions: Actions::new(&parameters),
            parameters,
            plans: plans::Plans::default(),
            supervisor: Supervisor::default(),
            watch: Watch::default(),
            modes: Modes::default(),
            landing: LandDetector::default(),
            home: Vector3::zeros(),
            home_is_set: false,
            on_ground: 0.0,
            idles: true,
            next: None,
            ordered: false,
            contact: false,
            blockers: Blockers::default(),
            remote: Remote::default(),
            switches: Events::default(),
            setpoints: Setpoints::default(),
            battery: Battery::default(),
            station: None,
            breach: false,
            range_short: false,
            looks: 0,
            storage_damaged: false,
            motor_test: None,
            wanted: Wanted::default(),
            estimation: Estimation::new(config),
            observer: DisturbanceObserver::default(),
            thrust_scale: ThrustScale::default(),
            position: PositionController::default(),
            time: None,
            inner_changed: false,
        })
    }

    /// The same, with settings that were found damaged in storage: it says so, and does not arm.
    #[must_use]
    pub fn with_damaged_storage(mut self) -> Self {
        self.storage_damaged = true;
        self
    }

    /// The inner step's parameters as they are now.
    pub fn inner_parameters(&self) -> InnerParameters {
        self.inner
    }

    /// The parameter table as it is now.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Phase, mode and failsafe.
    pub fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// What spoke against arming when it was last looked at; looked at while disarmed.
    pub fn blockers(&self) -> Blockers {
        self.blockers
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
        let landed = self.landing.is_landed();
        self.estimation.step(&self.parameters, snapshot, dt, landed);
        if let Some(frame) = self.estimation.frame() {
            self.plans.compile(source, frame);
        }
        self.observe(&before, snapshot);
        self.listen(snapshot, dt);
        self.decide(snapshot, source, dt, result);
        self.fly(source, dt, &mut result.report.events);
        let step = self.modes.last();
        self.next = step.next;
        let (contact, share) = (step.contact, step.thrust_share);
        let rests = step.demand == Demand::Rest;
        self.count_idling(rests);
        result.motors = self.motors(rests);
        self.go_on_testing(snapshot.stopped.is_some(), dt);
        let mut wanted = self.control(snapshot, dt);
        wanted.thrust *= share;
        // A vehicle that the ground holds needs little thrust. The legs hold it where it is: a tilt
        // demanded now would only topple it.
        self.contact = contact && wanted.thrust < LIGHT * self.landing.hover();
        result.setpoint = if self.contact {
            self.level(wanted.thrust)
        } else {
            wanted
        };
        self.wanted = self.wanted(&result.setpoint);
        result.tick = snapshot.tick;
        self.tell(snapshot, result);
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

    fn write_parameter(&mut self, write: &ParameterWrite, refusals: &mut Refusals) {
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
                self.actions = Actions::new(&self.parameters);
            }
            Err(refusal) => {
                self.parameters = old;
                let _ = refusals.push(Refused::Parameter(*write, refusal));
            }
        }
    }

    /// Takes in what comes from pilots, setpoints, battery and stations.
    fn listen(&mut self, snapshot: &Snapshot, dt: u32) {
        let (inputs, p) = (&snapshot.inputs, &self.parameters);
        let landed = self.landing.is_landed();
        self.switches = self
            .remote
            .step(&inputs.rc, &inputs.sticks, &p.rc, &p.rc_calibration, landed, dt);
        self.setpoints.take(inputs, dt);
        self.battery.step(&inputs.battery, &p.battery, dt);
        self.station = match self.station {
            _ if !inputs.station.is_empty() => Some(0),
            Some(age) => Some(age.saturating_add(dt)),
            None => None,
        };
    }

    /// The newest setpoint from outside, while it is fresh.
    fn fresh_setpoint(&self) -> Option<&Outside> {
        self.setpoints.fresh(self.parameters.safety.offboard_lost_time)
    }

    fn is_position_known(&self) -> bool {
        is_position_known(self.estimate(), self.estimation.position_age(), &self.parameters)
    }

    /// What there is that modes can rely on.
    fn there_is(&self) -> Needs {
        let known = &self.estimate().known;
        Needs::default()
            .with(Need::Attitude, known.attitude)
            .with(Need::Height, known.height)
            .with(Need::Position, self.is_position_known())
            .with(Need::Sticks, self.remote.sticks().is_some())
            .with(
                Need::Mission,
                self.plans.mission.is_some() && self.estimation.frame().is_some(),
            )
            .with(Need::Setpoint, self.fresh_setpoint().is_some())
    }

    /// Whether setpoints from outside need a position; also when the last one has grown old.
    fn setpoint_needs_position(&self) -> bool {
        !matches!(self.setpoints.newest(), Some(Outside::Attitude(_)))
    }

    /// Commands, what is watched, and what the supervisor makes of it.
    fn decide<S: MissionSource + ?Sized>(
        &mut self,
        snapshot: &Snapshot,
        source: &S,
        dt: u32,
        result: &mut OuterResult,
    ) {
        let phase = self.supervisor.phase();
        let armed = phase != Phase::Disarmed;
        if armed {
            let weight = self.weight();
            self.landing.step(snapshot, self.estimation.estimate(), weight);
        }
        let seconds = dt as f32 * 1e-6;
        self.on_ground = if armed && self.landing.is_landed() {
            self.on_ground + seconds
        } else {
            0.0
        };
        let p = &self.parameters.safety;
        let patience = match phase {
            Phase::Landed => p.disarm_landed,
            // A mission may wait on the ground for as long as its items say.
            _ if self.supervisor.mode() == Mode::Mission => f32::INFINITY,
            _ => p.disarm_ground,
        };
        let (there_is, places) = (self.there_is(), self.setpoint_needs_position());
        let needs = self.supervisor.mode().needs(places);
        let lost = armed && !needs.without(there_is).is_empty();
        let looked = self.look(snapshot, lost);
        let stopped = snapshot.stopped.is_some() || self.switches.kill;
        let flies = phase == Phase::Flying && !self.landing.is_landed();
        if flies && looked.is_none() && !stopped && self.next.is_none() && !self.is_commanded(snapshot) {
            // Nothing has changed since the supervisor's last step.
            return;
        }
        let mut facts = Facts {
            stopped,
            airborne: !self.landing.is_landed(),
            disarm_due: self.on_ground > patience,
            available: available(there_is, places),
            next: self.next.take(),
            active: Watch::with_stop(self.watch.active(), snapshot.stopped),
            rising: looked.unwrap_or_default(),
        };
        let report = &mut result.report;
        self.ordered = false;
        self.commands(snapshot, source, &facts, &mut report.events, &mut report.refusals);
        if self.ordered {
            // What the operator has just chosen stays, whatever was to follow what flew until now.
            facts.next = None;
        }
        // Arming settles what is over.
        facts.active = Watch::with_stop(self.watch.active(), snapshot.stopped);
        facts.rising = facts.rising.and(facts.active);
        self.supervisor.step(&facts, &self.actions);
        self.follow(phase, facts.stopped, &mut report.events);
    }

    /// A vehicle that begins to lift has its time to do so before it is disarmed for standing there.
    fn count_idling(&mut self, idles: bool) {
        if self.idles && !idles {
            let armed = self.supervisor.phase() == Phase::Armed;
            let spool_up = if armed {
                self.parameters.safety.spool_up
            } else {
                0.0
            };
            self.on_ground = min(self.on_ground, spool_up);
        }
        self.idles = idles;
    }

    /// What a change of phase brings along.
    fn follow(&mut self, before: Phase, stopped: bool, events: &mut MissionEvents) {
        let phase = self.supervisor.phase();
        if before == Phase::Flying && phase == Phase::Landed {
            self.on_ground = 0.0;
            let _ = events.push(MissionEvent::Landed);
        }
        if phase == Phase::Disarmed {
            if before != Phase::Disarmed {
                self.modes.rest();
            }
            self.landing.stand(self.estimation.estimate().position.z);
            if self.looks == 0 {
                self.blockers = self.find_blockers(stopped);
            }
        }
    }

    /// Looks at what is watched, when it is time; the rows that have become active. A mode that has
    /// `lost` what it relies on does not wait: it falls back in this step, and a row that watches it
    /// would not see it any more.
    fn look(&mut self, snapshot: &Snapshot, lost: bool) -> Option<RowSet> {
        let due = self
            .watch
            .step(snapshot, &self.wanted, self.estimation.is_on_sensors());
        // Whoever wants to arm is told what holds now, and arms with that.
        let settles = self.supervisor.phase() == Phase::Disarmed && self.is_commanded(snapshot);
        if !due && !lost && !settles {
            return None;
        }
        if due {
            self.looks = if self.looks >= SLOW - 1 { 0 } else { self.looks + 1 };
        }
        if due && self.looks == 0 {
            self.look_around();
        }
        let interrupted = self.supervisor.interrupted();
        let mode = interrupted.unwrap_or(self.supervisor.mode());
        let needs = mode.needs(self.setpoint_needs_position());
        let estimate = self.estimation.estimate();
        let flies = self.supervisor.phase() == Phase::Flying;
        let seen = Seen {
            parameters: &self.parameters,
            snapshot,
            estimate,
            position_age: self.estimation.position_age(),
            compass_lost: self.estimation.is_compass_lost(),
            barometer_lost: self.estimation.is_barometer_lost(),
            mode,
            needs,
            height: self.home.z - estimate.position.z,
            charge: self.battery.charge(),
            range_short: self.range_short && flies,
            rc_lost: self.remote.is_lost(),
            station_age: self.station.map(|age| age as f32 * 1e-6),
            setpoint_fresh: self.fresh_setpoint().is_some(),
            breach: self.breach,
        };
        Some(self.watch.look(&seen))
    }

    /// What changes slowly: the fence, and whether the battery lasts to return.
    fn look_around(&mut self) {
        let p = &self.parameters;
        let estimate = self.estimation.estimate();
        let known = self.is_position_known() && self.estimation.frame().is_some();
        let breach = self.plans.fence.watch(
            &p.fence,
            self.home,
            estimate.position,
            estimate.velocity,
            p.manual.acceleration,
            REACTION,
        );
        let counts = p.fence.action() != FenceAction::Nothing;
        self.breach = known && counts && breach.is_some();
        let to = self.plans.rally.destination(estimate.position, self.home);
        let (north, east) = (to.x - estimate.position.x, to.y - estimate.position.y);
        let distance = sqrt(north * north + east * east);
        let needed = time_to_return(distance, self.home.z - estimate.position.z, p);
        let left = self.battery.seconds_left(p.battery.emergency);
        self.range_short = left.is_some_and(|left| left < needed * p.safety.range_margin);
    }

    /// What is kept of a setpoint to be watched.
    fn wanted(&self, setpoint: &AttitudeSetpoint) -> Wanted {
        let p = &self.parameters;
        let most = p.position.thrust_max * 4.0 * p.vehicle.rotor_thrust_max();
        Wanted {
            cos_tilt: setpoint.attitude.cos_tilt(),
            all_thrust: setpoint.thrust >= 0.999 * most,
            light: setpoint.thrust < 0.5 * self.landing.hover(),
        }
    }

    /// Weight as the thrust feels it, N.
    fn weight(&self) -> f32 {
        self.parameters.vehicle.mass * GRAVITY / self.thrust_scale.scale()
    }

    /// Lets the mode make its step.
    fn fly<S: MissionSource + ?Sized>(&mut self, source: &S, dt: u32, events: &mut MissionEvents) {
        let phase = self.supervisor.phase();
        let spools = phase == Phase::Armed && self.on_ground < self.parameters.safety.spool_up;
        if phase == Phase::Disarmed || spools {
            return self.modes.pause();
        }
        let around = Around {
            parameters: &self.parameters,
            estimate: self.estimation.estimate(),
            handover: self.estimation.handover(),
            thrust_scale: self.thrust_scale.scale(),
            frame: self.estimation.frame(),
            home: self.home,
            rally: &self.plans.rally,
            source,
            stored: self.plans.mission,
            landed: self.landing.is_landed(),
            force: self.landing.force(),
            blind: self.landing.is_blind(),
            sticks: self.remote.sticks(),
            setpoints: &self.setpoints,
            dt,
            seconds: dt as f32 * 1e-6,
        };
        self.modes.step(self.supervisor.mode(), &around, events);
    }

    fn motors(&self, rests: bool) -> MotorState {
        match self.supervisor.phase() {
            Phase::Disarmed => self
                .motor_test
                .map_or(MotorState::Disarmed, |test| MotorState::Test {
                    rotor: test.rotor,
                    command: (test.share * FULL_COMMAND) as u16,
                }),
            Phase::Flying => MotorState::Run,
            Phase::Armed | Phase::Landed if rests => MotorState::Idle,
            Phase::Armed | Phase::Landed => MotorState::Run,
        }
    }

    /// A motor's test ends with its time, by whatever stops the motors, and when the vehicle is armed.
    fn go_on_testing(&mut self, stopped: bool, dt: u32) {
        let ends = stopped || self.switches.kill || self.supervisor.phase() != Phase::Disarmed;
        if let Some(test) = &mut self.motor_test {
            test.duration -= dt as f32 * 1e-6;
        }
        self.motor_test = self
            .motor_test
            .filter(|test| !ends && test.duration > 0.0 && test.share > 0.0);
    }

    /// Tells the observer what was measured while the vehicle turned from the last attitude to
    /// this one.
    fn observe(&mut self, before: &Estimate, snapshot: &Snapshot) {
        let increments = &snapshot.increments;
        let blind = increments.blind > 0;
        let grounded = self.landing.is_landed() || (self.contact && !blind);
        if grounded || !before.known.attitude || increments.duration <= 0.0 {
            self.observer.reset();
            return;
        }
        if blind {
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

    /// Writes what follows from the state after the step.
    fn tell(&mut self, snapshot: &Snapshot, result: &mut OuterResult) {
        let step = self.modes.last();
        let estimate = self.estimation.estimate();
        result.attitude = estimate.attitude;
        result.gyro_bias = estimate.gyro_bias;
        result.landed = self.landing.is_landed() || self.contact;
        result.motor_gain = self.parameters.motor.gain(self.battery.voltage());
        let report = &mut result.report;
        report.phase = self.supervisor.phase();
        report.mode = self.supervisor.mode();
        report.failsafe = self.supervisor.acting();
        report.active = Watch::with_stop(self.watch.active(), snapshot.stopped);
        report.blockers = self.blockers;
        report.estimate = *estimate;
        report.origin = self.estimation.frame().map(LocalFrame::origin);
        report.home = self.home;
        report.sensors = *self.estimation.sensors();
        report.handover = *self.estimation.handover();
        report.trajectory = match step.demand {
            Demand::Follow(point) => Some(point),
            _ => None,
        };
        report.leg_end = step.leg_end;
        report.mission = self.mission_report();
        report.battery = self.battery_report();
        report.disturbance = self.observer.disturbance(&self.parameters.observer);
        report.thrust_scale = self.thrust_scale.scale();
        result.parameters = None;
        if core::mem::take(&mut self.inner_changed) {
            result.parameters = Some(self.inner);
        }
    }

    fn mission_report(&self) -> MissionReport {
        let flown = self.modes.mission();
        MissionReport {
            count: self.plans.mission.map_or(0, |stored| stored.count),
            current: flown.map_or(self.modes.first_item, |mission| mission.current_item()),
            begun: flown.is_some(),
        }
    }

    fn battery_report(&self) -> BatteryReport {
        let p = &self.parameters.battery;
        BatteryReport {
            voltage: self.battery.voltage(),
            current: self.battery.current(),
            remaining: self.battery.remaining(),
            drawn: self.battery.drawn(),
            charge: self.battery.charge(),
            arming_voltage: p.arming_voltage(),
        }
    }
}
