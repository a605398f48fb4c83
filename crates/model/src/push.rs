//! Pushes: forces from outside over a span of time.

use windhover_math::Vector3;

/// A constant force on the centre of mass over a span of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// When it begins, in s.
    pub start: f64,
    /// The force in NED, in N.
    pub force: Vector3<f64>,
    /// How long it lasts, in s.
    pub duration: f64,
}

impl Push {
    /// The pushes of the reference conditions: 4 N for 0.5 s, north at 30 s and east at 60 s.
    pub fn reference() -> Vec<Self> {
        vec![
            Self {
                start: 30.0,
                force: Vector3::new(4.0, 0.0, 0.0),
                duration: 0.5,
            },
            Self {
                start: 60.0,
                force: Vector3::new(0.0, 4.0, 0.0),
                duration: 0.5,
            },
        ]
    }
}

/// Pushes with their times in whole nanoseconds.
#[derive(Clone, Debug)]
pub(crate) struct Pushes(Vec<Span>);

#[derive(Clone, Debug)]
struct Span {
    start_ns: u64,
    end_ns: u64,
    force: Vector3<f64>,
}

impl Pushes {
    pub(crate) fn new(pushes: &[Push]) -> Self {
        let ns = |seconds: f64| libm::round(seconds * 1e9) as u64;
        let span = |push: &Push| Span {
            start_ns: ns(push.start),
            end_ns: ns(push.start + push.duration),
            force: push.force,
        };
        Self(pushes.iter().map(span).collect())
    }

    /// The mean force in N over a step: its impulse does not depend on where steps begin.
    #[inline(always)]
    pub(crate) fn mean_force(&self, start_ns: u64, length_ns: u64) -> Vector3<f64> {
        let end_ns = start_ns + length_ns;
        let mut force = Vector3::zeros();
        for push in &self.0 {
            if push.start_ns < end_ns && push.end_ns > start_ns {
                let from = Ord::max(push.start_ns, start_ns);
                let to = Ord::min(push.end_ns, end_ns);
                force += push.force * ((to - from) as f64 / length_ns as f64);
            }
        }
        force
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::length::Length;

    #[test]
    fn the_impulse_does_not_depend_on_the_steps() {
        let east = Push {
            start: 0.1004,
            force: Vector3::new(0.0, 4.0, 0.0),
            duration: 0.05,
        };
        let up = Push {
            start: 0.12,
            force: Vector3::new(0.0, 0.0, -1.0),
            duration: 0.1,
        };
        let pushes = Pushes::new(&[east, up]);
        for step_ns in [1_000_000, 250_000, 7_000_000, 300_000_000] {
            let mut impulse = Vector3::zeros();
            let mut time = 0;
            while time < 300_000_000 {
                impulse += pushes.mean_force(time, step_ns) * (step_ns as f64 * 1e-9);
                time += step_ns;
            }
            assert!(
                (impulse - Vector3::new(0.0, 0.2, -0.1)).length() < 1e-12,
                "{step_ns}"
            );
        }
        assert_eq!(pushes.mean_force(100_000_000, 400_000), Vector3::zeros());
        assert_eq!(pushes.mean_force(101_000_000, 1_000_000), east.force);
    }

    #[test]
    fn the_reference_pushes_are_those_of_the_design() {
        let pushes = Pushes::new(&Push::reference());
        let at = |seconds: f64| pushes.mean_force((seconds * 1e9) as u64, 1_000_000);
        assert_eq!(at(29.9), Vector3::zeros());
        assert_eq!(at(30.2), Vector3::new(4.0, 0.0, 0.0));
        assert_eq!(at(30.6), Vector3::zeros());
        assert_eq!(at(60.2), Vector3::new(0.0, 4.0, 0.0));
    }
}
