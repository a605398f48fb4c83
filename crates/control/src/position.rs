//! Position and height control, equation (13), with what lets it hold the path in wind.
//!
//! In NED and per unit mass, with e the position error and ė the velocity error:
//!
//! - demanded acceleration a = a_ff + K_p·e + K_i∫e + K_d·ė − d,
//! - thrust P = m(g − a_down)/(cosφ cosθ).
//!
//! The paper has no feed-forward a_ff and no disturbance estimate d; its preset sets both to
//! nothing. Printed, the tilt factor of the height equation stands on the proportional term only,
//! and the gains have no units; `POS_FORM` and `POS_GAIN_UNIT` select these readings for the
//! reproduction. The horizontal demand is inverted to roll and pitch by [`crate::inversion`].

use windhover_math::{GRAVITY, Quaternion, Vector3, cos, max, min, saturate, scalar, sin, sin_cos, sqrt};
use windhover_parameters::parameters;

use crate::inversion::roll_pitch;
use crate::pid::{Pid, PidGains};
use crate::{TrajectorySetpoint, VehicleParameters};

parameters! {
    /// Gains and limits of position and height control. Defaults: preset `windhover`, whose
    /// integral action is the disturbance observer's.
    pub struct PositionParameters {
        north_p: "POS_N_P", "1/s^2", 0.0..=100.0, 9.0, "Position gain, north";
        north_i: "POS_N_I", "1/s^3", 0.0..=100.0, 0.0, "Integral gain, north";
        north_d: "POS_N_D", "1/s", 0.0..=50.0, 5.0, "Velocity gain, north";
        east_p: "POS_E_P", "1/s^2", 0.0..=100.0, 9.0, "Position gain, east";
        east_i: "POS_E_I", "1/s^3", 0.0..=100.0, 0.0, "Integral gain, east";
        east_d: "POS_E_D", "1/s", 0.0..=50.0, 5.0, "Velocity gain, east";
        down_p: "POS_D_P", "1/s^2", 0.0..=100.0, 24.0, "Position gain, down";
        down_i: "POS_D_I", "1/s^3", 0.0..=100.0, 0.0, "Integral gain, down";
        down_d: "POS_D_D", "1/s", 0.0..=50.0, 10.0, "Velocity gain, down";
        tracking: "POS_TRACK", "1/s", 0.0..=100.0, 2.0, "How fast integrals follow what tilt and thrust limits took away";
        error_max: "POS_ERR_MAX", "m", 0.1..=1000.0, 4.0, "Position errors count up to this length";
        tilt_max: "POS_TILT_MAX", "rad", 0.05..=1.2, 0.785, "Largest commanded tilt";
        thrust_min: "POS_THR_MIN", "", 0.0..=0.5, 0.05, "Smallest thrust in flight, as a share of the largest";
        thrust_max: "POS_THR_MAX", "", 0.1..=1.0, 0.9, "Largest thrust, as a share of what the rotors have";
        feed_forward: "POS_FF", "", 0.0..=1.0, 1.0, "Share of the path's acceleration and jerk that is fed forward";
        inversion: "POS_INV", "", 0.0..=1.0, 1.0, "Tilt by: 0 the thrust of eq. (13), 1 the demanded force's own length";
        form: "POS_FORM", "", 0.0..=1.0, 0.0, "Height equation: 0 corrected, 1 as printed";
        gain_unit: "POS_GAIN_UNIT", "", 0.0..=1.0, 0.0, "Gains are: 0 per unit mass, 1 forces";
    }
}

impl PositionParameters {
    fn gains(&self) -> [PidGains; 3] {
        let gains = |p, i, d| PidGains {
            p,
            i,
            d,
            tracking: self.tracking,
        };
        [
            gains(self.north_p, self.north_i, self.north_d),
            gains(self.east_p, self.east_i, self.east_d),
            gains(self.down_p, self.down_i, self.down_d),
        ]
    }

    /// Table I of the paper as printed, with a plain cascade: no feed-forward beyond the velocity
    /// that equation (13) has, and the thrust of (13) in the inversion.
    pub fn paper() -> Self {
        Self {
            north_p: 8.5,
            north_i: 0.02,
            north_d: 8.1,
            east_p: 4.9,
            east_i: 0.015,
            east_d: 5.1,
            down_p: 24.0,
            down_i: 10.0,
            down_d: 28.0,
            feed_forward: 0.0,
            inversion: 0.0,
            ..Self::default()
        }
    }
}

/// What position control needs to know of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionEstimate {
    /// Position, NED, m.
    pub position: Vector3,
    /// Velocity, NED, m/s.
    pub velocity: Vector3,
    /// Attitude, body to world.
    pub attitude: Quaternion,
    /// Acceleration by wind, payload and everything else that thrust and gravity do not explain,
    /// NED, m/s².
    pub disturbance: Vector3,
}

/// What position control demands of attitude control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeSetpoint {
    /// Attitude, body to world.
    pub attitude: Quaternion,
    /// Body rate that goes with it, rad/s: the attitude is due to turn so.
    pub rate: Vector3,
    /// Collective thrust in N.
    pub thrust: f32,
}

impl AttitudeSetpoint {
    /// Whether it may come in from outside: all finite, a rotation, and a thrust that is not
    /// negative.
    pub fn is_valid(&self) -> bool {
        let norm = self.attitude.dot(self.attitude);
        (0.98..1.02).contains(&norm)
            && scalar::is_finite(self.rate)
            && (0.0..f32::INFINITY).contains(&self.thrust)
    }
}

/// Position and height control with its integrals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PositionController {
    axes: [Pid; 3],
    shortfall: Vector3,
    limit: TiltLimit,
}

/// The largest tilt, rad, with its functions: they change with a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TiltLimit {
    tilt: f32,
    sin: f32,
    cos: f32,
    tan: f32,
}

impl Default for TiltLimit {
    fn default() -> Self {
        Self {
            tilt: 0.0,
            sin: 0.0,
            cos: 1.0,
            tan: 0.0,
        }
    }
}

impl TiltLimit {
    #[inline]
    fn of(&mut self, tilt: f32) -> Self {
        if tilt != self.tilt {
            *self = Self::new(tilt);
        }
        *self
    }

    #[cold]
    fn new(tilt: f32) -> Self {
        let sin = sin(tilt);
        Self {
            tilt,
            sin,
            cos: cos(tilt),
            tan: sin / sqrt(1.0 - sin * sin),
        }
    }
}

impl PositionController {
    /// One step: attitude and thrust for this `setpoint` and `estimate`, `dt` seconds after the
    /// last one. `thrust_shortfall` is what the mixer added to the last thrust (applied −
    /// demanded, N).
    pub fn step(
        &mut self,
        parameters: &PositionParameters,
        vehicle: &VehicleParameters,
        setpoint: &TrajectorySetpoint,
        estimate: &PositionEstimate,
        thrust_shortfall: f32,
        dt: f32,
    ) -> AttitudeSetpoint {
        let (limit, cos_tilt) = self.begin(parameters, vehicle, estimate, thrust_shortfall);
        let feedback = self.feedback(parameters, vehicle, setpoint, estimate, dt);
        let demand = feedback + setpoint.acceleration * parameters.feed_forward - estimate.disturbance;

        let (lift, thrust) = self.height(parameters, vehicle, demand.z, cos_tilt);
        let force = self.horizontal(vehicle, demand, lift, limit.tan);
        let inversion_thrust = if parameters.inversion > 0.5 {
            scalar::norm(Vector3::new(force.0, force.1, lift))
        } else {
            thrust
        };
        let heading = sin_cos(setpoint.heading);
        let angles = roll_pitch(force.0, force.1, inversion_thrust, heading, limit.sin);
        let attitude = Quaternion::from_euler(windhover_math::Euler {
            roll: angles.roll,
            pitch: angles.pitch,
            yaw: setpoint.heading,
        });
        AttitudeSetpoint {
            attitude,
            rate: body_rate(
                attitude,
                setpoint,
                inversion_thrust / vehicle.mass,
                parameters.feed_forward,
            ),
            thrust,
        }
    }

    /// The height equation alone: the thrust, in N, that leads a vehicle of whatever attitude to the
    /// height of `setpoint`. North and east are somebody else's; their integrals begin anew.
    pub fn lift(
        &mut self,
        parameters: &PositionParameters,
        vehicle: &VehicleParameters,
        setpoint: &TrajectorySetpoint,
        estimate: &PositionEstimate,
        thrust_shortfall: f32,
        dt: f32,
    ) -> f32 {
        let (_, cos_tilt) = self.begin(parameters, vehicle, estimate, thrust_shortfall);
        (self.shortfall.x, self.shortfall.y) = (0.0, 0.0);
        let error = saturate(setpoint.position.z - estimate.position.z, parameters.error_max);
        let rate = setpoint.velocity.z - estimate.velocity.z;
        let per_mass = per_mass(parameters, vehicle);
        let [_, _, gains] = parameters.gains();
        let [north, east, down] = &mut self.axes;
        (*north, *east) = (Pid::default(), Pid::default());
        let feedback = down.step(&gains, error, rate, self.shortfall.z / per_mass, dt) * per_mass;
        let demand = feedback + setpoint.acceleration.z * parameters.feed_forward - estimate.disturbance.z;
        self.height(parameters, vehicle, demand, cos_tilt).1
    }

    /// The tilt limit and the cosine of the tilt, no less than the limit's; what the mixer added to the
    /// last thrust is taken in.
    #[inline]
    fn begin(
        &mut self,
        parameters: &PositionParameters,
        vehicle: &VehicleParameters,
        estimate: &PositionEstimate,
        thrust_shortfall: f32,
    ) -> (TiltLimit, f32) {
        let limit = self.limit.of(parameters.tilt_max);
        let cos_tilt = max(estimate.attitude.cos_tilt(), limit.cos);
        self.shortfall.z -= thrust_shortfall * cos_tilt / vehicle.mass;
        (limit, cos_tilt)
    }

    /// Takes on new gains without a jump.
    pub fn retune(&mut self, old: &PositionParameters, new: &PositionParameters) {
        let gains = old.gains().into_iter().zip(new.gains());
        for (pid, (old, new)) in self.axes.iter_mut().zip(gains) {
            pid.retune(&old, &new);
        }
    }

    /// Forgets the integrals.
    pub fn reset(&mut self) {
        *self = Self {
            limit: self.limit,
            ..Self::default()
        };
    }

    /// The three PID of equation (13), in m/s².
    fn feedback(
        &mut self,
        parameters: &PositionParameters,
        vehicle: &VehicleParameters,
        setpoint: &TrajectorySetpoint,
        estimate: &PositionEstimate,
        dt: f32,
    ) -> Vector3 {
        let error = scalar::limit_norm(setpoint.position - estimate.position, parameters.error_max);
        let rate = setpoint.velocity - estimate.velocity;
        let per_mass = per_mass(parameters, vehicle);
        let [north, east, down] = parameters.gains();
        let [pid_north, pid_east, pid_down] = &mut self.axes;
        let shortfall = self.shortfall / per_mass;
        Vector3::new(
            pid_north.step(&north, error.x, rate.x, shortfall.x, dt),
            pid_east.step(&east, error.y, rate.y, shortfall.y, dt),
            pid_down.step(&down, error.z, rate.z, shortfall.z, dt),
        ) * per_mass
    }

    /// The vertical component of the thrust and the thrust, in N, inside the limits.
    fn height(
        &mut self,
        parameters: &PositionParameters,
        vehicle: &VehicleParameters,
        demand: f32,
        cos_tilt: f32,
    ) -> (f32, f32) {
        let wanted = if parameters.form > 0.5 {
            // m/(cosφ cosθ)·K_p·e + K_i∫e + K_d·ė + m·g: the tilt factor on the first term only.
            let proportional = self.axes[2].proportional(parameters.down_p);
            let rest = demand - proportional * per_mass(parameters, vehicle);
            vehicle.mass * (GRAVITY - rest - proportional / cos_tilt)
        } else {
            vehicle.mass * (GRAVITY - demand) / cos_tilt
        };
        let full = 4.0 * vehicle.rotor_thrust_max();
        let thrust = max(
            parameters.thrust_min * full,
            min(parameters.thrust_max * full, wanted),
        );
        self.shortfall.z = -(thrust - wanted) * cos_tilt / vehicle.mass;
        (thrust * cos_tilt, thrust)
    }

    /// The demanded horizontal force in N, shortened to the tilt limit for this lift.
    fn horizontal(
        &mut self,
        vehicle: &VehicleParameters,
        demand: Vector3,
        lift: f32,
        tan_tilt_max: f32,
    ) -> (f32, f32) {
        let (north, east) = (demand.x * vehicle.mass, demand.y * vehicle.mass);
        let length = sqrt(north * north + east * east);
        let reach = lift * tan_tilt_max;
        let share = if length > reach { reach / length } else { 1.0 };
        self.shortfall.x = demand.x * (share - 1.0);
        self.shortfall.y = demand.y * (share - 1.0);
        (north * share, east * share)
    }
}

/// What turns the unit of the gains into an acceleration.
fn per_mass(parameters: &PositionParameters, vehicle: &VehicleParameters) -> f32 {
    if parameters.gain_unit > 0.5 {
        1.0 / vehicle.mass
    } else {
        1.0
    }
}

/// Faster than this no roll or pitch is fed forward, rad/s.
const RATE_FEED_FORWARD_MAX: f32 = 5.0;

/// The body rate at which a vehicle of that attitude and specific thrust (m/s²) has the
/// setpoint's jerk, and its heading rate: with a − g = −c·z_B, the jerk's share along the body
/// axes is (−c·q, c·p).
fn body_rate(
    attitude: Quaternion,
    setpoint: &TrajectorySetpoint,
    specific_thrust: f32,
    feed_forward: f32,
) -> Vector3 {
    if specific_thrust < 1.0 {
        return Vector3::zeros();
    }
    let jerk = attitude.inverse_rotate(setpoint.jerk) * (feed_forward / specific_thrust);
    let roll_rate = saturate(jerk.y, RATE_FEED_FORWARD_MAX);
    let pitch_rate = saturate(-jerk.x, RATE_FEED_FORWARD_MAX);
    // A rolled vehicle that pitches would turn its heading: r = (ψ̇ cosθ − q sinφ)/cosφ, with
    // the world's down in body axes d = (−sinθ, sinφ cosθ, cosφ cosθ).
    let down = attitude.inverse_rotate(Vector3::new(0.0, 0.0, 1.0));
    let cos_squared_pitch = down.y * down.y + down.z * down.z;
    let yaw_rate = (setpoint.heading_rate * cos_squared_pitch - pitch_rate * down.y) / max(down.z, 0.3);
    Vector3::new(roll_rate, pitch_rate, yaw_rate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use windhover_math::Euler;

    const DT: f32 = 0.004;

    fn estimate(position: Vector3, velocity: Vector3, attitude: Quaternion) -> PositionEstimate {
        PositionEstimate {
            position,
            velocity,
            attitude,
            disturbance: Vector3::zeros(),
        }
    }

    /// Equation (13) with Table I, in the paper's frame (x forward, y up, z right), f64: the
    /// first step, so that the integral is K_i·e·dt.
    fn equation_13(e: [f64; 3], edot: [f64; 3], roll: f64, pitch: f64, m: f64, printed: bool) -> [f64; 3] {
        let (kp, ki, kd) = ([8.5, 24.0, 4.9], [0.02, 10.0, 0.015], [8.1, 28.0, 5.1]);
        let dt = f64::from(DT);
        let pid = |n: usize| kp[n] * e[n] + ki[n] * e[n] * dt + kd[n] * edot[n];
        let tilt = libm::cos(roll) * libm::cos(pitch);
        let height = if printed {
            m / tilt * kp[1] * e[1] + ki[1] * e[1] * dt + kd[1] * edot[1] + m * 9.80665
        } else {
            m * (9.80665 + pid(1)) / tilt
        };
        [pid(0), height, pid(2)]
    }

    proptest! {
        /// The paper's preset is equation (13) inverted by (12), whatever the tilt and heading.
        #[test]
        fn paper_preset_is_the_literal_equation_13(
            e in prop::array::uniform3(-0.12f32..0.12), edot in prop::array::uniform3(-0.1f32..0.1),
            roll in -0.5f32..0.5, pitch in -0.5f32..0.5, printed in any::<bool>(), heading in -3.0f32..3.0,
        ) {
            let parameters = PositionParameters {
                form: if printed { 1.0 } else { 0.0 },
                gain_unit: if printed { 1.0 } else { 0.0 },
                tilt_max: 1.2,
                ..PositionParameters::paper()
            };
            let vehicle = VehicleParameters::default();
            let attitude = Quaternion::from_euler(Euler { roll, pitch, yaw: heading });
            let origin = estimate(Vector3::zeros(), Vector3::zeros(), attitude);
            let mut setpoint = TrajectorySetpoint::at_rest(Vector3::from(e), heading);
            setpoint.velocity = Vector3::from(edot);
            let ours = PositionController::default().step(&parameters, &vehicle, &setpoint, &origin, 0.0, DT);

            let m = f64::from(vehicle.mass);
            let paper_error = [e[0], -e[2], e[1]].map(f64::from);
            let paper_rate = [edot[0], -edot[2], edot[1]].map(f64::from);
            let [ux, thrust, uz] = equation_13(paper_error, paper_rate, f64::from(roll), f64::from(pitch), m, printed);
            let scale = if printed { 1.0 } else { m };
            // Inside the limits of tilt and thrust, of which (13) knows nothing.
            prop_assume!(thrust > 1.1 && libm::hypot(ux, uz) * scale < 0.9 * thrust);
            prop_assert!((f64::from(ours.thrust) - thrust).abs() < 1e-4 * thrust, "{} against {thrust}", ours.thrust);
            let down = ours.attitude.down_axis();
            prop_assert!((f64::from(-down.x) * thrust - ux * scale).abs() < 1e-4 * thrust);
            prop_assert!((f64::from(-down.y) * thrust - uz * scale).abs() < 1e-4 * thrust);
        }

        /// With feed-forward, no error and no lead, thrust and attitude make the demanded
        /// acceleration exactly, the disturbance included.
        #[test]
        fn thrust_direction_makes_the_demanded_acceleration(
            a in prop::array::uniform3(-4.0f32..4.0), d in prop::array::uniform3(-2.0f32..2.0), heading in -3.0f32..3.0,
        ) {
            let parameters = PositionParameters { tilt_max: 1.2, ..Default::default() };
            let vehicle = VehicleParameters::default();
            let mut setpoint = TrajectorySetpoint::at_rest(Vector3::zeros(), heading);
            setpoint.acceleration = Vector3::from(a);
            let mut at = estimate(Vector3::zeros(), Vector3::zeros(), Quaternion::IDENTITY);
            at.disturbance = Vector3::from(d);
            // Two rounds: the thrust counts on the attitude that the vehicle has.
            let first = PositionController::default().step(&parameters, &vehicle, &setpoint, &at, 0.0, DT);
            at.attitude = first.attitude;
            let then = PositionController::default().step(&parameters, &vehicle, &setpoint, &at, 0.0, DT);
            let made = then.attitude.down_axis() * (-then.thrust / vehicle.mass)
                + Vector3::new(0.0, 0.0, GRAVITY) + at.disturbance;
            prop_assert!(scalar::norm(made - setpoint.acceleration) < 2e-3, "{made} for {a:?}");
            prop_assert!((then.attitude.heading() - heading).abs() < 1e-5);
        }

        /// The height alone is led as it is with the place: the same thrust over many steps, its limits
        /// and integral included; where the vehicle is over ground changes nothing.
        #[test]
        fn lift_is_the_height_equation_of_a_step(
            heights in prop::collection::vec((-8.0f32..8.0, -3.0f32..3.0, -1.0f32..1.0), 1..40),
            roll in -0.4f32..0.4, pitch in -0.4f32..0.4, north in -50.0f32..50.0, printed in any::<bool>(),
        ) {
            let parameters = PositionParameters {
                down_i: 2.0, form: if printed { 1.0 } else { 0.0 }, ..Default::default()
            };
            let vehicle = VehicleParameters::default();
            let attitude = Quaternion::from_euler(Euler { roll, pitch, yaw: 0.3 });
            let (mut whole, mut alone) = (PositionController::default(), PositionController::default());
            for (down, climb, added) in heights {
                let setpoint = TrajectorySetpoint::at_rest(Vector3::new(0.0, 0.0, down), 0.3);
                let mut at = estimate(Vector3::zeros(), Vector3::new(0.0, 0.0, climb), attitude);
                at.disturbance.z = 0.2 * climb;
                let step = whole.step(&parameters, &vehicle, &setpoint, &at, added, DT);
                at.position.x = north;
                let lift = alone.lift(&parameters, &vehicle, &setpoint, &at, added, DT);
                prop_assert!((lift - step.thrust).abs() < 1e-5 * step.thrust, "{lift} and {}", step.thrust);
            }
        }

        /// Whatever the error, tilt and thrust stay inside their limits.
        #[test]
        fn limits_hold(p in prop::array::uniform3(-1e6f32..1e6), v in prop::array::uniform3(-1e3f32..1e3)) {
            let (parameters, vehicle) = (PositionParameters::default(), VehicleParameters::default());
            let at = estimate(Vector3::from(p), Vector3::from(v), Quaternion::IDENTITY);
            let setpoint = TrajectorySetpoint::at_rest(Vector3::zeros(), 0.3);
            let ours = PositionController::default().step(&parameters, &vehicle, &setpoint, &at, 0.0, DT);
            let full = 4.0 * vehicle.rotor_thrust_max();
            prop_assert!(ours.attitude.cos_tilt() >= cos(parameters.tilt_max) - 1e-5);
            prop_assert!(ours.thrust >= parameters.thrust_min * full && ours.thrust <= parameters.thrust_max * full);
        }
    }

    /// The fed-forward rate is the one at which the thrust direction really turns when the
    /// acceleration changes by the jerk (numerically).
    #[test]
    fn rate_feed_forward_is_the_derivative_of_the_attitude() {
        let parameters = PositionParameters { ..Default::default() };
        let vehicle = VehicleParameters::default();
        let mut setpoint = TrajectorySetpoint::at_rest(Vector3::zeros(), 0.4);
        setpoint.jerk = Vector3::new(3.0, -2.0, 0.0);
        let attitude_at = |t: f32| {
            let mut moved = setpoint;
            moved.acceleration = Vector3::new(1.0, 2.0, 0.0) + setpoint.jerk * t;
            let at = estimate(Vector3::zeros(), Vector3::zeros(), Quaternion::IDENTITY);
            PositionController::default().step(&parameters, &vehicle, &moved, &at, 0.0, DT)
        };
        let turned = attitude_at(-0.01).attitude.conjugate() * attitude_at(0.01).attitude;
        let numerical = Vector3::new(turned.x, turned.y, turned.z) * (2.0 / 0.02);
        let ours = attitude_at(0.0).rate;
        assert!(
            (numerical.x - ours.x).abs() < 2e-3 && (numerical.y - ours.y).abs() < 2e-3,
            "{numerical} against {ours}"
        );
    }

    /// Held against a limit, the integrals stay where one can come back from.
    #[test]
    fn tilt_limit_does_not_wind_up() {
        let (parameters, vehicle) = (PositionParameters::default(), VehicleParameters::default());
        let mut controller = PositionController::default();
        let far = TrajectorySetpoint::at_rest(Vector3::new(1000.0, 0.0, 0.0), 0.0);
        let at = estimate(Vector3::zeros(), Vector3::zeros(), Quaternion::IDENTITY);
        for _ in 0..10_000 {
            controller.step(&parameters, &vehicle, &far, &at, 0.0, DT);
        }
        let back = TrajectorySetpoint::at_rest(Vector3::new(-2.0, 0.0, 0.0), 0.0);
        let pitch = controller
            .step(&parameters, &vehicle, &back, &at, 0.0, DT)
            .attitude
            .to_euler()
            .pitch;
        assert!(pitch > 0.3, "still leaning forward: {pitch}");
    }
}
