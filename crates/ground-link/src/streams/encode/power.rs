//! Messages about what keeps the vehicle going: health and battery.

use mavlink::dialects::common::{
    MavBatteryChargeState, MavBatteryFunction, MavBatteryType, MavSysStatusSensor as Bit,
};

use super::Source;
use crate::scale::{scaled, word};
use crate::telemetry::{Battery, Charge, Part};
use crate::wire::Message;

/// Coulomb in a milliampere hour.
const MAH: f32 = 3.6;

pub(super) fn sys_status(source: &Source<'_>, m: &mut Message) {
    let (t, health) = (source.telemetry, source.telemetry.health);
    let can_arm = if health.can_arm { Part::Good } else { Part::Bad };
    let parts = [
        (Bit::MAV_SYS_STATUS_SENSOR_3D_GYRO, health.gyro),
        (Bit::MAV_SYS_STATUS_SENSOR_3D_ACCEL, health.accelerometer),
        (Bit::MAV_SYS_STATUS_SENSOR_3D_MAG, health.compass),
        (Bit::MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE, health.barometer),
        (Bit::MAV_SYS_STATUS_SENSOR_GPS, health.gnss),
        (Bit::MAV_SYS_STATUS_SENSOR_RC_RECEIVER, health.radio),
        (Bit::MAV_SYS_STATUS_SENSOR_BATTERY, health.battery),
        (Bit::MAV_SYS_STATUS_AHRS, health.estimate),
        (Bit::MAV_SYS_STATUS_LOGGING, health.log),
        (Bit::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, health.motors),
        (Bit::MAV_SYS_STATUS_GEOFENCE, health.fence),
        (Bit::MAV_SYS_STATUS_PREARM_CHECK, can_arm),
    ];
    let (mut present, mut good) = (Bit::empty(), Bit::empty());
    for (bit, part) in parts {
        present.set(bit, part != Part::Absent);
        good.set(bit, part == Part::Good);
    }
    m.long(present.bits())
        .long(present.bits())
        .long(good.bits())
        .word(scaled(t.load, 1000, 0, (0, 1000)) as u16)
        .word(word(t.battery.voltage, 1000))
        .short(amperes(t.battery.current))
        .word(scaled(source.loss, 10_000, 0, (0, 10_000)) as u16)
        .zeros(5 * 2) // errors
        .byte(percent(t.battery.remaining));
}

pub(super) fn battery_status(source: &Source<'_>, m: &mut Message) {
    let Battery {
        voltage,
        current,
        consumed,
        remaining,
        charge,
    } = source.telemetry.battery;
    let state = match charge {
        Charge::Enough => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_OK,
        Charge::Low => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_LOW,
        Charge::Critical => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_CRITICAL,
    };
    let consumed = consumed.unwrap_or(f32::NAN) / MAH;
    m.integer(scaled(consumed, 1, -1, (0, i32::MAX)))
        .integer(-1) // energy
        .short(i16::MAX) // temperature
        .word(word(voltage, 1000));
    for _ in 1..10 {
        m.word(u16::MAX); // further cells
    }
    m.short(amperes(current))
        .byte(0) // number of the battery
        .byte(MavBatteryFunction::MAV_BATTERY_FUNCTION_ALL as u8)
        .byte(MavBatteryType::MAV_BATTERY_TYPE_UNKNOWN as u8)
        .byte(percent(remaining))
        .zeros(4) // time that remains
        .byte(state as u8);
}

/// In 10 mA; -1 when unknown.
fn amperes(current: Option<f32>) -> i16 {
    scaled(current.unwrap_or(f32::NAN), 100, -1, (0, 0x7fff)) as i16
}

/// In percent; -1 when unknown.
fn percent(share: Option<f32>) -> u8 {
    scaled(share.unwrap_or(f32::NAN), 100, -1, (0, 100)) as u8
}
