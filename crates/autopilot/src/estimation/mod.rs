//! What is believed of the vehicle: from its own sensors, or from somebody outside.
//!
//! At rest an [`Alignment`] finds the first attitude; from then on the filter of
//! [`windhover_estimator`] takes in what the sensors say. An [`ExternalEstimate`] takes the place
//! of all that while it comes: a model's truth, or motion capture. Between two of its words the
//! inertial increments carry it on; when it falls silent the filter begins where it left off.
//!
//! - [`handover`]: steps of the estimate, kept away from the controllers.
//! - `heading_watch`: how far a compass is trusted. `force_watch`: whether the accelerometer steps.
//! - `sensors`: what the filter is given.
//! - [`interference`]: what the motors' current does to the compass.

mod force_watch;
pub mod handover;
mod heading_watch;
pub mod interference;
mod sensors;

use windhover_estimator::alignment::{Progress, Stillness};
use windhover_estimator::health::SENSORS;
use windhover_estimator::start::{Deviations, Start};
use windhover_estimator::{
    Accuracy, Alignment, Filter, Health, InertialIncrements, NoiseParameters, Sensor, State,
};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{GRAVITY, Quaternion, Vector3, scalar};
use windhover_parameters::parameters;

use crate::aiding::CompassFitting;
use crate::inner::Snapshot;
use crate::io::Increments;
use crate::parameters::Parameters;
use crate::queue::ExternalEstimate;
use crate::sensing::CalibrationParameters;

use handover::Handover;
use sensors::{Aiding, Mean};

parameters! {
    /// How the sensors are taken in; the inertial sensors' noise is in `NoiseParameters`.
    pub struct EstimationParameters {
        gnss_delay: "EST_GNSS_DELAY", "s", 0.0..=0.3, 0.12, "Time from the moment that the receiver's message describes to its arrival";
        barometer_noise: "EST_BARO_NOISE", "m", 0.05..=10.0, 0.4, "Standard deviation of the barometer's height, gusts included";
        compass_noise: "EST_MAG_NOISE", "uT", 0.1..=50.0, 1.0, "Standard deviation of each component of the field, calibration errors included";
        compass_correlation: "EST_MAG_TAU", "s", 0.0..=600.0, 20.0, "Time over which the compass errs alike";
        position_error_max: "EST_POS_ERR_MAX", "m", 1.0..=200.0, 30.0, "Declared horizontal error from which the position counts as unknown";
    }
}

/// Without word from outside for so long, it is not relied on, µs.
const EXTERNAL_TIMEOUT: u32 = 500_000;

/// So long after standing still the alignment waits for a compass, s. Without one the vehicle
/// flies by attitude alone.
const COMPASS_PATIENCE: f32 = 3.0;

/// Standard deviation of the height at which the vehicle stands, which is 0 by definition, m.
const START_HEIGHT: f32 = 0.1;
/// Of where it stands, before the first fix, m.
const START_PLACE: f32 = 100.0;

/// A heading that may be wrong by so much serves no position control, rad.
const HEADING_ERROR_MAX: f32 = 0.5;
/// A tilt that may be wrong by so much serves no flight, rad.
const TILT_ERROR_MAX: f32 = 0.25;

/// Standing still is taken in, and the sensors are reported on, every so many steps: 10 times a
/// second.
const SLOW: u8 = 25;

/// The world's down axis, NED.
const DOWN: Vector3 = Vector3::new(0.0, 0.0, 1.0);

/// What is fixed when the core is made, beside the inner step's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OuterConfig {
    /// The origin of positions; without one the first fix sets it.
    pub home: Option<GlobalPosition>,
    /// Bearing of magnetic north, east positive, rad. Without one it is that of the origin by
    /// [`declination`](crate::declination()), and 0 while there is no origin.
    pub declination: Option<f32>,
    /// The compass.
    pub compass: CompassFitting,
}

/// What can be relied on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// Roll and pitch.
    pub attitude: bool,
    /// Heading.
    pub heading: bool,
    /// Height and climb.
    pub height: bool,
    /// Horizontal position and velocity.
    pub position: bool,
}

impl Known {
    const ALL: Self = Self {
        attitude: true,
        heading: true,
        height: true,
        position: true,
    };
}

/// What is believed of the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Position, NED, m from the origin.
    pub position: Vector3,
    /// Velocity, NED, m/s.
    pub velocity: Vector3,
    /// Attitude, body to world.
    pub attitude: Quaternion,
    /// What the gyro shows at rest, FRD, rad/s.
    pub gyro_bias: Vector3,
    /// What the accelerometer shows beside the specific force, FRD, m/s².
    pub accel_bias: Vector3,
    /// What of it can be relied on.
    pub known: Known,
    /// Standard deviations as declared; 0 for word from outside.
    pub accuracy: Accuracy,
}

/// How the sensors do, ten times a second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SensorReport {
    /// Of each [`Sensor`] in the order of its variants: 0 unseen, 1 good, 2 degraded, 3 lost.
    pub health: [u8; SENSORS],
    /// Measurements that the gates rejected, of all.
    pub rejected: u32,
    /// Measurements that were refused at the border, of all.
    pub refused: u32,
    /// How often the estimate was set to a measurement.
    pub resets: u32,
    /// How often the inertial sensors were doubted.
    pub doubts: u32,
}

impl SensorReport {
    fn new(filter: &Filter, doubts: u32) -> Self {
        let mut report = Self {
            doubts,
            ..Self::default()
        };
        for (sensor, code) in Sensor::ALL.into_iter().zip(&mut report.health) {
            let monitor = filter.monitor(sensor);
            report.rejected = report.rejected.saturating_add(monitor.rejected);
            report.refused = report.refused.saturating_add(monitor.refused);
            report.resets = report.resets.saturating_add(monitor.resets);
            *code = match filter.health(sensor) {
                Health::Unseen => 0,
                Health::Good { .. } => 1,
                Health::Degraded { .. } => 2,
                Health::Lost { .. } => 3,
            };
        }
        report
    }
}

/// Where the estimate comes from.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one, and no heap to put the filter on"
)]
enum Stage {
    /// From the sensors, of a vehicle that does not know its attitude yet.
    Aligning {
        alignment: Alignment,
        /// Time since it stands still without a compass, s.
        waiting: f32,
        pressure: Mean,
    },
    /// From the sensors.
    Running(Filter),
    /// From outside; how old the last word is, µs.
    External(u32),
}

impl Default for Stage {
    fn default() -> Self {
        Self::Aligning {
            alignment: Alignment::new(Stillness::default()),
            waiting: 0.0,
            pressure: Mean::default(),
        }
    }
}

/// The estimate with all that it follows from.
#[derive(Clone, Debug)]
pub struct Estimation {
    stage: Stage,
    estimate: Estimate,
    aiding: Aiding,
    handover: Handover,
    sensors: SensorReport,
    steps: u8,
}

/// The parameters that count here.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// How sensors are taken in.
    pub estimation: &'a EstimationParameters,
    /// The inertial sensors' noise.
    pub noise: &'a NoiseParameters,
    /// Offsets and scales of the sensors.
    pub calibration: &'a CalibrationParameters,
    /// Weight of the vehicle, N.
    pub weight: f32,
}

impl<'a> Settings<'a> {
    fn new(parameters: &'a Parameters) -> Self {
        Self {
            estimation: &parameters.estimation,
            noise: &parameters.noise,
            calibration: &parameters.calibration,
            weight: parameters.vehicle.mass * GRAVITY,
        }
    }
}

impl Estimation {
    /// Nothing known.
    pub fn new(config: &OuterConfig) -> Self {
        Self {
            stage: Stage::default(),
            estimate: Estimate::default(),
            aiding: Aiding::new(config),
            handover: Handover::default(),
            sensors: SensorReport::default(),
            steps: 0,
        }
    }

    /// How the sensors do.
    #[inline]
    pub fn sensors(&self) -> &SensorReport {
        &self.sensors
    }

    /// What is believed at the last snapshot.
    #[inline]
    pub fn estimate(&self) -> &Estimate {
        &self.estimate
    }

    /// The plane in which positions are counted, once there is an origin.
    #[inline]
    pub fn frame(&self) -> Option<&LocalFrame> {
        self.aiding.frame.as_ref()
    }

    /// What the setpoint is shifted by since the estimate made a step.
    #[inline]
    pub fn handover(&self) -> &Handover {
        &self.handover
    }

    /// The filter, while it runs.
    pub fn filter(&self) -> Option<&Filter> {
        match &self.stage {
            Stage::Running(filter) => Some(filter),
            _ => None,
        }
    }

    /// Time since the position or velocity was measured, s: 0 with word from outside, `None` while
    /// nothing has been measured.
    pub fn position_age(&self) -> Option<f32> {
        match &self.stage {
            Stage::Aligning { .. } => None,
            Stage::External(_) => Some(0.0),
            Stage::Running(filter) => {
                let age = |sensor| filter.monitor(sensor).age(filter.time());
                let ages = [Sensor::GnssPosition, Sensor::GnssVelocity, Sensor::Pose].map(age);
                let newest = ages.into_iter().flatten().min()?;
                Some(newest.min(1_000_000_000) as u32 as f32 * 1e-6)
            }
        }
    }

    /// Whether a compass that was heard of is not to be relied on.
    pub fn is_compass_lost(&self) -> bool {
        self.filter()
            .is_some_and(|filter| self.aiding.is_compass_lost(filter))
    }

    /// Whether a barometer that was heard of is not relied on any more.
    pub fn is_barometer_lost(&self) -> bool {
        let health = self.filter().map(|filter| filter.health(Sensor::Barometer));
        matches!(health, Some(Health::Lost { .. }))
    }

    /// Whether the filter runs on sensors, and this one has never been heard of.
    pub fn misses(&self, sensor: Sensor) -> bool {
        let health = self.filter().map(|filter| filter.health(sensor));
        matches!(health, Some(Health::Unseen))
    }

    /// Whether the vehicle flies on its own sensors.
    pub fn is_on_sensors(&self) -> bool {
        !matches!(self.stage, Stage::External(_))
    }

    /// Where the vehicle is, steps of the estimate are no more of a setpoint's concern.
    pub fn forget_steps(&mut self) {
        self.handover = Handover::default();
    }

    /// Takes in a snapshot, `dt` µs after the last one, of a vehicle that is `landed` or flies.
    #[inline]
    pub fn step(&mut self, parameters: &Parameters, snapshot: &Snapshot, dt: u32, landed: bool) {
        let newest = snapshot
            .inputs
            .external
            .iter()
            .rev()
            .find(|external| external.is_valid());
        if let Some(external) = newest {
            self.stage = Stage::External(0);
            self.believe(external);
            return;
        }
        if let Stage::External(age) = &mut self.stage {
            *age = age.saturating_add(dt);
            let known = *age < EXTERNAL_TIMEOUT;
            self.carry(&snapshot.increments);
            if known {
                return;
            }
            self.estimate.known = Known::default();
        }
        self.sense(parameters, snapshot, landed);
    }

    /// Word from outside is believed as it is.
    fn believe(&mut self, external: &ExternalEstimate) {
        self.estimate.position = external.position;
        self.estimate.velocity = external.velocity;
        self.estimate.attitude = external.attitude;
        self.estimate.gyro_bias = Vector3::zeros();
        self.estimate.accel_bias = Vector3::zeros();
        self.estimate.known = Known::ALL;
        self.estimate.accuracy = Accuracy::default();
    }

    /// Carries word from outside on by what the inertial sensors have measured since.
    #[inline]
    fn carry(&mut self, increments: &Increments) {
        let before = &self.estimate;
        let gained = before.attitude.rotate(increments.velocity) + DOWN * (GRAVITY * increments.duration);
        self.estimate = Estimate {
            position: before.position + (before.velocity + gained * 0.5) * increments.duration,
            velocity: before.velocity + gained,
            attitude: (before.attitude * increments.rotation).renormalized(),
            ..*before
        };
    }

    /// Takes in what the sensors say.
    #[inline(never)]
    fn sense(&mut self, parameters: &Parameters, snapshot: &Snapshot, landed: bool) {
        let settings = Settings::new(parameters);
        let measured = InertialIncrements::from(&snapshot.increments);
        match &mut self.stage {
            Stage::Aligning { .. } => self.align(&settings, snapshot, &measured),
            Stage::External(_) => self.take_over(&settings, snapshot.time),
            Stage::Running(filter) => {
                filter.trust_force(settings.noise, snapshot.increments.blind == 0);
                // An interval that is refused changes nothing: the next one carries on.
                let _ = filter.predict(&measured, snapshot.time);
                let reckoned = *filter.state();
                self.aiding.take_in(filter, &settings, snapshot);
                if self.steps == 0 {
                    self.aiding.rest(filter, &measured, landed);
                    self.sensors = SensorReport::new(filter, self.aiding.doubts);
                }
                self.steps = if self.steps < SLOW - 1 { self.steps + 1 } else { 0 };
                // Where forces are only reckoned, what the receiver corrects is how the vehicle moves.
                if !landed && snapshot.increments.blind == 0 {
                    self.handover.take_up(&reckoned, filter.state());
                }
                self.handover.decay(measured.duration);
                self.estimate = believed(filter, settings.estimation, &self.aiding);
            }
        }
    }

    /// Stands still, and learns how.
    fn align(&mut self, settings: &Settings<'_>, snapshot: &Snapshot, measured: &InertialIncrements) {
        self.carry(&snapshot.increments);
        let Stage::Aligning {
            alignment,
            waiting,
            pressure,
        } = &mut self.stage
        else {
            return;
        };
        for sample in &snapshot.inputs.gnss {
            if let Some(declination) = self.aiding.find_origin(sample, 0.0) {
                alignment.set_declination(declination);
            }
        }
        for sample in &snapshot.inputs.compass {
            alignment.take_in_field(&self.aiding.field(sample, settings));
        }
        for sample in &snapshot.inputs.barometer {
            pressure.add(sample.pressure);
        }
        let settled = match alignment.step(measured) {
            Progress::Settled => true,
            Progress::NoField => {
                *waiting += measured.duration;
                *waiting > COMPASS_PATIENCE
            }
            Progress::Restarted(_) => {
                (*waiting, *pressure) = (0.0, Mean::default());
                false
            }
            Progress::Collecting(_) => false,
        };
        if !settled {
            return;
        }
        let place = Vector3::new(START_PLACE, START_PLACE, START_HEIGHT);
        let Ok(mut filter) = alignment.finish(Vector3::zeros(), place, settings.noise, snapshot.time) else {
            return;
        };
        self.aiding.begin(&mut filter, pressure, alignment.field());
        self.stage = Stage::Running(filter);
    }

    /// Whoever was outside is silent: the filter begins where it left off.
    fn take_over(&mut self, settings: &Settings<'_>, time: u64) {
        let start = Start {
            state: State {
                position: self.estimate.position,
                velocity: self.estimate.velocity,
                attitude: self.estimate.attitude,
                ..State::default()
            },
            deviations: Deviations {
                position: Vector3::new(1.0, 1.0, 1.0),
                velocity: 0.5,
                tilt: 0.02,
                heading: 0.05,
                ..Deviations::default()
            },
        };
        if let Ok(filter) = Filter::new(&start, settings.noise, time) {
            self.aiding.trust_north();
            self.stage = Stage::Running(filter);
        }
    }
}

/// What the filter believes, and what of it can be relied on.
fn believed(filter: &Filter, parameters: &EstimationParameters, aiding: &Aiding) -> Estimate {
    let state = filter.state();
    let accuracy = aiding.declared(filter.accuracy());
    let attitude = accuracy.tilt < TILT_ERROR_MAX;
    let heading = attitude && accuracy.heading < HEADING_ERROR_MAX;
    Estimate {
        position: state.position,
        velocity: state.velocity,
        attitude: state.attitude,
        gyro_bias: state.gyro_bias,
        accel_bias: state.accel_bias,
        known: Known {
            attitude,
            heading,
            height: attitude
                && accuracy.vertical < parameters.position_error_max
                && is_height_measured(filter),
            position: heading && aiding.has_place() && accuracy.horizontal < parameters.position_error_max,
        },
        accuracy,
    }
}

/// Whether anything has measured the height lately: inertial sensors alone lose it within seconds.
fn is_height_measured(filter: &Filter) -> bool {
    /// µs.
    const LATELY: u64 = 5_000_000;
    [Sensor::Barometer, Sensor::GnssHeight, Sensor::Pose]
        .into_iter()
        .any(|sensor| {
            filter
                .monitor(sensor)
                .age(filter.time())
                .is_some_and(|age| age < LATELY)
        })
}

impl From<&Increments> for InertialIncrements {
    fn from(increments: &Increments) -> Self {
        Self {
            rotation: increments.rotation,
            gyro_bias: increments.gyro_bias,
            velocity: increments.velocity,
            duration: increments.duration,
        }
    }
}

/// Whether an interval is one of a vehicle that stands: it neither turns nor is pushed.
fn is_still(measured: &InertialIncrements, bias: Vector3) -> bool {
    /// rad/s.
    const TURNING: f32 = 0.05;
    /// m/s².
    const PUSHED: f32 = 0.5;
    let rate = measured.mean_rate() - bias;
    let force = scalar::norm(measured.velocity) / measured.duration;
    scalar::norm(rate) < TURNING && (force - GRAVITY).abs() < PUSHED
}
