//! Attitude control: from an attitude error to a torque, in two PID loops.
//!
//! The error between two attitudes is the rotation that leads from one to the other, twice its
//! quaternion's vector part: no singularity, and the shorter way round. A proportional loop makes
//! a body rate of it; a PID loop (equation 10, derivative on the measurement) makes an angular
//! acceleration of the rate error; inertia and the gyroscopic torque ω × Iω make a torque of that.
//!
//! The setpoint's own rate is fed forward, and its attitude is taken to turn with it between two
//! results of the outer loop.

use windhover_math::{Quaternion, Vector3, saturate};
use windhover_parameters::parameters;

use crate::pid::{Differentiator, Pid, PidGains};
use crate::position::AttitudeSetpoint;

parameters! {
    /// Gains and limits of attitude control.
    pub struct AttitudeParameters {
        tilt_p: "ATT_TILT_P", "1/s", 0.0..=50.0, 14.0, "Rate per roll or pitch error";
        heading_p: "ATT_YAW_P", "1/s", 0.0..=50.0, 3.0, "Rate per heading error";
        tilt_rate_p: "RATE_TILT_P", "1/s", 0.0..=300.0, 40.0, "Angular acceleration per roll or pitch rate error";
        tilt_rate_i: "RATE_TILT_I", "1/s^2", 0.0..=1000.0, 20.0, "Integral gain of the roll and pitch rate";
        tilt_rate_d: "RATE_TILT_D", "", 0.0..=5.0, 0.6, "Damping of roll and pitch: angular acceleration per angular acceleration";
        heading_rate_p: "RATE_YAW_P", "1/s", 0.0..=300.0, 10.0, "Angular acceleration per heading rate error";
        heading_rate_i: "RATE_YAW_I", "1/s^2", 0.0..=1000.0, 5.0, "Integral gain of the heading rate";
        derivative_filter: "RATE_D_TC", "s", 0.0..=0.1, 0.005, "Time constant of the derivative's filter";
        tracking: "RATE_TRACK", "1/s", 0.0..=1000.0, 10.0, "How fast the integrals follow a saturated mixer";
        tilt_rate_max: "RATE_TILT_MAX", "rad/s", 0.1..=35.0, 6.0, "Largest demanded roll or pitch rate";
        heading_rate_max: "RATE_YAW_MAX", "rad/s", 0.05..=35.0, 1.5, "Largest demanded heading rate";
    }
}

/// The figures of [`AttitudeParameters`] as a step uses them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeGains {
    attitude: Vector3,
    rate: [PidGains; 3],
    rate_max: Vector3,
    derivative_filter: f32,
    inertia: Vector3,
    inverse_inertia: Vector3,
}

impl AttitudeGains {
    /// For a vehicle with these moments of inertia (kg·m²).
    pub fn new(parameters: &AttitudeParameters, inertia: Vector3) -> Self {
        let p = parameters;
        let tilt = PidGains {
            p: p.tilt_rate_p,
            i: p.tilt_rate_i,
            d: -p.tilt_rate_d,
            tracking: p.tracking,
        };
        let heading = PidGains {
            p: p.heading_rate_p,
            i: p.heading_rate_i,
            d: 0.0,
            tracking: p.tracking,
        };
        Self {
            attitude: Vector3::new(p.tilt_p, p.tilt_p, p.heading_p),
            rate: [tilt, tilt, heading],
            rate_max: Vector3::new(p.tilt_rate_max, p.tilt_rate_max, p.heading_rate_max),
            derivative_filter: p.derivative_filter,
            inertia,
            inverse_inertia: Vector3::new(1.0 / inertia.x, 1.0 / inertia.y, 1.0 / inertia.z),
        }
    }
}

/// What attitude control needs to know of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeEstimate {
    /// Attitude, body to world.
    pub attitude: Quaternion,
    /// Body rate, FRD, rad/s.
    pub rate: Vector3,
}

/// The attitude controller with its memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeController {
    rate: [Pid; 3],
    derivative: Differentiator,
}

impl AttitudeController {
    /// One step: the torque (FRD, N·m) that turns the vehicle from the `estimate` to the
    /// `setpoint`, which was made `age` seconds ago. `shortfall` is the torque
    /// that the mixer added to the last one (applied − demanded, N·m); `dt` in s since the last.
    #[inline]
    pub fn step(
        &mut self,
        gains: &AttitudeGains,
        setpoint: &AttitudeSetpoint,
        age: f32,
        estimate: &AttitudeEstimate,
        shortfall: Vector3,
        dt: f32,
    ) -> Vector3 {
        let rate = estimate.rate;
        let rate_setpoint = rate_setpoint(gains, setpoint, age, estimate.attitude);
        let turning = self.derivative.step(rate, gains.derivative_filter, dt);
        let mut acceleration = Vector3::zeros();
        let axes = self.rate.iter_mut().zip(gains.rate.iter());
        for (n, (pid, gains_of_axis)) in axes.enumerate() {
            let missing = shortfall[n] * gains.inverse_inertia[n];
            acceleration[n] = pid.step(gains_of_axis, rate_setpoint[n] - rate[n], turning[n], missing, dt);
        }
        let momentum = gains.inertia.component_mul(&rate);
        gains.inertia.component_mul(&acceleration) + rate.cross(&momentum)
    }

    /// Takes on new gains without a jump.
    pub fn retune(&mut self, old: &AttitudeGains, new: &AttitudeGains) {
        for (pid, (old, new)) in self.rate.iter_mut().zip(old.rate.iter().zip(new.rate.iter())) {
            pid.retune(old, new);
        }
    }

    /// Forgets the integrals: for the time on the ground.
    pub fn reset_integrals(&mut self) {
        self.rate = Default::default();
    }
}

/// The proportional loop on the attitude error, in rad/s, inside the rate limits.
#[inline]
fn rate_setpoint(
    gains: &AttitudeGains,
    setpoint: &AttitudeSetpoint,
    age: f32,
    attitude: Quaternion,
) -> Vector3 {
    let error = (attitude.conjugate() * setpoint.attitude).shortest();
    let turn = Vector3::new(error.x, error.y, error.z) * 2.0 + setpoint.rate * age;
    let wanted = gains.attitude.component_mul(&turn) + setpoint.rate;
    Vector3::new(
        saturate(wanted.x, gains.rate_max.x),
        saturate(wanted.y, gains.rate_max.y),
        saturate(wanted.z, gains.rate_max.z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use windhover_math::{Euler, scalar};

    const DT: f32 = 1e-3;

    fn inertia() -> Vector3 {
        Vector3::new(7.5e-3, 7.5e-3, 1.3e-2)
    }

    fn setpoint(attitude: Quaternion, rate: Vector3) -> AttitudeSetpoint {
        AttitudeSetpoint {
            attitude,
            rate,
            thrust: 6.4,
        }
    }

    /// A free rigid body with an ideal torque, by small steps; attitude error after `seconds`.
    fn settle(
        gains: &AttitudeGains,
        mut now: AttitudeEstimate,
        wanted: &AttitudeSetpoint,
        seconds: f32,
    ) -> f32 {
        let mut controller = AttitudeController::default();
        for _ in 0..(seconds / DT) as u32 {
            let torque = controller.step(gains, wanted, 0.0, &now, Vector3::zeros(), DT);
            let momentum = inertia().component_mul(&now.rate);
            now.rate += (torque - now.rate.cross(&momentum)).component_div(&inertia()) * DT;
            now.attitude = (now.attitude * Quaternion::from_small_rotation(now.rate * DT)).normalized();
        }
        let error = (now.attitude.conjugate() * wanted.attitude).shortest();
        2.0 * scalar::norm(Vector3::new(error.x, error.y, error.z))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// From any attitude, upside down included, to any other, with no singularity.
        #[test]
        fn reaches_any_attitude_from_any_other(
            a in prop::array::uniform3(-3.1f32..3.1), b in prop::array::uniform3(-3.1f32..3.1),
        ) {
            let gains = AttitudeGains::new(&AttitudeParameters { heading_p: 6.0, ..Default::default() }, inertia());
            let euler = |e: [f32; 3]| Quaternion::from_euler(Euler { roll: e[0], pitch: e[1] * 0.5, yaw: e[2] });
            let now = AttitudeEstimate { attitude: euler(a), rate: Vector3::zeros() };
            let left = settle(&gains, now, &setpoint(euler(b), Vector3::zeros()), 8.0);
            prop_assert!(left < 0.02, "{left} rad left");
        }
    }

    #[test]
    fn the_gyroscopic_torque_is_taken_out() {
        let parameters = AttitudeParameters {
            tilt_rate_d: 0.0,
            ..Default::default()
        };
        let gains = AttitudeGains::new(&parameters, inertia());
        let rate = Vector3::new(1.0, 0.5, -1.2);
        let now = AttitudeEstimate {
            attitude: Quaternion::IDENTITY,
            rate,
        };
        // Turning exactly as demanded: the only torque left is the one that keeps it so.
        let torque = AttitudeController::default().step(
            &gains,
            &setpoint(Quaternion::IDENTITY, rate),
            0.0,
            &now,
            Vector3::zeros(),
            DT,
        );
        let expected = rate.cross(&inertia().component_mul(&rate));
        assert!(
            scalar::norm(torque - expected) < 1e-6,
            "{torque} against {expected}"
        );
    }

    #[test]
    fn an_old_setpoint_has_turned_on_with_its_rate() {
        let gains = AttitudeGains::new(&AttitudeParameters::default(), inertia());
        let rate = Vector3::new(0.4, -0.2, 0.1);
        let turned = Quaternion::from_small_rotation(rate * 0.004);
        let now = AttitudeEstimate {
            attitude: turned,
            rate,
        };
        let old = AttitudeController::default().step(
            &gains,
            &setpoint(Quaternion::IDENTITY, rate),
            0.004,
            &now,
            Vector3::zeros(),
            DT,
        );
        let fresh = AttitudeController::default().step(
            &gains,
            &setpoint(turned, rate),
            0.0,
            &now,
            Vector3::zeros(),
            DT,
        );
        assert!(scalar::norm(old - fresh) < 1e-6, "{old} against {fresh}");
    }

    #[test]
    fn rate_limits_hold() {
        let parameters = AttitudeParameters::default();
        let gains = AttitudeGains::new(&parameters, inertia());
        let upside_down = Quaternion::new(0.0, 1.0, 0.0, 0.0);
        let wanted = rate_setpoint(
            &gains,
            &setpoint(upside_down, Vector3::zeros()),
            0.0,
            Quaternion::IDENTITY,
        );
        assert_eq!(wanted.x, parameters.tilt_rate_max);
    }

    #[test]
    fn retuning_does_not_jump() {
        let old = AttitudeGains::new(&AttitudeParameters::default(), inertia());
        let new = AttitudeGains::new(
            &AttitudeParameters {
                tilt_rate_p: 60.0,
                tilt_rate_d: 0.1,
                ..Default::default()
            },
            inertia(),
        );
        let wanted = setpoint(
            Quaternion::from_small_rotation(Vector3::new(0.1, 0.0, 0.0)),
            Vector3::zeros(),
        );
        let now = AttitudeEstimate {
            attitude: Quaternion::IDENTITY,
            rate: Vector3::new(0.3, 0.0, 0.0),
        };
        let mut controller = AttitudeController::default();
        for _ in 0..20 {
            controller.step(&old, &wanted, 0.0, &now, Vector3::zeros(), DT);
        }
        let mut retuned = controller;
        retuned.retune(&old, &new);
        let without = controller.step(&old, &wanted, 0.0, &now, Vector3::zeros(), DT);
        let with = retuned.step(&new, &wanted, 0.0, &now, Vector3::zeros(), DT);
        assert!(
            scalar::norm(with - without) < 1e-5 * 7.5,
            "{with} after {without}"
        );
    }
}
