//! A point that moves as it is told and never jumps: what joins one mode of flight to the next.
//!
//! The velocity follows a wanted one with limited acceleration and jerk, so that a setpoint goes on
//! from whatever motion it had: it brakes to a stop, follows sticks, comes down to land, or heads
//! for a place that may itself move.

use windhover_control::TrajectorySetpoint;
use windhover_math::{Vector3, max, min, saturate, scalar, sqrt};

/// How fast the acceleration answers to what is left of the velocity's error, 1/s.
const APPROACH: f32 = 2.0;

/// How fast the velocity answers to what is left of the way, 1/s.
const CLOSING: f32 = 0.8;

/// What a glide may not exceed. All positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlideLimits {
    /// Horizontal acceleration, m/s².
    pub acceleration: f32,
    /// Vertical acceleration, m/s².
    pub vertical_acceleration: f32,
    /// Jerk, m/s³.
    pub jerk: f32,
}

/// A point in motion, NED.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Glide {
    /// m.
    pub position: Vector3,
    /// m/s.
    pub velocity: Vector3,
    /// m/s².
    pub acceleration: Vector3,
}

impl Glide {
    /// Standing still.
    pub fn at(position: Vector3) -> Self {
        Self {
            position,
            ..Self::default()
        }
    }

    /// Goes on by `dt` seconds towards a `wanted` velocity (m/s). `rate` (0 to 1) of the way is
    /// made: less than all while the vehicle has fallen behind. The jerk, m/s³.
    pub fn step(&mut self, wanted: Vector3, limits: &GlideLimits, rate: f32, dt: f32) -> Vector3 {
        let error = (wanted - self.velocity) * APPROACH;
        let flat = scalar::limit_norm(Vector3::new(error.x, error.y, 0.0), limits.acceleration);
        let target = Vector3::new(flat.x, flat.y, saturate(error.z, limits.vertical_acceleration));
        let change = scalar::limit_norm(target - self.acceleration, limits.jerk * dt);
        self.acceleration += change;
        self.velocity += self.acceleration * dt;
        self.position += self.velocity * (dt * rate);
        if dt > 0.0 { change / dt } else { Vector3::zeros() }
    }

    /// The velocity that leads to `target` and comes to rest there: at most `speed` horizontally,
    /// `climb` up and `descend` down, m/s.
    pub fn towards(
        &self,
        target: Vector3,
        limits: &GlideLimits,
        speed: f32,
        climb: f32,
        descend: f32,
    ) -> Vector3 {
        let way = target - self.position;
        let distance = sqrt(way.x * way.x + way.y * way.y);
        let flat = min(closing_speed(distance, limits.acceleration), speed);
        let share = if distance > 1e-3 { flat / distance } else { 0.0 };
        let upright = closing_speed(way.z.abs(), limits.vertical_acceleration);
        let vertical = if way.z < 0.0 {
            -min(upright, climb)
        } else {
            min(upright, descend)
        };
        Vector3::new(way.x * share, way.y * share, vertical)
    }

    /// Whether it has come to rest.
    pub fn is_at_rest(&self) -> bool {
        const STILL: f32 = 0.05;
        scalar::norm(self.velocity) < STILL && scalar::norm(self.acceleration) < 4.0 * STILL
    }

    /// The point as a setpoint with a heading, rad, and its rate, rad/s.
    pub fn setpoint(&self, jerk: Vector3, rate: f32, heading: (f32, f32)) -> TrajectorySetpoint {
        TrajectorySetpoint {
            position: self.position,
            velocity: self.velocity * rate,
            acceleration: self.acceleration * (rate * rate),
            jerk: jerk * (rate * rate * rate),
            heading: heading.0,
            heading_rate: heading.1,
        }
    }
}

/// The speed at which a way of `distance` (m) can be closed: in proportion near its end, and with
/// half of the acceleration further out, so that what is left of it turns corners and ends the jerk.
fn closing_speed(distance: f32, acceleration: f32) -> f32 {
    let brake = 0.5 * acceleration;
    let near = brake / (CLOSING * CLOSING);
    if distance <= near {
        distance * CLOSING
    } else {
        sqrt(max(brake * (2.0 * distance - near), 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMITS: GlideLimits = GlideLimits {
        acceleration: 1.5,
        vertical_acceleration: 1.0,
        jerk: 6.0,
    };
    const DT: f32 = 0.004;

    fn moving(velocity: [f32; 3]) -> Glide {
        Glide {
            velocity: Vector3::from(velocity),
            ..Glide::default()
        }
    }

    proptest! {
        /// Whatever it is told, velocity and acceleration have no jumps: a mode that begins with a
        /// glide begins with the motion that there was.
        #[test]
        fn never_jumps(from in prop::array::uniform3(-8.0f32..8.0), wanted in prop::array::uniform3(-8.0f32..8.0)) {
            let mut glide = moving(from);
            // The furthest change takes 16 s.
            for _ in 0..6000 {
                let before = glide;
                glide.step(Vector3::from(wanted), &LIMITS, 1.0, DT);
                let a = glide.acceleration;
                prop_assert!(scalar::norm(a - before.acceleration) <= LIMITS.jerk * DT * 1.001);
                prop_assert!(sqrt(a.x * a.x + a.y * a.y) <= LIMITS.acceleration * 1.001);
                prop_assert!(a.z.abs() <= LIMITS.vertical_acceleration * 1.001);
            }
            let left = scalar::norm(glide.velocity - Vector3::from(wanted));
            prop_assert!(left < 0.05, "{left}");
        }

        /// It brakes to a stop about where its speed and the limits say, without turning back.
        #[test]
        fn brakes_to_a_stop(speed in 0.2f32..12.0, direction in -3.1f32..3.1) {
            let (sin, cos) = windhover_math::sin_cos(direction);
            let mut glide = moving([speed * cos, speed * sin, 0.0]);
            for _ in 0..5000 {
                glide.step(Vector3::zeros(), &LIMITS, 1.0, DT);
            }
            prop_assert!(glide.is_at_rest());
            let way = glide.position.x * cos + glide.position.y * sin;
            let least = speed * speed / (2.0 * LIMITS.acceleration);
            prop_assert!(way > least && way < least + speed, "{way} m, at least {least}");
        }

        /// It arrives at a place and overshoots by no more than a hand's breadth.
        #[test]
        fn arrives(target in prop::array::uniform3(-40.0f32..40.0), from in prop::array::uniform3(-1.0f32..1.0)) {
            let target = Vector3::from(target);
            let mut glide = moving(from);
            let mut beyond = 0.0f32;
            let direction = target / scalar::norm(target);
            for _ in 0..25_000 {
                let wanted = glide.towards(target, &LIMITS, 5.0, 2.0, 1.5);
                glide.step(wanted, &LIMITS, 1.0, DT);
                let past = (glide.position - target).dot(&direction);
                if scalar::norm(target) > 5.0 && past > beyond {
                    beyond = past;
                }
            }
            prop_assert!(scalar::norm(glide.position - target) < 0.05, "{} short of {target}", glide.position);
            prop_assert!(beyond < 0.1, "{beyond} m too far");
        }
    }
}
