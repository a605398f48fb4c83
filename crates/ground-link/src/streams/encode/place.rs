//! Messages about places: where the vehicle is, where home is, where a photo was taken.

use mavlink::MessageData;
use mavlink::dialects::common::{CAMERA_IMAGE_CAPTURED_DATA, GpsFixType};
use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

use super::Source;
use crate::Photo;
use crate::scale::{centidegrees, divided, scaled, short, word};
use crate::telemetry::{Fix, Gnss};
use crate::wire::Message;

/// The camera hangs at the autopilot and speaks no MAVLink itself: it is the first of those.
const CAMERA: u8 = 1;

/// A number of satellites that is not known.
const UNKNOWN: u8 = 255;

impl Message {
    /// Latitude, longitude, altitude.
    fn place(&mut self, place: GlobalPosition) -> &mut Self {
        self.integer(place.latitude)
            .integer(place.longitude)
            .integer(place.altitude)
    }
}

pub(super) fn local_position(source: &Source<'_>, m: &mut Message) -> Option<()> {
    let position = source.telemetry.position?;
    let velocity = source.telemetry.velocity.unwrap_or_else(Vector3::zeros);
    m.long(source.boot_ms()).vector(position).vector(velocity);
    Some(())
}

pub(super) fn global_position(source: &Source<'_>, m: &mut Message) -> Option<()> {
    let t = source.telemetry;
    let global = t.global?;
    let velocity = t.velocity.unwrap_or_else(Vector3::zeros);
    m.long(source.boot_ms())
        .place(global)
        .integer(above_home(global, t.home));
    for speed in [velocity.x, velocity.y, velocity.z] {
        m.short(short(speed, 100));
    }
    m.word(centidegrees(t.attitude.map(|attitude| attitude.heading())));
    Some(())
}

/// mm.
fn above_home(position: GlobalPosition, home: Option<GlobalPosition>) -> i32 {
    home.map_or(0, |home| position.altitude.saturating_sub(home.altitude))
}

pub(super) fn gps_raw_int(source: &Source<'_>, m: &mut Message) {
    let gnss = source.telemetry.gnss;
    let fix = match gnss.map(|gnss| gnss.fix) {
        None => GpsFixType::GPS_FIX_TYPE_NO_GPS,
        Some(Fix::None) => GpsFixType::GPS_FIX_TYPE_NO_FIX,
        Some(Fix::Flat) => GpsFixType::GPS_FIX_TYPE_2D_FIX,
        Some(Fix::Full) => GpsFixType::GPS_FIX_TYPE_3D_FIX,
        Some(Fix::Differential) => GpsFixType::GPS_FIX_TYPE_DGPS,
        Some(Fix::RtkFloat) => GpsFixType::GPS_FIX_TYPE_RTK_FLOAT,
        Some(Fix::RtkFixed) => GpsFixType::GPS_FIX_TYPE_RTK_FIXED,
    };
    let (speed, satellites) = (gnss.map(|gnss| gnss.speed), gnss.map(|gnss| gnss.satellites));
    let Gnss {
        position,
        course,
        dilution: [horizontal, vertical],
        accuracy: [across, up],
        speed_accuracy,
        ..
    } = gnss.unwrap_or_default();
    m.huge(source.now)
        .place(position)
        .word(word(horizontal, 100))
        .word(word(vertical, 100))
        .word(word(speed, 100))
        .word(centidegrees(course))
        .byte(fix as u8)
        .byte(satellites.unwrap_or(UNKNOWN))
        .zeros(4); // altitude above the ellipsoid
    for metres in [across, up, speed_accuracy] {
        m.integer(scaled(metres, 1000, 0, (0, i32::MAX)));
    }
}

pub(super) fn home_position(source: &Source<'_>, m: &mut Message) -> Option<()> {
    m.place(source.telemetry.home?)
        .zeros(3 * 4) // local position
        .rotation(Quaternion::IDENTITY)
        .zeros(3 * 4) // approach
        .huge(source.now);
    Some(())
}

/// `CAMERA_IMAGE_CAPTURED`.
pub(crate) fn image_captured(photo: &Photo, source: &Source<'_>, m: &mut Message) {
    let ago = source.now.saturating_sub(photo.time);
    let utc = source.telemetry.utc.map(|utc| utc.saturating_sub(ago));
    m.start(CAMERA_IMAGE_CAPTURED_DATA::ID)
        .huge(utc.unwrap_or_default())
        .long(divided(photo.time, 1000) as u32)
        .place(photo.position)
        .integer(above_home(photo.position, source.telemetry.home))
        .rotation(photo.attitude)
        .long(photo.index)
        .byte(CAMERA)
        .byte(1); // captured
}
