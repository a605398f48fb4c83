//! What the controllers know of the vehicle.

use windhover_math::Vector3;
use windhover_parameters::parameters;

parameters! {
    /// Mass, inertia, rotors and their places: the figures that turn demands into rotor speeds.
    ///
    /// Rotors are numbered like PX4's quad X: 1 front right, 2 rear left (both counter-clockwise
    /// seen from above), 3 front left, 4 rear right (both clockwise). A plus frame is the X
    /// turned by −45°: 1 front, 2 rear, 3 left, 4 right.
    pub struct VehicleParameters {
        mass: "MASS", "kg", 0.02..=50.0, 0.65, "Take-off mass that the controllers reckon with";
        inertia_xx: "INERTIA_XX", "kg m^2", 1e-6..=10.0, 7.5e-3, "Moment of inertia about the front axis";
        inertia_yy: "INERTIA_YY", "kg m^2", 1e-6..=10.0, 7.5e-3, "Moment of inertia about the right axis";
        inertia_zz: "INERTIA_ZZ", "kg m^2", 1e-6..=10.0, 1.3e-2, "Moment of inertia about the down axis";
        thrust_coefficient: "ROTOR_KF", "N s^2", 1e-9..=0.1, 3.13e-5, "Thrust of one rotor over its speed squared, eq. (7)";
        torque_coefficient: "ROTOR_KM", "N m s^2", 1e-11..=0.01, 7.5e-7, "Reaction torque of one rotor over its speed squared, eq. (5.4)";
        rotor_speed_max: "ROTOR_SPEED_MAX", "rad/s", 10.0..=10000.0, 400.0, "Rotor speed at full command";
        rotor_lag: "ROTOR_LAG", "s", 0.001..=0.5, 0.03, "Time constant of the rotors";
        rotor0_x: "CA_ROTOR0_PX", "m", -2.0..=2.0, 0.23, "Rotor 1, forward of the centre of mass";
        rotor0_y: "CA_ROTOR0_PY", "m", -2.0..=2.0, 0.0, "Rotor 1, right of the centre of mass";
        rotor1_x: "CA_ROTOR1_PX", "m", -2.0..=2.0, -0.23, "Rotor 2, forward of the centre of mass";
        rotor1_y: "CA_ROTOR1_PY", "m", -2.0..=2.0, 0.0, "Rotor 2, right of the centre of mass";
        rotor2_x: "CA_ROTOR2_PX", "m", -2.0..=2.0, 0.0, "Rotor 3, forward of the centre of mass";
        rotor2_y: "CA_ROTOR2_PY", "m", -2.0..=2.0, -0.23, "Rotor 3, right of the centre of mass";
        rotor3_x: "CA_ROTOR3_PX", "m", -2.0..=2.0, 0.0, "Rotor 4, forward of the centre of mass";
        rotor3_y: "CA_ROTOR3_PY", "m", -2.0..=2.0, 0.23, "Rotor 4, right of the centre of mass";
    }
}

impl VehicleParameters {
    /// Moments of inertia about the body axes, kg·m².
    pub fn inertia(&self) -> Vector3 {
        Vector3::new(self.inertia_xx, self.inertia_yy, self.inertia_zz)
    }

    /// Rotor places (forward, right) in m, in the core's order.
    pub fn rotor_positions(&self) -> [(f32, f32); 4] {
        [
            (self.rotor0_x, self.rotor0_y),
            (self.rotor1_x, self.rotor1_y),
            (self.rotor2_x, self.rotor2_y),
            (self.rotor3_x, self.rotor3_y),
        ]
    }

    /// Largest thrust of one rotor, N.
    pub fn rotor_thrust_max(&self) -> f32 {
        self.thrust_coefficient * self.rotor_speed_max * self.rotor_speed_max
    }
}
