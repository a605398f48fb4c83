//! A whole mission: set up, flown to its end, summed up in figures.

use windhover_autopilot::blocker::Sentence;
use windhover_autopilot::fence::{self, Fence, FenceRefusal, Rally};
use windhover_autopilot::mission::nav::Chart;
use windhover_autopilot::mission::{MissionEvent, Refusal, check, route};
use windhover_autopilot::{
    Command, InnerConfig, InnerInput, MissionCommit, Mode, MotorCommand, Outer, OuterConfig, OuterReport,
    OuterResult, ParameterWrite, Parameters, Phase, Preset, Refused, Row, ScheduleRecord, Snapshot, Stop,
};
use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_model::{Conditions, Integrator, ModelKind, Truth, Vehicle, World};

use crate::beliefs::BeliefErrors;
use crate::closed_loop::{ClosedLoop, Disruption, Recorder};
use crate::figures::{Axes, ErrorSum, Figures, MotorHash, Photo, distance_to_polyline};
use crate::mission_file::{MissionFile, Place};
use crate::operator::Operator;
use crate::report::Event;
use crate::sensors::{EarthField, Sensing, Sensors, compass_fitting};

/// A vehicle that something keeps from starting for so long is not waited for, s.
const PATIENCE: f64 = 60.0;

/// A flight that has not come to its end by then is ended, s.
const TIME_LIMIT: f64 = 4.0 * 3600.0;

/// A vehicle whose motors were stopped in flight is on the ground after so long, s.
const FALL: f64 = 60.0;

/// A vehicle that has come down and lies on the ground for so long without disarming itself is not
/// waited for, s; more than `COM_DISARM_LAND` may be.
const UNNOTICED: f64 = 90.0;

/// Seconds between two positions that count for the cross-track error.
const SAMPLE_PERIOD: f64 = 0.02;

/// What is flown, by what, where.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The vehicle, its model and what its core is told.
    pub vehicle: Vehicle,
    /// Which position control.
    pub preset: Preset,
    /// Which equations of motion.
    pub model: ModelKind,
    /// How they are stepped.
    pub integrator: Integrator,
    /// Wind, pushes, payload, seed.
    pub conditions: Conditions,
    /// Samples of the IMU per second.
    pub imu_rate: u32,
    /// Late results and missing samples.
    pub disruption: Option<Disruption>,
    /// The sensors that it is flown on; without, the core is told the truth.
    pub sensors: Option<Sensors>,
    /// Writes to the parameter table in flight: when (s), and what.
    pub writes: Vec<(f64, ParameterWrite)>,
}

impl Setup {
    /// This vehicle in the reference conditions.
    pub fn reference(vehicle: Vehicle) -> Self {
        Self {
            vehicle,
            preset: Preset::Windhover,
            model: ModelKind::Rigid,
            integrator: Integrator::SemiImplicitEuler,
            conditions: Conditions::reference(),
            imu_rate: 1000,
            disruption: None,
            sensors: None,
            writes: Vec::new(),
        }
    }

    /// What the inner step is made with.
    pub fn inner_config(&self) -> InnerConfig {
        InnerConfig {
            imu_rate: self.imu_rate,
            rotation: Default::default(),
        }
    }

    /// The parameter table: defaults, preset, calibrations as of these sensors, vehicle file.
    pub fn parameters(&self) -> Result<Parameters, SetupError> {
        let mut parameters = Parameters::default();
        self.preset.apply(&mut parameters);
        // What the sensors are calibrated against is fitted at the factory, so to speak.
        let calibration = &mut parameters.calibration;
        (calibration.gyro_id, calibration.accel_id, calibration.compass_id) = (1.0, 1.0, 1.0);
        for (name, &value) in &self.vehicle.parameters {
            let refuse = |refusal| SetupError::Parameter {
                name: name.clone(),
                value,
                refusal,
            };
            let index = Parameters::find(name).ok_or(refuse(windhover_parameters::Refusal::Unknown))?;
            parameters.set(index, value as f32).map_err(refuse)?;
        }
        Ok(parameters)
    }

    /// What the outer step is made with, at a place. On sensors it finds out itself where it is.
    pub fn outer_config(&self, home: GlobalPosition) -> OuterConfig {
        let Some(sensors) = &self.sensors else {
            return OuterConfig {
                home: Some(home),
                ..OuterConfig::default()
            };
        };
        let exact = EarthField::at(home).map(|earth| earth.declination);
        OuterConfig {
            home: None,
            declination: exact.filter(|_| !sensors.own_declination),
            compass: compass_fitting(),
        }
    }

    /// The outer step as it is at the start.
    pub fn outer(&self, home: GlobalPosition) -> Result<Outer, SetupError> {
        Outer::new(self.parameters()?, &self.outer_config(home)).ok_or(SetupError::Vehicle)
    }

    /// The same loop with the sensors and the disruptions of this setup, at a place.
    pub fn equip(&self, mut flown: ClosedLoop, home: GlobalPosition) -> ClosedLoop {
        if let Some(sensors) = &self.sensors {
            let seed = self.conditions.seed;
            flown = flown.sensing(Sensing::new(sensors, &self.vehicle, home, self.imu_rate, seed));
        }
        match &self.disruption {
            Some(disruption) => flown.disrupted(disruption.clone()),
            None => flown,
        }
    }

    /// The world at the start.
    pub fn world(&self) -> World {
        World::new(&self.vehicle.plant, self.model, self.integrator, &self.conditions)
    }
}

/// What keeps a flight from starting.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A parameter of the vehicle file.
    #[error("[parameters], {name} = {value}: {refusal}")]
    Parameter {
        /// Its name.
        name: String,
        /// Its value in the file.
        value: f64,
        /// What is wrong.
        refusal: windhover_parameters::Refusal,
    },
    /// The parameters describe no vehicle that can fly.
    #[error("[parameters]: rotors in these places with these coefficients cannot hold the vehicle")]
    Vehicle,
    /// The mission is not one that is flown.
    #[error("{item}, {refusal}")]
    Mission {
        /// The item, as a person finds it.
        item: String,
        /// What is wrong.
        refusal: Refusal,
    },
    /// The fence or its rally points are none that are kept.
    #[error("{place}: {}", without_field(refusal))]
    Fence {
        /// Which polygon, circle or rally point, as a person finds it.
        place: String,
        /// What is wrong.
        refusal: FenceRefusal,
    },
}

/// What is wrong with a shape, less what is said already by naming it.
fn without_field(refusal: &FenceRefusal) -> String {
    let text = refusal.to_string();
    let fields = ["polygon: ", "circle: ", "fence: ", "rally point: "];
    let rest = fields.iter().find_map(|field| text.strip_prefix(field));
    rest.map_or(text.clone(), str::to_owned)
}

/// A flight that has been flown.
#[derive(Clone, Debug)]
pub struct Flight {
    /// Its figures; speed factor and log rate are left to whoever holds clock and log.
    pub figures: Figures,
    /// Simulated time, s.
    pub simulated: f64,
    /// True positions at 50 Hz, NED, m.
    pub positions: Vec<Vector3<f64>>,
    /// What happened besides what the core tells of in its log.
    pub events: Vec<Event>,
}

/// The home of a mission: what the file says, else the first place in it.
pub fn home(mission: &MissionFile) -> GlobalPosition {
    if let Some((latitude, longitude, altitude)) = mission.home {
        return GlobalPosition {
            latitude,
            longitude,
            altitude,
        };
    }
    let first = mission
        .items
        .iter()
        .find(|item| item.x != 0 && item.y != 0 && item.frame != 2);
    first.map_or(GlobalPosition::default(), |item| GlobalPosition {
        latitude: item.x,
        longitude: item.y,
        altitude: 0,
    })
}

/// Whether the core flies this mission, and its fence and rally points are such.
pub fn check_mission(mission: &MissionFile, parameters: &Parameters) -> Result<(), SetupError> {
    let (stored, home) = (mission.stored(), home(mission));
    let (source, frame) = (stored.plans(), LocalFrame::new(home));
    let refused = |(index, refusal)| SetupError::Mission {
        item: mission.describe(usize::from(index)),
        refusal,
    };
    let plan = route::Stored {
        slot: 0,
        count: stored.mission.len() as u16,
    };
    check(&source, plan, Some(home), &parameters.mission).map_err(refused)?;
    let of_fence = |(index, refusal)| SetupError::Fence {
        place: mission.describe_fence(usize::from(index)),
        refusal,
    };
    let of_rally = |(index, refusal)| SetupError::Fence {
        place: Place::Rally(usize::from(index) + 1).to_string(),
        refusal,
    };
    let fence = Fence::compile(&source, 0, stored.fence.len() as u16, &frame).map_err(of_fence)?;
    let rally = Rally::compile(&source, 0, stored.rally.len() as u16, &frame).map_err(of_rally)?;
    let chart = Chart {
        source: &source,
        stored: plan,
        frame: &frame,
        home: Vector3::zeros(),
        parameters: &parameters.mission,
    };
    fence::check_mission(&chart, &fence, &rally, &parameters.fence).map_err(refused)
}

/// A mission about to be flown.
pub fn closed_loop(setup: &Setup, mission: &MissionFile) -> Result<ClosedLoop, SetupError> {
    let outer = setup.outer(home(mission))?;
    check_mission(mission, outer.parameters())?;
    let home = home(mission);
    let stored = mission.stored();
    let flown = ClosedLoop::new(setup.world(), setup.inner_config(), outer, &stored, home);
    Ok(setup.equip(flown, home))
}

/// Flies a mission to its end. `progress` is told the share of the mission that is done, and
/// `recorder` sees everything.
pub fn fly<R: Recorder>(
    setup: &Setup,
    mission: &MissionFile,
    recorder: &mut R,
    progress: &mut dyn FnMut(f64),
) -> Result<Flight, SetupError> {
    let mut flown = ready(setup, mission)?;
    let mut operator = Operator::new(setup.sensors.is_some(), &mission.items);
    let mut watch = Watch::new(mission.items.len(), setup, home(mission));
    let rate = f64::from(setup.imu_rate);
    let mut writes = setup.writes.iter().peekable();
    let mut tick = 0u64;
    let ended = loop {
        let time = tick as f64 / rate;
        while let Some((_, write)) = writes.next_if(|(at, _)| *at <= time) {
            flown.mailboxes.queues.parameter.push(*write);
        }
        operator.step(&mut flown, time);
        flown.tick(&mut (&mut watch, &mut *recorder));
        tick += 1;
        if tick.is_multiple_of(u64::from(setup.imu_rate)) {
            progress(watch.progress());
        }
        if let Some(ended) = end(&flown.world, &watch, time) {
            break ended;
        }
    };
    Ok(watch.finish(ended, &flown.world, setup))
}

/// A vehicle whose plans are committed with the first tick: whoever gives commands may begin.
pub fn ready(setup: &Setup, mission: &MissionFile) -> Result<ClosedLoop, SetupError> {
    let mut flown = closed_loop(setup, mission)?;
    for (kind, items) in mission.stored().each() {
        if !items.is_empty() {
            let commit = MissionCommit {
                slot: 0,
                count: items.len() as u16,
                crc: windhover_flight_log::mission_crc(items.iter().copied()),
            };
            flown.mailboxes.queues.command.push(Command::Commit(kind, commit));
        }
    }
    Ok(flown)
}

/// A vehicle that is told the truth, armed and about to fly its mission from the ground: for
/// whoever wants to fly without an operator.
pub fn under_way(setup: &Setup, mission: &MissionFile) -> Result<ClosedLoop, SetupError> {
    let mut flown = ready(setup, mission)?;
    let period = setup.inner_config().k();
    // The plans are taken in before the mission is chosen.
    for commands in [&[][..], &[Command::Fly(Mode::Mission), Command::Arm][..]] {
        for command in commands {
            flown.mailboxes.queues.command.push(*command);
        }
        for _ in 0..2 * period {
            flown.tick(&mut ());
        }
    }
    Ok(flown)
}

/// Whether the mission was flown to its end, and how it ended.
fn end(world: &World, watch: &Watch, time: f64) -> Option<(bool, String)> {
    let falls = watch.disarmed.filter(|disarmed| disarmed.in_flight);
    if let Some(crash) = world.crash() {
        let cause = falls.map(|disarmed| disarmed.text() + ", ");
        Some((false, cause.unwrap_or_default() + &crash.to_string()))
    } else if let Some(divergence) = world.diverged() {
        Some((false, divergence.to_string()))
    } else if let Some(refused) = &watch.refused {
        Some((false, format!("refused at {time:.3} s: {refused}")))
    } else if falls.is_some_and(|disarmed| time < disarmed.time + FALL) {
        None
    } else if let Some(disarmed) = watch.disarmed {
        let text = match disarmed.why() {
            _ if watch.finished && !disarmed.in_flight => format!("mission completed, landed at {time:.1} s"),
            _ if disarmed.in_flight => disarmed.text(),
            Some(why) => format!("disarmed at {time:.1} s: {why}"),
            None if watch.was_airborne => format!("landed at {time:.1} s before the mission was completed"),
            None => format!("given up at {time:.1} s: the vehicle is too heavy to leave the ground"),
        };
        Some((watch.finished && !disarmed.in_flight, text))
    } else if !watch.has_started() && time >= PATIENCE {
        Some((false, format!("given up at {time:.1} s: {}", watch.blocked)))
    } else if watch
        .on_ground_since
        .is_some_and(|since| time > since + UNNOTICED)
    {
        let text =
            format!("given up at {time:.1} s: on the ground for {UNNOTICED} s without disarming itself");
        Some((false, text))
    } else if time >= TIME_LIMIT {
        Some((false, format!("given up after {:.0} hours", TIME_LIMIT / 3600.0)))
    } else {
        None
    }
}

/// What speaks against arming, in words.
fn blockers(report: &OuterReport) -> String {
    let sentence = |blocker| Sentence { blocker, report }.to_string();
    let words: Vec<String> = report.blockers.iter().map(sentence).collect();
    if words.is_empty() {
        return "the vehicle does not know where it is".into();
    }
    words.join("; ")
}

/// The end of a flight.
#[derive(Clone, Copy)]
struct Disarmed {
    time: f64,
    /// Which failsafe acted.
    failsafe: Option<Row>,
    /// In flight: the vehicle falls.
    in_flight: bool,
    /// The inner step had stopped the motors by itself.
    imu_missing: bool,
}

impl Disarmed {
    /// Why, in words, if it was not the usual end.
    fn why(&self) -> Option<&'static str> {
        let missing = self.imu_missing.then_some(Row::ImuMissing);
        let row = self.failsafe.or(missing);
        row.map(|row| row.watched().text)
    }

    /// What it is in flight.
    fn text(&self) -> String {
        let why = self.why().map(|why| format!(" ({why})"));
        format!(
            "motors off in flight at {:.1} s{}",
            self.time,
            why.unwrap_or_default()
        )
    }
}

/// Sums a flight up while it is flown.
struct Watch {
    beliefs: BeliefErrors,
    items: usize,
    item: usize,
    hash: MotorHash,
    /// The vehicle has been armed and is not any more.
    disarmed: Option<Disarmed>,
    /// What speaks against arming a vehicle that is not waited for much longer.
    blocked: String,
    was_armed: bool,
    was_airborne: bool,
    /// Since when a vehicle that has flown is at rest on the ground, s.
    on_ground_since: Option<f64>,
    phase: Phase,
    started: Option<f64>,
    finished: bool,
    refused: Option<String>,
    errors: ErrorSum,
    reached: usize,
    photos: Vec<Photo>,
    events: Vec<Event>,
    path: Vec<Vector3<f64>>,
    positions: Vec<Vector3<f64>>,
    next_sample: f64,
    cos_tilt_min: f64,
    ticks: u64,
    saturated: u64,
    time: f64,
}

impl Recorder for Watch {
    #[inline]
    fn tick(&mut self, _: &Truth, _: &InnerInput, motors: MotorCommand, _: Option<ScheduleRecord>) {
        self.hash.add(motors);
    }

    fn outer(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        self.time = truth.time;
        for refused in &result.report.refusals {
            self.refuse(refused);
        }
        self.follow_phase(truth, snapshot, result);
        if !self.has_started() && truth.time > PATIENCE - 0.1 {
            self.blocked = blockers(&result.report);
        }
        self.beliefs.look(truth, snapshot, result);
        for event in &result.report.events {
            let wanted = result
                .report
                .trajectory
                .map_or(truth.position, |point| point.position.map(f64::from));
            self.event(event, truth, wanted);
        }
        // On the ground the setpoint goes on down.
        let Some(setpoint) = result
            .report
            .trajectory
            .filter(|_| !result.landed || !self.was_airborne)
        else {
            return;
        };
        self.beliefs.add(truth, result);
        let wanted = setpoint.position.map(f64::from);
        if self.started.is_none() {
            self.started = Some(truth.time);
            self.path.push(truth.position);
        }
        self.ticks += u64::from(snapshot.increments.ticks);
        self.saturated += u64::from(snapshot.increments.saturated);
        self.errors.add(truth.position - wanted);
        self.cos_tilt_min = windhover_math::min(self.cos_tilt_min, truth.attitude.cos_tilt());
        self.follow(result.report.leg_end);
        if truth.time >= self.next_sample {
            self.next_sample = truth.time + SAMPLE_PERIOD - 1e-6;
            self.positions.push(truth.position);
        }
    }
}

impl Watch {
    fn new(items: usize, setup: &Setup, home: GlobalPosition) -> Self {
        Self {
            beliefs: BeliefErrors::new(setup, home),
            items,
            item: 0,
            hash: MotorHash::default(),
            disarmed: None,
            blocked: String::new(),
            was_armed: false,
            was_airborne: false,
            on_ground_since: None,
            phase: Phase::default(),
            started: None,
            finished: false,
            refused: None,
            errors: ErrorSum::default(),
            reached: 0,
            photos: Vec::new(),
            events: Vec::new(),
            path: Vec::new(),
            positions: Vec::new(),
            next_sample: 0.0,
            cos_tilt_min: 1.0,
            ticks: 0,
            saturated: 0,
            time: 0.0,
        }
    }

    fn has_started(&self) -> bool {
        self.started.is_some()
    }

    /// Notes whether it flies, and the end of the flight.
    fn follow_phase(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        let report = &result.report;
        let phase = report.phase;
        let before = core::mem::replace(&mut self.phase, phase);
        self.was_airborne |= phase == Phase::Flying;
        let rests = truth.position.z > -0.05 && Axes::from(truth.velocity).length() < 0.05;
        if !self.was_airborne || !rests {
            self.on_ground_since = None;
        } else {
            self.on_ground_since.get_or_insert(truth.time);
        }
        if phase == Phase::Disarmed {
            if self.was_armed && self.disarmed.is_none() {
                self.disarmed = Some(Disarmed {
                    time: truth.time,
                    failsafe: report.failsafe,
                    in_flight: before == Phase::Flying,
                    imu_missing: snapshot.stopped == Some(Stop::ImuMissing),
                });
            }
        } else {
            self.was_armed = true;
        }
    }

    fn progress(&self) -> f64 {
        self.item as f64 / self.items.max(1) as f64
    }

    fn refuse(&mut self, refused: &Refused) {
        match refused {
            Refused::Command(command, why) => self.refused = Some(format!("{command:?}: {why}")),
            Refused::Parameter(write, refusal) => {
                let declaration = Parameters::declaration(usize::from(write.index));
                let name = declaration.map_or("parameter", |declaration| declaration.name);
                self.events.push(Event {
                    time: self.time as f32,
                    text: format!("{name} = {} refused: {refusal}", write.value),
                });
            }
        }
    }

    /// A new leg is a new corner of the path.
    fn follow(&mut self, leg_end: Option<Vector3>) {
        let Some(corner) = leg_end.map(|corner| corner.map(f64::from)) else {
            return;
        };
        if self.path.last() != Some(&corner) {
            self.path.push(corner);
        }
    }

    fn event(&mut self, event: &MissionEvent, truth: &Truth, wanted: Vector3<f64>) {
        match *event {
            MissionEvent::Reached(item) => {
                self.reached += 1;
                self.item = usize::from(item) + 1;
            }
            MissionEvent::Missed(_) | MissionEvent::Landed => {}
            MissionEvent::Photo {
                item,
                target,
                settled,
            } => self.photo(usize::from(item) + 1, target, settled, truth, wanted),
            MissionEvent::Finished => {
                self.finished = true;
                self.item = self.items;
            }
        }
    }

    fn note(&mut self, truth: &Truth, text: String) {
        self.events.push(Event {
            time: truth.time as f32,
            text,
        });
    }

    fn photo(
        &mut self,
        item: usize,
        target: Option<Vector3>,
        settled: bool,
        truth: &Truth,
        wanted: Vector3<f64>,
    ) {
        let point = target.map_or(wanted, |target| target.map(f64::from));
        let photo = Photo {
            item,
            time_s: truth.time,
            stop: target.is_some(),
            settled,
            position_error_m: Axes::from(truth.position - point).length(),
            speed_m_s: Axes::from(truth.velocity).length(),
            tilt_deg: libm::acos(truth.attitude.cos_tilt().clamp(-1.0, 1.0)).to_degrees(),
        };
        self.photos.push(photo);
        self.item = item;
    }

    fn finish(mut self, (completed, ended): (bool, String), world: &World, setup: &Setup) -> Flight {
        let truth = world.truth();
        if self.disarmed.is_none_or(|disarmed| disarmed.in_flight) {
            self.note(&truth, ended.clone());
        }
        let pushes = setup.conditions.pushes.iter();
        for push in pushes.filter(|push| push.start < truth.time) {
            let force = [push.force.x, push.force.y, push.force.z];
            let parts = force.iter().zip(["north", "east", "down"]);
            let parts: Vec<String> = parts
                .filter(|(part, _)| **part != 0.0)
                .map(|(part, axis)| format!("{part} N {axis}"))
                .collect();
            let text = format!("push of {} for {} s", parts.join(", "), push.duration);
            self.events.push(Event {
                time: push.start as f32,
                text,
            });
        }
        let faults = setup.sensors.iter().flat_map(|sensors| &sensors.faults);
        for fault in faults.filter(|fault| fault.start < truth.time) {
            let span = if fault.duration.is_finite() {
                format!("for {} s", fault.duration)
            } else {
                "from here on".into()
            };
            self.events.push(Event {
                time: fault.start as f32,
                text: format!("fault {} {span}: {}", fault.name(), fault.text()),
            });
        }
        self.events.sort_by(|a, b| a.time.total_cmp(&b.time));
        let figures = Figures {
            completed,
            ended,
            duration_s: truth.time - self.started.unwrap_or(truth.time),
            waypoints_reached: self.reached,
            photos: self.photos,
            rmse_m: self.errors.rms(),
            max_error_m: self.errors.largest(),
            gnss_rmse_m: self.beliefs.gnss.rms_of_any(),
            estimate_rmse_m: self.beliefs.estimate.rms_of_any(),
            attitude_rmse_deg: self.beliefs.tilt.rms_of_any().map(f64::to_degrees),
            heading_rmse_deg: self.beliefs.heading.rms_of_any().map(f64::to_degrees),
            cross_track_rmse_m: cross_track(&self.positions, &self.path),
            tilt_max_deg: libm::acos(self.cos_tilt_min.clamp(-1.0, 1.0)).to_degrees(),
            saturated_fraction: self.saturated as f64 / self.ticks.max(1) as f64,
            energy_j: truth.energy,
            speed_factor: 0.0,
            log_bytes_per_s: 0.0,
            motor_hash: self.hash.to_string(),
            seed: setup.conditions.seed,
        };
        Flight {
            figures,
            simulated: truth.time,
            positions: self.positions,
            events: self.events,
        }
    }
}

fn cross_track(positions: &[Vector3<f64>], path: &[Vector3<f64>]) -> f64 {
    let squares = positions
        .iter()
        .map(|position| distance_to_polyline(*position, path))
        .map(|d| d * d);
    // A sum of nothing is -0.
    ((squares.sum::<f64>() + 0.0) / positions.len().max(1) as f64).sqrt()
}
