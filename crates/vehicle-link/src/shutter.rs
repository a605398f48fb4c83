//! Photos that a ground station asks for one after the other, by time or by distance.

use windhover_math::{Vector3, max, scalar};

/// The shortest time between two photos, s.
const SHORTEST: f32 = 0.1;

/// What photos are to be taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shutter {
    series: Option<Series>,
    distance: Option<Distance>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Series {
    /// µs.
    interval: u64,
    /// `None` goes on until told to stop.
    left: Option<u32>,
    due: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Distance {
    /// m.
    between: f32,
    /// Where the last one was taken, NED, m; where none was, one is due.
    last: Option<Vector3>,
}

impl Shutter {
    /// One every `interval` seconds from `now` (µs) on; `count` of 0 goes on until told to stop.
    pub fn start(&mut self, interval: f32, count: u32, now: u64) {
        self.series = Some(Series {
            interval: (max(interval, SHORTEST) * 1e6) as u64,
            left: (count > 0).then_some(count),
            due: now,
        });
    }

    /// One every so many metres from `last` on, or the first one at once; 0 stops.
    pub fn by_distance(&mut self, between: f32, last: Option<Vector3>) {
        self.distance = (between > 0.0).then_some(Distance { between, last });
    }

    /// A photo was taken here, whoever asked for it.
    pub fn taken(&mut self, here: Vector3) {
        if let Some(distance) = &mut self.distance {
            distance.last = Some(here);
        }
    }

    /// Whether a photo is to be taken at `now` µs.
    pub fn is_due(&mut self, now: u64, here: Vector3) -> bool {
        if let Some(distance) = &mut self.distance
            && distance
                .last
                .is_none_or(|last| scalar::norm(here - last) >= distance.between)
        {
            distance.last = Some(here);
            return true;
        }
        let Some(series) = self.series.as_mut().filter(|series| now >= series.due) else {
            return false;
        };
        series.due = now + series.interval;
        if let Some(left) = &mut series.left {
            *left -= 1;
            if *left == 0 {
                self.series = None;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_takes_as_many_as_were_asked_for() {
        let mut shutter = Shutter::default();
        shutter.start(0.5, 3, 1_000_000);
        let times = (0..5_000).map(|ms| 1_000_000 + ms * 1000);
        let taken: Vec<u64> = times
            .filter(|now| shutter.is_due(*now, Vector3::zeros()))
            .collect();
        assert_eq!(taken, [1_000_000, 1_500_000, 2_000_000]);
    }

    #[test]
    fn one_without_an_end_goes_on_until_it_is_stopped() {
        let mut shutter = Shutter::default();
        shutter.start(0.0, 0, 0);
        let count = |shutter: &mut Shutter| {
            (0..1000u64)
                .filter(|ms| shutter.is_due(ms * 1000, Vector3::zeros()))
                .count()
        };
        assert_eq!(count(&mut shutter), 10, "ten a second at most");
        shutter = Shutter::default();
        assert_eq!(count(&mut shutter), 0);
    }

    #[test]
    fn by_distance_photos_count_from_the_last_one() {
        let mut shutter = Shutter::default();
        let at = |north: f32| Vector3::new(north, 0.0, -10.0);
        shutter.by_distance(5.0, Some(at(0.0)));
        let taken: Vec<i32> = (0..=12)
            .filter(|north| shutter.is_due(0, at(*north as f32)))
            .collect();
        assert_eq!(taken, [5, 10]);
        shutter.taken(at(12.0));
        assert!(!shutter.is_due(0, at(16.0)));
        assert!(shutter.is_due(0, at(17.0)));
        shutter.by_distance(5.0, None);
        assert!(shutter.is_due(0, at(17.0)), "at once");
        assert!(!shutter.is_due(0, at(21.0)));
        shutter.by_distance(0.0, None);
        assert!(!shutter.is_due(0, at(100.0)));
    }
}
