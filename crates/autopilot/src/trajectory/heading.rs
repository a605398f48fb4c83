//! The heading setpoint: turns towards its target with limited rate and acceleration.

use windhover_math::{Vector3, atan2, saturate, wrap_pi};

/// How fast the rate follows the remaining error, 1/s.
const APPROACH: f32 = 2.0;

/// Nearer to a place, m, there is no direction to it.
const NEAREST: f32 = 0.5;

/// The heading from one place to another, rad; `None` above or below it.
pub fn towards(place: Vector3, from: Vector3) -> Option<f32> {
    let way = place - from;
    (way.x.abs() + way.y.abs() >= NEAREST).then(|| atan2(way.y, way.x))
}

/// A heading on its way to its target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadingSlew {
    /// Heading now, rad, −π to π.
    pub heading: f32,
    /// Rate now, rad/s.
    pub rate: f32,
}

impl HeadingSlew {
    /// Goes on by `dt` seconds towards `target` (rad), the shorter way round, with at most
    /// `rate_max` (rad/s) and `acceleration_max` (rad/s²).
    #[inline]
    pub fn step(&mut self, target: f32, rate_max: f32, acceleration_max: f32, dt: f32) {
        let wanted = saturate(wrap_pi(target - self.heading) * APPROACH, rate_max);
        self.rate += saturate(wanted - self.rate, acceleration_max * dt);
        self.heading = wrap_pi(self.heading + self.rate * dt);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_shorter_way_inside_its_limits_and_arrives() {
        let mut slew = HeadingSlew {
            heading: 3.0,
            rate: 0.0,
        };
        let mut turned = 0.0;
        for _ in 0..2500 {
            let before = slew.rate;
            slew.step(-3.0, 0.8, 1.6, 0.004);
            assert!(slew.rate.abs() <= 0.8 && (slew.rate - before).abs() <= 1.6 * 0.0041);
            turned += slew.rate * 0.004;
        }
        assert!((wrap_pi(slew.heading + 3.0)).abs() < 1e-3, "{slew:?}");
        assert!(
            (turned - (2.0 * core::f32::consts::PI - 6.0)).abs() < 1e-2,
            "{turned}"
        );
    }
}
