//! A channel that loses, delays and repeats frames, from a seed.

/// xorshift64*: small, seeded, and good enough to lose frames with.
#[derive(Clone)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    /// True with this probability, in percent.
    pub fn percent(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }
}

/// One direction of a channel.
pub struct Channel {
    pub loss: u64,
    pub repeats: u64,
    pub delay: u64,
    pub jitter: u64,
    random: Random,
    under_way: Vec<(u64, Vec<u8>)>,
}

impl Channel {
    pub fn clean() -> Self {
        Self::new(0, 0, 0, 0, 1)
    }

    /// 20 % loss, 30 ms jitter, 2 % repeated.
    pub fn bad(seed: u64) -> Self {
        Self::new(20, 2, 10_000, 30_000, seed)
    }

    pub fn new(loss: u64, repeats: u64, delay: u64, jitter: u64, seed: u64) -> Self {
        Self {
            loss,
            repeats,
            delay,
            jitter,
            random: Random::new(seed),
            under_way: Vec::new(),
        }
    }

    pub fn send(&mut self, now: u64, frame: Vec<u8>) {
        if self.random.percent(self.loss) {
            return;
        }
        let copies = 1 + usize::from(self.random.percent(self.repeats));
        for _ in 0..copies {
            let jitter = if self.jitter > 0 {
                self.random.below(self.jitter)
            } else {
                0
            };
            self.under_way.push((now + self.delay + jitter, frame.clone()));
        }
    }

    pub fn arrived(&mut self, now: u64) -> Vec<Vec<u8>> {
        self.under_way.sort_by_key(|(at, _)| *at);
        let count = self.under_way.iter().take_while(|(at, _)| *at <= now).count();
        self.under_way.drain(..count).map(|(_, frame)| frame).collect()
    }
}
