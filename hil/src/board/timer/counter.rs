//! The counter itself, with the prescaler, reload and compare values that are in force.

use crate::time::NEVER;

pub(super) struct Counter {
    /// The highest count of the register.
    top: u32,
    /// Ticks in a cycle of its clock; none while that is gated off.
    cycle: Option<u64>,
    prescaler: u32,
    reload: u32,
    compares: [u32; 4],
    /// The count at the time `since`, when it began.
    count: u32,
    since: u64,
}

impl Counter {
    pub(super) fn new(top: u32) -> Self {
        Self {
            top,
            cycle: None,
            prescaler: 0,
            reload: top,
            compares: [0; 4],
            count: 0,
            since: 0,
        }
    }

    /// Everything is counted up to now already.
    pub(super) fn set_clock(&mut self, now: u64, cycle: Option<u64>) {
        if self.cycle != cycle {
            self.cycle = cycle;
            self.since = now;
        }
    }

    /// Ticks in a count; none while it does not count.
    fn step(&self) -> Option<u64> {
        // A counter whose reload value is zero is blocked.
        let cycle = self.cycle.filter(|_| self.reload != 0)?;
        Some(cycle * (u64::from(self.prescaler) + 1))
    }

    /// Ticks in a period, while it counts.
    pub(super) fn period(&self) -> Option<u64> {
        Some(self.step()? * (u64::from(self.reload) + 1))
    }

    /// Ticks of a period before a channel matches; the whole period where it does not.
    pub(super) fn compare_time(&self, channel: usize) -> Option<u64> {
        let counts = u64::from(self.compares[channel]).min(u64::from(self.reload) + 1);
        Some(self.step()? * counts)
    }

    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// When the present count began.
    pub(super) fn since(&self) -> u64 {
        self.since
    }

    pub(super) fn set_count(&mut self, count: u32) {
        self.count = count & self.top;
    }

    /// Starts again from zero, the prescaler too.
    pub(super) fn restart(&mut self, now: u64) {
        self.count = 0;
        self.since = now;
    }

    /// It stands still; what the prescaler had counted is lost.
    pub(super) fn hold(&mut self, now: u64) {
        self.since = now;
    }

    pub(super) fn load(&mut self, prescaler: u32, reload: u32, compares: [u32; 4]) {
        self.prescaler = prescaler;
        self.reload = reload;
        self.compares = compares;
    }

    pub(super) fn set_reload(&mut self, reload: u32) {
        self.reload = reload;
    }

    pub(super) fn set_compare(&mut self, channel: usize, value: u32) {
        self.compares[channel] = value;
    }

    /// The count after which it wraps: a count beyond the reload value runs to the top.
    fn last(&self) -> u32 {
        if self.count > self.reload {
            self.top
        } else {
            self.reload
        }
    }

    /// When it wraps to zero.
    pub(super) fn next_overflow(&self) -> u64 {
        let counts = u64::from(self.last() - self.count) + 1;
        self.step().map_or(NEVER, |step| self.since + counts * step)
    }

    /// When a channel matches in this period; at its end, if not before.
    pub(super) fn next_match(&self, channel: usize) -> u64 {
        let compare = self.compares[channel];
        if compare <= self.count || compare > self.last() {
            return self.next_overflow();
        }
        let counts = u64::from(compare - self.count);
        self.step().map_or(NEVER, |step| self.since + counts * step)
    }

    /// Wraps. Returns whether that is an overflow: from the top it is none.
    pub(super) fn overflow(&mut self) -> bool {
        let overflows = self.last() == self.reload;
        self.since = self.next_overflow();
        self.count = 0;
        overflows
    }

    /// Jumps over whole periods before now. Returns whether there were any.
    pub(super) fn skip_periods(&mut self, now: u64) -> bool {
        let Some(period) = self.period() else {
            return false;
        };
        let periods = now.saturating_sub(self.since) / period;
        self.since += periods * period;
        periods > 0
    }

    /// Counts up to now within this period. Returns the channels that matched.
    pub(super) fn count_to(&mut self, now: u64) -> u32 {
        let Some(step) = self.step() else {
            self.since = now;
            return 0;
        };
        let counts = now.saturating_sub(self.since) / step;
        let before = self.count;
        self.count += counts as u32;
        self.since += counts * step;
        self.matches(before, self.count)
    }

    /// Channels that match after `before`, up to `until`.
    fn matches(&self, before: u32, until: u32) -> u32 {
        self.channels_with(|compare| before < compare && compare <= until)
    }

    /// Channels that match from the present count to the end of the period.
    pub(super) fn matches_before_overflow(&self) -> u32 {
        self.matches(self.count, self.last())
    }

    /// Channels whose value is above the reload value: they match when the counter overflows.
    pub(super) fn matches_beyond_period(&self) -> u32 {
        self.channels_with(|compare| compare > self.reload)
    }

    pub(super) fn matches_at_zero(&self) -> u32 {
        self.channels_with(|compare| compare == 0)
    }

    fn channels_with(&self, holds: impl Fn(u32) -> bool) -> u32 {
        self.compares
            .iter()
            .enumerate()
            .fold(0, |channels, (channel, compare)| {
                channels | u32::from(holds(*compare)) << channel
            })
    }
}
