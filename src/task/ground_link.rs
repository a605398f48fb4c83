//! The ground link: bytes of its port to requests, the core's reports to bytes.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::UartTx;
use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Duration, Instant, Timer};
use windhover_autopilot::{MissionCommit, Parameters};
use windhover_flight_log::version;
use windhover_ground_link::{Address, Config, Link, Severity};
use windhover_storage::View;
use windhover_vehicle_link::{Fitting, Told, VehicleLink};

use crate::board::{self, SerialReceiver};
use crate::fault;
use crate::shared::{self, COUNTERS};
use crate::shelf::Shelf;
use crate::start::Stored;

/// Between two looks at what has come, and at what the core has told: 58 bytes of the port's time. By
/// the clock and not by the byte: a port on which something babbles gets no more of the processor.
const PERIOD: Duration = Duration::from_millis(5);

/// Bytes that are looked at each time: four times what can come, where others left no time for long.
const LOOKED_AT: usize = 256;

/// Looks from one comparison of what is stored with what the core has to the next, where they were
/// equal: 50 ms.
const STORE_EVERY: u32 = 10;

/// A restart that was asked for waits for so long at most for what is still to be stored, µs.
const PATIENCE: u64 = 3_000_000;

/// And for so long at least, µs, so that its answer goes out: longer than a full [`OUTGOING`] takes.
const FAREWELL: u64 = 200_000;

/// Bytes on their way out: what the link's budget has in reserve for telemetry, 50 ms, as much for
/// answers, and two frames.
const OUT: usize = 1536;

/// Bytes of one transfer, 11 ms of the port's time.
const CHUNK: usize = 128;

/// From the link to the port's DMA.
static OUTGOING: Pipe<ThreadModeRawMutex, OUT> = Pipe::new();

/// The links and the vehicle's end of them.
pub struct Ground {
    links: [Link; 1],
    vehicle: VehicleLink,
    told: &'static mut Told,
    /// When a restart was asked for, µs.
    restart_asked: Option<u64>,
}

impl Ground {
    /// Of a vehicle with these parameters, whose sensors sit like this. `told` changes places with what
    /// the steps tell.
    pub fn new(
        parameters: &Parameters,
        fitting: Fitting,
        plans: [MissionCommit; 3],
        told: &'static mut Told,
    ) -> Self {
        let mut commit = [0; 8];
        for (to, from) in commit.iter_mut().zip(version::COMMIT.bytes()) {
            *to = from;
        }
        let link = Link::new(Config {
            address: Address {
                system: parameters.link.system as u8,
                component: 1,
            },
            // A little less than the port carries, so that what waits for it becomes less.
            bandwidth: board::GROUND_LINK_BAUD * 95 / 1000,
            uid: board::uid(),
            version: commit,
            ..Config::default()
        });
        Self {
            links: [link],
            vehicle: VehicleLink::new(parameters, fitting, plans),
            told,
            restart_asked: None,
        }
    }

    /// Ground stations are told this: what ended the last run.
    pub fn set_trouble(&mut self, trouble: &'static str) {
        self.vehicle.set_trouble(trouble);
    }

    fn receive(&mut self, bytes: &[u8], now: u64) {
        let [link] = &mut self.links;
        self.vehicle.receive(link, bytes, now, &mut Shelf);
    }

    /// Passes on between core and link.
    fn step(&mut self, stored: &mut Stored, now: u64) {
        let told = &mut self.told;
        shared::with(|shared| Told::take(&mut shared.told, told));
        self.vehicle.set_load(shared::value(&COUNTERS.load) as f32 * 1e-3);
        self.vehicle.step(&mut self.links, self.told, now, &mut |_, _| {});
        let inputs = self.vehicle.take_inputs();
        shared::with(|shared| shared.mailboxes.queues.refill(&inputs));
        if let Some(urgent) = self.vehicle.take_urgent() {
            shared::urge(urgent);
        }
        let effects = self.vehicle.take_effects();
        if effects.reboot {
            stored.keeper.hurry();
            self.restart_asked.get_or_insert(now);
        }
        if effects.store {
            stored.keeper.accept();
        }
    }

    /// Stores one thing that is not stored yet, if there is one and the vehicle is disarmed; whether
    /// there was one.
    async fn store(&mut self, stored: &mut Stored, now: u64) -> bool {
        let view = View {
            time: now,
            armed: shared::value(&COUNTERS.armed) != 0 || self.vehicle.telemetry().armed,
            parameters: self.vehicle.parameters(),
            plans: self.vehicle.committed(),
        };
        if view.armed {
            // Whoever flies meanwhile does not want it any more.
            self.restart_asked = None;
        }
        let task = stored.keeper.next(&view, &Shelf);
        let patience = if task.is_none() { FAREWELL } else { PATIENCE };
        let restarts = self.restart_asked.is_some_and(|asked| now > asked + patience);
        if restarts && !view.armed {
            fault::restart();
        }
        let Some(task) = task else { return false };
        let outcome = stored.journal.perform(&task).await;
        stored.keeper.done(outcome);
        if outcome.is_err() && stored.keeper.given_up().is_some() {
            defmt::error!("flash refuses: not stored");
            for link in &mut self.links {
                let text = "Not stored, flash refuses: what was changed is lost when power is away";
                link.say(Severity::Critical, format_args!("{text}"));
            }
        }
        true
    }

    /// What is to be sent; a frame that does not fit is lost, as on any radio.
    fn poll(&mut self, now: u64) {
        let [link] = &mut self.links;
        self.vehicle.poll(link, now, &mut Shelf, &mut |frame| {
            if frame.len() <= OUTGOING.free_capacity() {
                let mut rest = frame;
                // Twice at its end: what is taken at once does not go around the ring's end.
                while let Ok(count @ 1..) = OUTGOING.try_write(rest) {
                    rest = rest.get(count..).unwrap_or_default();
                }
            }
        });
    }
}

/// Serves the link for ever.
#[embassy_executor::task]
pub async fn ground_link(mut port: SerialReceiver, ground: &'static mut Ground, stored: &'static mut Stored) {
    let mut bytes = [0; LOOKED_AT];
    let mut stores = false;
    for look in (0..STORE_EVERY).cycle() {
        // Looks that were missed are not made up for: they would take the time that is missing.
        Timer::after(PERIOD).await;
        let count = port.take(&mut bytes).count;
        let received = bytes.get(..count).unwrap_or_default();
        let now = Instant::now().as_micros();
        ground.receive(received, now);
        ground.step(stored, now);
        ground.poll(now);
        if stores || look == 0 {
            stores = ground.store(stored, now).await;
        }
    }
}

/// Sends for ever what the link has to send. A port that fails has nobody at its other end.
#[embassy_executor::task]
pub async fn ground_sender(mut port: UartTx<'static, Async>) {
    let mut bytes = [0; CHUNK];
    loop {
        let count = OUTGOING.read(&mut bytes).await;
        let _ = port.write(bytes.get(..count).unwrap_or_default()).await;
    }
}
