//! What is done when something goes wrong, in numbers.

use windhover_parameters::parameters;

parameters! {
    /// Failsafes, arming and disarming.
    pub struct SafetyParameters {
        rc_lost_action: "NAV_RCL_ACT", "", 0.0..=6.0, 2.0, "Remote control lost: 0 warn, 1 hold, 2 return, 3 land, 5 and 6 motors off";
        station_lost_action: "NAV_DLL_ACT", "", 0.0..=6.0, 0.0, "Ground station lost: 0 warn, 1 hold, 2 return, 3 land, 5 and 6 motors off";
        station_lost_time: "COM_DL_LOSS_T", "s", 1.0..=300.0, 10.0, "A ground station that is silent for so long is lost";
        offboard_lost_time: "COM_OF_LOSS_T", "s", 0.1..=60.0, 0.5, "Setpoints from outside that are older than this are lost";
        offboard_lost_action: "OFFB_LOSS_ACT", "", 0.0..=6.0, 1.0, "Setpoints from outside lost: 0 warn, 1 hold, 2 return, 3 land, 5 and 6 motors off";
        low_battery_action: "COM_LOW_BAT_ACT", "", 0.0..=3.0, 3.0, "Battery: 0 only warn, 2 land when critical, 3 return when critical and land when empty";
        position_lost: "COM_POS_LOST_T", "s", 0.5..=60.0, 10.0, "Without a measured position for so long, prediction is not relied on any more";
        position_gone: "COM_POS_GONE_T", "s", 1.0..=600.0, 60.0, "Without a position for so long, the vehicle descends";
        tumble_tilt: "FD_FAIL_TILT", "rad", 0.8..=3.1, 1.4, "Tilt that no controlled flight has";
        tumble_time: "FD_FAIL_TIME", "s", 0.02..=5.0, 0.3, "A tilt beyond control counts after this time";
        tumble_height: "FD_FAIL_HEIGHT", "m", 0.0..=100.0, 2.0, "Below this height above the place of arming a vehicle that tumbles is not recovered";
        saturation_time: "FD_SAT_TIME", "s", 0.5..=60.0, 3.0, "A motor that is at its limit for so long is too weak";
        wind_time: "COM_WIND_TIME", "s", 0.5..=120.0, 5.0, "Wind that takes all the tilt for so long is too strong";
        range_margin: "COM_RANGE_MARGIN", "", 1.0..=5.0, 1.3, "Time that the battery must last, as a multiple of the time to return";
        disarm_ground: "COM_DISARM_PRFLT", "s", 1.0..=600.0, 10.0, "Armed for so long without leaving the ground, the vehicle disarms itself";
        disarm_landed: "COM_DISARM_LAND", "s", 0.1..=60.0, 2.0, "Landed for so long, the vehicle disarms itself";
        spool_up: "COM_SPOOLUP_TIME", "s", 0.0..=30.0, 1.0, "Armed motors idle for so long before the vehicle may take off";
        arming_tilt: "COM_ARM_TILT", "rad", 0.1..=1.5, 0.5, "A vehicle that stands more tilted than this does not arm";
    }
}
