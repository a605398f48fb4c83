//! Boards that lie askew in vehicles that stand level.

extern crate std;

use std::string::ToString;

use proptest::prelude::*;
use windhover_math::{Euler, Quaternion, Vector3};

use super::*;
use crate::calibration::Progress;
use crate::calibration::testing::{
    INTERVAL, Noise, any_duration, any_inertial, at_rest, within_declarations,
};

/// Runs to the end with a board of this attitude and what `spoil` does to its samples.
fn run(attitude: Euler, seed: u64, spoil: impl Fn(&mut Inertial, f32)) -> LevelProgress {
    let (mut machine, mut noise) = (LevelCalibrator::default(), Noise::new(seed));
    for step in 0..=(machine.limits.timeout / INTERVAL) as usize + 1 {
        let time = step as f32 * INTERVAL;
        let mut sample = at_rest(&mut noise, Quaternion::from_euler(attitude), time);
        spoil(&mut sample, time);
        match machine.step(&sample, INTERVAL) {
            Progress::Going { share, .. } => assert!((0.0..=1.0).contains(&share)),
            end => {
                let after = machine.step(&Inertial::default(), f32::NAN);
                assert_eq!(after, end, "an end stays");
                return end;
            }
        }
    }
    panic!("no end");
}

fn refused(progress: LevelProgress) -> LevelRefusal {
    match progress {
        Progress::Refused(reason) => {
            assert!(reason.to_string().len() > 20, "{reason}");
            reason
        }
        other => panic!("{other:?}"),
    }
}

/// If this failed, a vehicle would drift to one side by the difference: 0.005 rad is 0.3°. The mean of
/// 625 samples with 0.2 m/s² is known to 0.008 m/s², 0.8 mrad; five deviations are allowed.
#[test]
fn the_trim_is_the_attitude_of_the_board_whatever_the_heading() {
    let mut draw = Noise::new(1);
    for seed in 0..50 {
        let board = Euler {
            roll: draw.within(0.24),
            pitch: draw.within(0.24),
            yaw: draw.within(3.1),
        };
        let end = run(board, seed, |_, _| {});
        let Progress::Done(found) = end else {
            panic!("{board:?}: {end:?}");
        };
        assert!((found.roll - board.roll).abs() < 0.005, "{board:?} {found:?}");
        assert!((found.pitch - board.pitch).abs() < 0.005, "{board:?} {found:?}");
        let mut parameters = CalibrationParameters::default();
        found.write(&mut parameters);
        within_declarations(&parameters);
        assert_eq!(
            (parameters.level_roll, parameters.level_pitch),
            (found.roll, found.pitch)
        );
    }
}

/// If this failed, the documented use of the numbers would be wrong: with the board's attitude q and
/// the trim t, q · t⁻¹ must be a level attitude.
#[test]
fn taking_the_trim_off_the_boards_attitude_leaves_the_vehicle_level() {
    let board = Euler {
        roll: -0.2,
        pitch: 0.15,
        yaw: 2.0,
    };
    let Progress::Done(found) = run(board, 3, |_, _| {}) else {
        panic!("refused");
    };
    let trim = Quaternion::from_euler(Euler {
        roll: found.roll,
        pitch: found.pitch,
        yaw: 0.0,
    });
    let vehicle = Quaternion::from_euler(board) * trim.conjugate();
    assert!(vehicle.cos_tilt() > 0.999_97, "{vehicle:?}");
}

/// If this failed, a vehicle on a slope, or upside down, would learn to fly askew.
#[test]
fn a_place_that_is_not_level_is_refused() {
    for (roll, pitch) in [(0.3, 0.0), (0.0, -0.28), (3.1, 0.0), (0.0, 1.5)] {
        let attitude = Euler {
            roll,
            pitch,
            yaw: 0.0,
        };
        let reason = refused(run(attitude, 4, |_, _| {}));
        assert!(matches!(reason, LevelRefusal::Tilted { .. }), "{reason:?}");
    }
}

/// If this failed, an accelerometer that is not calibrated, or broken, would give a trim.
#[test]
fn a_force_that_is_not_gravity_is_refused() {
    let level = Euler {
        roll: 0.0,
        pitch: 0.0,
        yaw: 0.0,
    };
    let reason = refused(run(level, 5, |sample, _| sample.specific_force.z += 0.8));
    assert!(
        matches!(reason, LevelRefusal::NoGravity(size) if (size - 9.0).abs() < 0.05),
        "{reason:?}"
    );
    let reason = refused(run(level, 5, |sample, _| {
        sample.specific_force = Vector3::zeros();
    }));
    assert_eq!(reason, LevelRefusal::NoGravity(0.0));
}

/// If this failed, a vehicle in a hand would be trimmed by the hand.
#[test]
fn motion_until_time_is_up_is_refused() {
    let level = Euler {
        roll: 0.0,
        pitch: 0.0,
        yaw: 0.0,
    };
    let sway = |time: f32| windhover_math::sin(windhover_math::wrap_pi(3.0 * time));
    let reason = refused(run(level, 6, |sample, time| {
        sample.specific_force.x += sway(time)
    }));
    assert_eq!(reason, LevelRefusal::NeverStill(Some(Disturbance::Pushed)));
    let reason = refused(run(level, 6, |sample, time| sample.rate.x += 0.2 * sway(time)));
    assert_eq!(reason, LevelRefusal::NeverStill(Some(Disturbance::Turned)));
    let mut hasty = LevelCalibrator::new(LevelLimits {
        timeout: f32::NAN,
        ..Default::default()
    });
    let reason = refused(hasty.step(&Inertial::default(), INTERVAL));
    assert_eq!(reason, LevelRefusal::NeverStill(None));
}

/// If this failed, NaN could reach the mean.
#[test]
fn samples_that_are_none_are_refused_at_once() {
    for (force, duration, bad) in [
        (f32::NAN, INTERVAL, BadSample::NotANumber),
        (1e9, INTERVAL, BadSample::TooLarge),
        (0.0, 1.0, BadSample::Duration),
    ] {
        let sample = Inertial {
            specific_force: Vector3::new(0.0, force, 0.0),
            rate: Vector3::zeros(),
        };
        let reason = refused(LevelCalibrator::default().step(&sample, duration));
        assert_eq!(reason, LevelRefusal::Sample(bad));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// If this failed, some input could keep the machine running, or give a trim out of range.
    #[test]
    fn it_ends_in_time_whatever_it_is_fed(
        inputs in prop::collection::vec((any_inertial(), any_duration()), 152),
        same in any::<bool>(),
    ) {
        let mut machine = LevelCalibrator::default();
        let mut last = None;
        for (sample, duration) in &inputs {
            let sample = if same { &inputs[0].0 } else { sample };
            last = Some(machine.step(sample, *duration));
        }
        match last {
            Some(Progress::Done(found)) => {
                prop_assert!(found.roll.abs() <= 0.26 && found.pitch.abs() <= 0.26);
            }
            Some(Progress::Refused(_)) => {}
            other => prop_assert!(false, "{other:?}"),
        }
    }
}
