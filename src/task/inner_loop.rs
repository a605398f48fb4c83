//! The inner loop: a sample, or the lack of one, to four compare registers. Nothing on the board
//! is more urgent but the interrupts that carry its data.

use core::sync::atomic::Ordering;

use cortex_m::peripheral::DWT;
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer, with_deadline};
use windhover_autopilot::{Imu, ImuCounts, Inner, InnerConfig, InnerInput, MotorCommand};
use windhover_drivers::icm42688p::{Error, OutputDataRate};

use crate::board::{self, Motors};
use crate::fault::PROGRESS;
use crate::shared::{self, COUNTERS, DATA_READY, SNAPSHOT};

/// Without a sample for so long, the part is set up anew.
const GIVE_UP: Duration = Duration::from_millis(50);

/// Between two attempts to set the part up.
const RETRY: Duration = Duration::from_millis(500);

/// Between two looks at one of the part's registers.
const VERIFY: Duration = Duration::from_millis(100);

/// The loop's state: the core's inner step and where its commands go.
pub struct InnerLoop {
    inner: Inner,
    motors: Motors,
    /// 1.5 nominal periods: without a sample for so long after a tick, the tick comes without.
    time_out: Duration,
    last_tick: Instant,
    last_sample: Instant,
    command: MotorCommand,
}

impl InnerLoop {
    /// Before its first tick.
    pub fn new(config: InnerConfig, inner: Inner, motors: Motors) -> Self {
        let now = Instant::now();
        Self {
            inner,
            motors,
            time_out: Duration::from_micros(1_500_000 / u64::from(config.imu_rate)),
            last_tick: now,
            last_sample: now,
            command: MotorCommand::Disarmed,
        }
    }

    /// When the tick comes even without a sample.
    fn deadline(&self) -> Instant {
        self.last_tick + self.time_out
    }

    /// One tick, to the compare registers; then the log.
    fn tick(&mut self, imu: Imu) {
        let begin = DWT::cycle_count();
        let input = InnerInput {
            imu,
            urgent: shared::take_urgent(),
        };
        let inner = &mut self.inner;
        let output = shared::with(|shared| Some(inner.tick(&input, &mut shared.mailboxes)));
        let Some(output) = output else { return };
        self.motors.write(output.motors);
        self.command = output.motors;
        let now = Instant::now();
        self.account(&imu, now);
        let taken = output.record.is_some_and(|record| record.snapshot_taken);
        shared::with(|shared| {
            shared.log.tick(&input, output.motors, output.record);
            shared.told.tick(&imu, output.motors, output.record);
            if let Some(snapshot) = shared.mailboxes.snapshot.as_ref().filter(|_| taken) {
                shared.log.inputs(&snapshot.inputs, snapshot.tick);
            }
        });
        if taken {
            SNAPSHOT.signal(());
        }
        shared::add(&COUNTERS.inner_cycles, DWT::cycle_count().wrapping_sub(begin));
    }

    fn account(&mut self, imu: &Imu, now: Instant) {
        self.last_tick = Instant::from_micros(imu.time());
        shared::add(&PROGRESS.tick, 1);
        let armed = !matches!(self.command, MotorCommand::Disarmed);
        COUNTERS.armed.store(u32::from(armed), Ordering::Relaxed);
        if let Imu::Sample { time, .. } = imu {
            self.last_sample = self.last_tick;
            let latency = now.as_micros().saturating_sub(*time) as u32;
            COUNTERS.latency_max.fetch_max(latency, Ordering::Relaxed);
        }
    }

    /// A tick without a sample.
    fn miss(&mut self) {
        let time = Instant::now().as_micros();
        self.tick(Imu::Missing { time });
    }

    /// Goes on with ticks that lack a sample while something else takes its time.
    async fn meanwhile<F: Future>(&mut self, work: F) -> F::Output {
        let mut work = core::pin::pin!(work);
        loop {
            match select(work.as_mut(), Timer::at(self.deadline())).await {
                Either::First(done) => return done,
                Either::Second(()) => self.miss(),
            }
        }
    }

    /// Ticks by samples, until there have been none for [`GIVE_UP`], or the part is found to have
    /// lost its configuration while the motors stand still.
    async fn sample(&mut self, imu: &mut board::Imu) {
        self.last_sample = Instant::now();
        let mut verify = self.last_sample + VERIFY;
        while self.last_sample.elapsed() < GIVE_UP {
            let ready = with_deadline(self.deadline(), DATA_READY.wait()).await;
            match ready {
                Ok(time) => self.fetch(imu, time).await,
                Err(_) => self.miss(),
            }
            if Instant::now() >= verify {
                verify += VERIFY;
                let verified = with_deadline(self.deadline(), imu.verify()).await;
                if !matches!(verified, Ok(Ok(()))) {
                    shared::add(&COUNTERS.imu_errors, 1);
                    if self.command == MotorCommand::Disarmed {
                        defmt::warn!("the inertial sensors lost their configuration");
                        return;
                    }
                }
            }
        }
        defmt::warn!(
            "no sample of the inertial sensors for {=u64} ms",
            GIVE_UP.as_millis()
        );
    }

    /// Fetches the sample that is ready since `time`, and ticks with it. A burst that fails or
    /// takes too long is no sample: the tick comes at its time-out.
    async fn fetch(&mut self, imu: &mut board::Imu, time: u64) {
        match with_deadline(self.deadline(), imu.read()).await {
            Ok(Ok(sample)) => {
                let counts = ImuCounts {
                    accel: sample.accel,
                    gyro: sample.gyro,
                };
                // It may have been ready just before a tick that went ahead without it: time does
                // not run backwards.
                let time = time.max(self.last_tick.as_micros());
                self.tick(Imu::Sample { counts, time });
            }
            _ => shared::add(&COUNTERS.imu_errors, 1),
        }
    }
}

/// Runs the inner loop for ever.
#[embassy_executor::task]
pub async fn inner_loop(mut state: InnerLoop, mut imu: board::Imu, config: InnerConfig) {
    let rate = match config.imu_rate {
        4000 => OutputDataRate::Hz4000,
        _ => OutputDataRate::Hz1000,
    };
    let mut named = None;
    loop {
        let configured = state
            .meanwhile(imu.configure(rate, &mut embassy_time::Delay))
            .await;
        match configured {
            Ok(()) => {
                named = None;
                defmt::info!("inertial sensors: ready");
                DATA_READY.reset();
                state.sample(&mut imu).await;
            }
            Err(error) => {
                shared::add(&COUNTERS.imu_errors, 1);
                if named != Some(error) {
                    name(&error);
                }
                named = Some(error);
                state.meanwhile(Timer::after(RETRY)).await;
            }
        }
    }
}

/// Says why there are no inertial sensors.
fn name<E: core::fmt::Debug>(error: &Error<E>) {
    match error {
        Error::Absent { who_am_i } => {
            defmt::error!("inertial sensors: absent (identity {=u8:#x})", *who_am_i);
        }
        Error::WrongPart { who_am_i } => {
            defmt::error!("inertial sensors: another part (identity {=u8:#x})", *who_am_i);
        }
        Error::Mismatch {
            register,
            wrote,
            read,
        } => defmt::error!(
            "inertial sensors: register {=u8:#x} holds {=u8:#x} in place of {=u8:#x}",
            register.address,
            *read,
            *wrote
        ),
        _ => defmt::error!("inertial sensors: the bus fails"),
    }
}
