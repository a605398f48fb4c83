//! A matched world: a vehicle that flies turns, accelerations and hover, and sensors that are just
//! as noisy as the filter assumes.
//!
//! The truth is propagated in double precision by the very increments that the sensors measure,
//! before noise: there is no model error, so that whatever the filter is inconsistent by is its
//! own.

use std::collections::VecDeque;

use windhover_estimator::measurement::{BarometricHeight, GnssPosition, GnssVelocity, MagneticField};
use windhover_estimator::start::Deviations;
use windhover_estimator::{Filter, InertialIncrements, NoiseParameters, Start, State};
use windhover_math::{Quaternion, Vector3};

use crate::oracle::{GRAVITY, State64, narrow, narrow_rotation};
use crate::random::Random;

pub const STEP: u64 = 4000;
const DT: f64 = 0.004;

pub const GNSS_POSITION: Vector3<f64> = Vector3::new(0.5, 0.5, 1.0);
pub const GNSS_VELOCITY: f64 = 0.05;
pub const BAROMETER: f64 = 0.1;
/// Of a field of 20 µT horizontally and 40 µT down.
pub const COMPASS: f64 = 0.8;
pub const FIELD: Vector3<f64> = Vector3::new(20.0, 0.0, 40.0);

pub fn deviations() -> Deviations {
    Deviations {
        position: Vector3::new(1.0, 1.0, 0.3),
        velocity: 0.2,
        tilt: 0.01,
        heading: 0.1,
        gyro_bias: 2e-3,
        accel_bias: 0.05,
    }
}

/// What the vehicle does.
#[derive(Clone, Copy, PartialEq)]
pub enum Manoeuvre {
    /// Turns and accelerations at random.
    Lively,
    /// Stays where it is, but for small motions.
    Hover,
}

/// Truth, sensors and filter.
pub struct Flight {
    pub truth: State64,
    pub filter: Filter,
    pub time: u64,
    pub manoeuvre: Manoeuvre,
    /// How late the receiver is, µs.
    pub latency: u64,
    pub gnss: bool,
    random: Random,
    noise: NoiseParameters,
    force: Vector3<f64>,
    heading: f64,
    tilt: Vector3<f64>,
    fixes: VecDeque<(u64, GnssPosition, GnssVelocity)>,
}

impl Flight {
    pub fn new(seed: u64, manoeuvre: Manoeuvre, latency: u64) -> Self {
        let mut random = Random(seed.wrapping_mul(0x1234_5678_9ABC_DEF1));
        let noise = NoiseParameters::default();
        let d = deviations();
        let state = State64::from(&State {
            position: Vector3::new(3.0, -5.0, -20.0),
            ..State::default()
        });
        let mut errors = crate::dense::Column::zeros();
        let scale = [
            [d.position.x, d.position.y, d.position.z],
            [d.velocity; 3],
            [d.tilt, d.tilt, d.heading],
            [d.gyro_bias; 3],
            [d.accel_bias; 3],
        ];
        for i in 0..15 {
            errors[i] = f64::from(scale[i / 3][i % 3]) * random.normal();
        }
        let start = Start {
            state: State::from(&state),
            deviations: d,
        };
        let mut filter = Filter::new(&start, &noise, 1_000_000).unwrap();
        filter.refer_barometer(120.0, 0.0).unwrap();
        Self {
            truth: state.plus(&errors),
            filter,
            time: 1_000_000,
            manoeuvre,
            latency,
            gnss: true,
            random,
            noise,
            force: Vector3::zeros(),
            heading: 0.0,
            tilt: Vector3::zeros(),
            fixes: VecDeque::new(),
        }
    }

    /// Attitude and acceleration of the truth, as a quadcopter's go together.
    fn motion(&mut self) -> (Quaternion<f64>, Vector3<f64>) {
        let lively = if self.manoeuvre == Manoeuvre::Lively {
            1.0
        } else {
            0.05
        };
        self.tilt = self.tilt * 0.996 + self.random.normals() * (0.03 * lively);
        self.heading += DT * 0.3 * lively * libm::sin(self.time as f64 * 3e-7);
        // Back home by and by, and the velocity damped.
        let wanted = self.tilt * 3.0 - self.truth.velocity * 0.3 - self.truth.position * 0.02;
        let a = Vector3::new(wanted.x, wanted.y, 0.3 * wanted.z);
        let up = GRAVITY - a;
        let tilt = Vector3::new(-up.y, up.x, 0.0) / up.z;
        let level = Quaternion::from_rotation_vector(tilt);
        (level * Quaternion::from_heading(self.heading), a)
    }

    /// One interval: truth, increments with noise, prediction.
    pub fn step(&mut self) {
        let (wanted, acceleration) = self.motion();
        let turn = crate::oracle::logarithm(self.truth.attitude.conjugate() * wanted) * 0.05;
        let f = self.truth.attitude.inverse_rotate(acceleration - GRAVITY);
        self.force = f;
        let n = &self.noise;
        let root = libm::sqrt(DT);
        let d = |x: f32| f64::from(x);
        let rotation = Quaternion::from_rotation_vector(turn);
        let gyro = turn + self.truth.gyro_bias * DT + self.random.normals() * (d(n.gyro) * root);
        let accel = (f + self.truth.accel_bias) * DT + self.random.normals() * (d(n.accel) * root);
        let gained = self.truth.attitude.rotate(f * DT) + GRAVITY * DT;
        self.truth.position += (self.truth.velocity + gained * 0.5) * DT;
        self.truth.velocity += gained;
        self.truth.attitude = (self.truth.attitude * rotation).normalized();
        self.truth.gyro_bias += self.random.normals() * (d(n.gyro_walk) * root);
        self.truth.accel_bias += self.random.normals() * (d(n.accel_walk) * root);
        self.time += STEP;
        let taken = self.filter.state().gyro_bias;
        let own = gyro - taken.map(f64::from) * DT;
        let increments = InertialIncrements {
            rotation: narrow_rotation(Quaternion::from_rotation_vector(own)),
            gyro_bias: taken,
            velocity: narrow(accel),
            duration: DT as f32,
        };
        self.filter.predict(&increments, self.time).unwrap();
        self.sense();
    }

    /// Receiver at 5 Hz, barometer and compass at 25 Hz.
    fn sense(&mut self) {
        let n = self.time / STEP;
        if n.is_multiple_of(50) && self.gnss {
            let fix = self.fix();
            self.fixes.push_back(fix);
        }
        while let Some((due, position, velocity)) = self.fixes.front().copied() {
            if due > self.time {
                break;
            }
            self.fixes.pop_front();
            self.filter.fuse_gnss_position(&position).unwrap();
            self.filter.fuse_gnss_height(&position).unwrap();
            self.filter.fuse_gnss_velocity(&velocity).unwrap();
        }
        if n % 10 == 3 {
            let measured = self.barometer();
            self.filter.fuse_barometer(&measured).unwrap();
        }
        if n % 10 == 7 {
            let measured = self.compass();
            self.filter.fuse_compass(&measured).unwrap();
        }
    }

    fn fix(&mut self) -> (u64, GnssPosition, GnssVelocity) {
        let noise = self.random.normals().component_mul(&GNSS_POSITION);
        let position = GnssPosition {
            time: self.time,
            position: narrow(self.truth.position + noise),
            horizontal_deviation: GNSS_POSITION.x as f32,
            vertical_deviation: GNSS_POSITION.z as f32,
        };
        let velocity = GnssVelocity {
            time: self.time,
            velocity: narrow(self.truth.velocity + self.random.normals() * GNSS_VELOCITY),
            deviation: GNSS_VELOCITY as f32,
        };
        (self.time + self.latency, position, velocity)
    }

    pub fn barometer(&mut self) -> BarometricHeight {
        BarometricHeight {
            time: self.time,
            height: (120.0 - self.truth.position.z + BAROMETER * self.random.normal()) as f32,
            deviation: BAROMETER as f32,
        }
    }

    pub fn compass(&mut self) -> MagneticField {
        let field = self.truth.attitude.inverse_rotate(FIELD) + self.random.normals() * COMPASS;
        MagneticField {
            repeats: 1.0,
            time: self.time,
            field: narrow(field),
            deviation: COMPASS as f32,
            declination: 0.0,
        }
    }

    /// Errors of the filter.
    pub fn errors(&self) -> crate::dense::Column {
        self.truth.minus(&State64::from(self.filter.state()))
    }
}
