//! The conditions of a flight: wind, pushes, payload, seed.

use thiserror::Error;
use windhover_math::Vector3;

use crate::length::Length;
use crate::payload::Payload;
use crate::push::Push;
use crate::wind::mean_wind_from;

/// What a vehicle meets besides itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Velocity of the mean wind in NED, in m/s: where it blows *to*.
    pub wind: Vector3<f64>,
    /// Standard deviation of the Dryden gusts in each of three directions, in m/s.
    pub gust: f64,
    /// Forces over spans of time.
    pub pushes: Vec<Push>,
    /// What hangs below.
    pub payload: Payload,
    /// A constant acceleration in NED in m/s², besides gravity: an ideal disturbance.
    pub disturbance: Vector3<f64>,
    /// Everything random follows from it.
    pub seed: u64,
    /// Frames a second of the PWM that the speed controllers read, with the timer's preload
    /// latch; `None` for commands that act at once.
    pub pwm_hz: Option<u32>,
}

/// A condition that cannot be flown in, in one line.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field} is {value}: must be {allowed}")]
pub struct ConditionsError {
    /// Which condition.
    pub field: &'static str,
    /// The value found.
    pub value: f64,
    /// The values allowed, with their unit.
    pub allowed: &'static str,
}

impl Default for Conditions {
    /// Calm air, no pushes, no payload, PWM at 400 Hz.
    fn default() -> Self {
        Self {
            wind: Vector3::zeros(),
            gust: 0.0,
            pushes: Vec::new(),
            payload: Payload::NONE,
            disturbance: Vector3::zeros(),
            seed: 1,
            pwm_hz: Some(400),
        }
    }
}

impl Conditions {
    /// The reference conditions: wind towards north 4 and east 2 m/s with gusts of 1 m/s, and
    /// the two pushes of [`Push::reference`].
    pub fn reference() -> Self {
        Self {
            wind: mean_wind_from(4.47, 206.6),
            gust: 1.0,
            pushes: Push::reference(),
            ..Self::default()
        }
    }

    /// Checks that every figure is finite and in a range that means something.
    pub fn validate(&self) -> Result<(), ConditionsError> {
        let check = |field, value: f64, low: f64, high: f64, allowed| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            Err(ConditionsError {
                field,
                value,
                allowed,
            })
        };
        check("wind speed", self.wind.length(), 0.0, 100.0, "0 to 100 m/s")?;
        check("gust", self.gust, 0.0, 50.0, "0 to 50 m/s")?;
        check(
            "disturbance",
            self.disturbance.length(),
            0.0,
            100.0,
            "0 to 100 m/s²",
        )?;
        for push in &self.pushes {
            check("push start", push.start, 0.0, 1e6, "0 to 1000000 s")?;
            check("push duration", push.duration, 0.0, 1e6, "0 to 1000000 s")?;
            check("push force", push.force.length(), 0.0, 1e4, "0 to 10000 N")?;
        }
        if let Some(hz) = self.pwm_hz {
            check("PWM frequency", f64::from(hz), 50.0, 32_000.0, "50 to 32000 Hz")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reference_conditions_are_those_of_the_design() {
        let reference = Conditions::reference();
        assert_eq!(reference.validate(), Ok(()));
        assert!((reference.wind - Vector3::new(4.0, 2.0, 0.0)).length() < 0.01);
        assert_eq!((reference.gust, reference.pwm_hz), (1.0, Some(400)));
        assert_eq!(reference.pushes.len(), 2);
    }

    #[test]
    fn conditions_out_of_range_are_named() {
        let refused = |change: fn(&mut Conditions)| {
            let mut conditions = Conditions::reference();
            change(&mut conditions);
            conditions.validate().unwrap_err().to_string()
        };
        assert_eq!(refused(|c| c.gust = -1.0), "gust is -1: must be 0 to 50 m/s");
        assert_eq!(
            refused(|c| c.wind.x = f64::NAN),
            "wind speed is NaN: must be 0 to 100 m/s"
        );
        assert_eq!(
            refused(|c| c.pushes[1].start = -2.0),
            "push start is -2: must be 0 to 1000000 s"
        );
        assert_eq!(
            refused(|c| c.pushes[0].force.z = f64::INFINITY),
            "push force is inf: must be 0 to 10000 N"
        );
        assert_eq!(
            refused(|c| c.pushes[0].duration = f64::NAN),
            "push duration is NaN: must be 0 to 1000000 s"
        );
        assert_eq!(
            refused(|c| c.pwm_hz = Some(0)),
            "PWM frequency is 0: must be 50 to 32000 Hz"
        );
        assert_eq!(
            refused(|c| c.disturbance.y = 1e9),
            "disturbance is 1000000000: must be 0 to 100 m/s²"
        );
    }
}
