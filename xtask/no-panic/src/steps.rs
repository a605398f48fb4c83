//! The steps under proof, and the log that is written beside them, each a function of its own in
//! the ELF.

// The names are for the reader of the ELF and for xtask, which looks whether they are in it.
#![allow(unsafe_code)]

use windhover_autopilot::mission::{MissionItem, MissionSource, PlanKind};
use windhover_autopilot::{Inner, InnerInput, Mailboxes, Outer, OuterResult, Snapshot, TickOutput};
use windhover_flight_log::Logger;

/// Bytes of the log's ring.
pub const LOG: usize = 4096;

/// Stored plans of any kind in memory that the optimiser knows nothing about.
pub struct Storage<'a>(pub &'a [MissionItem]);

impl MissionSource for Storage<'_> {
    fn item(&self, _: PlanKind, _: u8, index: u16) -> Option<MissionItem> {
        core::hint::black_box(self.0).get(usize::from(index)).copied()
    }
}

/// One tick.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn inner_step(inner: &mut Inner, input: &InnerInput, mailboxes: &mut Mailboxes) -> TickOutput {
    #[cfg(feature = "prove-it-fails")]
    let _ = core::hint::black_box(mailboxes.result.as_ref().map(|result| result.tick)).unwrap();
    inner.tick(input, mailboxes)
}

/// One outer step.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn outer_step(outer: &mut Outer, snapshot: &Snapshot, storage: &Storage<'_>) -> OuterResult {
    outer.step(snapshot, storage)
}

/// The log of one tick.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn log_tick(logger: &mut Logger<LOG>, input: &InnerInput, output: &TickOutput) {
    logger.tick(input, output.motors, output.record);
}

/// The log of one outer step, and its way out.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn log_outer(
    logger: &mut Logger<LOG>,
    snapshot: &Snapshot,
    result: &OuterResult,
    out: &mut [u8],
) -> usize {
    logger.inputs(&snapshot.inputs, snapshot.tick);
    logger.result(snapshot, result);
    logger.drain(out)
}
