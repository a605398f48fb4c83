//! Where the vehicle should be, and how that moves.

use windhover_math::{Vector3, scalar};

/// A point of a trajectory with its derivatives: what position control follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectorySetpoint {
    /// Position, NED, m from the origin.
    pub position: Vector3,
    /// Velocity, NED, m/s.
    pub velocity: Vector3,
    /// Acceleration, NED, m/s².
    pub acceleration: Vector3,
    /// Jerk, NED, m/s³.
    pub jerk: Vector3,
    /// Heading in rad, 0 is north, positive towards east.
    pub heading: f32,
    /// Rate of the heading in rad/s.
    pub heading_rate: f32,
}

impl TrajectorySetpoint {
    /// Standing still at `position` (NED, m) with `heading` (rad).
    pub fn at_rest(position: Vector3, heading: f32) -> Self {
        Self {
            position,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            jerk: Vector3::zeros(),
            heading,
            heading_rate: 0.0,
        }
    }

    /// Whether every number is finite: what comes from outside has to be.
    pub fn is_finite(&self) -> bool {
        [self.position, self.velocity, self.acceleration, self.jerk]
            .into_iter()
            .all(scalar::is_finite)
            && self.heading.is_finite()
            && self.heading_rate.is_finite()
    }
}
