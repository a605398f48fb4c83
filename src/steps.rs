//! The two steps of the core, each a function of its own: what `cargo xtask count` counts, and
//! where the emulated board holds the firmware up.

use windhover_autopilot::{Inner, InnerInput, Mailboxes, Outer, OuterResult, Snapshot, TickOutput};

use crate::shelf::Shelf;

/// The inner step.
#[inline(never)]
pub fn inner_step(inner: &mut Inner, input: &InnerInput, mailboxes: &mut Mailboxes) -> TickOutput {
    inner.tick(input, mailboxes)
}

/// The outer step, on the plans on board.
#[inline(never)]
pub fn outer_step(outer: &mut Outer, snapshot: &Snapshot, result: &mut OuterResult) {
    outer.step_into(snapshot, &Shelf, result);
}
