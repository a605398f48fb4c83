//! How many bytes a channel may carry.

/// A budget of bytes a second, with a reserve of what was not used lately.
///
/// Something may be sent while there is any credit; its whole length is then taken off, so that
/// over time the rate is kept whatever the lengths.
#[derive(Clone, Debug)]
pub struct Budget {
    /// Bytes a second.
    rate: u32,
    /// Byte-microseconds per second: bytes times a million.
    credit: i64,
    time: Option<u64>,
}

/// The reserve lasts so long, µs.
const RESERVE: i64 = 50_000;

/// The least reserve, bytes: a frame.
const LEAST: i64 = 300;

/// One byte of credit.
const BYTE: i64 = 1_000_000;

impl Budget {
    /// So many bytes a second.
    pub fn new(rate: u32) -> Self {
        let mut budget = Self {
            rate,
            credit: 0,
            time: None,
        };
        budget.credit = budget.reserve();
        budget
    }

    fn reserve(&self) -> i64 {
        (i64::from(self.rate) * RESERVE).max(LEAST * BYTE)
    }

    /// Time has gone on to `now`, µs.
    pub fn advance(&mut self, now: u64) {
        let elapsed = now.saturating_sub(self.time.unwrap_or(now)).min(10_000_000);
        self.time = Some(now);
        let gained = i64::from(self.rate).saturating_mul(i64::try_from(elapsed).unwrap_or_default());
        self.credit = self.credit.saturating_add(gained).min(self.reserve());
    }

    /// Whether something may be sent.
    pub fn allows(&self) -> bool {
        self.credit > 0
    }

    /// Whether an answer may be sent: these may use the channel in advance, as much as the reserve.
    pub fn allows_answer(&self) -> bool {
        self.credit > -self.reserve()
    }

    /// So many bytes were sent.
    pub fn spend(&mut self, bytes: usize) {
        let bytes = i64::try_from(bytes).unwrap_or(i64::MAX);
        self.credit = self.credit.saturating_sub(bytes.saturating_mul(BYTE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn over_time_the_rate_is_kept() {
        let mut budget = Budget::new(1000);
        let mut sent = 0;
        for now in (0..10_000_000).step_by(1000) {
            budget.advance(now);
            while budget.allows() {
                budget.spend(47);
                sent += 47;
            }
        }
        assert!((10_000..10_000 + 400).contains(&sent), "{sent}");
    }

    #[test]
    fn answers_go_ahead_but_not_without_end() {
        let mut budget = Budget::new(1000);
        budget.advance(0);
        let mut sent = 0;
        while budget.allows_answer() {
            budget.spend(30);
            sent += 30;
        }
        assert!(!budget.allows());
        assert!((600..=630).contains(&sent), "{sent}");
        budget.advance(u64::MAX);
        assert!(budget.allows());
    }
}
