//! Barometer and compass on their bus, and the battery.

use embassy_time::{Duration, Instant, Timer};
use windhover_autopilot::{BarometerSample, BatterySample, CompassSample};
use windhover_drivers::health::Health;
use windhover_drivers::ist8310::Ist8310;
use windhover_drivers::spl06::Spl06;

use super::report::Reported;
use crate::board::{BatteryInputs, SensorBus};
use crate::shared;

/// Between two looks.
const PERIOD: Duration = Duration::from_millis(2);

/// Between two samples of the battery, in looks: 100 ms.
const BATTERY_EVERY: u32 = 50;

/// The lines of the bus are clocked free so often while no part works, µs.
const RECOVER_US: u64 = 1_000_000;

/// Reads barometer and compass for ever. A transfer blocks, 2 ms at most: in the lowest task.
#[embassy_executor::task]
pub async fn slow_sensors(mut bus: SensorBus, mut battery: BatteryInputs) {
    let (mut barometer, mut compass) = (Spl06::new(), Ist8310::new());
    let mut told = [Reported::new("barometer"), Reported::new("compass")];
    let mut recovered_at = 0;
    for look in (0..BATTERY_EVERY).cycle() {
        Timer::after(PERIOD).await;
        let now = Instant::now().as_micros();
        if let Some(reading) = barometer.poll(&mut bus, now) {
            let sample = BarometerSample {
                time: reading.time,
                pressure: reading.pressure,
            };
            shared::with(|shared| shared.mailboxes.queues.barometer.push(sample));
        }
        if let Some(reading) = compass.poll(&mut bus, Instant::now().as_micros()) {
            let sample = CompassSample {
                time: reading.time,
                counts: reading.counts,
            };
            shared::with(|shared| shared.mailboxes.queues.compass.push(sample));
        }
        let health = [barometer.health(), compass.health()];
        for (told, health) in told.iter_mut().zip(health) {
            told.tell(health);
        }
        if health.contains(&Health::BusFault) && now > recovered_at + RECOVER_US {
            recovered_at = now;
            if let Err(held) = bus.recover() {
                defmt::warn!("sensor bus: {} is held", held);
            }
        }
        if look == 0 {
            let [voltage, current] = battery.read();
            let sample = BatterySample {
                time: Instant::now().as_micros(),
                voltage,
                current,
            };
            shared::with(|shared| shared.mailboxes.queues.battery.push(sample));
        }
    }
}
