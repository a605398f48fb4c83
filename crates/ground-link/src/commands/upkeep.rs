//! Commands about the vehicle itself and its camera: calibrations, storage, tests of motors,
//! photos.

use super::arguments::Parameters;
use super::translate::Translated;
use super::{CommandResult, number};
use crate::request::{Calibration, Request};

/// The largest time that a motor is tested for, s.
const LONGEST_TEST: f32 = 10.0;

/// One calibration at a time, by the number of its parameter and what that says; none at all ends
/// the one that is under way.
pub(super) fn calibration(p: &Parameters) -> Translated {
    let mut wanted = None;
    for number in 1..=7 {
        let value = p.number(number);
        if value != 0.0 && wanted.replace((number, value as u8)).is_some() {
            return Err(CommandResult::Denied);
        }
    }
    Ok(Request::Calibrate(match wanted {
        None => Calibration::Cancel,
        Some((1, 1)) => Calibration::Gyro,
        Some((2, 1)) => Calibration::Compass,
        Some((3, 1)) => Calibration::Pressure,
        Some((4, 1)) => Calibration::Radio,
        Some((5, 1)) => Calibration::Accelerometer,
        Some((5, 2)) => Calibration::Level,
        Some((5, 4)) => Calibration::AccelerometerOffset,
        // Air speed, motors, temperatures and the like.
        Some(_) => return Err(CommandResult::Unsupported),
    }))
}

pub(super) fn storage(p: &Parameters) -> Translated {
    match p.number(1) {
        1.0 => Ok(Request::StoreParameters),
        2.0 | 3.0 => Ok(Request::ResetParameters),
        _ => Err(CommandResult::Denied),
    }
}

pub(super) fn reboot(p: &Parameters) -> Translated {
    match p.number(1) {
        1.0 => Ok(Request::Reboot),
        _ => Err(CommandResult::Denied),
    }
}

/// Throttle in percent (type 0) or as a pulse of 1000 to 2000 µs (type 1), for some seconds.
pub(super) fn motor_test(p: &Parameters) -> Translated {
    let throttle = match p.number(2) {
        0.0 => p.number(3) / 100.0,
        1.0 => (p.number(3) - 1000.0) * 1e-3,
        _ => return Err(CommandResult::Denied),
    };
    motor(p.number(1), throttle, p.number(4))
}

/// `ACTUATOR_OUTPUT_FUNCTION` 1 to 8 are motors; a value of NaN ends the test.
pub(super) fn actuator_test(p: &Parameters) -> Translated {
    let duration = p.number(2);
    match p.get(1) {
        None => motor(p.number(5), 0.0, duration),
        Some(value) if value < 0.0 => Err(CommandResult::Denied),
        Some(value) => motor(p.number(5), value, duration),
    }
}

fn motor(number: f32, throttle: f32, duration: f32) -> Translated {
    let fits = (1.0..=8.0).contains(&number)
        && (0.0..=1.0).contains(&throttle)
        && (0.0..=LONGEST_TEST).contains(&duration);
    if !fits {
        return Err(CommandResult::Denied);
    }
    Ok(Request::TestMotor {
        motor: number as u8,
        throttle,
        duration,
    })
}

/// One photo, now.
const ONE_PHOTO: Request = Request::TakePhotos {
    interval: 0.0,
    count: 1,
};

#[inline(never)]
pub(super) fn camera(command: u16, p: &Parameters) -> Option<Translated> {
    Some(match command {
        number::IMAGE_START_CAPTURE => photos(p.number(2), p.get(3).unwrap_or(1.0)),
        number::IMAGE_STOP_CAPTURE => Ok(Request::StopPhotos),
        number::DO_DIGICAM_CONTROL if p.number(5) > 0.5 => Ok(ONE_PHOTO),
        // Without a distance it is one photo, now.
        number::DO_SET_CAM_TRIGG_DIST if p.is(3, 1.0) && p.number(1) <= 0.0 => Ok(ONE_PHOTO),
        number::DO_SET_CAM_TRIGG_DIST if p.number(1) < 0.0 => Err(CommandResult::Denied),
        number::DO_SET_CAM_TRIGG_DIST => Ok(Request::PhotosByDistance {
            distance: p.number(1),
            at_once: p.is(3, 1.0),
        }),
        _ => return None,
    })
}

/// A count of 0 is without end: nothing else that is less than one photo may become it. Several, or
/// without end, need time between two.
fn photos(interval: f32, count: f32) -> Translated {
    let is_count = count == 0.0 || count >= 1.0;
    let count = count as u32;
    if !is_count || interval < 0.0 || count != 1 && interval == 0.0 {
        return Err(CommandResult::Denied);
    }
    Ok(Request::TakePhotos { interval, count })
}
