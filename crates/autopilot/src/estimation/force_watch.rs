//! Whether the accelerometer has begun to show something else.
//!
//! What the rotors' thrust does not explain of the specific force is wind, which comes over
//! seconds, or a push. An accelerometer that fails steps at once. When velocities then go another
//! way than the filter expects, it is the accelerometer's doing, and not a slow turn of the gyro.

use windhover_math::Vector3;

/// What is unexplained lately, s: long against the rotors' shaking.
const LATELY: f32 = 0.25;
/// And what is usual, s.
const USUAL: f32 = 1.5;
/// A step of so much along the thrust, m/s²: no drag is there.
const STEP: f32 = 0.35;
/// And across it: more than the drag of a vehicle that sets off, or a gust.
const STEP_ACROSS: f32 = 1.0;
/// Is remembered for so long, s.
const MEMORY: f32 = 0.7;

/// Watches the specific force against the thrust.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ForceWatch {
    lately: Vector3,
    usual: Vector3,
    is_away: bool,
    remembered: f32,
}

impl ForceWatch {
    /// Takes in what is unexplained (body, m/s²) in an interval of `dt` seconds.
    pub(super) fn look(&mut self, unexplained: Vector3, dt: f32) {
        let share = |time: f32| dt / (time + dt);
        self.lately += (unexplained - self.lately) * share(LATELY);
        let away = self.lately - self.usual;
        self.usual += away * share(USUAL);
        let across = away.x * away.x + away.y * away.y;
        let is_away = away.z.abs() > STEP || across > STEP_ACROSS * STEP_ACROSS;
        self.remembered = if is_away && !self.is_away {
            MEMORY
        } else {
            self.remembered - dt
        };
        self.is_away = is_away;
    }

    /// Whether it has stepped not long ago.
    pub(super) fn has_stepped(&self) -> bool {
        self.remembered > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_remembered_for_a_while_and_wind_that_comes_slowly_is_none() {
        let mut watch = ForceWatch::default();
        let mut wind = 0.0;
        for _ in 0..5000 {
            // 0.1 m/s³
            wind += 0.0004;
            watch.look(Vector3::new(wind, 0.0, 0.0), 0.004);
            assert!(!watch.has_stepped());
        }
        for _ in 0..150 {
            watch.look(Vector3::new(wind, 0.0, 0.8), 0.004);
        }
        assert!(watch.has_stepped());
        for _ in 0..5000 {
            watch.look(Vector3::new(wind, 0.0, 0.8), 0.004);
        }
        assert!(!watch.has_stepped());
    }
}
