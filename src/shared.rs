//! What passes between priorities: the schedule's mailboxes, the log, and a few counters.
//!
//! Everything lies behind one lock that is held for microseconds: it turns interrupts off.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use embassy_sync::blocking_mutex::CriticalSectionMutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use windhover_autopilot::{Mailboxes, Urgent};
use windhover_flight_log::Logger;
use windhover_vehicle_link::Told;

/// Bytes that the log may hold while its port is busy: most of it while the header goes out.
pub const LOG_BYTES: usize = 14_336;

/// The log as the firmware keeps it.
pub type FlightLog = Logger<LOG_BYTES, &'static mut [u8; LOG_BYTES]>;

/// What the lock guards.
pub struct Shared {
    /// The schedule's mailboxes.
    pub mailboxes: Mailboxes,
    /// The log, from the start of the core on.
    pub log: &'static mut FlightLog,
    /// What the steps have told ground stations.
    pub told: &'static mut Told,
}

static SHARED: CriticalSectionMutex<RefCell<Option<Shared>>> = CriticalSectionMutex::new(RefCell::new(None));

/// Work for the outer loop lies in its mailbox.
pub static SNAPSHOT: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// The inertial sensors have a sample since that time, µs since start.
pub static DATA_READY: Signal<CriticalSectionRawMutex, u64> = Signal::new();

static URGENT: AtomicU8 = AtomicU8::new(0);

/// The core starts with this log, and tells ground stations by this.
pub fn begin(log: &'static mut FlightLog, told: &'static mut Told) {
    SHARED.lock(|shared| {
        *shared.borrow_mut() = Some(Shared {
            mailboxes: Mailboxes::default(),
            log,
            told,
        });
    });
}

/// Does something under the lock. Nothing before the core has started.
pub fn with<R: Default>(act: impl FnOnce(&mut Shared) -> R) -> R {
    SHARED.lock(|shared| shared.borrow_mut().as_mut().map(act).unwrap_or_default())
}

/// Sets the latch of urgent commands; a kill is not undone by a disarm.
pub fn urge(urgent: Urgent) {
    let code = match urgent {
        Urgent::Disarm => 1,
        Urgent::Kill => 2,
    };
    URGENT.fetch_max(code, Ordering::Relaxed);
}

/// Takes what the latch of urgent commands holds.
pub fn take_urgent() -> Option<Urgent> {
    match URGENT.swap(0, Ordering::Relaxed) {
        0 => None,
        1 => Some(Urgent::Disarm),
        _ => Some(Urgent::Kill),
    }
}

/// Counters that health reads: each has one writer.
pub struct Counters {
    /// Processor cycles in the inner loop.
    pub inner_cycles: AtomicU32,
    /// Processor cycles in the outer loop, the inner loop's taken off.
    pub outer_cycles: AtomicU32,
    /// Time asleep, µs.
    pub asleep: AtomicU32,
    /// The longest time from data-ready to the motors' compare registers, µs.
    pub latency_max: AtomicU32,
    /// Bursts from the inertial sensors that failed.
    pub imu_errors: AtomicU32,
    /// Whether the motors may turn, as last commanded.
    pub armed: AtomicU32,
    /// Share of the processor's time that is used, in thousandths.
    pub load: AtomicU32,
}

/// All counters.
pub static COUNTERS: Counters = Counters {
    inner_cycles: AtomicU32::new(0),
    outer_cycles: AtomicU32::new(0),
    asleep: AtomicU32::new(0),
    latency_max: AtomicU32::new(0),
    imu_errors: AtomicU32::new(0),
    armed: AtomicU32::new(0),
    load: AtomicU32::new(0),
};

/// Adds to a counter that wraps.
pub fn add(counter: &AtomicU32, more: u32) {
    counter.fetch_add(more, Ordering::Relaxed);
}

/// The counter's value.
pub fn value(counter: &AtomicU32) -> u32 {
    counter.load(Ordering::Relaxed)
}
