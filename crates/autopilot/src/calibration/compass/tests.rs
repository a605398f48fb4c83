//! Compasses in vehicles with known iron, turned by hands.

extern crate std;

mod refusals;

use std::string::ToString;
use std::vec::Vec;

use windhover_math::scalar::norm;
use windhover_math::{Matrix3, Quaternion, max, min};

use super::*;
use crate::calibration::testing::{Noise, any_duration, any_number, within_declarations};
use crate::calibration::{BadSample, Progress};
use crate::sensing::CalibrationParameters;

/// Samples 50 times a second.
const INTERVAL: f32 = 0.02;

/// A compass with iron around it: raw = distortion · field + offset, with noise and outliers.
struct Compass {
    noise: Noise,
    /// NED, µT.
    field: Vector3,
    distortion: Matrix3,
    offset: Vector3,
    deviation: f32,
    outliers: f32,
}

impl Compass {
    /// Offsets up to 60 µT, scales ±20 %, cross terms up to 10 %, noise of 0.3 µT, 5 % outliers of up
    /// to 100 µT, and an inclination from 20° to 75° either way.
    fn random(seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let inclination =
            (47.5 + noise.within(27.5)).to_radians() * if noise.share() < 0.5 { -1.0 } else { 1.0 };
        let strength = 45.0 + noise.within(20.0);
        let (sin, cos) = windhover_math::sin_cos(inclination);
        let mut distortion = Matrix3::from_diagonal(&Vector3::from_fn(|_, _| 1.0 + noise.within(0.2)));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            distortion[(i, j)] = noise.within(0.1);
            distortion[(j, i)] = distortion[(i, j)];
        }
        Self {
            field: Vector3::new(cos, 0.0, sin) * strength,
            distortion,
            offset: Vector3::from_fn(|_, _| noise.within(60.0)),
            deviation: 0.3,
            outliers: 0.05,
            noise,
        }
    }

    fn sample(&mut self, attitude: Quaternion) -> Vector3 {
        let clean = self.distortion * attitude.inverse_rotate(self.field) + self.offset;
        let outlier = if self.noise.share() < self.outliers {
            self.noise.direction() * (100.0 * self.noise.share())
        } else {
            Vector3::zeros()
        };
        clean + self.noise.vector(self.deviation) + outlier
    }
}

/// Hands that put each side down in turn, turn the vehicle once around the vertical at their own
/// pace, wobble, and dwell.
struct Hands {
    noise: Noise,
    wobble: Vector3,
    heading: f32,
    time: f32,
}

impl Hands {
    fn new(seed: u64) -> Self {
        let mut noise = Noise::new(seed ^ 0xABCD);
        Self {
            heading: noise.within(3.0),
            wobble: Vector3::zeros(),
            time: 0.0,
            noise,
        }
    }

    /// The attitude a sample later. Each side takes ten seconds, the last three without a turn.
    fn turn(&mut self) -> Quaternion {
        self.time += INTERVAL;
        let within = self.time - 10.0 * (self.time / 10.0).floor();
        let pace = if within < 7.0 {
            1.0 + 0.4 * self.noise.normal(1.0)
        } else {
            0.0
        };
        self.heading = windhover_math::wrap_pi(self.heading + pace * INTERVAL);
        // A wobble of about 10°, over about a second.
        self.wobble += self.noise.vector(0.035) - self.wobble * INTERVAL;
        let quarter = core::f32::consts::FRAC_PI_2;
        let side = match (self.time / 10.0) as u32 % 6 {
            0 => Vector3::zeros(),
            1 => Vector3::x() * quarter,
            2 => Vector3::x() * -quarter,
            3 => Vector3::y() * quarter,
            4 => Vector3::y() * -quarter,
            _ => Vector3::x() * 2.0 * quarter,
        };
        Quaternion::from_heading(self.heading)
            * Quaternion::from_rotation_vector(self.wobble)
            * Quaternion::from_rotation_vector(side)
    }
}

/// Runs to the end with samples from `give`; with the time that it took, s.
fn run(limits: CompassLimits, mut give: impl FnMut(f32) -> Vector3) -> (CompassProgress, f32) {
    let mut machine = CompassCalibrator::new(limits);
    let steps = (limits.timeout / INTERVAL) as usize + usize::from(PASSES) + 3;
    for step in 0..steps {
        let time = step as f32 * INTERVAL;
        let progress = machine.step(give(time), INTERVAL);
        if let Progress::Going { share, .. } = progress {
            assert!((0.0..=1.0).contains(&share));
        } else {
            let again = machine.step(Vector3::zeros(), INTERVAL);
            assert_eq!(again, progress, "an end stays");
            return (progress, time);
        }
    }
    panic!("no end");
}

fn turned(seed: u64, mut compass: Compass, limits: CompassLimits) -> (CompassProgress, f32) {
    let mut hands = Hands::new(seed);
    run(limits, |_| compass.sample(hands.turn()))
}

fn refused(progress: CompassProgress) -> CompassRefusal {
    match progress {
        Progress::Refused(reason) => {
            assert!(reason.to_string().len() > 20, "{reason}");
            reason
        }
        other => panic!("{other:?}"),
    }
}

fn done(progress: CompassProgress) -> CompassCalibration {
    match progress {
        Progress::Done(found) => found,
        other => panic!("{other:?}"),
    }
}

/// Largest departure of the corrected field's length from its mean, as a share, over directions.
fn departure(compass: &Compass, correction: &CompassCorrection) -> f32 {
    let mut noise = Noise::new(99);
    let strength = norm(compass.field);
    let lengths: Vec<f32> = (0..500)
        .map(|_| compass.distortion * (noise.direction() * strength) + compass.offset)
        .map(|raw| norm(correction.apply(raw)))
        .collect();
    let least = lengths.iter().copied().fold(f32::INFINITY, min);
    let most = lengths.iter().copied().fold(0.0, max);
    (most - least) / (most + least)
}

/// If this failed, a compass calibrated by the book would show a wrong heading: 1 % of departure is
/// about 0.6°. Measured over these seeds: 0.17 µT and 0.66 %; over 3000 others
/// 0.24 µT and 0.81 %, none refused.
#[test]
fn random_iron_is_found_by_hands_that_turn_the_vehicle() {
    let (mut worst_offset, mut worst_departure) = (0.0, 0.0);
    for seed in 0..200 {
        let compass = Compass::random(seed);
        let clean = Compass::random(seed);
        let expected = Some(norm(compass.field));
        let limits = CompassLimits {
            expected,
            ..Default::default()
        };
        let found = done(turned(seed, compass, limits).0);
        worst_offset = max(norm(found.correction.offset - clean.offset), worst_offset);
        worst_departure = max(departure(&clean, &found.correction), worst_departure);
        assert!(found.residual < 0.02, "{seed}: {found:?}");
    }
    assert!(worst_offset < 0.3, "{worst_offset} µT");
    assert!(worst_departure < 0.01, "{worst_departure}");
}

/// If this failed, the fit would break down not far beyond what it is made for: three times as many
/// outliers may cost accuracy, not the result.
#[test]
fn three_times_as_many_outliers_are_borne() {
    for seed in 0..40 {
        let compass = Compass {
            outliers: 0.15,
            ..Compass::random(seed)
        };
        let clean = Compass::random(seed);
        let found = done(turned(seed, compass, CompassLimits::default()).0);
        let error = norm(found.correction.offset - clean.offset);
        let departure = departure(&clean, &found.correction);
        assert!(error < 0.6 && departure < 0.015, "{seed}: {error} {departure}");
    }
}

/// If this failed, rounding would limit the fit and not the noise: without noise it is exact to a few
/// parts in ten thousand, though the origin lies outside of the ellipsoid.
#[test]
fn without_noise_the_iron_is_found_exactly() {
    for seed in 0..40 {
        let compass = Compass {
            deviation: 0.0,
            outliers: 0.0,
            offset: Vector3::new(-60.0, 60.0, 60.0),
            ..Compass::random(seed)
        };
        let clean = Compass {
            offset: compass.offset,
            ..Compass::random(seed)
        };
        let found = done(turned(seed, compass, CompassLimits::default()).0);
        let error = norm(found.correction.offset - clean.offset);
        let departure = departure(&clean, &found.correction);
        assert!(error < 0.06 && departure < 0.002, "{seed}: {error} {departure}");
    }
}

/// If this failed, a calibration would be stored as something else than it was found, or be refused
/// by the parameter table.
#[test]
fn a_correction_comes_back_from_the_parameters() {
    for seed in 0..40 {
        let found = done(turned(seed, Compass::random(seed), CompassLimits::default()).0);
        let mut parameters = CalibrationParameters::default();
        found.write(&mut parameters);
        within_declarations(&parameters);
        assert_eq!(CompassCorrection::new(&parameters), found.correction);
        assert!((found.correction.soft.trace() - 3.0).abs() < 1e-5);
    }
    let nothing = CompassCorrection::new(&CalibrationParameters::default());
    let raw = Vector3::new(1.0, -2.0, 3.0);
    assert_eq!(nothing.apply(raw), raw);
}

/// If this failed, `corrected` would not be soft · (raw − offset).
#[test]
fn a_correction_takes_the_offset_off_first() {
    let correction = CompassCorrection {
        offset: Vector3::new(1.0, 2.0, 3.0),
        soft: Matrix3::new(1.0, 0.1, 0.2, 0.1, 1.5, 0.3, 0.2, 0.3, 0.5),
    };
    let corrected = correction.apply(Vector3::new(11.0, 2.0, 3.0));
    assert!(norm(corrected - Vector3::new(10.0, 1.0, 2.0)) < 1e-5);
}
