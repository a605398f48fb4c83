//! Simulated time against the clock: how far a simulation is to be.

/// A simulation that is behind by more than this does not catch up, s of simulated time at speed 1.
const BEHIND: f64 = 0.25;

/// Paces a simulation by the clock.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Simulated seconds in one of the clock; 0 for as many as there can be.
    speed: f64,
    /// A moment by the clock, and the simulated time that belongs to it, s.
    origin: (f64, f64),
}

impl Pace {
    /// So many simulated seconds in one of the clock, 0 for as many as there can be, from a simulated
    /// time on, s, while the clock is at 0.
    pub fn new(speed: f64, simulated: f64) -> Self {
        Self {
            speed,
            origin: (0.0, simulated),
        }
    }

    /// Where the simulated time is to be while it is at `simulated`, s, and the clock at `clock`, s. A
    /// machine that is too slow does not owe what it is behind.
    pub fn wanted(&mut self, clock: f64, simulated: f64) -> f64 {
        if self.speed == 0.0 {
            return f64::INFINITY;
        }
        let (since, before) = self.origin;
        let wanted = before + (clock - since) * self.speed;
        if wanted - simulated > BEHIND * self.speed {
            self.origin = (clock, simulated);
        }
        wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_times_the_speed() {
        let mut pace = Pace::new(4.0, 10.0);
        assert_eq!(pace.wanted(0.5, 11.5), 12.0);
        assert_eq!(
            pace.wanted(1.0, 13.9),
            14.0,
            "what was a little behind is made good"
        );
    }

    #[test]
    fn who_is_far_behind_starts_again_from_there() {
        let mut pace = Pace::new(2.0, 0.0);
        pace.wanted(10.0, 3.0);
        assert_eq!(pace.wanted(10.5, 3.5), 4.0, "not 21");
    }

    #[test]
    fn without_a_speed_there_is_no_end() {
        assert_eq!(Pace::new(0.0, 0.0).wanted(1.0, 1e6), f64::INFINITY);
    }
}
