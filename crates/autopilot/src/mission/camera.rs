//! When photos are taken that the vehicle does not stop for: every so many metres or seconds.

use windhover_math::{Vector3, sqrt};

/// What releases the shutter next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Trigger {
    /// Nothing.
    #[default]
    Off,
    /// So many metres from where the last photo was taken.
    Distance {
        /// Metres between two photos.
        distance: f32,
        /// Where the last one was taken, NED, m.
        last: Vector3,
    },
    /// So many seconds after the last photo.
    Time {
        /// Seconds between two photos.
        interval: f32,
        /// Seconds since the last one.
        since: f32,
        /// How many are left; `None` for no end.
        left: Option<u16>,
    },
}

impl Trigger {
    /// Goes on by `dt` seconds with the vehicle at `position` (NED, m); whether the shutter is
    /// released.
    pub fn step(&mut self, position: Vector3, dt: f32) -> bool {
        match self {
            Self::Off => false,
            Self::Distance { distance, last } => {
                let way = position - *last;
                let due = sqrt(way.x * way.x + way.y * way.y) >= *distance;
                if due {
                    *last = position;
                }
                due
            }
            Self::Time {
                interval,
                since,
                left,
            } => {
                *since += dt;
                if *since < *interval {
                    return false;
                }
                *since = 0.0;
                if let Some(left) = left {
                    *left = left.saturating_sub(1);
                    if *left == 0 {
                        *self = Self::Off;
                    }
                }
                true
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_distance() {
        let mut trigger = Trigger::Distance {
            distance: 10.0,
            last: Vector3::zeros(),
        };
        let photos = (0..=100)
            .filter(|n| trigger.step(Vector3::new(*n as f32 * 0.5, 0.0, -30.0), 0.1))
            .count();
        assert_eq!(photos, 5);
    }

    #[test]
    fn by_time_with_an_end() {
        let mut trigger = Trigger::Time {
            interval: 2.0,
            since: 2.0,
            left: Some(3),
        };
        let photos: u32 = (0..100)
            .map(|_| u32::from(trigger.step(Vector3::zeros(), 0.25)))
            .sum();
        assert_eq!(photos, 3);
        assert_eq!(trigger, Trigger::Off);
    }
}
