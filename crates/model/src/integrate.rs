//! Integration of the models: Runge-Kutta of order four, and semi-implicit Euler.
//!
//! A state consists of coordinates and speeds, in equal arithmetic for every model. The inputs
//! of a step (rotor speeds) are known at its start, in its middle and at its end.

/// Where in a step a derivative is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// At its start.
    Start,
    /// In its middle.
    Middle,
    /// At its end.
    End,
}

/// A state of coordinates and speeds. The derivative of a state has the same type.
pub trait State: Copy {
    /// `self + rate·dt`.
    fn plus(self, rate: &Self, dt: f64) -> Self;
    /// The speeds advanced by `rate·dt`, the coordinates left.
    fn kick(self, rate: &Self, dt: f64) -> Self;
    /// The coordinates advanced by the present speeds, the speeds left.
    fn drift(self, dt: f64) -> Self;
    /// Rounded back onto its constraints.
    #[inline(always)]
    fn constrained(self) -> Self {
        self
    }
}

/// How a step is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Runge-Kutta of order four.
    Rk4,
    /// Semi-implicit Euler: speeds first, then coordinates by the new speeds. Order one.
    #[default]
    SemiImplicitEuler,
}

/// One step of Runge-Kutta, order four.
#[inline(always)]
pub fn rk4<S: State>(x: S, dt: f64, derivative: impl Fn(&S, Stage) -> S) -> S {
    let half = 0.5 * dt;
    let k1 = derivative(&x, Stage::Start);
    let k2 = derivative(&x.plus(&k1, half), Stage::Middle);
    let k3 = derivative(&x.plus(&k2, half), Stage::Middle);
    let k4 = derivative(&x.plus(&k3, dt), Stage::End);
    let slopes = k1.plus(&k2, 2.0).plus(&k3, 2.0).plus(&k4, 1.0);
    x.plus(&slopes, dt / 6.0).constrained()
}

/// One step of semi-implicit Euler. The inputs count at the middle of the step.
#[inline(always)]
pub fn semi_implicit_euler<S: State>(x: S, dt: f64, derivative: impl Fn(&S, Stage) -> S) -> S {
    let rate = derivative(&x, Stage::Middle);
    x.kick(&rate, dt).drift(dt).constrained()
}

/// One step of the chosen kind.
#[inline(always)]
pub fn step<S: State>(integrator: Integrator, x: S, dt: f64, derivative: impl Fn(&S, Stage) -> S) -> S {
    match integrator {
        Integrator::Rk4 => rk4(x, dt, derivative),
        Integrator::SemiImplicitEuler => semi_implicit_euler(x, dt, derivative),
    }
}

/// Six coordinates and their six speeds: the state of the models with Euler angles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SixDegrees {
    /// Coordinates in m and rad; which they are is the model's to say.
    pub coordinate: [f64; 6],
    /// Their rates of change in m/s and rad/s.
    pub speed: [f64; 6],
}

#[inline(always)]
fn scaled_sum(a: [f64; 6], b: &[f64; 6], s: f64) -> [f64; 6] {
    core::array::from_fn(|i| a[i] + b[i] * s)
}

impl State for SixDegrees {
    #[inline(always)]
    fn plus(self, rate: &Self, dt: f64) -> Self {
        Self {
            coordinate: scaled_sum(self.coordinate, &rate.coordinate, dt),
            speed: scaled_sum(self.speed, &rate.speed, dt),
        }
    }
    #[inline(always)]
    fn kick(self, rate: &Self, dt: f64) -> Self {
        Self {
            speed: scaled_sum(self.speed, &rate.speed, dt),
            ..self
        }
    }
    #[inline(always)]
    fn drift(self, dt: f64) -> Self {
        Self {
            coordinate: scaled_sum(self.coordinate, &self.speed, dt),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A damped pendulum with large swings, pushed by a force that depends on time.
    fn swing(integrator: Integrator, steps: u32) -> f64 {
        let dt = 2.0 / f64::from(steps);
        let mut x = SixDegrees::default();
        x.coordinate[0] = 1.5;
        for n in 0..steps {
            let start = f64::from(n) * dt;
            x = step(integrator, x, dt, |s, stage| {
                let time = match stage {
                    Stage::Start => start,
                    Stage::Middle => start + 0.5 * dt,
                    Stage::End => start + dt,
                };
                let force = libm::sin(3.0 * time);
                let mut rate = SixDegrees {
                    coordinate: s.speed,
                    speed: [0.0; 6],
                };
                rate.speed[0] = -9.0 * libm::sin(s.coordinate[0]) - 0.3 * s.speed[0] + force;
                rate
            });
        }
        x.coordinate[0]
    }

    /// Order from three successive halvings of the step.
    fn order(integrator: Integrator, steps: u32) -> f64 {
        let [a, b, c] = [1, 2, 4].map(|k| swing(integrator, k * steps));
        libm::log2(((a - b) / (b - c)).abs())
    }

    #[test]
    fn runge_kutta_is_of_order_four() {
        let order = order(Integrator::Rk4, 200);
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn semi_implicit_euler_is_of_order_one() {
        let order = order(Integrator::SemiImplicitEuler, 2000);
        assert!((order - 1.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn both_agree_in_the_limit() {
        let difference = swing(Integrator::Rk4, 1000) - swing(Integrator::SemiImplicitEuler, 100_000);
        assert!(difference.abs() < 1e-4, "{difference}");
    }
}
