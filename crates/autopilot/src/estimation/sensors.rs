//! What the filter is given of each sensor, and when.

use windhover_estimator::doubt::{Doubt, Leaning};
use windhover_estimator::gate::Report;
use windhover_estimator::measurement::{BarometricHeight, MagneticField};
use windhover_estimator::{Accuracy, Filter, Health, InertialIncrements, Refusal, Sensor, Verdict};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{GRAVITY, Vector3, min, saturate, sqrt};

use super::force_watch::ForceWatch;
use super::heading_watch::HeadingWatch;
use super::interference::{Interference, load};
use super::{OuterConfig, Settings, is_still};
use crate::aiding::{BarometerSample, CompassFitting, CompassSample, GnssSample, PressureLevel};
use crate::calibration::compass::CompassCorrection;
use crate::declination;
use crate::inner::Snapshot;

/// How still a vehicle stands, m/s, and its gyro's mean over an interval, rad/s.
const REST: (f32, f32) = (0.05, 0.01);
/// How far the specific force is from gravity's in flight, m/s²: 2 m/s², and alike for seconds, so
/// that 25 in a row say no more than one. It counts only while no velocity is measured.
const FLIGHT_FORCE: f32 = 10.0;

/// Of a receiver's declared variance, the share that changes over minutes.
const SLOW_SHARE: f32 = 0.75;
/// What the rotors shake the accelerometer by, as a velocity of each axis that is none, m/s.
const SHAKING: f32 = 0.012;
/// How well accelerometer and gyro are aligned with each other and the vehicle, each axis, rad: no
/// flight at a constant heading tells it from a tilt.
const TILT_ERROR: f32 = 0.005;
/// What calibration has left of the compass, that flying does not take away, rad.
const HEADING_ERROR: f32 = 0.009;

/// When the velocity goes another way and the specific force has stepped: how far the filter may be
/// off then.
const WRONG_FORCE: Doubt = Doubt {
    tilt: 0.005,
    heading: 0.0,
    gyro_bias: [0.005, 0.005, 0.0],
    accel_bias: 0.5,
};
/// When it has not.
const WRONG_RATE: Doubt = Doubt {
    tilt: 0.02,
    heading: 0.0,
    gyro_bias: [DOUBT_GYRO, DOUBT_GYRO, 0.0],
    accel_bias: 0.1,
};
/// An episode of doubt lasts for so many fixes after its last lean.
const EPISODE: u8 = 50;
/// How far the gyro's bias may be off, rad/s.
const DOUBT_GYRO: f32 = 0.02;
/// And the heading, rad.
const DOUBT_HEADING: f32 = 0.05;
/// So often in a row; then one more in 50 fixes. A velocity that goes another way for longer is wrong
/// itself.
const DOUBTS: f32 = 4.0;
const DOUBTS_PER_FIX: f32 = 0.02;

/// A compass that has shown the same so often in a row hangs: its noise is one count.
const FROZEN_FIELD: u8 = 10;

/// A compass that has shown nothing for so long is silent, µs.
const COMPASS_SILENCE: u64 = 1_000_000;
/// A compass that was rejected so often in a row is wrong: a second at its rate.
const COMPASS_WRONG: u32 = 50;

/// A receiver that has said the same so often in a row hangs.
const HANGS: u8 = 1;

/// A receiver that declares less than this knows the height better than the barometer does, m.
const PRECISE_HEIGHT: f32 = 0.2;
/// The difference between both heights is followed with this time constant, s.
const HEIGHT_FOLLOWING: f32 = 20.0;
/// Standard deviation of the barometer while a precise receiver leads, m.
const LED_BAROMETER: f32 = 1.0;

/// A mean over the alignment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Mean {
    count: u16,
    mean: f32,
}

impl Mean {
    /// Adds a pressure, Pa; what is none is left out. After 1000 of them it follows the last ones.
    pub(super) fn add(&mut self, pressure: f32) {
        if PressureLevel::new(pressure).is_some() {
            self.count = (self.count + 1).min(1000);
            self.mean += (pressure - self.mean) / f32::from(self.count);
        }
    }
}

/// What lies between the sensors and the filter.
#[derive(Clone, Debug)]
pub(super) struct Aiding {
    pub(super) frame: Option<LocalFrame>,
    /// Bearing of magnetic north, east positive, rad, once it is known.
    declination: Option<f32>,
    /// The heading came from outside, so it counts from true north.
    is_north_true: bool,
    fitting: CompassFitting,
    level: Option<PressureLevel>,
    interference: Interference,
    /// When the last compass sample came, and when the last one that did not hang, µs.
    last_field: u64,
    live_field: Option<u64>,
    /// What it held, and how often in a row.
    last_counts: [i16; 3],
    same_field: u8,
    /// The receiver's height less the estimated one (down, m), while the barometer leads.
    height_offset: Option<f32>,
    /// Variance of the receiver's slow errors, which no filter can see, of each axis, m².
    receiver: f32,
    leaning: [Leaning; 3],
    force: ForceWatch,
    /// What is doubted, and for how many fixes more it is that.
    suspect: Doubt,
    episode: u8,
    heading: HeadingWatch,
    /// How often the inertial sensors were doubted, and how often they still may be.
    pub(super) doubts: u32,
    patience: f32,
    /// The receiver's last message, and how often in a row it has said the same.
    last_fix: GnssSample,
    same: u8,
}

impl Aiding {
    pub(super) fn new(config: &OuterConfig) -> Self {
        Self {
            frame: config.home.map(LocalFrame::new),
            declination: config.declination.or(config.home.map(declination)),
            is_north_true: false,
            fitting: config.compass,
            level: None,
            interference: Interference::default(),
            last_field: 0,
            live_field: None,
            last_counts: [0; 3],
            same_field: 0,
            height_offset: None,
            receiver: 0.0,
            leaning: [Leaning::default(); 3],
            force: ForceWatch::default(),
            suspect: WRONG_RATE,
            episode: 0,
            heading: HeadingWatch::default(),
            doubts: 0,
            patience: DOUBTS,
            last_fix: GnssSample::default(),
            same: 0,
        }
    }

    /// The alignment is done: heights count from the mean pressure, and the mean field (body, µT)
    /// is the Earth's.
    pub(super) fn begin(&mut self, filter: &mut Filter, pressure: &Mean, field: Option<Vector3>) {
        if let Some(level) = PressureLevel::new(pressure.mean) {
            self.level = Some(level);
            // The first height is 0 by definition, so it is known as well as the mean is.
            let _ = filter.refer_barometer(0.0, 0.05);
        }
        if let Some(field) = field {
            self.interference.refer(filter.state().attitude, field);
        }
    }

    /// Whether a compass that was heard of is silent, hangs, or says what cannot be.
    pub(super) fn is_compass_lost(&self, filter: &Filter) -> bool {
        let silent = |live| filter.time().saturating_sub(live) > COMPASS_SILENCE;
        self.live_field.is_some_and(silent) || filter.monitor(Sensor::Compass).consecutive >= COMPASS_WRONG
    }

    /// Whether there is an origin and a receiver that has said where the vehicle is.
    pub(super) fn has_place(&self) -> bool {
        self.frame.is_some() && self.receiver > 0.0
    }

    /// The filter's accuracy with what it cannot know of: the receiver's slow errors, and what
    /// calibration has left of the sensors' directions.
    pub(super) fn declared(&self, accuracy: Accuracy) -> Accuracy {
        let with = |known: f32, variance: f32| sqrt(known * known + variance);
        Accuracy {
            horizontal: with(accuracy.horizontal, 2.0 * SLOW_SHARE * self.receiver),
            velocity: with(accuracy.velocity, 3.0 * SHAKING * SHAKING),
            tilt: with(accuracy.tilt, 2.0 * TILT_ERROR * TILT_ERROR),
            heading: with(accuracy.heading, HEADING_ERROR * HEADING_ERROR),
            ..accuracy
        }
    }

    /// Somebody outside has said where north is.
    pub(super) fn trust_north(&mut self) {
        self.is_north_true = true;
    }

    /// The first fix is the origin, where there is none. The vehicle is `down` m below it. The
    /// declination, when that is known only now: until here magnetic north was taken for north.
    pub(super) fn find_origin(&mut self, sample: &GnssSample, down: f32) -> Option<f32> {
        if self.frame.is_some() || !sample.is_fix() {
            return None;
        }
        let above = saturate(down, 1e5) * 1e3;
        self.frame = Some(LocalFrame::new(GlobalPosition {
            altitude: sample.position.altitude.saturating_add(above as i32),
            ..sample.position
        }));
        if self.declination.is_some() {
            return None;
        }
        self.declination = Some(declination(sample.position));
        self.declination
    }

    /// The filter began with magnetic north for north: what it believes is turned to true north.
    #[cold]
    #[inline(never)]
    fn find_north(&mut self, filter: &mut Filter, declination: f32) {
        if !self.is_north_true && filter.turn(declination).is_ok() {
            self.interference.turn(declination);
        }
    }

    /// A compass sample as the filter takes it: µT in body axes.
    pub(super) fn field(&self, sample: &CompassSample, settings: &Settings<'_>) -> MagneticField {
        MagneticField {
            time: sample.time,
            field: CompassCorrection::new(settings.calibration).apply(self.fitting.field(sample.counts)),
            deviation: settings.estimation.compass_noise,
            repeats: 1.0,
            declination: self.declination.unwrap_or(0.0),
        }
    }

    /// Hands the filter what has come. What it makes of it is in its monitors.
    pub(super) fn take_in(&mut self, filter: &mut Filter, settings: &Settings<'_>, snapshot: &Snapshot) {
        let inputs = &snapshot.inputs;
        self.watch_force(settings, snapshot);
        for sample in &inputs.barometer {
            self.barometer(filter, settings, sample, snapshot.time);
        }
        if !inputs.compass.is_empty() {
            let load = load(
                snapshot.increments.thrust / snapshot.increments.duration,
                settings.weight,
            );
            for sample in &inputs.compass {
                self.compass(filter, settings, sample, snapshot.time, load);
            }
        }
        for sample in &inputs.gnss {
            let blind = snapshot.increments.blind > 0;
            self.gnss(filter, settings, sample, snapshot.time, blind);
        }
    }

    /// What the thrust does not explain of the specific force.
    fn watch_force(&mut self, settings: &Settings<'_>, snapshot: &Snapshot) {
        let increments = &snapshot.increments;
        if increments.duration > 0.0 {
            let per_second = 1.0 / increments.duration;
            let thrust = increments.thrust * per_second * (GRAVITY / settings.weight);
            let unexplained = increments.velocity * per_second + Vector3::new(0.0, 0.0, thrust);
            self.force.look(unexplained, increments.duration);
        }
    }

    fn barometer(
        &mut self,
        filter: &mut Filter,
        settings: &Settings<'_>,
        sample: &BarometerSample,
        now: u64,
    ) {
        if self.level.is_none() {
            self.level = PressureLevel::new(sample.pressure);
        }
        let Some(height) = self.level.and_then(|level| level.height(sample.pressure)) else {
            return;
        };
        let led = matches!(filter.health(Sensor::GnssHeight), Health::Good { .. });
        let measured = BarometricHeight {
            time: sample.time.min(now),
            height,
            deviation: if led {
                LED_BAROMETER
            } else {
                settings.estimation.barometer_noise
            },
        };
        let _ = filter.fuse_barometer(&measured);
    }

    fn compass(
        &mut self,
        filter: &mut Filter,
        settings: &Settings<'_>,
        sample: &CompassSample,
        now: u64,
        load: f32,
    ) {
        let elapsed = now.saturating_sub(self.last_field).min(1_000_000) as u32 as f32 * 1e-6;
        self.last_field = now;
        self.same_field = if sample.counts == self.last_counts {
            self.same_field.saturating_add(1)
        } else {
            0
        };
        self.last_counts = sample.counts;
        if self.same_field >= FROZEN_FIELD {
            return;
        }
        self.live_field = Some(now);
        let measured = self.field(sample, settings);
        let attitude = filter.state().attitude;
        let Some(field) = self.interference.correct(measured.field, attitude, load, elapsed) else {
            return;
        };
        let trust = self
            .heading
            .trust(settings.estimation.compass_correlation, elapsed);
        let outcome = filter.fuse_compass(&MagneticField {
            time: sample.time.min(now),
            field,
            repeats: trust.repeats,
            declination: measured.declination - trust.offset,
            ..measured
        });
        if let Ok(report) = &outcome
            && let [test] = &report.tests
            && report.verdict == Verdict::Accepted
            && self
                .heading
                .look(test.innovation + trust.offset, test.variance, elapsed)
        {
            self.doubts = self.doubts.saturating_add(1);
            filter.doubt(&Doubt {
                heading: DOUBT_HEADING,
                gyro_bias: [0.0, 0.0, DOUBT_GYRO],
                ..Doubt::default()
            });
        }
    }

    fn gnss(
        &mut self,
        filter: &mut Filter,
        settings: &Settings<'_>,
        sample: &GnssSample,
        now: u64,
        blind: bool,
    ) {
        if !sample.is_fix() || self.hangs(sample) {
            return;
        }
        if let Some(declination) = self.find_origin(sample, filter.state().position.z) {
            self.find_north(filter, declination);
        }
        let Some(frame) = &self.frame else {
            return;
        };
        let delay = (settings.estimation.gnss_delay * 1e6) as u64;
        let time = sample.time.min(now).saturating_sub(delay);
        let mut position = sample.position(frame, time);
        let outcome = filter.fuse_gnss_position(&position);
        if outcome.is_ok() {
            self.receiver = position.horizontal_deviation * position.horizontal_deviation;
        }
        let outcome = filter.fuse_gnss_velocity(&sample.velocity(time));
        if !blind {
            self.doubt(filter, &outcome);
        }

        let difference = position.position.z - filter.state().position.z;
        if position.vertical_deviation < PRECISE_HEIGHT {
            let _ = filter.fuse_gnss_height(&position);
        } else if matches!(filter.health(Sensor::Barometer), Health::Good { .. }) {
            // The barometer leads: what the receiver says differently is followed slowly, so that
            // it can take over without a step.
            let offset = self.height_offset.get_or_insert(difference);
            *offset += (difference - *offset) * (0.1 / HEIGHT_FOLLOWING);
        } else {
            position.position.z -= *self.height_offset.get_or_insert(difference);
            let _ = filter.fuse_gnss_height(&position);
        }
    }

    /// Whether a receiver says the same again and again: its noise alone would not let it.
    fn hangs(&mut self, sample: &GnssSample) -> bool {
        let is_same = sample.position == self.last_fix.position && sample.velocity == self.last_fix.velocity;
        self.same = if is_same { self.same.saturating_add(1) } else { 0 };
        self.last_fix = *sample;
        self.same >= HANGS
    }

    /// A velocity that goes another way than the inertial sensors say: they are wrong by more than
    /// the filter thinks.
    fn doubt(&mut self, filter: &mut Filter, outcome: &Result<Report<3>, Refusal>) {
        let Ok(report) = outcome else { return };
        let leans = report.tests.iter().zip(&mut self.leaning);
        let leans = leans.fold(false, |any, (test, leaning)| leaning.look(test) || any);
        if leans && self.patience >= 1.0 {
            self.patience -= 1.0;
            // What began is judged by its beginning: later the vehicle flies off and its drag changes.
            if self.episode == 0 {
                self.suspect = if self.force.has_stepped() {
                    WRONG_FORCE
                } else {
                    WRONG_RATE
                };
            }
            self.episode = EPISODE;
            filter.doubt(&self.suspect);
            self.doubts = self.doubts.saturating_add(1);
        }
        self.episode = self.episode.saturating_sub(1);
        self.patience = min(DOUBTS, self.patience + DOUBTS_PER_FIX);
    }

    /// On the ground: no velocity, no rate. In flight without a measured velocity: the specific
    /// force is gravity's on the average.
    pub(super) fn rest(&mut self, filter: &mut Filter, measured: &InertialIncrements, landed: bool) {
        if landed {
            if is_still(measured, filter.state().gyro_bias) {
                let _ = filter.fuse_rest(measured, REST.0, REST.1);
            }
            return;
        }
        let velocity_known = [Sensor::GnssVelocity, Sensor::Pose].into_iter().any(|sensor| {
            matches!(
                filter.health(sensor),
                Health::Good { .. } | Health::Degraded { .. }
            )
        });
        if !velocity_known {
            let _ = filter.fuse_gravity(measured, FLIGHT_FORCE);
        }
    }
}
