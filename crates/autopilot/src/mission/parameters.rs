//! How missions are flown, in numbers.

use windhover_math::{max, min};
use windhover_parameters::parameters;

parameters! {
    /// How missions are flown.
    pub struct MissionParameters {
        cruise_speed: "MPC_XY_CRUISE", "m/s", 0.1..=20.0, 2.0, "Horizontal speed of missions";
        climb_speed: "MPC_Z_V_AUTO_UP", "m/s", 0.1..=8.0, 2.0, "Climbing speed of missions";
        descend_speed: "MPC_Z_V_AUTO_DN", "m/s", 0.1..=4.0, 1.5, "Descending speed of missions";
        takeoff_speed: "MPC_TKO_SPEED", "m/s", 0.1..=5.0, 1.5, "Climbing speed from the ground";
        land_speed: "MPC_LAND_SPEED", "m/s", 0.1..=2.0, 0.7, "Descending speed to the ground";
        acceleration: "MPC_ACC_HOR", "m/s^2", 0.1..=10.0, 1.5, "Horizontal acceleration of missions";
        vertical_acceleration: "MIS_ACC_VER", "m/s^2", 0.1..=10.0, 1.5, "Vertical acceleration of missions";
        jerk: "MPC_JERK_AUTO", "m/s^3", 0.5..=80.0, 6.0, "Jerk of missions";
        acceptance_radius: "NAV_ACC_RAD", "m", 0.05..=100.0, 2.0, "A waypoint is reached within this distance, where its item gives none";
        return_altitude: "RTL_RETURN_ALT", "m", 0.0..=150.0, 30.0, "Height above home at which the vehicle returns";
        altitude_max: "MIS_ALT_MAX", "m", 1.0..=5000.0, 500.0, "Missions that go higher above home, or further below, are refused";
        distance_max: "MIS_DIST_MAX", "m", 10.0..=9000.0, 5000.0, "Missions that go further from home are refused";
        yaw_mode: "MIS_YAW_MODE", "", 0.0..=1.0, 0.0, "Heading where an item gives none: 0 stays, 1 along the path";
        yaw_rate: "MIS_YAW_RATE", "rad/s", 0.05..=6.0, 0.8, "Largest heading rate of missions";
        yaw_acceleration: "MIS_YAW_ACC", "rad/s^2", 0.05..=20.0, 1.6, "Largest heading acceleration of missions";
        slow_error: "MIS_ERR_SLOW", "m", 0.1..=100.0, 1.0, "Further from the path's point than this, the point slows down";
        stop_error: "MIS_ERR_STOP", "m", 0.2..=100.0, 3.0, "Further from the path's point than this, the point waits";
        photo_error: "PHOTO_ERR", "m", 0.01..=100.0, 0.1, "A photo waits until the position error is smaller";
        photo_speed: "PHOTO_SPEED", "m/s", 0.01..=10.0, 0.1, "A photo waits until the speed is smaller";
        photo_dwell: "PHOTO_DWELL", "s", 0.0..=10.0, 0.2, "How long both have to be so";
        photo_wait: "PHOTO_WAIT", "s", 0.0..=600.0, 5.0, "After this time the photo is taken all the same";
        arrival_wait: "MIS_ARRIVE_WAIT", "s", 0.0..=600.0, 20.0, "After this time a stop is given up that was not reached";
    }
}

impl MissionParameters {
    /// How fast a setpoint moves on, 0 to 1, when the vehicle is `error` m away from it: slower when
    /// it has fallen behind.
    pub fn rate(&self, error: f32) -> f32 {
        let span = max(self.stop_error - self.slow_error, 0.1);
        max(0.0, min(1.0, (self.slow_error + span - error) / span))
    }
}
