//! The PID controller, equation (10) with a time step.
//!
//! The paper prints u = P·E + I·ΣE + D·(E_t − E_{t−1}); here the sum is multiplied by the time
//! step and the difference divided by it, so that gains keep their meaning at every rate (the
//! printed form is `dt` = 1). The derivative is an argument: of the error where the setpoint's
//! own derivative is known, of the measurement where it is not ([`Differentiator`] filters it).
//!
//! The integral is kept in units of the output, and follows how much of the last output really
//! took effect (tracking anti-windup): while the actuator is saturated it grows no further in that
//! direction and shrinks to what fits, at most to nothing. It never turns against the other terms,
//! as plain back-calculation does after a large step, with a long tail. [`Pid::retune`] moves it
//! when gains change, so that the output is continuous.

use windhover_math::Vector3;

/// Gains of one PID controller in parallel form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidGains {
    /// Output per unit of error.
    pub p: f32,
    /// Output per unit of error and second.
    pub i: f32,
    /// Output per unit of error per second.
    pub d: f32,
    /// How fast the integral follows what the actuator could not do, in 1/s.
    pub tracking: f32,
}

/// The memory of one PID controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pid {
    integral: f32,
    error: f32,
    derivative: f32,
}

impl Pid {
    /// One step: the output for `error` and its `derivative` (per second), `dt` seconds after the
    /// last one. `shortfall` is what the actuator added to the last output (applied − demanded,
    /// in units of the output; 0 when it was not saturated).
    #[inline]
    pub fn step(&mut self, gains: &PidGains, error: f32, derivative: f32, shortfall: f32, dt: f32) -> f32 {
        let growth = gains.i * error * dt;
        self.integral = if shortfall == 0.0 {
            self.integral + growth
        } else {
            unwound(self.integral, growth, gains.tracking * shortfall * dt)
        };
        self.error = error;
        self.derivative = derivative;
        gains.p * error + self.integral + gains.d * derivative
    }

    /// Takes on new gains without a jump: the next output for the same error and derivative is
    /// the one that the old gains would have given.
    pub fn retune(&mut self, old: &PidGains, new: &PidGains) {
        self.integral += (old.p - new.p) * self.error + (old.d - new.d) * self.derivative;
    }

    /// Forgets everything; the integral starts at zero.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// The proportional term of the last step for this gain, in units of the output.
    pub fn proportional(&self, gain: f32) -> f32 {
        gain * self.error
    }

    /// The integral term, in units of the output.
    pub fn integral(&self) -> f32 {
        self.integral
    }
}

/// The integral after a step that would add `growth`, pulled back by `pull` (both in units of the
/// output): a pull keeps it from growing against the pull, and takes it to zero at the most.
fn unwound(integral: f32, growth: f32, pull: f32) -> f32 {
    let into_saturation = growth * pull < 0.0;
    let grown = if into_saturation {
        integral
    } else {
        integral + growth
    };
    if grown * pull >= 0.0 {
        return grown;
    }
    let pulled = grown + pull;
    if pulled * grown > 0.0 { pulled } else { 0.0 }
}

/// Derivative of a measurement in three axes, behind a first-order low-pass filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Differentiator {
    last: Option<Vector3>,
    derivative: Vector3,
}

impl Differentiator {
    /// The filtered derivative, per second, after a new `measurement`, `dt` seconds after the
    /// last; `time_constant` of the filter in s. The first measurement has none: zero.
    #[inline]
    pub fn step(&mut self, measurement: Vector3, time_constant: f32, dt: f32) -> Vector3 {
        if let Some(last) = self.last {
            // (raw − filtered)·dt/(T + dt), with raw = difference/dt
            let inverse = 1.0 / (time_constant + dt);
            self.derivative += (measurement - last - self.derivative * dt) * inverse;
        }
        self.last = Some(measurement);
        self.derivative
    }
}

/// Share of the way that a first-order low-pass filter with this time constant (s) goes in `dt`.
#[inline]
pub fn low_pass_share(time_constant: f32, dt: f32) -> f32 {
    dt / (time_constant + dt)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAINS: PidGains = PidGains {
        p: 2.0,
        i: 0.5,
        d: 0.25,
        tracking: 4.0,
    };

    #[test]
    fn printed_form_of_equation_10_at_a_time_step_of_one() {
        let errors = [0.3f32, -1.2, 2.0, 0.7, 0.0, -0.4];
        let mut pid = Pid::default();
        let mut last = 0.0;
        for t in 0..errors.len() {
            let literal = GAINS.p * errors[t]
                + GAINS.i * errors[..=t].iter().sum::<f32>()
                + GAINS.d * (errors[t] - last);
            let step = pid.step(&GAINS, errors[t], errors[t] - last, 0.0, 1.0);
            assert!((step - literal).abs() < 1e-6, "{step} against {literal} at {t}");
            last = errors[t];
        }
    }

    /// A double integrator x'' = u with u = p·e + d·e' has the closed form
    /// e(t) = e0·exp(−σt)(cos ωt + σ/ω sin ωt), σ = d/2, ω² = p − σ².
    #[test]
    fn step_response_of_a_double_integrator_is_the_closed_form() {
        let gains = PidGains {
            p: 9.0,
            i: 0.0,
            d: 3.0,
            tracking: 0.0,
        };
        let (mut x, mut v, mut pid) = (0.0f32, 0.0f32, Pid::default());
        let dt = 1e-4f32;
        let (sigma, omega) = (1.5f64, 6.75f64.sqrt());
        for n in 0..30_000 {
            let t = f64::from(n) * 1e-4;
            let exact = libm::exp(-sigma * t) * (libm::cos(omega * t) + sigma / omega * libm::sin(omega * t));
            assert!(
                (f64::from(1.0 - x) - exact).abs() < 1e-3,
                "at {t} s: {} against {exact}",
                1.0 - x
            );
            let u = pid.step(&gains, 1.0 - x, -v, 0.0, dt);
            v += u * dt;
            x += v * dt;
        }
    }

    #[test]
    fn the_integral_removes_a_constant_disturbance() {
        let gains = PidGains {
            p: 9.0,
            i: 6.0,
            d: 5.0,
            tracking: 0.0,
        };
        let (mut x, mut v, mut pid) = (0.0f32, 0.0f32, Pid::default());
        for _ in 0..20_000 {
            let u = pid.step(&gains, 1.0 - x, -v, 0.0, 1e-3) - 3.0;
            v += u * 1e-3;
            x += v * 1e-3;
        }
        assert!((x - 1.0).abs() < 1e-4 && (pid.integral() - 3.0).abs() < 1e-3);
    }

    #[test]
    fn a_saturated_actuator_does_not_wind_the_integral_up() {
        let mut pid = Pid::default();
        let mut shortfall = 0.0;
        for _ in 0..100_000 {
            let output = pid.step(&GAINS, 10.0, 0.0, shortfall, 1e-3);
            shortfall = output.clamp(-1.0, 1.0) - output;
        }
        assert_eq!(pid.integral(), 0.0, "the proportional term alone saturates");
        // Once the error changes sign the output leaves the limit at once.
        assert!(pid.step(&GAINS, -1.0, 0.0, shortfall, 1e-3) < -1.0);
    }

    /// An integral that is needed, because a constant load pulls, is kept as far as it fits.
    #[test]
    fn a_saturated_actuator_keeps_the_integral_that_fits() {
        let (mut pid, mut shortfall) = (Pid::default(), 0.0);
        for _ in 0..100_000 {
            let output = pid.step(&GAINS, 0.1, 0.0, shortfall, 1e-3);
            shortfall = output.clamp(-1.0, 1.0) - output;
        }
        assert!((pid.integral() - 0.8).abs() < 0.02, "{}", pid.integral());
    }

    /// A large step against a limit leaves nothing behind that would have to decay.
    #[test]
    fn a_saturated_step_leaves_no_integral_against_it() {
        let (mut pid, mut shortfall) = (Pid::default(), 0.0);
        for _ in 0..1000 {
            let output = pid.step(&GAINS, 50.0, 0.0, shortfall, 1e-3);
            shortfall = output.clamp(-1.0, 1.0) - output;
        }
        assert!(pid.integral() >= 0.0);
    }

    #[test]
    fn retuning_in_flight_does_not_jump() {
        let mut pid = Pid::default();
        for n in 0..100 {
            pid.step(&GAINS, (n as f32) * 0.01, 1.0, 0.0, 0.01);
        }
        let before = pid.step(&GAINS, 1.0, 1.0, 0.0, 0.0);
        let new = PidGains {
            p: 5.0,
            i: 2.0,
            d: 0.0,
            tracking: 1.0,
        };
        pid.retune(&GAINS, &new);
        let after = pid.step(&new, 1.0, 1.0, 0.0, 0.0);
        assert!((before - after).abs() < 1e-5, "{before} to {after}");
    }

    #[test]
    fn the_differentiator_settles_to_a_ramps_slope_as_its_filter_says() {
        let along = |value| Vector3::new(value, 0.0, -value);
        let mut derivative = Differentiator::default();
        assert_eq!(derivative.step(along(5.0), 0.05, 1e-3), Vector3::zeros());
        let mut value = 5.0f32;
        let mut last = Vector3::zeros();
        for _ in 0..50 {
            value += 3.0e-3;
            last = derivative.step(along(value), 0.05, 1e-3);
        }
        // One time constant after a ramp of slope 3 has begun.
        let exact = 3.0 * (1.0 - libm::exp(-1.0)) as f32;
        assert!((last - along(exact)).amax() < 0.03, "{last} against {exact}");
    }
}
