//! Logical execution time: when the inner step adopts results, and when snapshots are taken.
//!
//! Preemption makes ordinary firmware unrepeatable: which setpoint an attitude step sees depends
//! on how long the position step took. Here inputs are frozen and results adopted only at
//! boundaries, every K-th tick. A result that is late waits for the next boundary and is never
//! thrown away; while it is out there is no new snapshot, and a miss is counted. So the one thing
//! about the outer step's timing that can matter is, at each boundary, whether its result was
//! there: [`ScheduleRecord::adopted`]. Given these records a run repeats exactly.

use crate::io::ScheduleRecord;

/// How often the outer step runs, per second, at nominal rate.
pub const OUTER_RATE: u32 = 250;

/// Whether the inner loop has waited too long for the outer one: 100 ms, in outer periods.
const SILENCE_PERIODS: u32 = OUTER_RATE / 10;

/// The schedule's state: a counter and whether the outer step is at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    k: u32,
    tick: u32,
    phase: u32,
    busy: bool,
    periods_since_result: u32,
    misses: u32,
}

impl Schedule {
    /// A schedule with a boundary every `k` ticks, the first at tick 0.
    pub const fn new(k: u32) -> Self {
        Self {
            k: if k == 0 { 1 } else { k },
            tick: 0,
            phase: 0,
            busy: false,
            periods_since_result: 0,
            misses: 0,
        }
    }

    /// Whether the coming tick is a boundary: only then is a result looked for.
    #[inline]
    pub fn at_boundary(&self) -> bool {
        self.phase == 0
    }

    /// Whether a snapshot has been given to the outer step whose result was not adopted yet.
    #[inline]
    pub fn is_busy(&self) -> bool {
        self.busy
    }

    /// The number of the coming tick.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// How many boundaries found the outer step still at work.
    pub fn misses(&self) -> u32 {
        self.misses
    }

    /// Whether there has been no result for 100 ms.
    #[inline]
    pub fn is_outer_silent(&self) -> bool {
        self.periods_since_result > SILENCE_PERIODS
    }

    /// Goes on by one tick. At a boundary, `adopted` says whether a result is adopted, and the
    /// record says what happens.
    #[inline]
    pub fn advance(&mut self, adopted: bool) -> Option<ScheduleRecord> {
        let record = self.at_boundary().then(|| self.boundary(adopted));
        self.tick = self.tick.wrapping_add(1);
        self.phase = if self.phase + 1 >= self.k { 0 } else { self.phase + 1 };
        record
    }

    fn boundary(&mut self, adopted: bool) -> ScheduleRecord {
        if adopted {
            self.busy = false;
            self.periods_since_result = 0;
        } else {
            self.periods_since_result = self.periods_since_result.saturating_add(1);
        }
        let snapshot_taken = !self.busy;
        if self.busy {
            self.misses = self.misses.saturating_add(1);
        }
        self.busy = true;
        ScheduleRecord {
            tick: self.tick,
            adopted,
            snapshot_taken,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boundaries_are_every_kth_tick_from_zero() {
        for k in [1, 4, 16] {
            let mut schedule = Schedule::new(k);
            for tick in 0..100 {
                assert_eq!(schedule.at_boundary(), tick % k == 0);
                let record = schedule.advance(tick > 0);
                assert_eq!(record.map(|r| r.tick), (tick % k == 0).then_some(tick));
            }
        }
    }

    /// All ways in which an outer step can be late over ten boundaries: a snapshot exactly when
    /// no result is out, a miss exactly when one is, and nothing lost.
    #[test]
    fn every_pattern_of_lateness() {
        for pattern in 0u32..1 << 10 {
            let mut schedule = Schedule::new(2);
            let (mut given, mut adopted, mut misses) = (0, 0, 0);
            for boundary in 0..10 {
                let ready = given > adopted && pattern >> boundary & 1 == 1;
                let record = schedule.advance(ready).expect("a boundary");
                assert!(schedule.advance(false).is_none(), "between boundaries nothing happens");
                adopted += u32::from(record.adopted);
                assert_eq!(record.snapshot_taken, given == adopted, "pattern {pattern:b}");
                given += u32::from(record.snapshot_taken);
                misses += u32::from(!record.snapshot_taken);
                assert!(given == adopted + 1, "one snapshot is out after every boundary");
            }
            assert_eq!(schedule.misses(), misses);
        }
    }

    #[test]
    fn silence_is_noticed_after_100_ms() {
        let mut schedule = Schedule::new(4);
        let mut silent_after = None;
        for tick in 0..1000u32 {
            schedule.advance(false);
            if schedule.is_outer_silent() && silent_after.is_none() {
                silent_after = Some(tick);
            }
        }
        assert_eq!(silent_after, Some(100));
    }
}
