//! Messages about places: where the vehicle is, where home is, where a photo was taken.

use mavlink::dialects::common::{
    CAMERA_IMAGE_CAPTURED_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, GpsFixType, HOME_POSITION_DATA,
    LOCAL_POSITION_NED_DATA,
};
use windhover_math::Vector3;
use windhover_math::geodesy::GlobalPosition;

use super::Source;
use crate::Photo;
use crate::scale::{centidegrees, scaled, short, word};
use crate::telemetry::Fix;
use crate::wire::Message;

pub(super) fn local_position(source: &Source<'_>) -> Option<Message> {
    let position = source.telemetry.position?;
    let velocity = source.telemetry.velocity.unwrap_or_else(Vector3::zeros);
    Some(Message::of(&LOCAL_POSITION_NED_DATA {
        time_boot_ms: source.boot_ms(),
        x: position.x,
        y: position.y,
        z: position.z,
        vx: velocity.x,
        vy: velocity.y,
        vz: velocity.z,
    }))
}

pub(super) fn global_position(source: &Source<'_>) -> Option<Message> {
    let t = source.telemetry;
    let global = t.global?;
    let velocity = t.velocity.unwrap_or_else(Vector3::zeros);
    Some(Message::of(&GLOBAL_POSITION_INT_DATA {
        time_boot_ms: source.boot_ms(),
        lat: global.latitude,
        lon: global.longitude,
        alt: global.altitude,
        relative_alt: above_home(global, t.home),
        vx: short(velocity.x, 100),
        vy: short(velocity.y, 100),
        vz: short(velocity.z, 100),
        hdg: centidegrees(t.attitude.map(|attitude| attitude.heading())),
    }))
}

/// mm.
fn above_home(position: GlobalPosition, home: Option<GlobalPosition>) -> i32 {
    home.map_or(0, |home| position.altitude.saturating_sub(home.altitude))
}

pub(super) fn gps_raw_int(source: &Source<'_>) -> Message {
    let Some(gnss) = source.telemetry.gnss else {
        return Message::of(&GPS_RAW_INT_DATA {
            time_usec: source.now,
            eph: u16::MAX,
            epv: u16::MAX,
            vel: u16::MAX,
            cog: u16::MAX,
            fix_type: GpsFixType::GPS_FIX_TYPE_NO_GPS,
            satellites_visible: 255,
            ..GPS_RAW_INT_DATA::DEFAULT
        });
    };
    let [horizontal, vertical] = gnss.dilution;
    let millimetres = |metres: f32| scaled(metres, 1000, 0u32, (0, i32::MAX));
    let [h_acc, v_acc] = gnss.accuracy.map(millimetres);
    Message::of(&GPS_RAW_INT_DATA {
        time_usec: source.now,
        lat: gnss.position.latitude,
        lon: gnss.position.longitude,
        alt: gnss.position.altitude,
        eph: word(horizontal, 100),
        epv: word(vertical, 100),
        vel: word(Some(gnss.speed), 100),
        cog: centidegrees(gnss.course),
        fix_type: match gnss.fix {
            Fix::None => GpsFixType::GPS_FIX_TYPE_NO_FIX,
            Fix::Flat => GpsFixType::GPS_FIX_TYPE_2D_FIX,
            Fix::Full => GpsFixType::GPS_FIX_TYPE_3D_FIX,
            Fix::Differential => GpsFixType::GPS_FIX_TYPE_DGPS,
            Fix::RtkFloat => GpsFixType::GPS_FIX_TYPE_RTK_FLOAT,
            Fix::RtkFixed => GpsFixType::GPS_FIX_TYPE_RTK_FIXED,
        },
        satellites_visible: gnss.satellites,
        h_acc,
        v_acc,
        vel_acc: millimetres(gnss.speed_accuracy),
        ..GPS_RAW_INT_DATA::DEFAULT
    })
}

pub(super) fn home_position(source: &Source<'_>) -> Option<Message> {
    let home = source.telemetry.home?;
    Some(Message::of(&HOME_POSITION_DATA {
        latitude: home.latitude,
        longitude: home.longitude,
        altitude: home.altitude,
        q: [1.0, 0.0, 0.0, 0.0],
        time_usec: source.now,
        ..HOME_POSITION_DATA::DEFAULT
    }))
}

/// `CAMERA_IMAGE_CAPTURED`.
pub(crate) fn image_captured(photo: &Photo, source: &Source<'_>) -> Message {
    let attitude = photo.attitude;
    Message::of(&CAMERA_IMAGE_CAPTURED_DATA {
        time_utc: source.telemetry.utc.unwrap_or_default(),
        time_boot_ms: (photo.time / 1000) as u32,
        lat: photo.position.latitude,
        lon: photo.position.longitude,
        alt: photo.position.altitude,
        relative_alt: above_home(photo.position, source.telemetry.home),
        q: [attitude.w, attitude.x, attitude.y, attitude.z],
        image_index: i32::try_from(photo.index).unwrap_or(i32::MAX),
        capture_result: mavlink::dialects::common::MavBool::MAV_BOOL_TRUE,
        ..CAMERA_IMAGE_CAPTURED_DATA::DEFAULT
    })
}
