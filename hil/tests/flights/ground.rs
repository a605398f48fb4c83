//! A ground station at the flashed firmware's serial port: what it uploads is there, and is still there
//! after power has been away.

use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::Address;
use windhover_ground_link::frame::{MAX_FRAME, Parser, Writer};
use windhover_hil::flight::Flight;
use windhover_hil::time::SECOND;
use windhover_sim::mission_file;

use crate::{firmware, plan};

/// Numbers of messages (MAVLink, common).
const HEARTBEAT: u32 = 0;
const PARAM_REQUEST_READ: u32 = 20;
const PARAM_VALUE: u32 = 22;
const PARAM_SET: u32 = 23;
const MISSION_REQUEST_LIST: u32 = 43;
const MISSION_COUNT: u32 = 44;
const MISSION_ACK: u32 = 47;
const MISSION_REQUEST_INT: u32 = 51;
const MISSION_ITEM_INT: u32 = 73;

/// The vehicle, as a target.
const VEHICLE: [u8; 2] = [1, 1];

/// A ground station at the port.
struct Station {
    flight: Flight,
    writer: Writer,
    parser: Parser,
}

impl Station {
    fn new() -> Self {
        Self {
            flight: Flight::new(firmware(), &plan(1.0)).expect("the firmware runs"),
            writer: Writer::new(Address {
                system: 255,
                component: 190,
            }),
            parser: Parser::default(),
        }
    }

    fn run(&mut self, time: u64) {
        let until = self.flight.machine.now() + time;
        self.flight.run(until).expect("nothing that it must not do");
    }

    fn send(&mut self, id: u32, payload: &[u8]) {
        let mut frame = [0; MAX_FRAME];
        let length = self.writer.write(&mut frame, id, payload, None).expect("a frame");
        let now = self.flight.machine.now();
        self.flight.machine.bus().wiring.send(now, &frame[..length]);
    }

    /// The messages that came since the last time.
    fn seen(&mut self) -> Vec<(u32, Vec<u8>)> {
        self.run(SECOND / 100);
        let answers = self.flight.machine.bus().wiring.take_answers();
        let bytes: Vec<u8> = answers.into_iter().map(|(_, byte)| byte).collect();
        let mut seen = Vec::new();
        self.parser.feed(&bytes, |frame| {
            let mut payload = frame.payload.to_vec();
            payload.resize(64, 0);
            seen.push((frame.id, payload));
        });
        seen
    }

    /// Waits for a message.
    fn wait(&mut self, id: u32, fits: impl Fn(&[u8]) -> bool) -> Vec<u8> {
        for _ in 0..500 {
            let seen = self.seen();
            if let Some((_, payload)) = seen.into_iter().find(|(of, payload)| *of == id && fits(payload)) {
                return payload;
            }
        }
        panic!("no message {id}; the firmware said {:?}", self.flight.lines);
    }

    /// Uploads a mission; the result.
    fn upload(&mut self, items: &[MissionItem]) -> u8 {
        let [low, high] = (items.len() as u16).to_le_bytes();
        self.send(MISSION_COUNT, &[low, high, VEHICLE[0], VEHICLE[1], 0]);
        for _ in 0..2000 {
            for (id, payload) in self.seen() {
                match id {
                    MISSION_REQUEST_INT => {
                        let seq = u16::from_le_bytes([payload[0], payload[1]]);
                        self.send(MISSION_ITEM_INT, &item_payload(seq, &items[usize::from(seq)]));
                    }
                    MISSION_ACK => return payload[2],
                    _ => {}
                }
            }
        }
        panic!("the upload does not end");
    }

    /// Downloads the mission, item by item, each as its payload without the target.
    fn download(&mut self) -> Vec<Vec<u8>> {
        self.send(MISSION_REQUEST_LIST, &[VEHICLE[0], VEHICLE[1], 0]);
        let count = self.wait(MISSION_COUNT, |_| true);
        let count = u16::from_le_bytes([count[0], count[1]]);
        let item = |station: &mut Self, seq: u16| {
            let [low, high] = seq.to_le_bytes();
            station.send(MISSION_REQUEST_INT, &[low, high, VEHICLE[0], VEHICLE[1], 0]);
            let item = station.wait(MISSION_ITEM_INT, |payload| payload[28..30] == [low, high]);
            [&item[..30], &item[30..32], &item[34..35]].concat()
        };
        (0..count).map(|seq| item(self, seq)).collect()
    }

    /// Asks for a parameter by its name.
    fn parameter(&mut self, name: &str) -> f32 {
        let mut payload = vec![0xFF, 0xFF, VEHICLE[0], VEHICLE[1]];
        payload.extend(padded(name));
        self.send(PARAM_REQUEST_READ, &payload);
        let value = self.wait(PARAM_VALUE, |payload| payload[8..24] == padded(name));
        f32::from_le_bytes([value[0], value[1], value[2], value[3]])
    }

    fn set_parameter(&mut self, name: &str, value: f32) {
        let mut payload = value.to_le_bytes().to_vec();
        payload.extend(VEHICLE);
        payload.extend(padded(name));
        payload.push(9);
        self.send(PARAM_SET, &payload);
        self.wait(PARAM_VALUE, |payload| payload[8..24] == padded(name));
    }

    /// Power is away for a moment.
    fn power_cycle(&mut self) {
        self.flight.machine.power_cycle();
        self.flight.machine.bus().wiring.take_answers();
        self.parser = Parser::default();
        self.run(SECOND);
        self.wait(HEARTBEAT, |_| true);
    }
}

fn padded(name: &str) -> [u8; 16] {
    let mut padded = [0; 16];
    padded[..name.len()].copy_from_slice(name.as_bytes());
    padded
}

/// `MISSION_ITEM_INT`.
fn item_payload(seq: u16, item: &MissionItem) -> Vec<u8> {
    let mut payload = Vec::new();
    for param in item.params {
        payload.extend(param.to_le_bytes());
    }
    payload.extend(item.x.to_le_bytes());
    payload.extend(item.y.to_le_bytes());
    payload.extend(item.z.to_le_bytes());
    payload.extend(seq.to_le_bytes());
    payload.extend(item.command.to_le_bytes());
    payload.extend([1, 1, item.frame, 0, u8::from(item.autocontinue), 0]);
    payload
}

fn mission() -> Vec<MissionItem> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let file = mission_file::read(&root.join("missions/monitoring.plan")).expect("it is read");
    file.stored().mission
}

/// What a download gives of an item: all but whom it is for and whether it is the current one.
fn kept(items: &[MissionItem]) -> Vec<Vec<u8>> {
    let item = |(seq, item): (usize, &MissionItem)| {
        let payload = item_payload(seq as u16, item);
        [&payload[..30], &payload[30..32], &payload[34..35]].concat()
    };
    items.iter().enumerate().map(item).collect()
}

/// Uploaded and set, and there again after power has been away; uploads enough to turn the journal's
/// pages meanwhile, while the processor stands still for the flash.
#[test]
fn what_is_uploaded_outlasts_power() {
    let mut station = Station::new();
    station.run(SECOND);
    station.wait(HEARTBEAT, |_| true);
    assert_eq!(station.parameter("RTL_RETURN_ALT"), 30.0, "its default");
    let short = mission();
    let mut items = short.clone();
    while items.len() < 150 {
        items.extend_from_slice(&short[1..]);
    }
    let last = 140;
    // Some 5 kB each: more than three sectors hold.
    for count in [150, 149, 148, 147, 146, 145, 144, 143, 142, 141, last] {
        assert_eq!(station.upload(&items[..count]), 0, "{:?}", station.flight.lines);
        station.set_parameter("RTL_RETURN_ALT", count as f32);
        // Parameters rest before they are stored.
        station.run(3 * SECOND);
    }
    assert_eq!(station.download(), kept(&items[..last]));
    station.power_cycle();
    assert_eq!(station.download(), kept(&items[..last]));
    assert_eq!(station.parameter("RTL_RETURN_ALT"), last as f32);
    // And once more: what is read back is stored as it is.
    station.power_cycle();
    assert_eq!(station.download(), kept(&items[..last]));
    let errors: Vec<_> = station
        .flight
        .lines
        .iter()
        .filter(|line| line.level == "error")
        .collect();
    assert!(errors.is_empty(), "{errors:?}");
    assert_eq!(station.flight.machine.resets().len(), 2, "no watchdog meanwhile");
}
