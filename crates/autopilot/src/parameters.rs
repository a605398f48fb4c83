//! The parameter table: every group under one index, and the two presets.

use windhover_control::VehicleParameters;
use windhover_control::attitude::AttitudeParameters;
use windhover_control::observer::ObserverParameters;
use windhover_control::position::PositionParameters;
use windhover_parameters::{parameter_groups, parameters};

use windhover_estimator::NoiseParameters;

use crate::battery::BatteryParameters;
use crate::calibration::rc::RcCalibrationParameters;
use crate::estimation::EstimationParameters;
use crate::fence::FenceParameters;
use crate::gyro_filter::FilterParameters;
use crate::mission::MissionParameters;
use crate::mode::ManualParameters;
use crate::rc::RcParameters;
use crate::sensing::CalibrationParameters;
use crate::supervisor::SafetyParameters;

parameters! {
    /// Motors at the edges of flight.
    pub struct MotorParameters {
        idle: "MOT_IDLE", "", 0.02..=0.3, 0.08, "Speed of armed rotors on the ground, and least speed in flight, as a share of the largest";
        curve: "THR_MDL_FAC", "", 0.1..=1.0, 1.0, "Share of a rotor's thrust that follows the command's square, the rest follows the command: 1 where the speed controller sets the speed";
        voltage: "MOT_VOLT_REF", "V", 0.0..=60.0, 0.0, "Battery voltage at which commands are right: below it they are raised as the voltage falls, by a third at most; 0: never";
    }
}

impl MotorParameters {
    /// What commands are multiplied by at a battery voltage of so many V.
    pub fn gain(&self, voltage: Option<f32>) -> f32 {
        match voltage {
            Some(voltage) if self.voltage > 0.0 && voltage > 0.0 => {
                (self.voltage / voltage).clamp(1.0, 4.0 / 3.0)
            }
            _ => 1.0,
        }
    }
}

parameters! {
    /// What the board is set up with when it starts; a change acts at the next start.
    pub struct BoardParameters {
        imu_rate: "IMU_GYRO_RATEMAX", "Hz", 1000.0..=4000.0, 1000.0, "Samples of the inertial sensors a second: 4000, and 1000 for anything less; acts at the next start";
        pwm_rate: "MOT_PWM_RATE", "Hz", 50.0..=490.0, 400.0, "Pulses to the motors a second; acts at the next start";
    }
}

impl BoardParameters {
    /// Samples of the inertial sensors per second: a rate that the schedule and the part know.
    pub fn imu_rate(&self) -> u32 {
        if self.imu_rate >= 4000.0 { 4000 } else { 1000 }
    }
}

parameters! {
    /// How the vehicle introduces itself to ground stations.
    pub struct LinkParameters {
        system: "MAV_SYS_ID", "", 1.0..=250.0, 1.0, "System number of the vehicle among those that a ground station sees; acts at the next start";
        autopilot: "MAV_AUTOPILOT", "", 0.0..=12.0, 12.0, "As which autopilot it introduces itself: 12 PX4, whose mode numbers it has, so that ground stations offer all they can; 0 generic";
    }
}

parameter_groups! {
    /// All parameters of the core.
    pub struct Parameters {
        vehicle: VehicleParameters,
        motor: MotorParameters,
        attitude: AttitudeParameters,
        position: PositionParameters,
        observer: ObserverParameters,
        mission: MissionParameters,
        calibration: CalibrationParameters,
        filter: FilterParameters,
        board: BoardParameters,
        estimation: EstimationParameters,
        noise: NoiseParameters,
        manual: ManualParameters,
        safety: SafetyParameters,
        fence: FenceParameters,
        rc: RcParameters,
        rc_calibration: RcCalibrationParameters,
        battery: BatteryParameters,
        link: LinkParameters,
    }
}

/// Which position control flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Table I of the paper as printed, in a plain cascade.
    Paper,
    /// With velocity, acceleration and jerk fed forward, and a disturbance observer.
    Windhover,
}

impl Preset {
    /// Sets the parameters that make up the preset; the rest stays.
    pub fn apply(self, parameters: &mut Parameters) {
        match self {
            Self::Paper => {
                parameters.position = PositionParameters::paper();
                parameters.observer = ObserverParameters::paper();
            }
            Self::Windhover => {
                parameters.position = PositionParameters::default();
                parameters.observer = ObserverParameters::default();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_are_well_formed() {
        for (index, declaration) in Parameters::declarations().enumerate() {
            let name = declaration.name;
            assert!(
                name.len() <= 16
                    && name
                        .bytes()
                        .all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_')
            );
            assert!(
                declaration.check(declaration.default).is_ok(),
                "{name}: default out of range"
            );
            assert_eq!(Parameters::find(name), Some(index), "{name} is declared twice");
            assert!(
                !declaration.text.ends_with('.') && declaration.text.len() > 10,
                "{name}: {}",
                declaration.text
            );
        }
    }

    #[test]
    fn commands_rise_as_the_battery_sags_and_no_further_than_by_a_third() {
        let motor = MotorParameters {
            voltage: 16.0,
            ..Default::default()
        };
        let gains = [
            Some(16.8),
            Some(16.0),
            Some(14.0),
            Some(3.0),
            Some(f32::NAN),
            None,
        ]
        .map(|v| motor.gain(v));
        assert_eq!(gains, [1.0, 1.0, 16.0 / 14.0, 4.0 / 3.0, 1.0, 1.0]);
        assert_eq!(MotorParameters::default().gain(Some(10.0)), 1.0, "off by default");
    }

    #[test]
    fn every_rate_that_can_be_set_is_one_that_the_schedule_knows() {
        for rate in [1000.0, 1000.5, 2000.0, 3999.9, 4000.0] {
            let board = BoardParameters {
                imu_rate: rate,
                ..Default::default()
            };
            assert!([1000, 4000].contains(&board.imu_rate()), "{rate}");
        }
    }

    #[test]
    fn presets_are_within_range_and_differ() {
        let tables = [Preset::Paper, Preset::Windhover].map(|preset| {
            let mut table = Parameters::default();
            preset.apply(&mut table);
            table
        });
        for table in &tables {
            for (index, declaration) in Parameters::declarations().enumerate() {
                assert!(
                    declaration.check(table.get(index).unwrap()).is_ok(),
                    "{}",
                    declaration.name
                );
            }
        }
        assert_ne!(tables[0], tables[1]);
    }
}
