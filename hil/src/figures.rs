//! The figures of a flight on the emulated board. Whatever depends on the processor's speed comes
//! from the cost model: an estimate, and called so.

use windhover_flight_log::View;
use windhover_flight_log::reader::{Entry, Log};
use windhover_flight_log::views::{BoardHealth, TickCounts};
use windhover_math::max;
use windhover_sim::replay::{Replay, replay};

use crate::flight::{Flight, Outcome};
use crate::time::SECOND;

/// The exceptions by which samples get to the motors: data-ready, the inner executor, both DMA
/// streams of the inertial sensors' bus.
const INNER_EXCEPTIONS: [usize; 4] = [16 + 10, 16 + 19, 16 + 56, 16 + 59];

/// All figures of a flight.
#[derive(Clone, Debug)]
pub struct Figures {
    /// How it came out.
    pub outcome: Outcome,
    /// Simulated over wall time.
    pub speed: f64,
    /// Virtual time, s.
    pub virtual_s: f64,
    /// Share of the processor's time for the inner loop and its interrupts, since the motors turn, or
    /// power came on where they never do; an estimate.
    pub load_inner: f64,
    /// Share of the processor's time awake, since then; an estimate.
    pub load: f64,
    /// What the firmware itself says last.
    pub health: Option<BoardHealth>,
    /// Its sums.
    pub counts: Option<TickCounts>,
    /// Why the firmware's last run started, as its log says.
    pub reset_cause: String,
    /// Resets since power-on.
    pub resets: usize,
    /// The replay of its log, or why there is none.
    pub replay: Result<Replay, String>,
}

impl Figures {
    /// Of a flight that has ended, its log, and how long it took on the wall, in s.
    pub fn new(flight: &mut Flight, outcome: Outcome, log: &[u8], wall_s: f64) -> Self {
        let virtual_s = flight.machine.now() as f64 / SECOND as f64;
        let resets = flight.machine.resets().len();
        let load = flight.load();
        let total = load.total().max(1) as f64;
        let inner: u64 = INNER_EXCEPTIONS.iter().map(|n| load.exception(*n)).sum();
        let mut figures = Self {
            outcome,
            speed: virtual_s / max(wall_s, 1e-9),
            virtual_s,
            load_inner: inner as f64 / total,
            load: 1.0 - load.asleep as f64 / total,
            health: None,
            counts: None,
            reset_cause: String::new(),
            resets,
            replay: Err(String::new()),
        };
        match Log::open(log) {
            Ok(log) => figures.read(&log),
            Err(error) => figures.replay = Err(error.to_string()),
        }
        figures
    }

    fn read(&mut self, log: &Log<'_>) {
        self.reset_cause = log.text("reset_cause").unwrap_or_default().into();
        for entry in log.entries() {
            match entry {
                Entry::View {
                    view: View::BoardHealth(health),
                    ..
                } => self.health = Some(health),
                Entry::View {
                    view: View::TickCounts(counts),
                    ..
                } => self.counts = Some(counts),
                _ => {}
            }
        }
        self.replay = replay(log).map_err(|error| error.to_string());
    }

    /// Whether the log was replayed to its end, and equal.
    pub fn replays(&self) -> bool {
        let whole = |replay: &Replay| replay.difference.is_none() && replay.missing_from.is_none();
        self.replay.as_ref().is_ok_and(whole)
    }

    /// A table for people.
    pub fn text(&self) -> String {
        let error = self.outcome.attitude_error.map(|error| {
            format!(
                "attitude error        {:8.2} deg, largest while held",
                error.to_degrees()
            )
        });
        let mut lines = Vec::from_iter(error);
        lines.extend([
            format!(
                "motors at the end     {}",
                if self.outcome.stopped {
                    "stopped"
                } else {
                    "TURNING"
                }
            ),
            format!(
                "resets                {:5}    last start: {}",
                self.resets, self.reset_cause
            ),
            format!(
                "load (estimate)       {:8.1} %, inner loop {:.1} %",
                self.load * 100.0,
                self.load_inner * 100.0
            ),
        ]);
        if let Some(health) = &self.health {
            lines.push(format!(
                "latency (estimate)    {:5}    us, data-ready to compare registers, largest",
                health.latency_max
            ));
            lines.push(format!(
                "stack                 {:5}    of {} bytes",
                health.stack_used, health.stack_size
            ));
            lines.push(format!("IMU errors            {:5}", health.imu_errors));
        }
        if let Some(counts) = &self.counts {
            lines.push(format!(
                "ticks                 {:5}    without a sample {}, deadlines missed {}",
                counts.ticks, counts.missing, counts.missed
            ));
        }
        lines.push(format!(
            "speed                 {:8.2} x real time, {:.1} s virtual",
            self.speed, self.virtual_s
        ));
        lines.push(match &self.replay {
            Err(error) => format!("replay                none: {error}"),
            Ok(replay) => match (&replay.difference, replay.missing_from) {
                (Some(difference), _) => format!("replay                DIFFERS: {difference}"),
                (None, Some(tick)) => {
                    format!("replay                equal up to tick {tick}, where inputs are missing")
                }
                (None, None) => format!("replay                equal, {} ticks, bit for bit", replay.ticks),
            },
        });
        lines.join("\n") + "\n"
    }

    /// The same for programs.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "attitude_error_deg": self.outcome.attitude_error.map(f64::to_degrees),
            "height_m": self.outcome.height,
            "stopped": self.outcome.stopped,
            "speed_factor": self.speed,
            "virtual_s": self.virtual_s,
            "load_estimate": self.load,
            "load_inner_estimate": self.load_inner,
            "latency_max_us_estimate": self.health.map(|health| health.latency_max),
            "stack_used": self.health.map(|health| health.stack_used),
            "imu_errors": self.health.map(|health| health.imu_errors),
            "missing": self.counts.map(|counts| counts.missing),
            "missed_deadlines": self.counts.map(|counts| counts.missed),
            "resets": self.resets,
            "reset_cause": self.reset_cause,
            "replay_equal": self.replays(),
            "replay_ticks": self.replay.as_ref().map_or(0, |replay| replay.ticks),
        })
    }
}
