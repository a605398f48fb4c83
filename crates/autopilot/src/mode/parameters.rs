//! How sticks and setpoints from outside are flown, in numbers.

use windhover_parameters::parameters;

parameters! {
    /// Limits of modes that follow somebody, and of braking.
    pub struct ManualParameters {
        velocity: "MPC_VEL_MANUAL", "m/s", 0.3..=20.0, 4.0, "Horizontal speed at full stick, and the most that setpoints from outside get";
        climb: "MPC_Z_VEL_MAX_UP", "m/s", 0.2..=8.0, 2.0, "Climbing speed at full stick, and the most that setpoints from outside get";
        descend: "MPC_Z_VEL_MAX_DN", "m/s", 0.2..=4.0, 1.5, "Descending speed at full stick, and the most that setpoints from outside get";
        acceleration: "MPC_ACC_HOR_MAX", "m/s^2", 0.5..=12.0, 3.0, "Horizontal acceleration under sticks and while braking for a hold or the geofence";
        vertical_acceleration: "MPC_ACC_UP_MAX", "m/s^2", 0.5..=10.0, 2.0, "Vertical acceleration under sticks and while braking";
        jerk: "MPC_JERK_MAX", "m/s^3", 1.0..=500.0, 12.0, "Jerk under sticks and while braking";
        tilt: "MAN_TILT_MAX", "rad", 0.05..=1.2, 0.6, "Tilt at full stick; PX4 has the same in degrees as MPC_MAN_TILT_MAX";
        yaw_rate: "MAN_YAW_RATE", "rad/s", 0.05..=6.0, 1.5, "Heading rate at full stick; PX4 has the same in degrees as MPC_MAN_Y_MAX";
        takeoff_altitude: "MIS_TAKEOFF_ALT", "m", 0.5..=80.0, 2.5, "Height above home that the mode takeoff climbs to where nobody says how high";
        land_slow_height: "MPC_LAND_ALT2", "m", 0.5..=100.0, 5.0, "Below this height above home a landing goes at its slowest speed";
        land_fast_height: "MPC_LAND_ALT1", "m", 1.0..=200.0, 10.0, "Above this height above home a landing begins to slow down";
        land_delay: "RTL_LAND_DELAY", "s", 0.0..=300.0, 0.5, "Wait over the place of return before landing";
    }
}
