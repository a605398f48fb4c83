//! The outer loop: whatever lies in the snapshot's mailbox, to a result in the other one. The
//! watchdog is fed here: while the outer step completes and inner ticks go on, and only then.

use core::sync::atomic::Ordering;

use cortex_m::peripheral::DWT;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;
use windhover_autopilot::{Outer, OuterResult, Snapshot};
use windhover_flight_log::{LoggerConfig, Reporter, result_hash};

use crate::fault::PROGRESS;
use crate::shared::{self, COUNTERS, SNAPSHOT};
use crate::shelf::Shelf;

/// The outer step, on the plans on board. A function of its own: what `cargo xtask count` counts, and
/// where the emulated board holds the firmware up.
#[inline(never)]
fn outer_step(outer: &mut Outer, snapshot: &Snapshot, result: &mut OuterResult) {
    outer.step_into(snapshot, &Shelf, result);
}

/// Runs the outer loop for ever.
#[embassy_executor::task]
pub async fn outer_loop(
    outer: &'static mut Outer,
    config: LoggerConfig,
    mut watchdog: IndependentWatchdog<'static, IWDG>,
) {
    let mut reporter = Reporter::new(config);
    loop {
        SNAPSHOT.wait().await;
        let Some(snapshot) = shared::with(|shared| shared.mailboxes.snapshot.take()) else {
            continue;
        };
        let (begin, inner) = (DWT::cycle_count(), shared::value(&COUNTERS.inner_cycles));
        let mut result = OuterResult::default();
        outer_step(outer, &snapshot, &mut result);
        let hash = result_hash(&result);
        reporter.report(
            &snapshot,
            &result,
            || shared::with(|shared| shared.log.latest()),
            &mut |message| {
                shared::with(|shared| shared.log.message(message));
            },
        );
        // One after the other: interrupts are off in each.
        shared::with(|shared| shared.told.outer(&snapshot, &result));
        shared::with(|shared| {
            shared.log.announce(hash);
            shared.mailboxes.result = Some(result);
        });
        let tick = shared::value(&PROGRESS.tick);
        if PROGRESS.outer.swap(tick, Ordering::Relaxed) != tick {
            watchdog.pet();
        }
        let busy = DWT::cycle_count().wrapping_sub(begin);
        let others = shared::value(&COUNTERS.inner_cycles).wrapping_sub(inner);
        shared::add(&COUNTERS.outer_cycles, busy.saturating_sub(others));
    }
}
