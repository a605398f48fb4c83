//! Gyros on stands, in hands and in drawers.

extern crate std;

use std::string::ToString;

use proptest::prelude::*;
use windhover_math::scalar::norm;
use windhover_math::{Quaternion, max};

use super::*;
use crate::calibration::Progress;
use crate::calibration::testing::{
    INTERVAL, Noise, any_duration, any_inertial, at_rest, within_declarations,
};

/// Runs to the end; with the time that it took, s, and the last disturbance.
fn run(mut give: impl FnMut(f32) -> Inertial) -> (GyroProgress, f32, Option<Disturbance>) {
    let mut machine = GyroCalibrator::default();
    let mut again = None;
    for step in 0..=(machine.limits.timeout / INTERVAL) as usize + 1 {
        let time = step as f32 * INTERVAL;
        match machine.step(&give(time), INTERVAL) {
            Progress::Going { share, instruction } => {
                assert!((0.0..=1.0).contains(&share));
                assert!(instruction.to_string().ends_with("still"));
                again = instruction.again;
            }
            end => {
                let after = machine.step(&Inertial::default(), f32::NAN);
                assert_eq!(after, end, "an end stays");
                return (end, time, again);
            }
        }
    }
    panic!("no end");
}

fn refused(progress: GyroProgress) -> GyroRefusal {
    match progress {
        Progress::Refused(reason) => {
            assert!(reason.to_string().len() > 20, "{reason}");
            reason
        }
        other => panic!("{other:?}"),
    }
}

/// If this failed, the gyro would start with a wrong rate. The mean of 625 samples with 0.01 rad/s has
/// a deviation of 0.0004 in each axis; the vibration averages out. Five deviations are allowed.
#[test]
fn the_offset_is_the_mean_rate_under_noise_and_vibration() {
    let mut worst = 0.0;
    for seed in 0..50 {
        let mut noise = Noise::new(seed);
        let offset = Vector3::from_fn(|_, _| noise.within(0.15));
        let attitude = Quaternion::from_rotation_vector(noise.vector(0.5));
        let (end, time, again) = run(|time| {
            let mut sample = at_rest(&mut noise, attitude, time);
            sample.rate += offset;
            sample
        });
        let Progress::Done(found) = end else {
            panic!("{end:?}");
        };
        worst = max(norm(found.offset - offset), worst);
        assert!((2.4..2.7).contains(&time) && again.is_none(), "{time}");
        let mut parameters = CalibrationParameters::default();
        found.write(&mut parameters);
        within_declarations(&parameters);
        assert_eq!(
            [parameters.gyro_x, parameters.gyro_y, parameters.gyro_z],
            <[f32; 3]>::from(found.offset)
        );
    }
    assert!(worst < 0.002, "{worst}");
}

/// If this failed, a vehicle that was touched would keep part of the touch as an offset.
#[test]
fn motion_starts_it_again_and_leaves_nothing() {
    for (push, turn, why) in [(3.0, 0.0, Disturbance::Pushed), (0.0, 0.3, Disturbance::Turned)] {
        let mut noise = Noise::new(4);
        let (end, time, again) = run(|time| {
            let mut sample = at_rest(&mut noise, Quaternion::from_heading(0.0), time);
            if (1.5..1.8).contains(&time) {
                sample.specific_force.x += push;
                sample.rate.z += turn;
            }
            sample
        });
        let Progress::Done(found) = end else {
            panic!("{end:?}");
        };
        assert!((4.2..4.6).contains(&time), "{time}");
        assert_eq!(again, Some(why));
        assert!(norm(found.offset) < 0.002, "{found:?}");
    }
}

/// If this failed, a vehicle that tilts steadily, in a hand or on a ship, would get its rate as an
/// offset: 0.1 rad/s is within what an offset may be, but gravity moves.
#[test]
fn a_steady_tilting_is_no_offset() {
    let mut noise = Noise::new(5);
    let (end, time, _) = run(|time| {
        let attitude = Quaternion::from_rotation_vector(Vector3::new(0.1 * time, 0.0, 0.0));
        let mut sample = at_rest(&mut noise, attitude, time);
        sample.rate.x += 0.1;
        sample
    });
    assert_eq!(refused(end), GyroRefusal::NeverStill(Some(Disturbance::Pushed)));
    assert!((29.9..30.1).contains(&time), "{time}");
}

/// If this failed, motion could hold it up for ever, or be taken for rest.
#[test]
fn what_never_rests_is_refused_when_time_is_up() {
    let mut noise = Noise::new(6);
    let (end, ..) = run(|_| Inertial {
        specific_force: noise.vector(10.0),
        rate: noise.vector(3.0),
    });
    assert_eq!(refused(end), GyroRefusal::NeverStill(Some(Disturbance::Turned)));
    let mut hasty = GyroCalibrator::new(GyroLimits {
        timeout: 0.1,
        ..Default::default()
    });
    let still = Inertial::default();
    assert!(matches!(hasty.step(&still, 0.06), Progress::Going { .. }));
    assert_eq!(refused(hasty.step(&still, 0.06)), GyroRefusal::NeverStill(None));
}

/// If this failed, a broken gyro, or a steady turn faster than any offset, would be calibrated away.
#[test]
fn an_offset_that_is_none_is_refused_with_its_axis() {
    let mut noise = Noise::new(7);
    let (end, ..) = run(|time| {
        let mut sample = at_rest(&mut noise, Quaternion::from_heading(0.0), time);
        sample.rate.y -= 0.25;
        sample
    });
    let reason = refused(end);
    assert!(
        matches!(reason, GyroRefusal::Offset(Axis::Right, rate) if (rate + 0.25).abs() < 0.002),
        "{reason:?}"
    );
    assert!(reason.to_string().contains("right axis"));
}

/// If this failed, NaN could reach the mean.
#[test]
fn samples_that_are_none_are_refused_at_once() {
    let good = Inertial::default();
    for (rate, force, duration, bad) in [
        (f32::NAN, 0.0, INTERVAL, BadSample::NotANumber),
        (0.0, f32::INFINITY, INTERVAL, BadSample::NotANumber),
        (71.0, 0.0, INTERVAL, BadSample::TooLarge),
        (0.0, -641.0, INTERVAL, BadSample::TooLarge),
        (0.0, 0.0, -INTERVAL, BadSample::Duration),
    ] {
        let (mut machine, mut sample) = (GyroCalibrator::default(), good);
        machine.step(&good, INTERVAL);
        sample.rate.x += rate;
        sample.specific_force.z += force;
        let reason = refused(machine.step(&sample, duration));
        assert_eq!(reason, GyroRefusal::Sample(bad));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// If this failed, some input could keep the machine running, or give an offset out of range.
    #[test]
    fn it_ends_in_time_whatever_it_is_fed(
        inputs in prop::collection::vec((any_inertial(), any_duration()), 152),
        same in any::<bool>(),
    ) {
        let mut machine = GyroCalibrator::default();
        let mut last = None;
        for (sample, duration) in &inputs {
            let sample = if same { &inputs[0].0 } else { sample };
            last = Some(machine.step(sample, *duration));
        }
        match last {
            Some(Progress::Done(found)) => {
                prop_assert!(Axis::beyond(found.offset, GyroLimits::default().offset).is_none());
            }
            Some(Progress::Refused(_)) => {}
            other => prop_assert!(false, "{other:?}"),
        }
    }
}
