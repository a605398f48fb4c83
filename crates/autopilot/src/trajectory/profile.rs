//! Motion along a line from rest to rest, with limited speed, acceleration and jerk.
//!
//! Speed rises and falls in S-curves: the acceleration grows with the jerk limit, stays, and
//! shrinks again. A distance too short for the full speed gets the largest speed that fits.
//! Everything is closed form in the time since the start.

use windhover_math::{max, min, sqrt};

/// Distance along the line with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// m.
    pub distance: f32,
    /// m/s.
    pub speed: f32,
    /// m/s².
    pub acceleration: f32,
    /// m/s³.
    pub jerk: f32,
}

/// From rest to a speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp {
    speed: f32,
    acceleration: f32,
    jerk: f32,
    /// How long the acceleration grows, and how long it shrinks again, s.
    jerk_time: f32,
    duration: f32,
}

impl Ramp {
    fn new(speed: f32, acceleration: f32, jerk: f32) -> Self {
        let peak = min(acceleration, sqrt(speed * jerk));
        if peak <= 0.0 {
            return Self::default();
        }
        let jerk_time = peak / jerk;
        Self {
            speed,
            acceleration: peak,
            jerk,
            jerk_time,
            duration: speed / peak + jerk_time,
        }
    }

    /// The way it takes, m: the curve is symmetric about half of the time and of the speed.
    fn distance(&self) -> f32 {
        0.5 * self.speed * self.duration
    }

    /// The motion `t` seconds after its start.
    #[inline]
    fn at(&self, t: f32) -> Motion {
        let left = self.duration - t;
        if t < self.jerk_time {
            Motion {
                distance: self.jerk * t * t * t * (1.0 / 6.0),
                speed: 0.5 * self.jerk * t * t,
                acceleration: self.jerk * t,
                jerk: self.jerk,
            }
        } else if left < self.jerk_time {
            Motion {
                distance: self.distance() - self.speed * left + self.jerk * left * left * left * (1.0 / 6.0),
                speed: self.speed - 0.5 * self.jerk * left * left,
                acceleration: self.jerk * left,
                jerk: -self.jerk,
            }
        } else {
            let start = 0.5 * self.acceleration * self.jerk_time;
            let s = t - self.jerk_time;
            Motion {
                distance: self.acceleration * self.jerk_time * self.jerk_time * (1.0 / 6.0)
                    + start * s
                    + 0.5 * self.acceleration * s * s,
                speed: start + self.acceleration * s,
                acceleration: self.acceleration,
                jerk: 0.0,
            }
        }
    }
}

/// Motion over a given distance, from rest to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Profile {
    length: f32,
    up: Ramp,
    cruise_time: f32,
    down: Ramp,
}

/// What a [`Profile`] may not exceed. All positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileLimits {
    /// m/s.
    pub speed: f32,
    /// While speeding up, m/s².
    pub acceleration: f32,
    /// While slowing down, m/s².
    pub deceleration: f32,
    /// m/s³.
    pub jerk: f32,
}

impl Profile {
    /// The fastest such motion over `length` metres. A length that is not positive takes no time.
    pub fn new(length: f32, limits: &ProfileLimits) -> Self {
        let ramps = |speed: f32| {
            (
                Ramp::new(speed, limits.acceleration, limits.jerk),
                Ramp::new(speed, limits.deceleration, limits.jerk),
            )
        };
        let fits = |speed: f32| {
            let (up, down) = ramps(speed);
            up.distance() + down.distance() <= length
        };
        if length.is_nan() || length <= 0.0 {
            return Self::default();
        }
        let mut speed = limits.speed;
        if !fits(speed) {
            // The way grows with the speed: halve the interval until f32 is exhausted.
            let (mut low, mut high) = (0.0, speed);
            for _ in 0..26 {
                let middle = 0.5 * (low + high);
                if fits(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            speed = low;
        }
        let (up, down) = ramps(speed);
        let rest = max(length - up.distance() - down.distance(), 0.0);
        Self {
            length,
            up,
            cruise_time: if speed > 0.0 { rest / speed } else { 0.0 },
            down,
        }
    }

    /// The time it takes, s.
    pub fn duration(&self) -> f32 {
        self.up.duration + self.cruise_time + self.down.duration
    }

    /// How long it speeds up, s.
    pub fn up_time(&self) -> f32 {
        self.up.duration
    }

    /// How long it slows down, s.
    pub fn down_time(&self) -> f32 {
        self.down.duration
    }

    /// The way still to go `left` seconds before the end, where that is while slowing down, m.
    pub fn remaining(&self, left: f32) -> f32 {
        self.down.at(left).distance
    }

    /// The way gone `t` seconds after the start, where that is while speeding up, m.
    pub fn gone(&self, t: f32) -> f32 {
        self.up.at(t).distance
    }

    /// The motion `t` seconds after the start. Before it, at rest; after it, at rest at the end.
    #[inline]
    pub fn at(&self, t: f32) -> Motion {
        let left = self.duration() - t;
        if t <= 0.0 {
            Motion::default()
        } else if left <= 0.0 {
            Motion {
                distance: self.length,
                ..Motion::default()
            }
        } else if t < self.up.duration {
            self.up.at(t)
        } else if left < self.down.duration {
            let back = self.down.at(left);
            Motion {
                distance: self.length - back.distance,
                speed: back.speed,
                acceleration: -back.acceleration,
                jerk: back.jerk,
            }
        } else {
            Motion {
                distance: self.up.distance() + self.up.speed * (t - self.up.duration),
                speed: self.up.speed,
                ..Motion::default()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn limits() -> impl Strategy<Value = ProfileLimits> {
        (0.1f32..15.0, 0.1f32..8.0, 0.1f32..8.0, 0.2f32..60.0).prop_map(
            |(speed, acceleration, deceleration, jerk)| ProfileLimits {
                speed,
                acceleration,
                deceleration,
                jerk,
            },
        )
    }

    proptest! {
        /// From rest to rest over the length, inside every limit, each derivative the derivative
        /// of the one before (numerically).
        #[test]
        fn reaches_the_end_inside_the_limits(length in 0.01f32..500.0, limits in limits()) {
            let profile = Profile::new(length, &limits);
            let steps = 2000;
            let dt = profile.duration() / steps as f32;
            let mut last = profile.at(0.0);
            prop_assert_eq!(last, Motion::default());
            for n in 1..=steps {
                let now = profile.at(n as f32 * dt);
                prop_assert!(now.speed >= -1e-4 * limits.speed && now.speed <= limits.speed * 1.0001);
                prop_assert!(now.acceleration <= limits.acceleration * 1.0001);
                prop_assert!(-now.acceleration <= limits.deceleration * 1.0001);
                let slack = limits.jerk * dt * dt + 2e-5 * length + 1e-5;
                let moved = 0.5 * (now.speed + last.speed) * dt;
                prop_assert!((now.distance - last.distance - moved).abs() < slack, "distance at {n}");
                let sped = now.speed - last.speed;
                prop_assert!(sped.abs() <= max(limits.acceleration, limits.deceleration) * dt * 1.001 + 1e-4 * limits.speed);
                last = now;
            }
            prop_assert!((last.distance - length).abs() < 1e-4 * length + 1e-5, "{last:?}");
            prop_assert!(last.speed.abs() < 1e-3 * limits.speed);
        }
    }

    /// With a length that allows it, the time is the closed form: L/v + the two ramps.
    #[test]
    fn a_long_leg_takes_the_closed_forms_time() {
        let limits = ProfileLimits {
            speed: 2.0,
            acceleration: 1.5,
            deceleration: 1.5,
            jerk: 6.0,
        };
        let profile = Profile::new(20.0, &limits);
        let exact = 20.0 / 2.0 + 2.0 / 1.5 + 1.5 / 6.0;
        assert!(
            (profile.duration() - exact).abs() < 1e-4,
            "{}",
            profile.duration()
        );
    }

    #[test]
    fn no_length_takes_no_time() {
        let limits = ProfileLimits {
            speed: 2.0,
            acceleration: 1.5,
            deceleration: 1.5,
            jerk: 6.0,
        };
        for length in [0.0, -1.0, f32::NAN] {
            let profile = Profile::new(length, &limits);
            assert_eq!(profile.duration(), 0.0);
            assert_eq!(profile.at(1.0).distance, 0.0);
        }
    }
}
