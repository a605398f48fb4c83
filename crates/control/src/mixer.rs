//! The mixer: thrust and torque into four rotor speeds, equation (5) inverted, from geometry.
//!
//! A rotor at (x, y) makes thrust f and reaction torque s·(k_z/k_f)·f, s = +1 when it turns
//! counter-clockwise seen from above. In FRD: T = Σf, M_x = −Σ y·f, M_y = Σ x·f,
//! M_z = Σ s·(k_z/k_f)·f. This covers the plus frame of the paper and X frames alike.
//!
//! When the rotors cannot do it all, roll and pitch come first, then thrust, then heading.
//! Torques are shortened, never turned round.

use windhover_math::{Vector3, max, min, sqrt};

use crate::VehicleParameters;

/// Direction of rotation in the core's rotor order: +1 is counter-clockwise from above.
pub const SPIN: [f32; 4] = [1.0, 1.0, -1.0, -1.0];

/// Full scale of a rotor command.
pub const FULL_COMMAND: f32 = 65_535.0;

/// Thrust (N, up along −z_B) and torque (FRD, N·m) together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Collective thrust in N.
    pub thrust: f32,
    /// Torque about the body axes in N·m.
    pub torque: Vector3,
}

/// What the mixer made of a demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed {
    /// Rotor commands, 65535·ω/ω_max, in the core's rotor order.
    pub command: [u16; 4],
    /// The wrench that these commands make: the demand, where nothing was saturated.
    pub applied: Wrench,
    /// Whether a rotor limit changed the demand.
    pub saturated: bool,
}

/// A vehicle's geometry, inverted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer {
    /// Thrust of each rotor per unit of thrust, roll, pitch and heading torque.
    share: [[f32; 4]; 4],
    thrust_min: f32,
    thrust_max: f32,
    curve: Curve,
    /// The curve of a speed controller at its reference voltage.
    reference: Curve,
}

/// From a rotor's thrust f to its command: √(base + per_thrust·f) + offset.
///
/// With a controller whose share m of the thrust follows the command's square and the rest the
/// command itself (PX4's `THR_MDL_FAC`), f/f_max = m·u² + (1 − m)·u, so that
/// u = √(a² + f/(m·f_max)) − a with a = (1 − m)/(2m).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Curve {
    base: f32,
    per_thrust: f32,
    offset: f32,
}

impl Curve {
    fn new(share: f32, thrust_max: f32) -> Self {
        let a = (1.0 - share) / (2.0 * share) * FULL_COMMAND;
        Self {
            base: a * a,
            per_thrust: FULL_COMMAND * FULL_COMMAND / (share * thrust_max),
            offset: 0.5 - a,
        }
    }

    /// The same with commands that are `gain` times as large.
    fn times(&self, gain: f32) -> Self {
        Self {
            base: self.base * (gain * gain),
            per_thrust: self.per_thrust * (gain * gain),
            offset: (self.offset - 0.5) * gain + 0.5,
        }
    }
}

impl Mixer {
    /// The mixer of this vehicle, whose rotors turn with at least `idle` (0 to 1) of their
    /// largest speed in flight, and of whose thrust the share `squared` (above 0, to 1) follows the
    /// command's square. `None` when four rotors in these places cannot make every torque, or the
    /// vehicle's figures are not positive.
    pub fn new(vehicle: &VehicleParameters, idle: f32, squared: f32) -> Option<Self> {
        let kappa = vehicle.torque_coefficient / vehicle.thrust_coefficient;
        let thrust_max = vehicle.rotor_thrust_max();
        let positions = vehicle.rotor_positions();
        let column = |n: usize| -> [f32; 4] {
            let (x, y) = positions.get(n).copied().unwrap_or((0.0, 0.0));
            [1.0, -y, x, SPIN.get(n).copied().unwrap_or(0.0) * kappa]
        };
        let share = invert_columns([column(0), column(1), column(2), column(3)])?;
        let well_formed =
            share.iter().all(|of_rotor| of_rotor[0] > 0.01) && thrust_max > 0.0 && thrust_max.is_finite();
        let reference = Curve::new(squared, thrust_max);
        well_formed.then_some(Self {
            share,
            thrust_min: idle * idle * thrust_max,
            thrust_max,
            curve: reference,
            reference,
        })
    }

    /// Makes all commands `gain` times as large as at the reference voltage: for a battery that sags.
    pub fn set_gain(&mut self, gain: f32) {
        self.curve = self.reference.times(gain);
    }

    /// Rotor commands for a demanded wrench. While `landed`, thrust is never raised to make room
    /// for a torque: the torque is shortened instead.
    #[inline]
    pub fn mix(&self, demand: &Wrench, landed: bool) -> Mixed {
        let wanted = self.rotor_thrusts(demand.thrust, demand.torque);
        let fits = wanted
            .iter()
            .all(|&f| f >= self.thrust_min && f <= self.thrust_max);
        if fits {
            return Mixed {
                command: wanted.map(|thrust| self.command(thrust)),
                applied: *demand,
                saturated: false,
            };
        }
        let applied = self.saturate(demand, landed);
        // Rounding can leave a thrust a hair outside its limits.
        let inside = |thrust| max(self.thrust_min, min(self.thrust_max, thrust));
        let thrusts = self.rotor_thrusts(applied.thrust, applied.torque);
        Mixed {
            command: thrusts.map(|thrust| self.command(inside(thrust))),
            applied,
            saturated: true,
        }
    }

    /// Thrust of each rotor in N for a wrench, whether it can make it or not.
    #[inline]
    fn rotor_thrusts(&self, thrust: f32, torque: Vector3) -> [f32; 4] {
        let mut rotors = [0.0; 4];
        for (rotor, share) in rotors.iter_mut().zip(&self.share) {
            *rotor = share[0] * thrust + share[1] * torque.x + share[2] * torque.y + share[3] * torque.z;
        }
        rotors
    }

    /// The command that makes this thrust; the conversion saturates.
    #[inline]
    fn command(&self, thrust: f32) -> u16 {
        let curve = &self.curve;
        (sqrt(curve.base + curve.per_thrust * thrust) + curve.offset) as u16
    }

    /// The nearest wrench that the rotors can make: roll and pitch before thrust before heading.
    #[inline(never)]
    fn saturate(&self, demand: &Wrench, landed: bool) -> Wrench {
        let tilt = self.rotor_thrusts(0.0, Vector3::new(demand.torque.x, demand.torque.y, 0.0));
        let span = self.tilt_scale(&tilt);
        let mut scale = span;
        let (low, high) = self.thrust_range(&tilt, scale);
        let mut thrust = max(low, min(high, demand.thrust));
        if landed && low > demand.thrust {
            thrust = max(demand.thrust, self.thrust_range(&[0.0; 4], 0.0).0);
            scale = min(span, self.room(&tilt, thrust, &[0.0; 4]));
        }
        let heading = self.rotor_thrusts(0.0, Vector3::new(0.0, 0.0, demand.torque.z));
        let scaled_tilt = tilt.map(|f| f * scale);
        let heading_scale = self.room(&heading, thrust, &scaled_tilt);
        Wrench {
            thrust,
            torque: Vector3::new(
                demand.torque.x * scale,
                demand.torque.y * scale,
                demand.torque.z * heading_scale,
            ),
        }
    }

    /// The largest share (0 to 1) of the roll and pitch torque for which some thrust exists:
    /// for every two rotors i, j the least thrust that i allows is at most the most that j allows.
    fn tilt_scale(&self, tilt: &[f32; 4]) -> f32 {
        let mut scale = 1.0;
        for (i, share_i) in tilt.iter().zip(&self.share) {
            for (j, share_j) in tilt.iter().zip(&self.share) {
                let steep = j / share_j[0] - i / share_i[0];
                let room = self.thrust_max / share_j[0] - self.thrust_min / share_i[0];
                if steep > 0.0 && room < steep * scale {
                    scale = max(0.0, room / steep);
                }
            }
        }
        scale
    }

    /// Least and greatest collective thrust at which every rotor stays inside its limits.
    fn thrust_range(&self, tilt: &[f32; 4], scale: f32) -> (f32, f32) {
        let (mut low, mut high) = (0.0, f32::INFINITY);
        for (f, share) in tilt.iter().zip(&self.share) {
            low = max(low, (self.thrust_min - f * scale) / share[0]);
            high = min(high, (self.thrust_max - f * scale) / share[0]);
        }
        (low, high)
    }

    /// The largest share (0 to 1) of `more` that fits on top of `thrust` and `tilt`.
    fn room(&self, more: &[f32; 4], thrust: f32, tilt: &[f32; 4]) -> f32 {
        let mut scale = 1.0;
        for ((more, tilt), share) in more.iter().zip(tilt).zip(&self.share) {
            let base = share[0] * thrust + tilt;
            let room = if *more > 0.0 {
                self.thrust_max - base
            } else {
                base - self.thrust_min
            };
            let need = more.abs();
            if room < need * scale {
                scale = max(0.0, room / need);
            }
        }
        scale
    }
}

/// Inverse of the matrix with these columns, by Gauss and Jordan; row n of the result belongs to
/// column n. `None` when it is singular for practical purposes.
fn invert_columns(columns: [[f32; 4]; 4]) -> Option<[[f32; 4]; 4]> {
    // Rows of [A | 1], A with the given columns: row r is the r-th entry of every column.
    let mut rows = [[0.0f32; 8]; 4];
    for (r, row) in rows.iter_mut().enumerate() {
        for (place, column) in row.iter_mut().zip(&columns) {
            *place = column.get(r).copied()?;
        }
        *row.get_mut(4 + r)? = 1.0;
    }
    for n in 0..4 {
        let scale = columns
            .iter()
            .map(|column| column.get(n).map_or(0.0, |v| v.abs()))
            .fold(0.0, max);
        let pivot = (n..4).reduce(|best, r| {
            if entry(&rows, r, n).abs() > entry(&rows, best, n).abs() {
                r
            } else {
                best
            }
        })?;
        let of_pivot = *rows.get(pivot)?;
        let value = of_pivot.get(n).copied()?;
        if !value.is_finite() || value.abs() <= 1e-4 * scale {
            return None;
        }
        *rows.get_mut(pivot)? = *rows.get(n)?;
        let normalised = of_pivot.map(|v| v / value);
        *rows.get_mut(n)? = normalised;
        for (r, row) in rows.iter_mut().enumerate() {
            let factor = row.get(n).copied()?;
            if r != n {
                for (place, v) in row.iter_mut().zip(&normalised) {
                    *place -= factor * v;
                }
            }
        }
    }
    Some(rows.map(|[_, _, _, _, a, b, c, d]| [a, b, c, d]))
}

fn entry(rows: &[[f32; 8]; 4], row: usize, column: usize) -> f32 {
    rows.get(row)
        .and_then(|row| row.get(column))
        .copied()
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plus() -> VehicleParameters {
        VehicleParameters::default()
    }

    fn x_frame() -> VehicleParameters {
        VehicleParameters {
            mass: 1.4,
            thrust_coefficient: 1.105e-5,
            torque_coefficient: 1.779e-7,
            rotor_speed_max: 1006.6,
            rotor0_x: 0.16,
            rotor0_y: 0.16,
            rotor1_x: -0.16,
            rotor1_y: -0.16,
            rotor2_x: 0.16,
            rotor2_y: -0.16,
            rotor3_x: -0.16,
            rotor3_y: 0.16,
            ..Default::default()
        }
    }

    /// A frame whose rotors stand unevenly about the centre of mass.
    fn uneven() -> VehicleParameters {
        VehicleParameters {
            rotor0_x: 0.2,
            rotor0_y: 0.1,
            rotor1_x: -0.15,
            rotor1_y: -0.2,
            ..x_frame()
        }
    }

    fn frames() -> [VehicleParameters; 3] {
        [plus(), x_frame(), uneven()]
    }

    /// The wrench that rotor commands make, from geometry, in f64.
    fn wrench_of(vehicle: &VehicleParameters, command: [u16; 4]) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for (n, (x, y)) in vehicle.rotor_positions().into_iter().enumerate() {
            let speed = f64::from(command[n]) / 65535.0 * f64::from(vehicle.rotor_speed_max);
            let thrust = f64::from(vehicle.thrust_coefficient) * speed * speed;
            sum[0] += thrust;
            sum[1] -= f64::from(y) * thrust;
            sum[2] += f64::from(x) * thrust;
            sum[3] += f64::from(SPIN[n]) * f64::from(vehicle.torque_coefficient) * speed * speed;
        }
        sum
    }

    fn as_array(wrench: &Wrench) -> [f64; 4] {
        [wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z].map(f64::from)
    }

    /// Equation (5) literally, with the arm (design, section 1): M1 rear, M2 right, M3 front,
    /// M4 left; in FRD M_x = U2, M_y = −U3, M_z = −U4.
    #[test]
    fn equation_5_in_the_papers_numbering() {
        let vehicle = plus();
        let mixer = Mixer::new(&vehicle, 0.05, 1.0).unwrap();
        let demand = Wrench {
            thrust: 7.0,
            torque: Vector3::new(0.1, -0.07, 0.02),
        };
        let speeds = mixer
            .mix(&demand, false)
            .command
            .map(|c| f64::from(c) / 65535.0 * 400.0);
        let [front, rear, left, right] = speeds;
        let (w1, w2, w3, w4) = (rear * rear, right * right, front * front, left * left);
        let (kf, kz, l) = (3.13e-5, 7.5e-7, 0.23);
        assert!((kf * (w1 + w2 + w3 + w4) - 7.0).abs() < 1e-3);
        assert!((l * kf * (w4 - w2) - 0.1).abs() < 1e-3, "U2");
        assert!((l * kf * (w1 - w3) - 0.07).abs() < 1e-3, "U3");
        assert!((kz * (-w1 + w2 - w3 + w4) + 0.02).abs() < 1e-4, "U4");
    }

    proptest! {
        /// Mixer times geometry is the identity, wherever nothing saturates; and what is said to
        /// have been applied is what the commands make, saturated or not.
        #[test]
        fn mixer_times_geometry_is_the_identity(
            frame in 0usize..3, lift in 0.0f32..1.5, roll in -1.0f32..1.0, pitch in -1.0f32..1.0, yaw in -1.0f32..1.0,
            landed in any::<bool>(),
        ) {
            let vehicle = frames()[frame];
            let mixer = Mixer::new(&vehicle, 0.05, 1.0).unwrap();
            let full = 4.0 * vehicle.rotor_thrust_max();
            let demand = Wrench {
                thrust: lift * full,
                torque: Vector3::new(roll * 0.1 * full, pitch * 0.1 * full, yaw * 0.01 * full),
            };
            let mixed = mixer.mix(&demand, landed);
            let made = wrench_of(&vehicle, mixed.command);
            let tolerance = f64::from(full) * 2e-4;
            for (made, said) in made.into_iter().zip(as_array(&mixed.applied)) {
                prop_assert!((made - said).abs() < tolerance, "{mixed:?} for {demand:?} makes {made}");
            }
            if !mixed.saturated {
                prop_assert_eq!(mixed.applied, demand);
            }
        }

        /// Saturation shortens roll and pitch together and never turns them, or heading, round.
        #[test]
        fn saturation_never_flips_a_torque(
            frame in 0usize..3, lift in -1.0f32..3.0, torque in prop::array::uniform3(-100.0f32..100.0), landed in any::<bool>(),
        ) {
            let vehicle = frames()[frame];
            let mixer = Mixer::new(&vehicle, 0.05, 1.0).unwrap();
            let thrust = lift * 4.0 * vehicle.rotor_thrust_max();
            let demand = Wrench { thrust, torque: Vector3::from(torque) };
            let applied = mixer.mix(&demand, landed).applied;
            for n in 0..3 {
                let share = applied.torque[n] / demand.torque[n];
                prop_assert!((0.0..=1.0 + 1e-6).contains(&share) || demand.torque[n] == 0.0, "{share}");
            }
            prop_assert!((applied.torque.x * demand.torque.y - applied.torque.y * demand.torque.x).abs() < 1e-2);
            if landed && thrust > 1.0 {
                prop_assert!(applied.thrust <= thrust * (1.0 + 1e-6), "thrust raised while landed");
            }
        }

        /// No demand, however wild, makes anything but a command inside the limits.
        #[test]
        fn always_inside_the_limits(thrust in any::<f32>(), torque in prop::array::uniform3(any::<f32>()), landed in any::<bool>()) {
            let mixer = Mixer::new(&plus(), 0.1, 1.0).unwrap();
            let command = mixer.mix(&Wrench { thrust, torque: Vector3::from(torque) }, landed).command;
            prop_assert!(command.iter().all(|&c| c >= 6553), "{command:?}");
        }
    }

    #[test]
    fn roll_and_pitch_before_thrust_before_heading() {
        let vehicle = x_frame();
        let mixer = Mixer::new(&vehicle, 0.05, 1.0).unwrap();
        let full = 4.0 * vehicle.rotor_thrust_max();
        // Near full thrust: thrust gives way to roll, heading to both.
        let demand = Wrench {
            thrust: full,
            torque: Vector3::new(1.0, 0.0, 0.5),
        };
        let applied = mixer.mix(&demand, false).applied;
        assert!(
            (applied.torque.x - 1.0).abs() < 1e-4 && applied.thrust < full && applied.torque.z.abs() < 1e-4
        );
        // With no thrust asked for in flight, thrust is raised to make the roll torque.
        let demand = Wrench {
            thrust: 0.0,
            torque: Vector3::new(1.0, 0.0, 0.0),
        };
        let applied = mixer.mix(&demand, false).applied;
        assert!((applied.torque.x - 1.0).abs() < 1e-4 && applied.thrust > 1.0);
        // On the ground it is not.
        let applied = mixer.mix(&demand, true).applied;
        assert!(
            applied.torque.x < 0.2 && applied.thrust < 0.02 * full,
            "{applied:?}"
        );
    }

    #[test]
    fn a_geometry_that_cannot_fly_is_refused() {
        let in_line = VehicleParameters {
            rotor2_y: 0.0,
            rotor3_y: 0.0,
            rotor2_x: 0.1,
            rotor3_x: -0.1,
            ..plus()
        };
        assert_eq!(Mixer::new(&in_line, 0.05, 1.0), None);
        let one_sided = VehicleParameters {
            rotor0_x: -0.23,
            rotor1_x: -0.3,
            ..plus()
        };
        assert_eq!(Mixer::new(&one_sided, 0.05, 1.0), None);
    }

    proptest! {
        /// Whatever the controller's curve and the gain, putting the command through the curve gives
        /// the thrust that was wanted: if this failed, a vehicle with such controllers would hover on
        /// its integrals, or hold its attitude with other gains than were set.
        #[test]
        fn the_thrust_curve_is_inverted(squared in 0.1f32..=1.0, gain in 1.0f32..1.2, lift in 0.2f32..0.6) {
            let vehicle = x_frame();
            let mut mixer = Mixer::new(&vehicle, 0.05, squared).unwrap();
            mixer.set_gain(gain);
            let most = vehicle.rotor_thrust_max();
            let demand = Wrench { thrust: 4.0 * most * lift, torque: Vector3::new(0.1, -0.2, 0.02) };
            let mixed = mixer.mix(&demand, false);
            let thrusts = mixer.rotor_thrusts(demand.thrust, demand.torque);
            for (command, wanted) in mixed.command.into_iter().zip(thrusts) {
                let signal = f32::from(command) / FULL_COMMAND / gain;
                let made = most * (squared * signal * signal + (1.0 - squared) * signal);
                prop_assert!((made - wanted).abs() < 2e-4 * most, "{made} for {wanted}");
            }
        }
    }
}
