//! The logger: takes what the core consumed and gave, and gives bytes to whoever owns the storage.
//!
//! Bytes wait in a ring of `N`. Half of it is reserved for inputs: outputs and views that find the
//! other half full are dropped and counted, and a dropout message says for how long. An input that
//! finds no room at all begins a gap: inputs are no longer logged until there is room again at a
//! boundary, and a `gap` record says from which tick to which they are missing.
//!
//! Calls, in this order: [`Logger::tick`] after each tick of the inner step; [`Logger::inputs`]
//! with what a snapshot froze, before the next boundary; [`Logger::result`] with what the outer
//! step made of it, before the tick that adopts it.

mod config;
mod outlet;
mod reporter;

use windhover_autopilot::{InnerInput, MotorCommand, OuterInputs, OuterResult, ScheduleRecord, Snapshot};

use crate::batch::{ImuBatch, ImuTimes};
use crate::hash::{period_hash, result_hash};
use crate::header::InfoValue;
use crate::inputs::Sink;
use crate::motors::MotorBatch;
use crate::plan::PlanItem;
use crate::record::{Record, Topic, data};
use crate::views::Gap;
use crate::wire::{self, kind, message};

use crate::ring::Storage;
use outlet::Outlet;

pub use config::{LoggerConfig, nominal_step};
pub use reporter::{Latest, Reporter};

/// The longest message of all.
const LONGEST: usize = 256;

/// Periods between two synchronisation messages and two looks at the slow views: one second.
const SLOW: u32 = 250;

/// The logger with its ring of `N` bytes, in an array of its own or a borrowed one.
#[derive(Clone, Debug)]
pub struct Logger<const N: usize, S = [u8; N]> {
    k: usize,
    nominal: u64,
    out: Outlet<S>,
    reporter: Reporter,
    imu: ImuBatch,
    motors: MotorBatch,
    /// Hash of the outer result that was not adopted yet.
    result: Option<u32>,
    /// Hash of the outer result with which this period began.
    adopted: Option<u32>,
    tick: u32,
    periods: u32,
    missed: u32,
    dropped_inputs: u32,
    scratch: [u8; LONGEST],
}

/// Whether a message may use the reserve.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    Input,
    Output,
}

impl<const N: usize> Logger<N> {
    /// Empty, before the first tick.
    pub fn new(config: LoggerConfig) -> Self {
        Self::in_storage(config, [0; N])
    }
}

impl<const N: usize, S: Storage> Logger<N, S> {
    /// Empty, before the first tick, with `N` bytes that lie elsewhere.
    pub fn in_storage(config: LoggerConfig, storage: S) -> Self {
        Self {
            k: config.k(),
            nominal: config.nominal(),
            reporter: Reporter::new(config),
            out: Outlet::new(storage),
            imu: ImuBatch::new(ScheduleRecord {
                tick: 0,
                adopted: false,
                snapshot_taken: false,
            }),
            motors: MotorBatch::new(),
            result: None,
            adopted: None,
            tick: 0,
            periods: 0,
            missed: 0,
            dropped_inputs: 0,
            scratch: [0; LONGEST],
        }
    }

    /// One tick of the inner step: what it took, what it commanded, and what the boundary did.
    #[inline]
    pub fn tick(&mut self, input: &InnerInput, motors: MotorCommand, record: Option<ScheduleRecord>) {
        self.out.time = input.imu.time();
        if let Some(record) = record {
            self.boundary(record);
        }
        if !self.imu.push(&input.imu) {
            // A period longer than any we log: its inputs are not all there.
            self.lose(self.imu.record.tick);
        }
        self.motors.push(motors);
        if let Some(urgent) = input.urgent {
            let (tick, time) = (self.tick, self.out.time);
            self.input(tick, time, &urgent);
        }
        self.tick = self.tick.wrapping_add(1);
    }

    /// Writes the period that ends, and begins the next.
    fn boundary(&mut self, record: ScheduleRecord) {
        self.flush();
        self.tick = record.tick;
        self.periods = self.periods.wrapping_add(1);
        self.missed = self.missed.wrapping_add(u32::from(!record.snapshot_taken));
        if let Some(from) = self.out.gap
            && self.out.ring.free() > self.out.reserve()
        {
            let gap = Gap {
                from,
                until: record.tick,
            };
            self.out.gap = None;
            self.out.end_dropout();
            let time = self.out.time;
            let length = data(&mut self.scratch, Gap::TOPIC.id, time, |out| gap.put(out));
            if !self.push(Class::Input, length) {
                self.out.gap = Some(from);
            }
        }
        if self.periods.is_multiple_of(SLOW) {
            let length = message(&mut self.scratch, kind::SYNC, |out| out.bytes(wire::SYNC));
            self.push(Class::Output, length);
        }
        self.imu.restart(record);
        self.motors.count = 0;
        self.motors.tick = record.tick as u16;
        self.adopted = if record.adopted { self.result.take() } else { None };
    }

    /// Writes the period that has come together.
    fn flush(&mut self) {
        if self.imu.count == 0 {
            return;
        }
        let (k, nominal, tick) = (self.k, self.nominal, self.imu.record.tick);
        if self.out.gap.is_some() {
            self.lose(tick);
        } else if self.flush_inputs(k, nominal) {
            self.motors.hash = period_hash(self.adopted, self.motors.commands());
            let time = self.imu.times[0];
            let motors = &self.motors;
            let length = data(&mut self.scratch, MotorBatch::TOPIC.id, time, |out| {
                motors.put(k, out)
            });
            self.push(Class::Output, length);
        } else {
            self.lose(tick);
        }
        self.imu.count = 0;
        self.motors.count = 0;
    }

    fn flush_inputs(&mut self, k: usize, nominal: u64) -> bool {
        let imu = &self.imu;
        let time = imu.times[0];
        if imu.needs_times(nominal) {
            let exact = ImuTimes {
                tick: imu.record.tick,
                times: imu.times,
            };
            let length = data(&mut self.scratch, ImuTimes::TOPIC.id, time, |out| {
                exact.put(k, out)
            });
            if !self.push(Class::Input, length) {
                return false;
            }
        }
        let imu = &self.imu;
        let length = data(&mut self.scratch, ImuBatch::TOPIC.id, time, |out| {
            imu.put(k, nominal, out);
        });
        self.push(Class::Input, length)
    }

    /// What the snapshot of a boundary froze.
    #[inline]
    pub fn inputs(&mut self, inputs: &OuterInputs, tick: u32) {
        let time = self.imu.times[0];
        Inputs {
            logger: self,
            tick,
            time,
        }
        .take_all(inputs);
    }

    /// What the outer step made of a snapshot.
    pub fn result(&mut self, snapshot: &Snapshot, result: &OuterResult) {
        self.announce(result_hash(result));
        let latest = self.latest();
        let out = &mut self.out;
        self.reporter.report(snapshot, result, || latest, &mut |message| {
            out.message(message);
        });
    }

    /// The hash of the outer result that the next boundary may adopt: [`result_hash`].
    pub fn announce(&mut self, hash: u32) {
        self.result = Some(hash);
    }

    /// What views show of the ticks so far.
    pub fn latest(&self) -> Latest {
        Latest {
            imu: usize::from(self.imu.count)
                .checked_sub(1)
                .and_then(|last| self.imu.imu(last)),
            motors: self.motors.commands().last().copied(),
            missed: self.missed,
            dropped_outputs: self.out.dropped_outputs,
        }
    }

    /// A whole message for people, as [`Reporter`] makes them. `false` when it found no room.
    pub fn message(&mut self, message: &[u8]) -> bool {
        self.out.message(message)
    }

    /// An item that was stored in flight, before a command commits to it.
    pub fn plan_item(&mut self, item: &PlanItem) {
        let time = self.out.time;
        let length = data(&mut self.scratch, PlanItem::TOPIC.id, time, |out| item.put(out));
        if self.out.gap.is_some() || !self.push(Class::Input, length) {
            let tick = self.imu.record.tick;
            self.lose(tick);
        }
    }

    fn input<T: Topic>(&mut self, tick: u32, time: u64, item: &T) {
        let length = data(&mut self.scratch, T::TOPIC.id, time, |out| {
            out.bytes(tick.to_le_bytes());
            item.put(out);
        });
        if self.out.gap.is_some() || !self.push(Class::Input, length) {
            let tick = self.imu.record.tick;
            self.lose(tick);
        }
    }

    /// An input of this period is lost, and with it the period.
    fn lose(&mut self, tick: u32) {
        self.out.gap.get_or_insert(tick);
        self.out.dropout_since.get_or_insert(self.out.time);
        self.dropped_inputs = self.dropped_inputs.saturating_add(1);
    }

    /// A record for people, or of a model. `false` when it found no room.
    pub fn view<T: Topic>(&mut self, time: u64, view: &T) -> bool {
        let length = data(&mut self.scratch, T::TOPIC.id, time, |out| view.put(out));
        self.push(Class::Output, length)
    }

    /// A line of text, at PX4's level "info". `false` when it found no room or is too long.
    pub fn text(&mut self, time: u64, text: &str) -> bool {
        let length = message(&mut self.scratch, kind::TEXT, |out| {
            out.bytes([b'6']);
            out.bytes(time.to_le_bytes());
            out.slice(text.as_bytes());
        });
        self.push(Class::Output, length)
    }

    /// A named value that is known only now. `false` when it found no room or is too long.
    pub fn info(&mut self, name: &str, value: InfoValue<'_>) -> bool {
        let length = message(&mut self.scratch, kind::INFO, |out| value.put(name, out));
        self.push(Class::Output, length)
    }

    /// Puts the message in `scratch` into the ring.
    #[inline]
    fn push(&mut self, class: Class, length: Option<usize>) -> bool {
        if class == Class::Output && !self.out.make_room(length.unwrap_or(N)) {
            return false;
        }
        match length.and_then(|length| self.scratch.get(..length)) {
            Some(message) => self.out.ring.push(message),
            None => false,
        }
    }

    /// Writes the period that has begun, as far as it has come: at the end of a log.
    pub fn finish(&mut self) {
        self.flush();
    }

    /// Moves bytes out, the oldest first, messages cut anywhere; how many.
    pub fn drain(&mut self, to: &mut [u8]) -> usize {
        self.out.ring.drain(to)
    }

    /// How many bytes wait.
    pub fn waiting(&self) -> usize {
        self.out.ring.len()
    }

    /// Outputs and views that found no room.
    pub fn dropped_outputs(&self) -> u32 {
        self.out.dropped_outputs
    }

    /// Inputs that found no room, a whole period counted as one.
    pub fn dropped_inputs(&self) -> u32 {
        self.dropped_inputs
    }
}

struct Inputs<'a, const N: usize, S> {
    logger: &'a mut Logger<N, S>,
    tick: u32,
    time: u64,
}

impl<const N: usize, S: Storage> Sink for Inputs<'_, N, S> {
    fn take<T: Topic>(&mut self, item: &T) {
        self.logger.input(self.tick, self.time, item);
    }
}
