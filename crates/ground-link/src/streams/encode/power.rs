//! Messages about what keeps the vehicle going: health and battery.

use mavlink::dialects::common::{
    BATTERY_STATUS_DATA, MavBatteryChargeState, MavBatteryFault, MavBatteryMode, MavSysStatusSensor,
    MavSysStatusSensorExtended, SYS_STATUS_DATA,
};

use super::Source;
use crate::scale::{scaled, word};
use crate::telemetry::{Battery, Charge, Part};
use crate::wire::Message;

/// Coulomb in a milliampere hour.
const MAH: f32 = 3.6;

pub(super) fn sys_status(source: &Source<'_>) -> Message {
    type Bit = MavSysStatusSensor;
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
    let none = MavSysStatusSensorExtended::empty();
    let Battery {
        voltage,
        current,
        remaining,
        ..
    } = t.battery;
    Message::of(&SYS_STATUS_DATA {
        onboard_control_sensors_present: present,
        onboard_control_sensors_enabled: present,
        onboard_control_sensors_health: good,
        load: scaled(t.load, 1000, 0, (0, 1000)),
        voltage_battery: word(voltage, 1000),
        current_battery: amperes(current),
        drop_rate_comm: scaled(source.loss, 10_000, 0, (0, 10_000)),
        battery_remaining: percent(remaining),
        onboard_control_sensors_present_extended: none,
        onboard_control_sensors_enabled_extended: none,
        onboard_control_sensors_health_extended: none,
        ..SYS_STATUS_DATA::DEFAULT
    })
}

pub(super) fn battery_status(source: &Source<'_>) -> Message {
    let Battery {
        voltage,
        current,
        consumed,
        remaining,
        charge,
    } = source.telemetry.battery;
    let mut voltages = [u16::MAX; 10];
    let [first, ..] = &mut voltages;
    *first = word(voltage, 1000);
    Message::of(&BATTERY_STATUS_DATA {
        current_consumed: consumed.map_or(-1, |charge| scaled(charge / MAH, 1, -1, (0, i32::MAX))),
        energy_consumed: -1,
        temperature: i16::MAX,
        voltages,
        current_battery: amperes(current),
        battery_remaining: percent(remaining),
        charge_state: match charge {
            Charge::Enough => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_OK,
            Charge::Low => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_LOW,
            Charge::Critical => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_CRITICAL,
        },
        mode: MavBatteryMode::MAV_BATTERY_MODE_UNKNOWN,
        fault_bitmask: MavBatteryFault::empty(),
        ..BATTERY_STATUS_DATA::DEFAULT
    })
}

/// In 10 mA; -1 when unknown.
fn amperes(current: Option<f32>) -> i16 {
    scaled(current.unwrap_or(f32::NAN), 100, -1, (0, 0x7fff))
}

/// In percent; -1 when unknown.
fn percent(share: Option<f32>) -> i8 {
    scaled(share.unwrap_or(f32::NAN), 100, -1, (0, 100))
}
