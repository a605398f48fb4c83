//! What a logger is made with.

use windhover_autopilot::sensing::SensingBorder;
use windhover_autopilot::{InnerConfig, Parameters};

use crate::batch::MAX_K;

/// What a logger is made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoggerConfig {
    /// What the inner step is made with.
    pub inner: InnerConfig,
    /// From counts to SI units, for the view `sensor_combined`.
    pub sensing: SensingBorder,
    /// Thrust of all rotors at full command, N, for the view `vehicle_attitude_setpoint`.
    pub thrust_max: f32,
    /// Views are written every so many outer steps; 0 for none.
    pub view_divider: u32,
}

impl LoggerConfig {
    /// For a core with these parameters; views 17 times a second.
    pub fn new(inner: InnerConfig, parameters: &Parameters) -> Self {
        Self {
            inner,
            sensing: SensingBorder::new(&inner.rotation, &parameters.calibration),
            thrust_max: 4.0 * parameters.vehicle.rotor_thrust_max(),
            view_divider: 15,
        }
    }

    pub(super) fn k(&self) -> usize {
        (self.inner.k() as usize).min(MAX_K)
    }

    pub(super) fn nominal(&self) -> u64 {
        nominal_step(self.inner.imu_rate)
    }
}

/// The nominal step between two ticks, µs, from which deviations count.
pub const fn nominal_step(imu_rate: u32) -> u64 {
    match 1_000_000u32.checked_div(imu_rate) {
        Some(step) => step as u64,
        None => 0,
    }
}
