//! The model `rigid`: a full rigid body with body rates, quaternion and rotor momentum.
//!
//! m v̇ = m g e_z − T R e_z + drag + pushes
//! I ω̇ = M − ω × (I ω) − ω × h,  h = −J_r Ω_r e_z (down)
//! q̇ = ½ q ⊗ (0, ω)
//!
//! World NED, body FRD. The reaction to spinning a rotor up, J_r dΩ_r/dt about down, is left
//! out, as it is in equation (8).

use windhover_math::Vector3;

use crate::body::{Body, Outside};
use crate::kinematics::{Kinematics, attitude_rate};
use crate::rotor::Wrench;

/// Rate of change of the state: velocity, acceleration, attitude rate, angular acceleration.
#[inline(always)]
pub fn derivative(body: &Body, state: &Kinematics, wrench: &Wrench, outside: &Outside) -> Kinematics {
    let thrust = state.attitude.down_axis() * (wrench.thrust * body.inverse_mass);
    Kinematics {
        position: state.velocity,
        velocity: body.outside_acceleration(state.velocity, outside) - thrust,
        attitude: attitude_rate(state.attitude, state.body_rate),
        body_rate: angular_acceleration(body, state.body_rate, wrench),
    }
}

/// Euler's equation with a diagonal inertia, in rad/s².
#[inline(always)]
fn angular_acceleration(body: &Body, rate: Vector3<f64>, wrench: &Wrench) -> Vector3<f64> {
    let mut momentum = body.inertia.component_mul(&rate);
    momentum.z -= wrench.spin;
    (wrench.torque - rate.cross(&momentum)).component_mul(&body.inverse_inertia)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{Integrator, step};
    use crate::length::Length;
    use crate::payload::Payload;
    use crate::vehicle::Vehicle;
    use windhover_math::{Euler, Quaternion};

    fn body(inertia: [f64; 3], drag: f64) -> Body {
        let mut plant = Vehicle::named("os4").unwrap().plant;
        plant.inertia = inertia;
        plant.linear_drag = drag;
        Body::new(&plant, Payload::NONE)
    }

    fn tumbling() -> Kinematics {
        Kinematics {
            velocity: Vector3::new(1.0, -2.0, -3.0),
            body_rate: Vector3::new(3.0, -2.0, 1.0),
            attitude: Quaternion::from_euler(Euler {
                roll: 0.3,
                pitch: -0.5,
                yaw: 2.0,
            }),
            ..Kinematics::default()
        }
    }

    /// Energy in J and angular momentum in NED of a body with rotors of momentum `spin`.
    fn invariants(body: &Body, state: &Kinematics, spin: f64) -> (f64, Vector3<f64>) {
        let rotation = body.inertia.component_mul(&state.body_rate);
        let energy = 0.5 * state.body_rate.dot(&rotation)
            + body.mass * (0.5 * state.velocity.length_squared() - crate::GRAVITY * state.position.z);
        let momentum = rotation - Vector3::new(0.0, 0.0, spin);
        (energy, state.attitude.rotate(momentum))
    }

    fn fly(integrator: Integrator, dt: f64, time: f64, wrench: &Wrench) -> (Body, Kinematics) {
        let body = body([7.5e-3, 9e-3, 1.3e-2], 0.0);
        let mut state = tumbling();
        for _ in 0..(time / dt).round() as u32 {
            state = step(integrator, state, dt, |s, _| {
                derivative(&body, s, wrench, &Outside::default())
            });
        }
        (body, state)
    }

    #[test]
    fn a_free_body_keeps_energy_and_angular_momentum_for_a_minute() {
        for spin in [0.0, 0.01] {
            let wrench = Wrench {
                spin,
                ..Wrench::default()
            };
            let (body, end) = fly(Integrator::Rk4, 1e-3, 60.0, &wrench);
            let (energy, momentum) = invariants(&body, &tumbling(), spin);
            let (energy_end, momentum_end) = invariants(&body, &end, spin);
            // It has fallen for a minute: kinetic and potential energy are some 100 kJ each.
            assert!((energy_end - energy).abs() < 1e-6, "{energy} {energy_end}");
            assert!(
                (momentum_end - momentum).length() < 1e-9 * momentum.length(),
                "{momentum_end}"
            );
            assert!(
                (end.body_rate - tumbling().body_rate).length() > 0.1,
                "must tumble"
            );
            assert!((end.attitude.dot(end.attitude) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn semi_implicit_euler_loses_momentum_in_the_first_order_only() {
        let loss = |dt: f64| {
            let (body, end) = fly(Integrator::SemiImplicitEuler, dt, 2.0, &Wrench::default());
            let before = invariants(&body, &tumbling(), 0.0).1;
            (invariants(&body, &end, 0.0).1 - before).length() / before.length()
        };
        let ratio = loss(1e-3) / loss(5e-4);
        assert!(
            loss(1e-3) < 0.01 && (ratio - 2.0).abs() < 0.05,
            "{} {ratio}",
            loss(1e-3)
        );
    }

    /// The state after one second of a manoeuvre with every term in play.
    fn manoeuvre(integrator: Integrator, steps: u32) -> Kinematics {
        let body = body([7.5e-3, 9e-3, 1.3e-2], 0.25);
        let dt = 1.0 / f64::from(steps);
        let wrench = Wrench {
            thrust: 8.0,
            torque: Vector3::new(0.01, -0.02, 0.005),
            spin: 0.01,
        };
        let outside = Outside {
            wind: Vector3::new(4.0, 2.0, 0.0),
            ..Outside::default()
        };
        let mut state = tumbling();
        for _ in 0..steps {
            state = step(integrator, state, dt, |s, _| {
                derivative(&body, s, &wrench, &outside)
            });
        }
        state
    }

    fn order(integrator: Integrator, steps: u32) -> f64 {
        let [a, b, c] = [1, 2, 4].map(|k| {
            let s = manoeuvre(integrator, k * steps);
            let q = s.attitude.shortest();
            [
                s.position.x,
                s.position.z,
                s.velocity.y,
                s.body_rate.x,
                s.body_rate.z,
                q.x,
                q.y,
            ]
        });
        let gap = |a: [f64; 7], b: [f64; 7]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b) * (a - b))
                .sum::<f64>()
                .sqrt()
        };
        libm::log2(gap(a, b) / gap(b, c))
    }

    #[test]
    fn the_integrators_have_their_orders_on_the_rigid_body() {
        let four = order(Integrator::Rk4, 100);
        let one = order(Integrator::SemiImplicitEuler, 1000);
        assert!((four - 4.0).abs() < 0.15, "{four}");
        assert!((one - 1.0).abs() < 0.1, "{one}");
    }

    #[test]
    fn a_spinning_top_precesses() {
        // Surplus of counter-clockwise rotors, momentum up: rolling to the right turns it
        // towards the right, and the reaction pitches the body up... by the right hand:
        // −ω × h with ω = p e_x, h = −s e_z is −p s e_y.
        let body = body([7.5e-3, 7.5e-3, 1.3e-2], 0.0);
        let wrench = Wrench {
            spin: 0.02,
            ..Wrench::default()
        };
        let rate = Vector3::new(1.0, 0.0, 0.0);
        let acceleration = angular_acceleration(&body, rate, &wrench);
        assert!((acceleration - Vector3::new(0.0, -0.02 / 7.5e-3, 0.0)).length() < 1e-12);
    }
}
