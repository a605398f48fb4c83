//! The model `simple`: equation (1), with its three angles that turn independently.
//!
//! N̈ = −u sin θ / m, Ë = u cos θ sin φ / m, ḧ = u cos θ cos φ / m − g, and I α̈ = τ for
//! each angle. North, east and height up, with angles that are positive as in NED.
//!
//! The thrust points along −R e_z for R = R_x(φ) R_y(θ) R_z(ψ) and for no other order: first
//! about the front, then about the right axis, and the heading last, about the thrust itself,
//! so that it does not move the vehicle. That is the attitude reported. The torques are those
//! about front, right and down, taken at heading 0, where the model means something: whoever
//! flies it holds the heading there. Besides what is printed, the air drags, pushes push, and
//! rotors lag.

use windhover_math::{Quaternion, Vector3};

use crate::body::{Body, Outside};
use crate::integrate::SixDegrees;
use crate::kinematics::Kinematics;
use crate::rotor::Wrench;

/// Rate of change of the state north, east, height, φ, θ, ψ and its speeds.
#[inline]
pub fn derivative(body: &Body, state: &SixDegrees, wrench: &Wrench, outside: &Outside) -> SixDegrees {
    let [_, _, _, phi, theta, _] = state.coordinate;
    let [vn, ve, vup, ..] = state.speed;
    let (sin_phi, cos_phi) = libm::sincos(phi);
    let (sin_theta, cos_theta) = libm::sincos(theta);
    let lift = wrench.thrust * body.inverse_mass;
    let besides = body.outside_acceleration(Vector3::new(vn, ve, -vup), outside);
    let turn = wrench.torque.component_mul(&body.inverse_inertia);
    SixDegrees {
        coordinate: state.speed,
        speed: [
            -lift * sin_theta + besides.x,
            lift * cos_theta * sin_phi + besides.y,
            lift * cos_theta * cos_phi - besides.z,
            turn.x,
            turn.y,
            turn.z,
        ],
    }
}

/// The attitude of the angles φ, θ, ψ: R_x(φ) R_y(θ) R_z(ψ).
fn attitude(phi: f64, theta: f64, psi: f64) -> Quaternion<f64> {
    let half = |angle: f64| libm::sincos(0.5 * angle);
    let ((s1, c1), (s2, c2)) = (half(phi), half(theta));
    Quaternion::new(c1, s1, 0.0, 0.0) * Quaternion::new(c2, 0.0, s2, 0.0) * Quaternion::from_heading(psi)
}

/// To NED and FRD.
#[inline]
pub fn to_kinematics(state: &SixDegrees) -> Kinematics {
    let [n, e, up, phi, theta, psi] = state.coordinate;
    let [vn, ve, vup, phi_rate, theta_rate, psi_rate] = state.speed;
    let (sin_theta, cos_theta) = libm::sincos(theta);
    let (sin_psi, cos_psi) = libm::sincos(psi);
    // The first two turns as they are before the third.
    let (x, y) = (phi_rate * cos_theta, theta_rate);
    Kinematics {
        position: Vector3::new(n, e, -up),
        velocity: Vector3::new(vn, ve, -vup),
        attitude: attitude(phi, theta, psi),
        body_rate: Vector3::new(
            x * cos_psi + y * sin_psi,
            y * cos_psi - x * sin_psi,
            psi_rate + phi_rate * sin_theta,
        ),
    }
}

/// From NED and FRD. At θ = ±90° the angles are not defined.
pub fn from_kinematics(state: &Kinematics) -> SixDegrees {
    let (p, v, rate) = (state.position, state.velocity, state.body_rate);
    let matrix = state.attitude.to_matrix();
    let theta = libm::asin(matrix[(0, 2)].clamp(-1.0, 1.0));
    let phi = libm::atan2(-matrix[(1, 2)], matrix[(2, 2)]);
    let psi = libm::atan2(-matrix[(0, 1)], matrix[(0, 0)]);
    let (sin_theta, cos_theta) = libm::sincos(theta);
    let (sin_psi, cos_psi) = libm::sincos(psi);
    let phi_rate = (rate.x * cos_psi - rate.y * sin_psi) / cos_theta;
    let theta_rate = rate.x * sin_psi + rate.y * cos_psi;
    let psi_rate = rate.z - phi_rate * sin_theta;
    SixDegrees {
        coordinate: [p.x, p.y, -p.z, phi, theta, psi],
        speed: [v.x, v.y, -v.z, phi_rate, theta_rate, psi_rate],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{Integrator, step};
    use crate::payload::Payload;
    use crate::truth::turn;
    use crate::vehicle::Vehicle;
    use proptest::prelude::*;

    /// Equation (1) letter by letter: accelerations of x, y, z, ψ, θ, φ.
    fn printed(m: f64, i: [f64; 3], u: f64, tau: [f64; 3], angle: [f64; 3]) -> [f64; 6] {
        let [phi, theta, _psi] = angle;
        let [tau_phi, tau_theta, tau_psi] = tau;
        let [i_phi, i_theta, i_psi] = i;
        let (sin, cos) = (libm::sin, libm::cos);
        [
            -u * sin(theta) / m,
            u * cos(theta) * sin(phi) / m,
            (u * cos(theta) * cos(phi) - m * 9.806_65) / m,
            tau_psi / i_psi,
            tau_theta / i_theta,
            tau_phi / i_phi,
        ]
    }

    fn frictionless() -> Body {
        let mut plant = Vehicle::named("os4").unwrap().plant;
        plant.inertia = [7e-3, 8e-3, 1.3e-2];
        plant.linear_drag = 0.0;
        Body::new(&plant, Payload::NONE)
    }

    fn state_of(x: &[f64; 12]) -> SixDegrees {
        SixDegrees {
            coordinate: core::array::from_fn(|i| x[i]),
            speed: core::array::from_fn(|i| x[i + 6]),
        }
    }

    proptest! {
        #[test]
        fn the_model_is_equation_1(
            x in prop::array::uniform12(-1.4..1.4f64),
            u in 0.0..20.0f64,
            tau in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let wrench = Wrench { thrust: u, torque: Vector3::from(tau), spin: 0.02 };
            let rate = derivative(&frictionless(), &state_of(&x), &wrench, &Outside::default());
            let [ax, ay, az, psi, theta, phi] = printed(0.65, [7e-3, 8e-3, 1.3e-2], u, tau, [x[3], x[4], x[5]]);
            for (found, wanted) in rate.speed.into_iter().zip([ax, ay, az, phi, theta, psi]) {
                prop_assert!((found - wanted).abs() < 1e-9, "{rate:?}");
            }
            prop_assert_eq!(rate.coordinate, state_of(&x).speed);
        }

        #[test]
        fn thrust_points_where_the_reported_attitude_says(x in prop::array::uniform12(-1.4..1.4f64)) {
            let body = frictionless();
            let wrench = Wrench { thrust: body.mass, ..Wrench::default() };
            let rate = derivative(&body, &state_of(&x), &wrench, &Outside::default()).speed;
            let up = Vector3::new(rate[0], rate[1], -rate[2] - crate::GRAVITY);
            let down = to_kinematics(&state_of(&x)).attitude.down_axis();
            prop_assert!((up + down).abs().max() < 1e-12);
        }

        #[test]
        fn the_body_rate_is_that_of_the_attitude(x in prop::array::uniform12(-1.4..1.4f64)) {
            let dt = 1e-5;
            let now = state_of(&x);
            let free = |s: &SixDegrees, _| SixDegrees { coordinate: s.speed, speed: [0.0; 6] };
            let before = step(Integrator::Rk4, now, -dt, free);
            let after = step(Integrator::Rk4, now, dt, free);
            let rate = turn(to_kinematics(&before).attitude, to_kinematics(&after).attitude) / (2.0 * dt);
            let found = to_kinematics(&now).body_rate;
            prop_assert!((rate - found).abs().max() < 1e-7, "{rate} {found}");
        }

        #[test]
        fn the_border_goes_both_ways(x in prop::array::uniform12(-1.4..1.4f64)) {
            let back = from_kinematics(&to_kinematics(&state_of(&x)));
            for i in 0..6 {
                prop_assert!((back.coordinate[i] - x[i]).abs() < 1e-9);
                prop_assert!((back.speed[i] - x[i + 6]).abs() < 1e-9);
            }
        }
    }
}
