//! The log on its way out: the header, then whatever waits, by DMA.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::UartTx;
use embassy_time::Timer;
use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::{InnerConfig, Parameters};
use windhover_flight_log::{Header, HeaderWriter, PlanKind, mission_crc, version};
use windhover_math::geodesy::GlobalPosition;

use crate::board;
use crate::fault::Cause;
use crate::shared;

/// Bytes that go out in one transfer.
const CHUNK: usize = 512;

/// What the header says that is known only when the core starts.
pub struct Start {
    /// Time of the start, µs.
    pub time: u64,
    /// IMU rate and rotation.
    pub inner: InnerConfig,
    /// The parameter table.
    pub parameters: Parameters,
    /// Home.
    pub home: GlobalPosition,
    /// Why the microcontroller started.
    pub cause: Cause,
}

/// Streams for ever.
#[embassy_executor::task]
pub async fn log_stream(mut port: UartTx<'static, Async>, start: &'static Start) {
    let header = Header {
        time: start.time,
        commit: version::COMMIT,
        release: version::RELEASE,
        board: board::NAME,
        inner: start.inner,
        parameters: &start.parameters,
        home: start.home,
        declination: 0.0,
        reset_cause: &start.cause,
        mission_crc: mission_crc(core::iter::empty()),
        plans: &[],
        more: &[],
    };
    let mut writer = HeaderWriter::new(header, |_: PlanKind, _: u8, _: u16| None::<MissionItem>);
    while let Some(chunk) = writer.chunk() {
        // A port that fails is noticed by the ring that runs full, which counts.
        let _ = port.write(chunk).await;
    }
    let mut bytes = [0; CHUNK];
    loop {
        match shared::with(|shared| shared.log.drain(&mut bytes)) {
            0 => Timer::after_millis(2).await,
            count => {
                let _ = port.write(bytes.get(..count).unwrap_or_default()).await;
            }
        }
    }
}
