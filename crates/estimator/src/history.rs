//! The recent past, for measurements that arrive late.
//!
//! A receiver's position is some 120 ms old when it comes; at 10 m/s that is more than a metre.
//! The filter stays in the present and looks back: what position, velocity and attitude were at
//! the measurement's time *as believed now*, by taking what the inertial sensors have measured
//! since off the present state. The innovation is formed there, and the matrix H carries how the
//! past depends on the present errors: position then = position − lag · velocity + …
//!
//! For the velocity H has the effects of attitude and accelerometer bias over the lag, and the
//! process noise of the lag is taken off (it is in the present error, not in the measured one):
//! without both a lively flight was 10 % overconfident. Neglected are the same effects on the
//! position (½ lag² g δθ: 1 mm for 1° and 120 ms) and of the gyro's bias on the attitude.
//!
//! The alternative, a filter at a delayed horizon with an output predictor (as PX4's), is exact in
//! all of this, but fuses every sensor as late as the slowest, holds a queue for each, and has a
//! second state to keep consistent. Here a look back costs a search and an interpolation.
//!
//! Kept is a *track*: position, velocity and attitude by dead reckoning alone, into which no
//! correction is ever put, so that a correction need not walk through the past; only differences
//! along it mean anything. It would drift off by itself (a bias of 0.05 m/s² gives 300 km in an
//! hour, and `f32` has no digits for that), so it starts anew from the present state at each turn
//! of the ring, and the step between old and new track is kept: entries before it are shifted by
//! it when they are read.

use windhover_math::{GRAVITY, Quaternion, Vector3};

use crate::covariance::{Axis, LateVelocity};
use crate::state::{Propagation, State};

/// Entries: 320 ms at 125 Hz, every second step of the filter. Between two of them 8 ms apart a
/// line is off the path by an eighth of a · (8 ms)²: 0.1 mm at 10 m/s².
pub const LENGTH: usize = 41;

/// Between two points if no step is late, µs.
const NOMINAL: i32 = 8000;

/// A point of the track.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    /// µs, the low 32 bits.
    time: u32,
    position: Vector3,
    velocity: Vector3,
    attitude: Quaternion,
}

/// A past moment, relative to the present one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Past {
    /// How long ago, s.
    pub(crate) lag: f32,
    /// Position then − (position − lag · velocity now), m.
    position: Vector3,
    /// Velocity then − velocity now, m/s.
    velocity: Vector3,
    /// Body then to body now.
    turned: Quaternion,
}

/// Why there is no such moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unreachable {
    /// It is still to come.
    Ahead,
    /// It is forgotten.
    Behind,
}

/// The ring of past points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct History {
    points: [Point; LENGTH],
    /// Where the next point goes: points from here on belong to the track before.
    next: usize,
    now: Point,
    /// Where the track began anew, with the step that it made there.
    seam: (u32, Vector3, Vector3),
}

/// From `earlier` to `later`, µs; negative the other way round. Right within ±35 minutes.
#[inline(always)]
fn elapsed(earlier: u32, later: u32) -> i32 {
    later.wrapping_sub(earlier) as i32
}

impl Past {
    /// The present.
    pub(crate) const NOW: Self = Self {
        lag: 0.0,
        position: Vector3::new(0.0, 0.0, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        turned: Quaternion::IDENTITY,
    };

    /// Position then, as believed now.
    #[inline(always)]
    pub(crate) fn position(&self, now: &State) -> Vector3 {
        now.position - now.velocity * self.lag + self.position
    }

    /// Velocity then, as believed now.
    #[inline(always)]
    pub(crate) fn velocity(&self, now: &State) -> Vector3 {
        now.velocity + self.velocity
    }

    /// Velocity of an axis then, as a function of the present errors: over the lag an attitude
    /// error turns the integral F of the specific force, so v(t) = v − F + … gives
    /// δv(t) = δv − δθ × F + R lag δb_a.
    #[inline(always)]
    pub(crate) fn late_velocity(&self, now: &State, axis: Axis, noise_density: f32) -> LateVelocity {
        let f = Vector3::new(
            -self.velocity.x,
            -self.velocity.y,
            -self.velocity.z - GRAVITY * self.lag,
        );
        let r = now.attitude.to_matrix();
        let (attitude, row) = match axis {
            Axis::X => ([(Axis::Y, -f.z), (Axis::Z, f.y)], [r.m11, r.m12, r.m13]),
            Axis::Y => ([(Axis::X, f.z), (Axis::Z, -f.x)], [r.m21, r.m22, r.m23]),
            Axis::Z => ([(Axis::X, -f.y), (Axis::Y, f.x)], [r.m31, r.m32, r.m33]),
        };
        LateVelocity {
            attitude,
            bias: [row[0] * self.lag, row[1] * self.lag, row[2] * self.lag],
            since: noise_density * self.lag,
            half_lag: 0.5 * self.lag,
        }
    }

    /// Attitude then, as believed now.
    #[inline(always)]
    pub(crate) fn attitude(&self, now: &State) -> Quaternion {
        if self.lag > 0.0 {
            now.attitude * self.turned
        } else {
            now.attitude
        }
    }
}

impl History {
    /// Knows nothing but the present, LENGTH times.
    pub(crate) fn new(state: &State, time: u32) -> Self {
        let now = Point {
            time,
            position: state.position,
            velocity: state.velocity,
            attitude: state.attitude,
        };
        Self {
            points: [now; LENGTH],
            next: 1,
            now,
            seam: (time, Vector3::zeros(), Vector3::zeros()),
        }
    }

    /// Carries the track over an interval that the filter is carried over as well.
    #[inline(always)]
    pub(crate) fn advance(&mut self, moved: &Propagation, time: u32) {
        let now = &mut self.now;
        now.time = time;
        now.position += (now.velocity + moved.gained * 0.5) * moved.transition.duration;
        now.velocity += moved.gained;
        now.attitude = now.attitude * moved.rotation;
    }

    /// Keeps the present point of the track.
    #[inline(always)]
    pub(crate) fn keep(&mut self) {
        if let Some(place) = self.points.get_mut(self.next) {
            *place = self.now;
        }
        self.next = if self.next + 1 < LENGTH { self.next + 1 } else { 0 };
    }

    /// Once in a turn of the ring, after [`Self::keep`]: the track starts anew from `state`.
    #[inline(always)]
    pub(crate) fn renew(&mut self, state: &State) -> bool {
        if self.next != 0 {
            return false;
        }
        let now = &mut self.now;
        now.attitude = now.attitude.renormalized();
        self.seam = (
            now.time,
            state.position - now.position,
            state.velocity - now.velocity,
        );
        now.position = state.position;
        now.velocity = state.velocity;
        true
    }

    /// The world's axes turn: the whole track by `turn`, a rotation in the world.
    pub(crate) fn turn(&mut self, turn: Quaternion) {
        for point in self.points.iter_mut().chain([&mut self.now]) {
            point.position = turn.rotate(point.position);
            point.velocity = turn.rotate(point.velocity);
            point.attitude = turn * point.attitude;
        }
        let (_, position, velocity) = &mut self.seam;
        *position = turn.rotate(*position);
        *velocity = turn.rotate(*velocity);
    }

    /// Where the point so many entries back is kept.
    #[inline(always)]
    fn index(&self, entries: usize) -> Option<usize> {
        if entries >= LENGTH {
            None
        } else if entries < self.next {
            Some(self.next - 1 - entries)
        } else {
            Some(LENGTH + self.next - 1 - entries)
        }
    }

    /// The point so many entries back, on the present track; 0 is the last one written.
    #[inline]
    fn back(&self, entries: usize) -> Option<Point> {
        let index = self.index(entries)?;
        let mut point = *self.points.get(index)?;
        if index >= self.next {
            let (time, position, velocity) = self.seam;
            let since = elapsed(time, point.time) as f32 * 1e-6;
            point.position += position + velocity * since;
            point.velocity += velocity;
        }
        Some(point)
    }

    /// The time of the point so many entries back.
    #[inline(always)]
    fn time_back(&self, entries: usize) -> Option<u32> {
        self.points.get(self.index(entries)?).map(|point| point.time)
    }

    /// The moment `time`, µs.
    pub(crate) fn at(&self, time: u32) -> Result<Past, Unreachable> {
        let age = elapsed(time, self.now.time);
        if age < 0 {
            return Err(Unreachable::Ahead);
        }
        if age == 0 {
            return Ok(Past::NOW);
        }
        // Where it would be if no step was late, then along the ring: at most a few entries.
        let mut entries = (age / NOMINAL) as usize;
        if entries >= LENGTH {
            entries = LENGTH - 1;
        }
        while let Some(then) = self.time_back(entries) {
            let after = elapsed(then, time);
            if after < 0 {
                entries += 1;
                continue;
            }
            match self.time_back(entries.wrapping_sub(1)) {
                Some(next) if entries > 0 && elapsed(next, time) >= 0 => entries -= 1,
                _ => return self.between(entries, after, time).ok_or(Unreachable::Behind),
            }
        }
        Err(Unreachable::Behind)
    }

    /// Between the point so many entries back, which lies `after` µs before `time`, and the next.
    fn between(&self, entries: usize, after: i32, time: u32) -> Option<Past> {
        let a = self.back(entries)?;
        let b = if entries > 0 {
            self.back(entries - 1)?
        } else {
            self.now
        };
        let length = elapsed(a.time, b.time);
        let share = if length > 0 {
            after as f32 / length as f32
        } else {
            0.0
        };
        let position = a.position + (b.position - a.position) * share;
        let velocity = a.velocity + (b.velocity - a.velocity) * share;
        let (from, to) = (a.attitude, b.attitude);
        let near = Quaternion::new(
            from.w + (to.w - from.w) * share,
            from.x + (to.x - from.x) * share,
            from.y + (to.y - from.y) * share,
            from.z + (to.z - from.z) * share,
        );
        let lag = elapsed(time, self.now.time) as f32 * 1e-6;
        Some(Past {
            lag,
            position: position - self.now.position + self.now.velocity * lag,
            velocity: velocity - self.now.velocity,
            turned: (self.now.attitude.conjugate() * near).normalized(),
        })
    }
}
