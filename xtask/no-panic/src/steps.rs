//! The two steps under proof, each a function of its own in the ELF.

// The names are for the reader of the ELF and for xtask, which looks whether they are in it.
#![allow(unsafe_code)]

use windhover_autopilot::mission::{MissionItem, MissionSource};
use windhover_autopilot::{Inner, InnerInput, Mailboxes, Outer, OuterResult, Snapshot, TickOutput};

/// Stored missions in memory that the optimiser knows nothing about.
pub struct Storage<'a>(pub &'a [MissionItem]);

impl MissionSource for Storage<'_> {
    fn item(&self, slot: u8, index: u16) -> Option<MissionItem> {
        core::hint::black_box(self.0).item(slot, index)
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
