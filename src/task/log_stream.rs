//! The log on its way out: the header, then whatever waits, by DMA.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::UartTx;
use embassy_time::Timer;
use windhover_autopilot::mission::MissionSource;
use windhover_autopilot::{InnerConfig, MissionCommit, OuterConfig, Parameters};
use windhover_flight_log::{Header, HeaderWriter, Plan, PlanKind, version};

use crate::board;
use crate::fault::PROGRESS;
use crate::shared;
use crate::shelf::Shelf;

/// The most bytes that go out in one transfer: 10 ms of the port's time.
const CHUNK: usize = 2048;

/// Bytes that are taken out of the log at once, while interrupts are off.
const PIECE: usize = 256;

/// What the header says that is known only when the core starts.
pub struct Start {
    /// Time of the start, µs.
    pub time: u64,
    /// IMU rate and rotation.
    pub inner: InnerConfig,
    /// The parameter table.
    pub parameters: Parameters,
    /// What the outer step was made with.
    pub outer: OuterConfig,
    /// Why the microcontroller started.
    pub cause: &'static str,
    /// The plans that were stored.
    pub plans: [MissionCommit; 3],
}

/// Streams for ever.
#[embassy_executor::task]
pub async fn log_stream(mut port: UartTx<'static, Async>, start: &'static Start) {
    let plans = PlanKind::EACH.into_iter().zip(&start.plans);
    let plans: heapless::Vec<Plan, 3> = plans
        .filter(|(_, plan)| plan.count > 0)
        .map(|(kind, plan)| Plan {
            kind,
            slot: plan.slot,
            count: plan.count,
        })
        .collect();
    let [mission, ..] = &start.plans;
    let header = Header {
        time: start.time,
        commit: version::COMMIT,
        release: version::RELEASE,
        board: board::NAME,
        inner: start.inner,
        parameters: &start.parameters,
        outer: start.outer,
        reset_cause: start.cause,
        mission_crc: mission.crc,
        plans: &plans,
        more: &[],
    };
    let item = |kind: PlanKind, slot: u8, index: u16| Shelf.item(kind, slot, index);
    let mut writer = HeaderWriter::new(header, item);
    while let Some(chunk) = writer.chunk() {
        send(&mut port, chunk).await;
    }
    let mut bytes = [0; CHUNK];
    loop {
        match drain(&mut bytes) {
            0 => Timer::after_millis(2).await,
            count => send(&mut port, bytes.get(..count).unwrap_or_default()).await,
        }
    }
}

/// Sends bytes, and counts them.
async fn send(port: &mut UartTx<'static, Async>, bytes: &[u8]) {
    // A port that fails is noticed by the ring that runs full, which counts.
    let _ = port.write(bytes).await;
    shared::add(&PROGRESS.log, bytes.len() as u32);
}

/// Moves what waits into `bytes`, as much as fits; how much.
fn drain(bytes: &mut [u8]) -> usize {
    let mut count = 0;
    for piece in bytes.chunks_mut(PIECE) {
        let taken = shared::with(|shared| shared.log.drain(piece));
        count += taken;
        if taken < piece.len() {
            break;
        }
    }
    count
}
