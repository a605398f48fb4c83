//! A ground station at the serial port of the emulated board: frames, in virtual time.

use std::collections::VecDeque;
use std::path::Path;

use mavlink::dialects::common::*;
use mavlink::{MavlinkVersion, MessageData};
use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::Address;
use windhover_ground_link::frame::{MAX_FRAME, Parser, Writer};
use windhover_hil::flight::{Flight, FlightError, Plan};
use windhover_hil::log::Line;
use windhover_hil::machine::Stop;
use windhover_hil::time::SECOND;
use windhover_sim::mission_file;
use windhover_tests::station::{Seen, item_payload};

use crate::firmware;

/// Between two looks at the port.
const LOOK: u64 = SECOND / 100;

/// A board and a ground station that says once a second that it is there.
pub struct Station {
    pub flight: Flight,
    writer: Writer,
    parser: Parser,
    seen: VecDeque<Seen>,
    /// Lines of text that came, their parts put together.
    pub texts: Vec<String>,
    /// Whether the vehicle says that it is armed.
    pub armed: bool,
    /// Photos that were told.
    pub photos: usize,
    /// How often power failed, and came back at once.
    pub power_failures: usize,
    next_heartbeat: u64,
}

impl Station {
    /// At power-on.
    pub fn new(plan: &Plan) -> Self {
        Self::beside(Flight::new(firmware(), plan).expect("the firmware runs"))
    }

    /// Beside a vehicle that runs already.
    pub fn beside(flight: Flight) -> Self {
        flight.machine.bus().wiring.take_answers();
        Self {
            flight,
            writer: Writer::new(Address {
                system: 255,
                component: 190,
            }),
            parser: Parser::default(),
            seen: VecDeque::new(),
            texts: Vec::new(),
            armed: false,
            photos: 0,
            power_failures: 0,
            next_heartbeat: 0,
        }
    }

    /// Virtual time, s since the first power-on.
    pub fn time(&self) -> f64 {
        self.flight.machine.now() as f64 / SECOND as f64
    }

    /// Sends a message.
    pub fn send<M: MessageData>(&mut self, message: &M) {
        let mut payload = [0; 255];
        let length = message.ser(MavlinkVersion::V2, &mut payload);
        self.raw(M::ID, &payload[..length]);
    }

    fn raw(&mut self, id: u32, payload: &[u8]) {
        let mut frame = [0; MAX_FRAME];
        let length = self.writer.write(&mut frame, id, payload, None).expect("a frame");
        let now = self.flight.machine.now();
        self.flight.machine.bus().wiring.send(now, &frame[..length]);
    }

    /// One look.
    fn step(&mut self) {
        if self.flight.machine.now() >= self.next_heartbeat {
            self.next_heartbeat = self.flight.machine.now() + SECOND;
            self.send(&HEARTBEAT_DATA {
                mavtype: MavType::MAV_TYPE_GCS,
                mavlink_version: 3,
                ..HEARTBEAT_DATA::default()
            });
        }
        let until = self.flight.machine.now() + LOOK;
        match self.flight.run(until) {
            Err(FlightError::Stop(Stop::PowerFailure { .. })) => {
                self.power_failures += 1;
                return self.cut_power();
            }
            outcome => outcome.expect("nothing that it must not do"),
        }
        let answers = self.flight.machine.bus().wiring.take_answers();
        let bytes: Vec<u8> = answers.into_iter().map(|(_, byte)| byte).collect();
        let (now, mut came) = (self.flight.machine.now() * 1_000_000 / SECOND, Vec::new());
        self.parser.feed(&bytes, |frame| came.push(Seen::new(now, frame)));
        came.into_iter().for_each(|seen| self.look(seen));
    }

    /// Takes in what is looked at by the way, and keeps the rest for whoever waits for it.
    fn look(&mut self, seen: Seen) {
        if let Some(heartbeat) = seen.read::<HEARTBEAT_DATA>() {
            self.armed = heartbeat
                .base_mode
                .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        }
        if let Some(text) = seen.read::<STATUSTEXT_DATA>() {
            let part = text.text.to_str().unwrap_or_default();
            match self.texts.last_mut().filter(|_| text.chunk_seq > 0) {
                Some(line) => line.push_str(part),
                None => self.texts.push(part.to_string()),
            }
        }
        self.photos += usize::from(seen.id == CAMERA_IMAGE_CAPTURED_DATA::ID);
        self.seen.push_back(seen);
        // Streams that nobody waits for.
        self.seen.drain(..self.seen.len().saturating_sub(500));
    }

    /// Time goes on, s.
    pub fn run(&mut self, seconds: f64) {
        let until = self.flight.machine.now() + (seconds * SECOND as f64) as u64;
        while self.flight.machine.now() < until {
            self.step();
        }
    }

    /// Steps until something holds.
    pub fn until(&mut self, seconds: f64, what: &str, holds: impl Fn(&Self) -> bool) {
        let until = self.flight.machine.now() + (seconds * SECOND as f64) as u64;
        while !holds(self) {
            assert!(
                self.flight.machine.now() < until,
                "not within {seconds} s: {what}; texts: {:#?}; the firmware said {:#?}",
                self.texts,
                self.flight.lines
            );
            self.step();
        }
    }

    /// What the vehicle says of its last run within 2 s.
    pub fn told_of_last_run(&mut self) -> String {
        self.run(2.0);
        let texts = self.texts.iter();
        let told: Vec<_> = texts.filter_map(|line| line.strip_prefix("Last run: ")).collect();
        told.join(" ")
    }

    /// Waits for a message that fits.
    pub fn wait<M: MessageData>(&mut self, seconds: f64, fits: impl Fn(&M) -> bool) -> M {
        let until = self.flight.machine.now() + (seconds * SECOND as f64) as u64;
        loop {
            while let Some(seen) = self.seen.pop_front() {
                if let Some(message) = seen.read::<M>().filter(|message| fits(message)) {
                    return message;
                }
            }
            assert!(
                self.flight.machine.now() < until,
                "no {} within {seconds} s; texts: {:#?}; the firmware said {:#?}",
                M::NAME,
                self.texts,
                self.flight.lines
            );
            self.step();
        }
    }

    /// Sends a command; its answer.
    pub fn command(&mut self, command: MavCmd, params: [f32; 7]) -> MavResult {
        let [param1, param2, param3, param4, param5, param6, param7] = params;
        self.send(&COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command,
            target_system: 1,
            target_component: 1,
            confirmation: 0,
        });
        let fits = |ack: &COMMAND_ACK_DATA| ack.command == command;
        self.wait::<COMMAND_ACK_DATA>(5.0, fits).result
    }

    /// Arms, as soon as nothing speaks against it.
    pub fn arm(&mut self, seconds: f64) {
        let until = self.time() + seconds;
        let ask = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        while self.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, ask) != MavResult::MAV_RESULT_ACCEPTED {
            assert!(
                self.time() < until,
                "it does not arm: {:#?}; the firmware said {:#?}",
                self.texts,
                self.flight.lines
            );
            self.run(1.0);
        }
    }

    /// Uploads the items as the mission: gives what is asked for. Power that fails cancels it.
    pub fn upload(&mut self, items: &[MissionItem]) -> MavMissionResult {
        self.seen.clear();
        let failures = self.power_failures;
        self.send(&MISSION_COUNT_DATA {
            count: items.len() as u16,
            target_system: 1,
            target_component: 1,
            ..MISSION_COUNT_DATA::default()
        });
        for _ in 0..3000 {
            while let Some(seen) = self.seen.pop_front() {
                if let Some(ask) = seen.read::<MISSION_REQUEST_INT_DATA>() {
                    let item = &items[usize::from(ask.seq)];
                    self.raw(MISSION_ITEM_INT_DATA::ID, &mission_item(ask.seq, item));
                }
                if let Some(ack) = seen.read::<MISSION_ACK_DATA>() {
                    return ack.mavtype;
                }
            }
            self.step();
            if self.power_failures > failures {
                return MavMissionResult::MAV_MISSION_OPERATION_CANCELLED;
            }
        }
        panic!("the upload does not end");
    }

    /// Downloads the mission, each item as its payload without the target.
    pub fn download(&mut self) -> Vec<Vec<u8>> {
        self.send(&MISSION_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
            ..MISSION_REQUEST_LIST_DATA::default()
        });
        let count = self.wait::<MISSION_COUNT_DATA>(5.0, |_| true).count;
        let item = |station: &mut Self, seq| {
            station.send(&MISSION_REQUEST_INT_DATA {
                seq,
                target_system: 1,
                target_component: 1,
                ..MISSION_REQUEST_INT_DATA::default()
            });
            let item = station.wait::<MISSION_ITEM_INT_DATA>(5.0, |item| item.seq == seq);
            let mut payload = [0; 255];
            item.ser(MavlinkVersion::V2, &mut payload);
            kept(&payload)
        };
        (0..count).map(|seq| item(self, seq)).collect()
    }

    /// Asks for a parameter by its name.
    pub fn parameter(&mut self, name: &str) -> f32 {
        self.send(&PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
        });
        self.value(name)
    }

    /// Asks for another value of a parameter.
    pub fn ask_for_value(&mut self, name: &str, value: f32) {
        self.send(&PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        });
    }

    /// Sets a parameter.
    pub fn set_parameter(&mut self, name: &str, value: f32) {
        self.ask_for_value(name, value);
        assert_eq!(self.value(name), value, "{name}");
    }

    fn value(&mut self, name: &str) -> f32 {
        let fits = |value: &PARAM_VALUE_DATA| value.param_id.to_str() == Ok(name);
        self.wait::<PARAM_VALUE_DATA>(5.0, fits).param_value
    }

    /// Power is away for a moment.
    pub fn power_cycle(&mut self) {
        self.cut_power();
        self.wait::<HEARTBEAT_DATA>(5.0, |_| true);
    }

    fn cut_power(&mut self) {
        self.flight.machine.power_cycle();
        self.flight.machine.bus().wiring.take_answers();
        self.parser = Parser::default();
        self.seen.clear();
        self.armed = false;
        self.photos = 0;
    }

    /// What the firmware said since its last start.
    pub fn said(&self) -> &[Line] {
        let begins = |line: &Line| line.message.starts_with("windhover on ");
        let begin = self.flight.lines.iter().rposition(begins);
        &self.flight.lines[begin.unwrap_or(0)..]
    }
}

/// An item of the mission as it is sent.
fn mission_item(seq: u16, item: &MissionItem) -> Vec<u8> {
    item_payload(MavMissionType::MAV_MISSION_TYPE_MISSION, seq, item)
}

/// What a download gives of an item: all but whom it is for and whether it is the current one.
fn kept(payload: &[u8]) -> Vec<u8> {
    [&payload[..32], &payload[34..35], &payload[36..37]].concat()
}

/// What [`Station::download`] is to give.
pub fn downloaded(items: &[MissionItem]) -> Vec<Vec<u8>> {
    let items = items.iter().enumerate();
    let payload = |(seq, item): (usize, &MissionItem)| kept(&mission_item(seq as u16, item));
    items.map(payload).collect()
}

/// `missions/monitoring.plan`.
pub fn monitoring() -> Vec<MissionItem> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let file = mission_file::read(&root.join("missions/monitoring.plan")).expect("it is read");
    file.stored().mission
}
