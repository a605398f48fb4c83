//! A flight's log as the desktop writes it: what the core consumed and gave, and the truth.
//!
//! The log is the one the firmware writes, by the same writer. Around it the desktop puts what
//! only it knows: the truth at the times of the views, the conditions of the flight before the
//! first tick, and its figures after the last. [`crate::flight_report`] reads them back.

use windhover_autopilot::mission::MissionSource;
use windhover_autopilot::{InnerInput, MotorCommand, OuterResult, Parameters, ScheduleRecord, Snapshot};
use windhover_flight_log::views::Truth as LoggedTruth;
use windhover_flight_log::{
    Header, HeaderWriter, InfoValue, Logger, LoggerConfig, Plan, PlanItem, PlanKind, mission_crc, version,
};
use windhover_math::geodesy::GlobalPosition;
use windhover_model::Truth;

use crate::closed_loop::Recorder;
use crate::flight::Setup;
use crate::report::{Event, Figure};
use crate::stored::Stored;

/// Bytes that the logger may hold; the desktop empties it at every outer step.
const BUFFER: usize = 16_384;

/// What stands between the parts of a line of text in the log.
const SEPARATOR: char = '|';

/// Writes a flight's log into memory.
pub struct FlightLog {
    logger: Box<Logger<BUFFER>>,
    bytes: Vec<u8>,
    /// Bytes that were taken away.
    taken: usize,
    header: usize,
    truth_bytes: usize,
    steps: u32,
    view_divider: u32,
    scratch: Vec<u8>,
}

impl FlightLog {
    /// Begins the log of a flight of this `setup`, whose core is made with these `parameters`.
    /// `conditions` are lines for people: name and value.
    pub fn new(
        setup: &Setup,
        parameters: &Parameters,
        home: GlobalPosition,
        stored: &Stored,
        conditions: &[(String, String)],
    ) -> Self {
        let config = LoggerConfig::new(setup.inner_config(), parameters);
        let texts: Vec<(String, String)> = conditions
            .iter()
            .enumerate()
            .map(|(n, (name, value))| (format!("condition_{n:02}"), format!("{name}{SEPARATOR}{value}")))
            .collect();
        let more: Vec<(&str, InfoValue<'_>)> = texts
            .iter()
            .map(|(name, text)| (name.as_str(), InfoValue::Text(text)))
            .collect();
        let plans = stored.each().map(|(kind, items)| Plan {
            kind,
            slot: 0,
            count: items.len() as u16,
        });
        let header = Header {
            time: 0,
            commit: version::COMMIT,
            release: version::RELEASE,
            board: "desktop",
            inner: setup.inner_config(),
            parameters,
            outer: setup.outer_config(home),
            reset_cause: "start",
            mission_crc: mission_crc(stored.mission.iter().copied()),
            plans: &plans,
            more: &more,
        };
        let bytes = header_bytes(header, stored);
        Self {
            logger: Box::new(Logger::new(config)),
            header: bytes.len(),
            bytes,
            taken: 0,
            truth_bytes: 0,
            steps: 0,
            view_divider: config.view_divider.max(1),
            scratch: vec![0; BUFFER],
        }
    }

    /// Bytes per second of everything that a board would log too, header apart.
    pub fn rate(&self, seconds: f64) -> f64 {
        (self.taken + self.bytes.len() - self.header - self.truth_bytes) as f64
            / windhover_math::max(seconds, 1e-3)
    }

    /// What was written since the last time; the rest of the log goes on behind it.
    pub fn take(&mut self) -> Vec<u8> {
        self.drain();
        self.taken += self.bytes.len();
        std::mem::take(&mut self.bytes)
    }

    /// An item of a plan that is written on board.
    pub fn plan_item(&mut self, item: &PlanItem) {
        self.logger.plan_item(item);
    }

    /// Ends the log with what is known only now; the log.
    pub fn finish(mut self, figures: &[Figure], events: &[Event]) -> Vec<u8> {
        self.logger.finish();
        self.drain();
        for event in events {
            self.logger
                .text((f64::from(event.time) * 1e6) as u64, &event.text);
        }
        self.drain();
        for (n, Figure { label, value, unit }) in figures.iter().enumerate() {
            let text = format!("{label}{SEPARATOR}{value}{SEPARATOR}{unit}");
            self.logger
                .info(&format!("figure_{n:02}"), InfoValue::Text(&text));
            self.drain();
        }
        self.bytes
    }

    fn truth(&mut self, truth: &Truth, time: u64) {
        let before = self.logger.waiting();
        let (p, v, q) = (&truth.position, &truth.velocity, &truth.attitude);
        self.logger.view(
            time,
            &LoggedTruth {
                position: [p.x, p.y, p.z],
                velocity: [v.x, v.y, v.z],
                q: [q.w, q.x, q.y, q.z],
                body_rate: [truth.body_rate.x, truth.body_rate.y, truth.body_rate.z].map(|x| x as f32),
                rotor_speed: truth.rotor_speed.map(|speed| speed as f32),
                wind: [truth.wind.x, truth.wind.y, truth.wind.z].map(|x| x as f32),
                power: truth.power as f32,
                energy: truth.energy,
            },
        );
        self.truth_bytes += self.logger.waiting() - before;
    }

    fn drain(&mut self) {
        loop {
            let count = self.logger.drain(&mut self.scratch);
            if count == 0 {
                return;
            }
            self.bytes.extend_from_slice(&self.scratch[..count]);
        }
    }
}

impl Recorder for FlightLog {
    #[inline]
    fn tick(&mut self, _: &Truth, input: &InnerInput, motors: MotorCommand, record: Option<ScheduleRecord>) {
        self.logger.tick(input, motors, record);
    }

    fn outer(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        self.logger.inputs(&snapshot.inputs, snapshot.tick);
        self.logger.result(snapshot, result);
        if self.steps.is_multiple_of(self.view_divider) || !result.report.events.is_empty() {
            self.truth(truth, snapshot.time);
        }
        self.steps += 1;
        if self.logger.waiting() > BUFFER / 4 {
            self.drain();
        }
    }
}

/// The parts of a line that [`FlightLog`] wrote.
pub fn parts(line: &str) -> impl Iterator<Item = &str> {
    line.split(SEPARATOR)
}

fn header_bytes(header: Header<'_>, stored: &Stored) -> Vec<u8> {
    let plans = stored.plans();
    let item = |kind: PlanKind, slot: u8, index: u16| plans.item(kind, slot, index);
    let mut writer = HeaderWriter::new(header, item);
    let mut bytes = Vec::new();
    while let Some(chunk) = writer.chunk() {
        bytes.extend_from_slice(chunk);
    }
    bytes
}
