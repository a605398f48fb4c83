//! How the board does: the light, and once a second a record in the log.

use core::sync::atomic::Ordering;

use embassy_stm32::gpio::Output;
use embassy_time::{Duration, Instant, Ticker};
use windhover_flight_log::views::BoardHealth;

use crate::board;
use crate::shared::{self, COUNTERS};

/// Steps of the light per second.
const STEPS: u64 = 10;

/// Differences of a counter that wraps.
#[derive(Default)]
struct Since(u32);

impl Since {
    fn last(&mut self, counter: &core::sync::atomic::AtomicU32) -> f32 {
        let now = shared::value(counter);
        now.wrapping_sub(core::mem::replace(&mut self.0, now)) as f32
    }
}

/// Disarmed the light is on for a tenth of a second each second, armed it blinks fast.
#[embassy_executor::task]
pub async fn health(mut light: Output<'static>) {
    let mut ticker = Ticker::every(Duration::from_hz(STEPS));
    let (mut inner, mut outer, mut asleep) = (Since::default(), Since::default(), Since::default());
    let mut last = Instant::now();
    let mut waiting_max = 0;
    for step in (0..STEPS).cycle() {
        ticker.next().await;
        let armed = shared::value(&COUNTERS.armed) != 0;
        light.set_level(board::light(if armed { step % 2 == 0 } else { step == 0 }));
        waiting_max = waiting_max.max(shared::with(|shared| shared.log.waiting()));
        if step > 0 {
            continue;
        }
        let now = Instant::now();
        let elapsed = now.duration_since(last).as_micros() as f32;
        last = now;
        let cycles = elapsed * board::CYCLES_PER_MICROSECOND;
        let record = BoardHealth {
            load: 1.0 - asleep.last(&COUNTERS.asleep) / elapsed,
            load_inner: inner.last(&COUNTERS.inner_cycles) / cycles,
            load_outer: outer.last(&COUNTERS.outer_cycles) / cycles,
            stack_used: board::stack_used(),
            stack_size: board::STACK.len() as u32,
            latency_max: shared::value(&COUNTERS.latency_max),
            imu_errors: shared::value(&COUNTERS.imu_errors),
            log_waiting_max: waiting_max as u32,
        };
        COUNTERS
            .load
            .store((record.load.clamp(0.0, 1.0) * 1000.0) as u32, Ordering::Relaxed);
        shared::with(|shared| shared.log.view(now.as_micros(), &record));
    }
}
