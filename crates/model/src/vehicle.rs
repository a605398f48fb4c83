//! Vehicle files: what a vehicle is, and what the core is told about it.
//!
//! A file is TOML with `name`, `description`, `source`, a section `[plant]` (the model's only)
//! and a section `[parameters]` (set into the core's table, which checks the names). The two
//! may differ on purpose: a heavier plant than the core believes is a test of robustness.

use std::collections::BTreeMap;

use serde::Deserialize;
use thiserror::Error;

use crate::GRAVITY;

/// The vehicles that are built in, with their files.
const NAMED: [(&str, &str); 2] = [
    ("os4", include_str!("../../../vehicles/os4.toml")),
    ("x450", include_str!("../../../vehicles/x450.toml")),
];

/// A vehicle file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vehicle {
    /// Short name, as on the command line.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Where the figures come from.
    pub source: String,
    /// What the model flies.
    pub plant: Plant,
    /// What the core is told: parameter names and values, in alphabetical order.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
}

/// The physical vehicle. Rotors are in the core's order, which is PX4's quad X: 1 front right
/// and 2 rear left turn counter-clockwise seen from above, 3 front left and 4 rear right
/// clockwise. A plus frame is the X turned by −45°: 1 front, 2 rear, 3 left, 4 right.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plant {
    /// Mass in kg.
    pub mass: f64,
    /// Moments of inertia about front, right and down, in kg·m².
    pub inertia: [f64; 3],
    /// Rotor positions front and right of the centre of mass, in m.
    pub rotor_position: [[f64; 2]; 4],
    /// Thrust coefficient k_f in N·s²: thrust = k_f ω².
    pub k_f: f64,
    /// Reaction torque coefficient k_z in N·m·s²: torque = k_z ω².
    pub k_z: f64,
    /// Inertia J_r of one rotor about its axis in kg·m².
    pub rotor_inertia: f64,
    /// Rotor speed at full command in rad/s.
    pub rotor_speed_max: f64,
    /// Time constant of the rotor speed in s.
    pub rotor_lag: f64,
    /// Time constant while slowing down in s, where it differs.
    #[serde(default)]
    pub rotor_lag_down: Option<f64>,
    /// Drag force per airspeed in kg/s.
    #[serde(default)]
    pub linear_drag: f64,
    /// Drag force per squared airspeed in kg/m.
    #[serde(default)]
    pub quadratic_drag: f64,
}

/// Why a vehicle is refused, in one line. The caller names the file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum VehicleError {
    /// Not TOML, or not the fields of a vehicle.
    #[error("line {line}: {message}")]
    Syntax {
        /// Line in the file, from 1.
        line: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// A figure outside what can be flown.
    #[error("{field} is {value}: must be {allowed}")]
    Range {
        /// The field, with its section.
        field: String,
        /// The value found.
        value: f64,
        /// The values allowed.
        allowed: String,
    },
    /// Moments of inertia that no body has.
    #[error(
        "plant.inertia is [{}, {}, {}]: each must be at most the sum of the other two",
        .0[0], .0[1], .0[2]
    )]
    ImpossibleInertia([f64; 3]),
    /// A rotor on the wrong side.
    #[error("plant.rotor_position: rotor {rotor} is at [{x}, {y}]: must be {allowed} (m front, m right)")]
    RotorOrder {
        /// Rotor number, 1 to 4.
        rotor: usize,
        /// Position found, m front.
        x: f64,
        /// Position found, m right.
        y: f64,
        /// Where this rotor must be.
        allowed: &'static str,
    },
    /// A vehicle that cannot fly.
    #[error("plant: full thrust is {thrust:.3} N: must be more than the weight of {weight:.3} N")]
    CannotLift {
        /// Thrust of all rotors at full speed in N.
        thrust: f64,
        /// Weight in N.
        weight: f64,
    },
    /// A name that no parameter can have.
    #[error("parameters.{0}: a name has 1 to 16 characters of A-Z, 0-9 and _")]
    ParameterName(String),
    /// No vehicle of that name is built in.
    #[error("no vehicle is named {0}: known are os4 and x450, or give a file that ends in .toml")]
    UnknownName(String),
}

impl Vehicle {
    /// A vehicle that is built in: `os4` or `x450`.
    ///
    /// ```
    /// use windhover_model::Vehicle;
    /// assert_eq!(Vehicle::named("os4").unwrap().plant.mass, 0.65);
    /// assert!(Vehicle::named("ornithopter").is_err());
    /// ```
    pub fn named(name: &str) -> Result<Self, VehicleError> {
        match NAMED.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => Self::from_toml(text),
            None => Err(VehicleError::UnknownName(name.escape_default().to_string())),
        }
    }

    /// Reads and checks the text of a vehicle file.
    pub fn from_toml(text: &str) -> Result<Self, VehicleError> {
        let vehicle: Self = toml::from_str(text).map_err(|error| syntax_error(text, &error))?;
        vehicle.plant.validate()?;
        for (name, &value) in &vehicle.parameters {
            let allowed = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
            if name.is_empty() || name.len() > 16 || !name.chars().all(allowed) {
                return Err(VehicleError::ParameterName(name.escape_default().to_string()));
            }
            check(&format!("parameters.{name}"), value, f64::MIN, f64::MAX)?;
        }
        Ok(vehicle)
    }
}

fn syntax_error(text: &str, error: &toml::de::Error) -> VehicleError {
    let end = error.span().map_or(0, |span| span.start);
    let line = 1 + text.bytes().take(end).filter(|&b| b == b'\n').count();
    let message = error.message().replace('\n', ", ");
    VehicleError::Syntax { line, message }
}

fn check(field: &str, value: f64, low: f64, high: f64) -> Result<(), VehicleError> {
    if value.is_finite() && value >= low && value <= high {
        return Ok(());
    }
    let allowed = if low == f64::MIN {
        "a finite number".to_owned()
    } else {
        format!("{low:?} to {high:?}")
    };
    Err(VehicleError::Range {
        field: field.to_owned(),
        value,
        allowed,
    })
}

impl Plant {
    /// Weight in N.
    pub fn weight(&self) -> f64 {
        self.mass * GRAVITY
    }

    /// Rotor speed in rad/s at which four equal rotors carry the weight.
    pub fn hover_speed(&self) -> f64 {
        (self.weight() / (4.0 * self.k_f)).sqrt()
    }

    /// Checks that the figures are those of a body that can fly.
    pub fn validate(&self) -> Result<(), VehicleError> {
        check("plant.mass", self.mass, 0.01, 100.0)?;
        for value in self.inertia {
            check("plant.inertia", value, 1e-7, 100.0)?;
        }
        let [a, b, c] = self.inertia;
        let room = 1.0 + 1e-9; // a plane body touches the limit
        if a > (b + c) * room || b > (a + c) * room || c > (a + b) * room {
            return Err(VehicleError::ImpossibleInertia(self.inertia));
        }
        for value in self.rotor_position.as_flattened() {
            check("plant.rotor_position", *value, -5.0, 5.0)?;
        }
        self.validate_rotor_order()?;
        check("plant.k_f", self.k_f, 1e-12, 1.0)?;
        check("plant.k_z", self.k_z, 1e-14, 1.0)?;
        check("plant.rotor_inertia", self.rotor_inertia, 0.0, 1.0)?;
        check("plant.rotor_speed_max", self.rotor_speed_max, 1.0, 20_000.0)?;
        check("plant.rotor_lag", self.rotor_lag, 1e-4, 1.0)?;
        if let Some(lag) = self.rotor_lag_down {
            check("plant.rotor_lag_down", lag, 1e-4, 1.0)?;
        }
        check("plant.linear_drag", self.linear_drag, 0.0, 100.0)?;
        check("plant.quadratic_drag", self.quadratic_drag, 0.0, 100.0)?;
        let thrust = 4.0 * self.k_f * self.rotor_speed_max * self.rotor_speed_max;
        if thrust <= self.weight() {
            return Err(VehicleError::CannotLift {
                thrust,
                weight: self.weight(),
            });
        }
        Ok(())
    }

    /// The signs that rotors have in an X or in a plus frame; a swapped pair would turn the
    /// vehicle over.
    fn validate_rotor_order(&self) -> Result<(), VehicleError> {
        let [a, b, c, d] = self.rotor_position;
        let rotors = [
            (a, a[0] > 0.0 && a[1] >= 0.0, "front right, or front"),
            (b, b[0] < 0.0 && b[1] <= 0.0, "rear left, or rear"),
            (c, c[0] >= 0.0 && c[1] < 0.0, "front left, or left"),
            (d, d[0] <= 0.0 && d[1] > 0.0, "rear right, or right"),
        ];
        for (index, ([x, y], fits, allowed)) in rotors.into_iter().enumerate() {
            if !fits {
                return Err(VehicleError::RotorOrder {
                    rotor: index + 1,
                    x,
                    y,
                    allowed,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn os4_with(from: &str, to: &str) -> Result<Vehicle, VehicleError> {
        let text = NAMED[0].1;
        assert!(text.contains(from), "{from}");
        Vehicle::from_toml(&text.replacen(from, to, 1))
    }

    #[test]
    fn the_named_vehicles_are_sound_and_tell_the_core_the_truth() {
        for (name, _) in NAMED {
            let vehicle = Vehicle::named(name).unwrap();
            assert_eq!(vehicle.name, name);
            let (plant, told) = (&vehicle.plant, &vehicle.parameters);
            assert_eq!(told["MASS"], plant.mass);
            assert_eq!(told["INERTIA_XX"], plant.inertia[0]);
            assert_eq!(told["INERTIA_YY"], plant.inertia[1]);
            assert_eq!(told["INERTIA_ZZ"], plant.inertia[2]);
            assert_eq!(told["ROTOR_KF"], plant.k_f);
            assert_eq!(told["ROTOR_KM"], plant.k_z);
            assert_eq!(told["ROTOR_SPEED_MAX"], plant.rotor_speed_max);
            assert_eq!(told["ROTOR_LAG"], plant.rotor_lag);
            for (i, [x, y]) in plant.rotor_position.into_iter().enumerate() {
                assert_eq!(told[&format!("CA_ROTOR{i}_PX")], x);
                assert_eq!(told[&format!("CA_ROTOR{i}_PY")], y);
            }
        }
    }

    #[test]
    fn figures_out_of_range_are_named_with_what_is_allowed() {
        let cases = [
            (
                "mass = 0.650",
                "mass = -0.650",
                "plant.mass is -0.65: must be 0.01 to 100.0",
            ),
            (
                "mass = 0.650",
                "mass = nan",
                "plant.mass is NaN: must be 0.01 to 100.0",
            ),
            (
                "mass = 0.650",
                "mass = inf",
                "plant.mass is inf: must be 0.01 to 100.0",
            ),
            (
                "[7.5e-3, 7.5e-3, 1.3e-2]",
                "[0.0, 7.5e-3, 1.3e-2]",
                "plant.inertia is 0: must be 1e-7 to 100.0",
            ),
            (
                "[7.5e-3, 7.5e-3, 1.3e-2]",
                "[1e-3, 1e-3, 1.3e-2]",
                "plant.inertia is [0.001, 0.001, 0.013]: each must be at most the sum of the other two",
            ),
            (
                "rotor_lag = 0.030",
                "rotor_lag = 0",
                "plant.rotor_lag is 0: must be 0.0001 to 1.0",
            ),
            (
                "linear_drag = 0.25",
                "linear_drag = -1",
                "plant.linear_drag is -1: must be 0.0 to 100.0",
            ),
            (
                "[[0.23, 0.0], [-0.23, 0.0]",
                "[[-0.23, 0.0], [0.23, 0.0]",
                "plant.rotor_position: rotor 1 is at [-0.23, 0]: must be front right, or front (m front, m right)",
            ),
            (
                "mass = 0.650",
                "mass = 3.0",
                "plant: full thrust is 20.032 N: must be more than the weight of 29.420 N",
            ),
            (
                "MASS = 0.650",
                "MASS = nan",
                "parameters.MASS is NaN: must be a finite number",
            ),
            (
                "MASS = 0.650",
                "A_NAME_THAT_IS_TOO_LONG = 1",
                "parameters.A_NAME_THAT_IS_TOO_LONG: a name has 1 to 16 characters of A-Z, 0-9 and _",
            ),
        ];
        for (from, to, message) in cases {
            assert_eq!(os4_with(from, to).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn a_file_that_is_not_a_vehicle_is_refused_in_one_line() {
        let cases = [
            ("mass = 0.650", "", "line 6: missing field `mass`"),
            (
                "mass = 0.650",
                "mass = \"heavy\"",
                "line 7: invalid type: string \"heavy\", expected f64",
            ),
            ("mass = 0.650", "mass 0.650", "line 7: "),
            ("k_f = 3.13e-5", "wings = 2", "line 12: unknown field `wings`"),
            ("rotor_inertia = 6.0e-5", "mass = 1.0", "line 14: duplicate key"),
        ];
        for (from, to, start) in cases {
            let message = os4_with(from, to).unwrap_err().to_string();
            assert!(message.starts_with(start), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
        assert!(Vehicle::from_toml("").is_err());
        assert!(Vehicle::from_toml("\u{0}\u{7f}[[").is_err());
        let unknown = Vehicle::named("os5\n").unwrap_err().to_string();
        assert!(
            unknown.starts_with("no vehicle is named os5\\n: known are os4 and x450"),
            "{unknown}"
        );
    }

    #[test]
    fn lag_and_drag_may_be_left_out_or_split() {
        let vehicle = os4_with("quadratic_drag = 0.0 ", "rotor_lag_down = 0.05 #").unwrap();
        assert_eq!(vehicle.plant.rotor_lag_down, Some(0.05));
        assert_eq!(vehicle.plant.quadratic_drag, 0.0);
    }
}
