//! What the inner step consumes, one message a period of the outer step.
//!
//! A period is K ticks from a boundary on, 4 at 1 kHz, 16 at 4 kHz. Times of its ticks are the
//! first one's, and for each further tick the deviation of its step from the nominal one in an
//! `int8_t`, µs. Where a step does not fit, `imu_times` goes before with every time.

use windhover_autopilot::{Imu, ImuCounts, ScheduleRecord};

use crate::record::{Count, Description, Field};
use crate::value::{Scalar, Value};
use crate::wire::{Decoder, Encoder};

/// The most ticks of a period.
pub const MAX_K: usize = 16;

const ADOPTED: u8 = 1;
const SNAPSHOT: u8 = 2;
const EXACT_TIMES: u8 = 4;
const COUNT_SHIFT: u8 = 3;

/// The inputs of the inner step in one period, and what its boundary did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuBatch {
    /// The boundary with which it begins.
    pub record: ScheduleRecord,
    /// How many ticks; fewer than K only at the end of a log.
    pub count: u8,
    /// Bit n is set when tick n brought no sample; its counts are 0.
    pub missing: u16,
    /// Time of each tick, µs.
    pub times: [u64; MAX_K],
    /// Raw counts of each tick.
    pub counts: [ImuCounts; MAX_K],
}

pub(crate) const fn field(name: &'static str, scalar: Scalar, count: Count) -> Field {
    Field { name, scalar, count }
}

impl ImuBatch {
    /// What a log says of it. `flags`: 1 adopted, 2 snapshot taken, 4 times are in `imu_times`,
    /// 8·ticks.
    pub const TOPIC: Description = Description {
        id: 1,
        name: "imu_batch",
        ticked: true,
        fields: &[
            field("missing", Scalar::U16, Count::One),
            field("flags", Scalar::U8, Count::One),
            field("step", Scalar::I8, Count::PerStep),
            field("accel", Scalar::I16, Count::PerTick(3)),
            field("gyro", Scalar::I16, Count::PerTick(3)),
        ],
    };

    /// Before its first tick.
    pub const fn new(record: ScheduleRecord) -> Self {
        Self {
            record,
            count: 0,
            missing: 0,
            times: [0; MAX_K],
            counts: [ImuCounts {
                accel: [0; 3],
                gyro: [0; 3],
            }; MAX_K],
        }
    }

    /// Begins the next period.
    #[inline]
    pub fn restart(&mut self, record: ScheduleRecord) {
        self.record = record;
        self.count = 0;
        self.missing = 0;
    }

    /// Adds a tick; `false` when it is one too many.
    #[inline]
    pub fn push(&mut self, imu: &Imu) -> bool {
        let index = usize::from(self.count);
        let (Some(counts), Some(time)) = (self.counts.get_mut(index), self.times.get_mut(index)) else {
            return false;
        };
        match imu {
            Imu::Sample {
                counts: read,
                time: at,
            } => (*counts, *time) = (*read, *at),
            Imu::Missing { time: at } => {
                (*counts, *time) = (ImuCounts::default(), *at);
                self.missing |= 1 << index;
            }
        }
        self.count += 1;
        true
    }

    /// One tick as the inner step saw it; `None` beyond the last.
    pub fn imu(&self, index: usize) -> Option<Imu> {
        if index >= usize::from(self.count) {
            return None;
        }
        let (counts, time) = (*self.counts.get(index)?, *self.times.get(index)?);
        Some(if self.missing >> index & 1 == 1 {
            Imu::Missing { time }
        } else {
            Imu::Sample { counts, time }
        })
    }

    /// Deviations from the nominal step, tick by tick; `None` when one does not fit.
    #[inline]
    fn steps(&self, nominal: u64) -> Option<[u8; MAX_K]> {
        let mut steps = [0; MAX_K];
        let count = usize::from(self.count);
        for (step, pair) in steps.iter_mut().zip(self.times.get(..count)?.windows(2)) {
            let deviation = match pair {
                [a, b] => b.wrapping_sub(*a).wrapping_sub(nominal) as i64,
                _ => 0,
            };
            *step = i8::try_from(deviation).ok()?.cast_unsigned();
        }
        Some(steps)
    }

    /// Whether the times fit, or [`ImuTimes`] has to go before.
    pub fn needs_times(&self, nominal: u64) -> bool {
        self.steps(nominal).is_none()
    }

    /// Writes it but for its time, which stands before: that of the first tick.
    #[inline]
    pub fn put(&self, k: usize, nominal: u64, out: &mut Encoder<'_>) {
        let steps = self.steps(nominal);
        let flag = |set: bool, bit| if set { bit } else { 0 };
        let flags = flag(self.record.adopted, ADOPTED)
            | flag(self.record.snapshot_taken, SNAPSHOT)
            | flag(steps.is_none(), EXACT_TIMES)
            | self.count << COUNT_SHIFT;
        self.record.tick.put(out);
        self.missing.put(out);
        flags.put(out);
        for step in steps.unwrap_or_default().iter().take(k.saturating_sub(1)) {
            step.put(out);
        }
        let count = usize::from(self.count);
        let absent = ImuCounts::default();
        let ticks = || {
            (0..k.min(MAX_K))
                .zip(&self.counts)
                .map(|(n, counts)| if n < count { counts } else { &absent })
        };
        for counts in ticks() {
            let [[a, b], [c, d], [e, f]] = counts.accel.map(i16::to_le_bytes);
            out.bytes([a, b, c, d, e, f]);
        }
        for counts in ticks() {
            let [[a, b], [c, d], [e, f]] = counts.gyro.map(i16::to_le_bytes);
            out.bytes([a, b, c, d, e, f]);
        }
    }

    /// Reads what [`Self::put`] wrote. `time` stood before it, `exact` is the last [`ImuTimes`].
    pub fn get(
        time: u64,
        k: usize,
        nominal: u64,
        exact: Option<&ImuTimes>,
        from: &mut Decoder<'_>,
    ) -> Option<Self> {
        let tick = u32::get(from)?;
        let missing = u16::get(from)?;
        let flags = u8::get(from)?;
        let mut batch = Self::new(ScheduleRecord {
            tick,
            adopted: flags & ADOPTED != 0,
            snapshot_taken: flags & SNAPSHOT != 0,
        });
        batch.missing = missing;
        batch.count = flags >> COUNT_SHIFT;
        if batch.count == 0 || usize::from(batch.count) > k.min(MAX_K) {
            return None;
        }
        let mut at = time;
        for (n, place) in batch.times.iter_mut().take(k).enumerate() {
            if n > 0 {
                let deviation = i64::from(i8::get(from)?);
                at = at.wrapping_add(nominal).wrapping_add_signed(deviation);
            }
            *place = at;
        }
        if flags & EXACT_TIMES != 0 {
            batch.times = exact.filter(|exact| exact.tick == tick)?.times;
        }
        for counts in batch.counts.iter_mut().take(k) {
            counts.accel = Value::get(from)?;
        }
        for counts in batch.counts.iter_mut().take(k) {
            counts.gyro = Value::get(from)?;
        }
        Some(batch)
    }
}

/// The time of every tick of a period whose steps are far from nominal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImuTimes {
    /// The boundary with which the period begins.
    pub tick: u32,
    /// Time of each tick, µs.
    pub times: [u64; MAX_K],
}

impl ImuTimes {
    /// What a log says of it.
    pub const TOPIC: Description = Description {
        id: 2,
        name: "imu_times",
        ticked: true,
        fields: &[field("time", Scalar::U64, Count::PerTick(1))],
    };

    /// Writes it but for its time.
    pub fn put(&self, k: usize, out: &mut Encoder<'_>) {
        self.tick.put(out);
        for time in self.times.iter().take(k) {
            time.put(out);
        }
    }

    /// Reads it but for its time.
    pub fn get(k: usize, from: &mut Decoder<'_>) -> Option<Self> {
        let tick = u32::get(from)?;
        let mut times = [0; MAX_K];
        for time in times.iter_mut().take(k) {
            *time = Value::get(from)?;
        }
        Some(Self { tick, times })
    }
}
