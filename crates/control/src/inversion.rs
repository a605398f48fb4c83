//! The angle inversion, equation (12): which roll and pitch make a demanded horizontal force.
//!
//! Equation (11) gives the horizontal force of a thrust P at roll γ, pitch ϑ and heading ψ. In
//! NED, with N and E the demanded force, its exact inverse is
//!
//! - φ_d = arcsin((E cosψ − N sinψ)/P),
//! - θ_d = arccos((N cosψ + E sinψ)/(P cosφ_d)) − π/2.
//!
//! The paper prints (12.2) without the cosine of the roll and without the quarter turn, which
//! gives 90° at hover (design, section 1). A demand that would tilt the vehicle further than
//! allowed is shortened, and keeps its direction.

use windhover_math::{acos, asin, sin_cos, sqrt};

/// Roll and pitch in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollPitch {
    /// Roll φ, positive to the right.
    pub roll: f32,
    /// Pitch θ, positive nose up.
    pub pitch: f32,
}

/// Roll and pitch at which a `thrust` (N, positive) has the horizontal components `north` and
/// `east` (N), at the heading whose sine and cosine are given. Demands beyond `thrust` ×
/// `sin_tilt_max` are shortened to that; a thrust that is not positive asks for level.
pub fn roll_pitch(
    north: f32,
    east: f32,
    thrust: f32,
    heading_sin_cos: (f32, f32),
    sin_tilt_max: f32,
) -> RollPitch {
    let level = RollPitch {
        roll: 0.0,
        pitch: 0.0,
    };
    let horizontal = sqrt(north * north + east * east);
    if !(thrust > 0.0 && horizontal.is_finite()) {
        return level;
    }
    let reach = thrust * sin_tilt_max;
    let share = if horizontal > reach {
        reach / horizontal
    } else {
        1.0
    } / thrust;
    let (sin, cos) = heading_sin_cos;
    // Components along the heading and to its right, as shares of the thrust.
    let forward = (north * cos + east * sin) * share;
    let right = (east * cos - north * sin) * share;
    let roll = asin(right);
    let cos_roll = sqrt(1.0 - right * right);
    if cos_roll <= 0.0 {
        return RollPitch { roll, pitch: 0.0 };
    }
    RollPitch {
        roll,
        pitch: acos(forward / cos_roll) - core::f32::consts::FRAC_PI_2,
    }
}

/// Equation (11) in NED: the horizontal force (north, east) in N of a `thrust` in N at this roll,
/// pitch and heading in rad.
pub fn horizontal_force(thrust: f32, attitude: RollPitch, heading: f32) -> (f32, f32) {
    let (sin_roll, cos_roll) = sin_cos(attitude.roll);
    let (sin, cos) = sin_cos(heading);
    let forward = -thrust * cos_roll * windhover_math::sin(attitude.pitch);
    let right = thrust * sin_roll;
    (forward * cos - right * sin, forward * sin + right * cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Equation (11) as printed, in the paper's frame (x forward, y up, z right), f64.
    fn equation_11(p: f64, roll: f64, pitch: f64, yaw: f64) -> (f64, f64) {
        use libm::{cos, sin};
        let ux = p * (-cos(roll) * cos(yaw) * sin(pitch) + sin(roll) * sin(yaw));
        let uz = p * (cos(roll) * sin(yaw) * sin(pitch) + sin(roll) * cos(yaw));
        (ux, uz)
    }

    /// Equation (12) as printed where it is right, corrected where it is not (design, section 1).
    fn equation_12(p: f64, ux: f64, uz: f64, yaw: f64) -> (f64, f64) {
        use libm::{acos, asin, cos, sin};
        let roll = asin((uz * cos(yaw) + ux * sin(yaw)) / p);
        let pitch = core::f64::consts::FRAC_PI_2 - acos((uz * sin(yaw) - ux * cos(yaw)) / (p * cos(roll)));
        (roll, pitch)
    }

    proptest! {
        /// The paper's ψ is about its up axis, ours about down: ψ_paper = −ψ; x is north, z east.
        #[test]
        fn equals_the_literal_equations(
            roll in -1.2f64..1.2, pitch in -1.2f64..1.2, yaw in -3.1f64..3.1, thrust in 0.5f64..60.0,
        ) {
            let (ux, uz) = equation_11(thrust, roll, pitch, -yaw);
            let (north, east) = horizontal_force(
                thrust as f32,
                RollPitch { roll: roll as f32, pitch: pitch as f32 },
                yaw as f32,
            );
            prop_assert!((f64::from(north) - ux).abs() < 1e-6 * thrust * 4.0);
            prop_assert!((f64::from(east) - uz).abs() < 1e-6 * thrust * 4.0);
            let (paper_roll, paper_pitch) = equation_12(thrust, ux, uz, -yaw);
            let ours = roll_pitch(ux as f32, uz as f32, thrust as f32, sin_cos(yaw as f32), 1.0);
            prop_assert!((f64::from(ours.roll) - paper_roll).abs() < 3e-6);
            prop_assert!((f64::from(ours.pitch) - paper_pitch).abs() < 1e-5);
        }

        /// Whatever attitude makes a force, the inversion of that force is this attitude.
        #[test]
        fn round_trip_over_all_feasible_attitudes(
            roll in -1.2f32..1.2, pitch in -1.2f32..1.2, yaw in -7.0f32..7.0, thrust in 0.1f32..200.0,
        ) {
            let wanted = RollPitch { roll, pitch };
            let (north, east) = horizontal_force(thrust, wanted, yaw);
            let back = roll_pitch(north, east, thrust, sin_cos(yaw), 1.0);
            prop_assert!((back.roll - roll).abs() < 5e-6, "{back:?} for {wanted:?}");
            prop_assert!((back.pitch - pitch).abs() < 2e-5, "{back:?} for {wanted:?}");
        }

        /// Too large a demand: the tilt is the largest allowed, and the direction is the demand's.
        #[test]
        fn too_large_a_demand_keeps_its_direction(
            direction in -3.1f32..3.1, excess in 1.0f32..1e6, yaw in -3.1f32..3.1, sin_max in 0.1f32..0.9,
        ) {
            let (sin, cos) = sin_cos(direction);
            let demand = 7.0 * sin_max * excess;
            let angles = roll_pitch(demand * cos, demand * sin, 7.0, sin_cos(yaw), sin_max);
            let (north, east) = horizontal_force(7.0, angles, yaw);
            let made = sqrt(north * north + east * east);
            prop_assert!((made - 7.0 * sin_max).abs() < 1e-4);
            prop_assert!((north * sin - east * cos).abs() < 1e-4, "sideways");
            prop_assert!(north * cos + east * sin > 0.0, "backwards");
        }

        /// No input, however wild, makes anything but finite angles.
        #[test]
        fn always_finite(north in any::<f32>(), east in any::<f32>(), thrust in any::<f32>(), yaw in any::<f32>(), sin_max in 0.0f32..1.0) {
            let angles = roll_pitch(north, east, thrust, sin_cos(yaw), sin_max);
            prop_assert!(angles.roll.is_finite() && angles.pitch.is_finite());
        }
    }

    /// The reason for the correction: (12.2) as printed asks for 90° at hover.
    #[test]
    fn the_printed_12_2_is_wrong_at_hover_and_ours_is_level() {
        let printed = libm::acos(0.0);
        assert!((printed - core::f64::consts::FRAC_PI_2).abs() < 1e-12);
        let ours = roll_pitch(0.0, 0.0, 6.4, sin_cos(0.7), 0.6);
        assert!(ours.roll.abs() < 1e-6 && ours.pitch.abs() < 1e-6, "{ours:?}");
    }
}
