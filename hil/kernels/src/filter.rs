//! The filter over a few seconds of a vehicle that turns and shakes, with all of its sensors at
//! their rates. What is counted of a measurement is all of it: border, look back, gate, update.

use core::hint::black_box;

use windhover_estimator::measurement::{BarometricHeight, GnssPosition, GnssVelocity, MagneticField};
use windhover_estimator::start::{Deviations, Start};
use windhover_estimator::{Filter, InertialIncrements, NoiseParameters, Refusal, Report, State, Verdict};
use windhover_math::{GRAVITY, Quaternion, Vector3, sin};

use crate::require;

/// Steps of the flight: 6 s, in which each state is held within its bounds 50 times.
const STEPS: u32 = 1500;
const INTERVAL: f32 = 0.004;
/// How old the receiver's word is, µs.
const DELAY: u64 = 120_000;

pub fn fly() {
    let start = Start {
        state: State::default(),
        deviations: Deviations::default(),
    };
    let Ok(mut filter) = Filter::new(&start, &NoiseParameters::default(), 0) else {
        return require(false);
    };
    for step in 1..=STEPS {
        let time = u64::from(step) * 4000;
        let increments = increments(&filter, step);
        require(predict(&mut filter, black_box(&increments), time).is_ok());
        match step % 10 {
            1 | 6 => take_barometer(&mut filter, step, time),
            2 | 7 => take_compass(&mut filter, step, time),
            4 => require(is_accepted(&gravity(&mut filter, black_box(&increments)))),
            _ => {}
        }
        if step % 25 == 13 && time > 2 * DELAY {
            take_receiver(&mut filter, step, time - DELAY);
        }
    }
}

/// Something between −1 and 1.
fn wave(step: u32, rate: f32) -> f32 {
    sin(step as f32 * rate)
}

/// What the inertial sensors of such a vehicle show.
fn increments(filter: &Filter, step: u32) -> InertialIncrements {
    let turn = Vector3::new(wave(step, 0.05), wave(step, 0.03), 0.5) * (0.5 * INTERVAL);
    let shaking = Vector3::new(wave(step, 0.4), wave(step, 0.7), wave(step, 0.9));
    let up = Vector3::new(0.0, 0.0, -GRAVITY);
    let force = filter.state().attitude.inverse_rotate(up) + shaking * 0.5;
    InertialIncrements {
        rotation: Quaternion::from_small_rotation(turn),
        gyro_bias: filter.state().gyro_bias,
        velocity: force * INTERVAL,
        duration: INTERVAL,
    }
}

fn is_accepted<const N: usize>(report: &Result<Report<N>, Refusal>) -> bool {
    matches!(
        black_box(report),
        Ok(Report {
            verdict: Verdict::Accepted,
            ..
        })
    )
}

fn take_barometer(filter: &mut Filter, step: u32, time: u64) {
    let measured = BarometricHeight {
        time,
        height: 0.2 * wave(step, 2.1) - filter.state().position.z,
        deviation: 0.4,
    };
    require(is_accepted(&barometer(filter, black_box(&measured))));
}

fn take_compass(filter: &mut Filter, step: u32, time: u64) {
    let north = Vector3::new(20.0, wave(step, 1.7), 40.0);
    let measured = MagneticField {
        time,
        field: filter.state().attitude.inverse_rotate(north),
        deviation: 1.0,
        repeats: 20.0,
        declination: 0.05,
    };
    require(is_accepted(&compass(filter, black_box(&measured))));
}

fn take_receiver(filter: &mut Filter, step: u32, time: u64) {
    let wrong = Vector3::new(wave(step, 1.1), wave(step, 1.3), wave(step, 1.9));
    let position = GnssPosition {
        time,
        position: filter.state().position + wrong,
        horizontal_deviation: 1.0,
        vertical_deviation: 1.5,
    };
    let velocity = GnssVelocity {
        time,
        velocity: filter.state().velocity + wrong * 0.05,
        deviation: 0.1,
    };
    require(is_accepted(&gnss_position(filter, black_box(&position))));
    require(is_accepted(&gnss_height(filter, black_box(&position))));
    require(is_accepted(&gnss_velocity(filter, black_box(&velocity))));
}

#[inline(never)]
fn predict(filter: &mut Filter, increments: &InertialIncrements, time: u64) -> Result<(), Refusal> {
    filter.predict(increments, time)
}

#[inline(never)]
fn barometer(filter: &mut Filter, measured: &BarometricHeight) -> Result<Report<1>, Refusal> {
    filter.fuse_barometer(measured)
}

#[inline(never)]
fn compass(filter: &mut Filter, measured: &MagneticField) -> Result<Report<1>, Refusal> {
    filter.fuse_compass(measured)
}

#[inline(never)]
fn gravity(filter: &mut Filter, increments: &InertialIncrements) -> Result<Report<3>, Refusal> {
    filter.fuse_gravity(increments, 10.0)
}

#[inline(never)]
fn gnss_position(filter: &mut Filter, measured: &GnssPosition) -> Result<Report<2>, Refusal> {
    filter.fuse_gnss_position(measured)
}

#[inline(never)]
fn gnss_height(filter: &mut Filter, measured: &GnssPosition) -> Result<Report<1>, Refusal> {
    filter.fuse_gnss_height(measured)
}

#[inline(never)]
fn gnss_velocity(filter: &mut Filter, measured: &GnssVelocity) -> Result<Report<3>, Refusal> {
    filter.fuse_gnss_velocity(measured)
}
