//! A path of straight legs, flown one after the other or rounding the corners between them.
//!
//! Every leg is a motion from rest to rest along its line ([`Profile`]). Where the vehicle stops,
//! the legs follow one another. Where it passes, the next leg begins while the last one still
//! slows down, and the two motions add up: the sum rounds the corner, is as smooth as its parts,
//! and straight on it keeps the speed. How early the next leg begins decides how far from the
//! corner the path passes; acceleration at the corner is shared so that the sum keeps the limit.

use windhover_control::TrajectorySetpoint;
use windhover_math::{Vector3, max, min, scalar};

use super::profile::{Profile, ProfileLimits};

/// Speeds and accelerations of a path, all positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Horizontal speed, m/s.
    pub speed: f32,
    /// Climbing speed, m/s.
    pub climb: f32,
    /// Descending speed, m/s.
    pub descend: f32,
    /// Horizontal acceleration, m/s².
    pub acceleration: f32,
    /// Vertical acceleration, m/s².
    pub vertical_acceleration: f32,
    /// Jerk, m/s³.
    pub jerk: f32,
}

impl Limits {
    /// Speed and acceleration along a unit vector (NED).
    fn along(&self, direction: Vector3) -> (f32, f32) {
        let horizontal = windhover_math::sqrt(direction.x * direction.x + direction.y * direction.y);
        let vertical = direction.z.abs();
        let vertical_speed = if direction.z < 0.0 {
            self.climb
        } else {
            self.descend
        };
        let share = |limit: f32, part: f32| if part > 1e-3 { limit / part } else { f32::INFINITY };
        (
            min(share(self.speed, horizontal), share(vertical_speed, vertical)),
            min(
                share(self.acceleration, horizontal),
                share(self.vertical_acceleration, vertical),
            ),
        )
    }
}

/// How a leg ends, or how the one before it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// At rest.
    Stop,
    /// Passing on in the direction of this unit vector (before it: coming from it), at most
    /// this far from the corner, m.
    Pass {
        /// Direction of the other leg.
        direction: Vector3,
        /// Largest distance from the corner.
        radius: f32,
    },
}

/// Shortest leg that can be joined to another without a stop, m.
pub const SHORTEST_PASS: f32 = 0.1;

/// Direction from one point to another and the distance; no direction where they are the same.
pub fn direction_and_length(from: Vector3, to: Vector3) -> (Vector3, f32) {
    let way = to - from;
    let length = scalar::norm(way);
    if length > 1e-3 {
        (way / length, length)
    } else {
        (Vector3::zeros(), 0.0)
    }
}

/// The share of its acceleration that each of two legs may use where they meet: the sum of both
/// keeps the horizontal and the vertical limit then, whatever each of them uses of its share.
fn corner_share(direction: Vector3, joint: &Joint, limits: &Limits) -> f32 {
    let Joint::Pass { direction: other, .. } = joint else {
        return 1.0;
    };
    let sum = *other * limits.along(*other).1 - direction * limits.along(direction).1;
    let horizontal = windhover_math::sqrt(sum.x * sum.x + sum.y * sum.y) / limits.acceleration;
    let vertical = sum.z.abs() / limits.vertical_acceleration;
    1.0 / max(1.0, max(horizontal, vertical))
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Leg {
    target: Vector3,
    direction: Vector3,
    profile: Profile,
    /// Time since its start, µs.
    clock: u32,
    /// How long before its end the next leg begins, s.
    overlap: f32,
    end: Joint,
}

impl Leg {
    /// Where the leg is from `start`, `clock` µs after it began and at `rate` of the planned speed.
    fn at(&self, start: Vector3, clock: u32, rate: f32) -> TrajectorySetpoint {
        let motion = self.profile.at(clock as f32 * 1e-6);
        TrajectorySetpoint {
            position: start + self.direction * motion.distance,
            velocity: self.direction * (motion.speed * rate),
            acceleration: self.direction * (motion.acceleration * rate * rate),
            jerk: self.direction * (motion.jerk * rate * rate * rate),
            heading: 0.0,
            heading_rate: 0.0,
        }
    }

    /// When the next leg begins on this leg's clock, µs.
    fn next_begins(&self) -> u32 {
        (max(self.profile.duration() - self.overlap, 0.0) * 1e6) as u32
    }

    fn is_over(&self) -> bool {
        self.clock as f32 * 1e-6 >= self.profile.duration()
    }
}

/// The path as far as it is planned: the leg being flown and perhaps the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    start: Vector3,
    first: Option<Leg>,
    second: Option<Leg>,
}

/// Where the path is after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathStep {
    /// Position and its derivatives; the heading is left to others.
    pub setpoint: TrajectorySetpoint,
    /// Whether a leg came to its end in this step.
    pub leg_finished: bool,
}

impl Path {
    /// Standing still.
    pub fn at(position: Vector3) -> Self {
        Self {
            start: position,
            first: None,
            second: None,
        }
    }

    /// Whether there is no leg left to fly.
    pub fn is_finished(&self) -> bool {
        self.first.is_none()
    }

    /// Whether another leg can be planned.
    pub fn has_room(&self) -> bool {
        self.second.is_none()
    }

    /// Where the last planned leg ends.
    pub fn end(&self) -> Vector3 {
        match (&self.second, &self.first) {
            (Some(leg), _) | (None, Some(leg)) => leg.target,
            (None, None) => self.start,
        }
    }

    /// Direction of the last planned leg; none when there is no leg.
    pub fn last_direction(&self) -> Vector3 {
        self.second
            .or(self.first)
            .map_or(Vector3::zeros(), |leg| leg.direction)
    }

    /// How the last planned leg ends.
    pub fn last_joint(&self) -> Joint {
        self.second.or(self.first).map_or(Joint::Stop, |leg| leg.end)
    }

    /// Plans a leg from the end of the last one to `target`. `before` and `after` say how it is
    /// joined to its neighbours; the neighbour's own plan must say the same. Without room nothing
    /// is planned.
    pub fn push(&mut self, target: Vector3, limits: &Limits, before: Joint, after: Joint) {
        let (direction, length) = direction_and_length(self.end(), target);
        let (speed, acceleration) = limits.along(direction);
        let profile = Profile::new(
            length,
            &ProfileLimits {
                speed,
                acceleration: acceleration * corner_share(direction, &before, limits),
                deceleration: acceleration * corner_share(direction, &after, limits),
                jerk: limits.jerk,
            },
        );
        let leg = Leg {
            target,
            direction,
            profile,
            clock: 0,
            overlap: 0.0,
            end: after,
        };
        match &mut self.first {
            None => self.first = Some(leg),
            Some(first) if self.second.is_none() => {
                first.overlap = overlap(first, &leg);
                self.second = Some(leg);
            }
            Some(_) => {}
        }
    }

    /// Goes on by `dt` µs at `rate` (0 to 1) of the planned speed.
    #[inline(always)]
    pub fn step(&mut self, dt: u32, rate: f32) -> PathStep {
        let dt = if rate < 1.0 { (dt as f32 * rate) as u32 } else { dt };
        let leg_finished = self.advance(dt);
        let Some(first) = &self.first else {
            return PathStep {
                setpoint: TrajectorySetpoint::at_rest(self.start, 0.0),
                leg_finished,
            };
        };
        let mut setpoint = first.at(self.start, first.clock, rate);
        if let Some(second) = &self.second
            && let Some(begun) = first.clock.checked_sub(first.next_begins())
        {
            let more = second.at(setpoint.position, begun, rate);
            setpoint.position = more.position;
            setpoint.velocity += more.velocity;
            setpoint.acceleration += more.acceleration;
            setpoint.jerk += more.jerk;
        }
        PathStep {
            setpoint,
            leg_finished,
        }
    }

    fn advance(&mut self, dt: u32) -> bool {
        let Some(first) = &mut self.first else {
            return false;
        };
        first.clock = first.clock.saturating_add(dt);
        if !first.is_over() {
            return false;
        }
        self.start = first.target;
        let begun = first.clock.saturating_sub(first.next_begins());
        self.first = self.second.take().map(|leg| Leg { clock: begun, ..leg });
        true
    }
}

/// How long before the first leg's end the second begins, s: as long as the path then stays
/// within the joint's radius of the corner, and at most half of either leg.
fn overlap(first: &Leg, second: &Leg) -> f32 {
    let Joint::Pass { radius, .. } = first.end else {
        return 0.0;
    };
    let most = min(
        min(first.profile.down_time(), second.profile.up_time()),
        0.5 * min(first.profile.duration(), second.profile.duration()),
    );
    let distance = |overlap: f32| {
        let half = 0.5 * overlap;
        scalar::norm(
            second.direction * second.profile.gone(half) - first.direction * first.profile.remaining(half),
        )
    };
    if distance(most) <= radius {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if distance(middle) <= radius {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LIMITS: Limits = Limits {
        speed: 2.0,
        climb: 1.5,
        descend: 1.0,
        acceleration: 1.5,
        vertical_acceleration: 1.0,
        jerk: 6.0,
    };
    const DT: u32 = 4000;

    /// Flies a corner: the setpoints of every step.
    fn fly(corner: Vector3, end: Vector3, joint: bool, radius: f32) -> std::vec::Vec<TrajectorySetpoint> {
        let mut path = Path::at(Vector3::zeros());
        let (first, _) = direction_and_length(Vector3::zeros(), corner);
        let (second, _) = direction_and_length(corner, end);
        let pass = |direction| {
            if joint {
                Joint::Pass { direction, radius }
            } else {
                Joint::Stop
            }
        };
        path.push(corner, &LIMITS, Joint::Stop, pass(second));
        path.push(end, &LIMITS, pass(first), Joint::Stop);
        let mut flown = std::vec::Vec::new();
        while !path.is_finished() {
            flown.push(path.step(DT, 1.0).setpoint);
            assert!(flown.len() < 100_000);
        }
        flown
    }

    extern crate std;

    fn corner_distance(flown: &[TrajectorySetpoint], corner: Vector3) -> f32 {
        flown
            .iter()
            .map(|s| scalar::norm(s.position - corner))
            .fold(f32::INFINITY, min)
    }

    #[test]
    fn a_stop_is_at_rest_on_the_corner_and_the_path_ends_exactly() {
        let (corner, end) = (Vector3::new(20.0, 0.0, 0.0), Vector3::new(20.0, 30.0, 0.0));
        let flown = fly(corner, end, false, 0.0);
        let nearest = flown
            .iter()
            .find(|s| scalar::norm(s.position - corner) < 1e-4)
            .unwrap();
        assert!(scalar::norm(nearest.velocity) < 0.05);
        assert!(scalar::norm(flown.last().unwrap().position - end) < 1e-4);
    }

    #[test]
    fn straight_on_keeps_the_speed() {
        let flown = fly(
            Vector3::new(20.0, 0.0, 0.0),
            Vector3::new(50.0, 0.0, 0.0),
            true,
            5.0,
        );
        let slow = flown.iter().filter(|s| s.position.x > 3.0 && s.position.x < 47.0);
        for setpoint in slow {
            assert!((setpoint.velocity.x - 2.0).abs() < 1e-3, "{setpoint:?}");
        }
    }

    proptest! {
        /// Whatever the corner: within the radius of it, inside speed and acceleration limits,
        /// and the velocity is the derivative of the position.
        #[test]
        fn corners_keep_radius_and_limits(turn in -3.1f32..3.1, a in 2.0f32..60.0, b in 2.0f32..60.0, radius in 0.1f32..5.0) {
            let (sin, cos) = windhover_math::sin_cos(turn);
            let corner = Vector3::new(a, 0.0, 0.0);
            let end = corner + Vector3::new(cos * b, sin * b, 0.0);
            let flown = fly(corner, end, true, radius);
            prop_assert!(corner_distance(&flown, corner) <= radius + 0.01);
            for pair in flown.windows(2) {
                let [last, now] = pair else { unreachable!() };
                prop_assert!(scalar::norm(now.velocity) < 2.0 * 1.001);
                prop_assert!(scalar::norm(now.acceleration) < 1.5 * 1.001, "{now:?}");
                let moved = (now.velocity + last.velocity) * 0.002;
                prop_assert!(scalar::norm(now.position - last.position - moved) < 2e-4);
                let sped = (now.acceleration + last.acceleration) * 0.002;
                prop_assert!(scalar::norm(now.velocity - last.velocity - sped) < 1e-3);
            }
            prop_assert!(scalar::norm(flown.last().unwrap().position - end) < 1e-3);
        }
    }

    #[test]
    fn a_slower_rate_scales_the_derivatives() {
        let mut path = Path::at(Vector3::zeros());
        path.push(Vector3::new(0.0, 0.0, -30.0), &LIMITS, Joint::Stop, Joint::Stop);
        let mut last = path.step(DT, 0.5).setpoint;
        for _ in 0..1000 {
            let now = path.step(DT, 0.5).setpoint;
            let moved = (now.velocity + last.velocity) * 0.002;
            assert!(scalar::norm(now.position - last.position - moved) < 1e-4);
            let sped = (now.acceleration + last.acceleration) * 0.002;
            assert!(scalar::norm(now.velocity - last.velocity - sped) < 1e-4);
            let changed = (now.jerk + last.jerk) * 0.002;
            // The jerk jumps, four times a leg.
            let jump = scalar::norm(now.jerk - last.jerk) * 0.002;
            assert!(scalar::norm(now.acceleration - last.acceleration - changed) < jump + 1e-4);
            assert!(now.velocity.z >= -0.75 * 1.001);
            last = now;
        }
    }
}
