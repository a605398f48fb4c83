//! The model `paper`: equation (8), twelve states.
//!
//! In the paper's own frame inside: x forward, y left, z up from the start, Euler angles φ, θ, ψ
//! and their rates of change, on which the torques act as printed. Its rotors are M1 rear, M2
//! right, M3 front, M4 left, 1 and 3 counter-clockwise; the inputs (5) and (6), with the arm
//! that (5.2) and (5.3) lack, are body torques: U2 = M_x, U3 = −M_y, U4 = −M_z for front, right,
//! down. So they follow from the geometry of any frame.
//!
//! Converted at the border: north = x, east = −y, down = −z, and roll = φ, pitch = −θ,
//! heading = −ψ. Besides what is printed, the air drags, pushes push, and rotors lag.

use windhover_math::rotation::body_rate_from_euler_rate;
use windhover_math::{Euler, Quaternion, Vector3};

use crate::body::{Body, Outside};
use crate::integrate::SixDegrees;
use crate::kinematics::Kinematics;
use crate::rotor::Wrench;

/// Rate of change of the state x, y, z, φ, θ, ψ and its speeds.
#[inline]
pub fn derivative(body: &Body, state: &SixDegrees, wrench: &Wrench, outside: &Outside) -> SixDegrees {
    let [_, _, _, phi, theta, psi] = state.coordinate;
    let [vx, vy, vz, phi_rate, theta_rate, psi_rate] = state.speed;
    let (sin_phi, cos_phi) = libm::sincos(phi);
    let (sin_theta, cos_theta) = libm::sincos(theta);
    let (sin_psi, cos_psi) = libm::sincos(psi);
    let (ix, iy, iz) = (body.inertia.x, body.inertia.y, body.inertia.z);
    let [u1, u2, u3, u4] = inputs(wrench);
    let spin = wrench.spin; // J_r Ω_r
    let lift = u1 / body.mass;
    // (9)
    let ux = cos_phi * sin_theta * cos_psi + sin_phi * sin_psi;
    let uy = cos_phi * sin_theta * sin_psi - sin_phi * cos_psi;
    // Gravity, drag and pushes come in NED.
    let besides = body.outside_acceleration(Vector3::new(vx, -vy, -vz), outside);
    SixDegrees {
        coordinate: state.speed,
        speed: [
            ux * lift + besides.x,
            uy * lift - besides.y,
            cos_phi * cos_theta * lift - besides.z,
            ((iy - iz) * theta_rate * psi_rate - spin * theta_rate + u2) / ix,
            ((iz - ix) * phi_rate * psi_rate + spin * phi_rate + u3) / iy,
            ((ix - iy) * phi_rate * theta_rate + u4) / iz,
        ],
    }
}

/// The inputs U1 to U4 of (5), in N and N·m.
#[inline(always)]
fn inputs(wrench: &Wrench) -> [f64; 4] {
    let torque = wrench.torque;
    [wrench.thrust, torque.x, -torque.y, -torque.z]
}

/// From the paper's frame to NED and FRD; the body rate is W(φ, θ) times the Euler rates.
#[inline]
pub fn to_kinematics(state: &SixDegrees) -> Kinematics {
    let [x, y, z, phi, theta, psi] = state.coordinate;
    let [vx, vy, vz, phi_rate, theta_rate, psi_rate] = state.speed;
    let euler = Euler {
        roll: phi,
        pitch: -theta,
        yaw: -psi,
    };
    let rate = Euler {
        roll: phi_rate,
        pitch: -theta_rate,
        yaw: -psi_rate,
    };
    Kinematics {
        position: Vector3::new(x, -y, -z),
        velocity: Vector3::new(vx, -vy, -vz),
        attitude: Quaternion::from_euler(euler),
        body_rate: body_rate_from_euler_rate(euler, rate),
    }
}

/// From NED and FRD to the paper's frame. A pitch of ±90° has no Euler rates.
pub fn from_kinematics(state: &Kinematics) -> SixDegrees {
    let (p, v, rate) = (state.position, state.velocity, state.body_rate);
    let euler = state.attitude.to_euler();
    let (sin_roll, cos_roll) = libm::sincos(euler.roll);
    let (sin_pitch, cos_pitch) = libm::sincos(euler.pitch);
    let yaw_rate = (rate.y * sin_roll + rate.z * cos_roll) / cos_pitch;
    let pitch_rate = rate.y * cos_roll - rate.z * sin_roll;
    let roll_rate = rate.x + sin_pitch * yaw_rate;
    SixDegrees {
        coordinate: [p.x, -p.y, -p.z, euler.roll, -euler.pitch, -euler.yaw],
        speed: [v.x, -v.y, -v.z, roll_rate, -pitch_rate, -yaw_rate],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::payload::Payload;
    use crate::rotor::RotorForces;
    use crate::vehicle::{Plant, Vehicle};
    use proptest::prelude::*;

    /// Equations (5) to (9) letter by letter in the paper's own frame and rotor numbers, with
    /// the arm `l` in (5.2) and (5.3).
    #[rustfmt::skip]
    fn printed(plant: &Plant, l: f64, x: &[f64; 12], w: &[f64; 4]) -> [f64; 12] {
        let (m, g, k_f, k_z, j_r) = (plant.mass, 9.806_65, plant.k_f, plant.k_z, plant.rotor_inertia);
        let [i_x, i_y, i_z] = plant.inertia;
        let (w1, w2, w3, w4) = (w[0], w[1], w[2], w[3]);
        let u_1 = k_f * (w1 * w1 + w2 * w2 + w3 * w3 + w4 * w4);
        let u_2 = l * k_f * (-w2 * w2 + w4 * w4);
        let u_3 = l * k_f * (w1 * w1 - w3 * w3);
        let u_4 = k_z * (-w1 * w1 + w2 * w2 - w3 * w3 + w4 * w4);
        let omega_r = w1 - w2 + w3 - w4;
        let [_, _, _, phi, theta, psi, vx, vy, vz, dphi, dtheta, dpsi] = *x;
        let (cos, sin) = (libm::cos, libm::sin);
        let u_x = cos(phi) * sin(theta) * cos(psi) + sin(phi) * sin(psi);
        let u_y = cos(phi) * sin(theta) * sin(psi) - sin(phi) * cos(psi);
        [
            vx, vy, vz, dphi, dtheta, dpsi,
            u_x * u_1 / m,
            u_y * u_1 / m,
            (cos(phi) * cos(theta)) * u_1 / m - g,
            (i_y - i_z) / i_x * dtheta * dpsi - j_r * omega_r / i_x * dtheta + u_2 / i_x,
            (i_z - i_x) / i_y * dphi * dpsi + j_r * omega_r / i_y * dphi + u_3 / i_y,
            (i_x - i_y) / i_z * dphi * dtheta + u_4 / i_z,
        ]
    }

    fn close(a: &[f64; 12], b: &SixDegrees) -> bool {
        let (low, high) = a.split_at(6);
        let near = |a: &[f64], b: &[f64]| {
            a.iter()
                .zip(b)
                .all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + a.abs()))
        };
        near(low, &b.coordinate) && near(high, &b.speed)
    }

    proptest! {
        #[test]
        fn the_model_is_equation_8(
            x in prop::array::uniform12(-1.4..1.4f64),
            w in prop::array::uniform4(0.0..400.0f64),
        ) {
            let mut plant = Vehicle::named("os4").unwrap().plant;
            plant.inertia = [7e-3, 8e-3, 1.3e-2];
            plant.linear_drag = 0.0;
            let body = Body::new(&plant, Payload::NONE);
            // M1 rear, M2 right, M3 front, M4 left in the core's order: front, rear, left, right.
            let wrench = RotorForces::new(&plant).wrench(&[w[2], w[0], w[3], w[1]]);
            let state = SixDegrees {
                coordinate: core::array::from_fn(|i| x[i]),
                speed: core::array::from_fn(|i| x[i + 6]),
            };
            let rate = derivative(&body, &state, &wrench, &Outside::default());
            prop_assert!(close(&printed(&plant, 0.23, &x, &w), &rate), "{rate:?}");
        }

        #[test]
        fn the_border_goes_both_ways(x in prop::array::uniform12(-1.4..1.4f64)) {
            let state = SixDegrees {
                coordinate: core::array::from_fn(|i| x[i]),
                speed: core::array::from_fn(|i| x[i + 6]),
            };
            let back = from_kinematics(&to_kinematics(&state));
            prop_assert!(close(&x, &back), "{state:?} {back:?}");
        }

        #[test]
        fn thrust_points_where_the_reported_attitude_says(x in prop::array::uniform12(-1.4..1.4f64)) {
            let mut plant = Vehicle::named("os4").unwrap().plant;
            plant.linear_drag = 0.0;
            let body = Body::new(&plant, Payload::NONE);
            let state = SixDegrees {
                coordinate: core::array::from_fn(|i| x[i]),
                speed: core::array::from_fn(|i| x[i + 6]),
            };
            let wrench = Wrench { thrust: plant.mass, ..Wrench::default() };
            let rate = derivative(&body, &state, &wrench, &Outside::default()).speed;
            let up = Vector3::new(rate[0], -rate[1], -rate[2] - crate::GRAVITY);
            let down = to_kinematics(&state).attitude.down_axis();
            prop_assert!((up + down).abs().max() < 1e-12);
        }
    }

    #[test]
    fn drag_and_pushes_act_in_the_papers_frame_too() {
        let plant = Vehicle::named("os4").unwrap().plant;
        let body = Body::new(&plant, Payload::NONE);
        let outside = Outside {
            wind: Vector3::new(4.0, 2.0, 0.0),
            force: Vector3::new(0.0, 0.0, -1.3),
            acceleration: Vector3::new(0.0, 0.5, 0.0),
        };
        let rate = derivative(&body, &SixDegrees::default(), &Wrench::default(), &outside).speed;
        let drag = 0.25 / 0.65;
        let wanted = [4.0 * drag, -2.0 * drag - 0.5, 2.0 - crate::GRAVITY];
        for i in 0..3 {
            assert!((rate[i] - wanted[i]).abs() < 1e-12, "{rate:?}");
        }
    }
}
