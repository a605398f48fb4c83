//! A ground station at a simulated vehicle: frames by a link, in simulated time.

use std::collections::VecDeque;

use mavlink::dialects::common::*;
use mavlink::{MavlinkVersion, MessageData};
use windhover_autopilot::mission::MissionItem;
use windhover_ground_link::Address;
use windhover_ground_link::frame::{Frame, MAX_FRAME, Parser, Writer};
use windhover_math::geodesy::GlobalPosition;
use windhover_model::random::Random;
use windhover_sim::flight::Setup;
use windhover_sim::sitl;
use windhover_sim::sitl::served::Served;

/// Where the vehicle stands: home of the reference mission.
pub const HOME: GlobalPosition = GlobalPosition {
    latitude: 473_977_418,
    longitude: 85_455_938,
    altitude: 488_000,
};

/// One outer period, µs.
const STEP: u64 = 4_000;

/// The link of packets.
const LINK: usize = 0;

/// A network that loses frames, both ways.
#[derive(Clone, Debug)]
pub struct Losses {
    random: Random,
    share: f64,
}

/// A message as it came.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Simulated time, µs.
    pub time: u64,
    /// Its number.
    pub id: u32,
    payload: Vec<u8>,
}

impl Seen {
    /// A frame that came at `time`, µs.
    pub fn new(time: u64, frame: &Frame<'_>) -> Self {
        Self {
            time,
            id: frame.id,
            payload: frame.payload.to_vec(),
        }
    }

    /// The message, if it is one of that type.
    pub fn read<M: MessageData>(&self) -> Option<M> {
        (self.id == M::ID).then(|| M::deser(MavlinkVersion::V2, &self.payload).expect("a valid message"))
    }
}

/// A vehicle and a ground station.
pub struct Station {
    /// The vehicle.
    pub served: Served,
    writer: Writer,
    parser: Parser,
    losses: Option<Losses>,
    /// Simulated time, µs.
    pub now: u64,
    /// How much faster simulated time runs than the clock of the links.
    speed: u64,
    /// All that came and was not looked at yet.
    pub seen: VecDeque<Seen>,
    /// Lines of text that came.
    pub texts: Vec<String>,
    /// The last heartbeat: armed, and the mode's main and sub number.
    pub heartbeat: (bool, u8, u8),
    /// The log so far.
    pub log: Vec<u8>,
}

impl Station {
    /// Beside a vehicle that has just been switched on.
    pub fn new(setup: &Setup) -> Self {
        Self {
            served: sitl::vehicle(setup, HOME, &[]).expect("a vehicle that flies"),
            writer: Writer::new(Address {
                system: 255,
                component: 190,
            }),
            parser: Parser::default(),
            losses: None,
            now: 0,
            speed: 1,
            seen: VecDeque::new(),
            texts: Vec::new(),
            heartbeat: (false, 0, 0),
            log: Vec::new(),
        }
    }

    /// The same at a network that loses this share of frames, both ways.
    #[must_use]
    pub fn losing(mut self, share: f64, seed: u64) -> Self {
        self.losses = Some(Losses {
            random: Random::new(seed, 5),
            share,
        });
        self
    }

    /// The same in a simulation that runs so many times faster than the clock.
    #[must_use]
    pub fn hurried(mut self, speed: u64) -> Self {
        self.speed = speed;
        self
    }

    /// The clock of the links, µs.
    fn clock(&self) -> u64 {
        self.now / self.speed
    }

    fn is_lost(&mut self) -> bool {
        let losses = self.losses.as_mut();
        losses.is_some_and(|losses| losses.random.uniform() < losses.share)
    }

    /// Sends a message.
    pub fn send<M: MessageData>(&mut self, message: &M) {
        let mut payload = [0; 255];
        message.ser(MavlinkVersion::V2, &mut payload);
        self.raw(M::ID, &payload[..M::ENCODED_LEN]);
    }

    /// Sends a message by its number and its bytes.
    pub fn raw(&mut self, id: u32, payload: &[u8]) {
        let mut frame = [0; MAX_FRAME];
        let length = self.writer.write(&mut frame, id, payload, None).expect("a frame");
        if !self.is_lost() {
            let clock = self.clock();
            self.served.receive_packet(LINK, &frame[..length], clock);
        }
    }

    /// One outer period.
    pub fn step(&mut self) {
        self.served.step(self.clock());
        self.now += STEP;
        let (clock, mut frames) = (self.clock(), Vec::new());
        self.served
            .poll(LINK, clock, &mut |frame| frames.push(frame.to_vec()));
        for frame in frames {
            if self.is_lost() {
                continue;
            }
            let (time, seen) = (self.now, &mut self.seen);
            self.parser
                .feed(&frame, |frame| seen.push_back(Seen::new(time, frame)));
        }
        self.look();
        self.log.extend(self.served.take_log());
    }

    /// Takes in what is looked at by the way; streams are not kept.
    fn look(&mut self) {
        const KEPT: [u32; 9] = [
            COMMAND_ACK_DATA::ID,
            MISSION_ACK_DATA::ID,
            MISSION_REQUEST_INT_DATA::ID,
            MISSION_COUNT_DATA::ID,
            MISSION_ITEM_INT_DATA::ID,
            MISSION_ITEM_REACHED_DATA::ID,
            PARAM_VALUE_DATA::ID,
            CAMERA_IMAGE_CAPTURED_DATA::ID,
            LOCAL_POSITION_NED_DATA::ID,
        ];
        for seen in &self.seen {
            if let Some(heartbeat) = seen.read::<HEARTBEAT_DATA>() {
                let [_, _, main, sub] = heartbeat.custom_mode.to_le_bytes();
                let armed = heartbeat
                    .base_mode
                    .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
                self.heartbeat = (armed, main, sub);
            }
            if let Some(text) = seen.read::<STATUSTEXT_DATA>() {
                self.texts
                    .push(text.text.to_str().unwrap_or_default().to_string());
            }
        }
        self.seen.retain(|seen| KEPT.contains(&seen.id));
    }

    /// Time goes on, s.
    pub fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds * 250.0) as u32 {
            self.step();
        }
    }

    /// Waits for a message that fits; panics when none has come within so many seconds.
    pub fn wait<M: MessageData>(&mut self, seconds: f64, fits: impl Fn(&M) -> bool) -> (u64, M) {
        for _ in 0..(seconds * 250.0) as u32 {
            while let Some(seen) = self.seen.pop_front() {
                if let Some(message) = seen.read::<M>().filter(|message| fits(message)) {
                    return (seen.time, message);
                }
            }
            self.step();
        }
        panic!("no {} within {seconds} s; texts: {:#?}", M::NAME, self.texts);
    }

    /// Steps until something holds.
    pub fn until(&mut self, seconds: f64, what: &str, holds: impl Fn(&Self) -> bool) {
        for _ in 0..(seconds * 250.0) as u32 {
            if holds(self) {
                return;
            }
            self.step();
        }
        panic!("not within {seconds} s: {what}; texts: {:#?}", self.texts);
    }

    /// A vehicle that nothing speaks against arming.
    pub fn ready(mut self) -> Self {
        self.until(60.0, "ready to arm", |station| {
            station.served.vehicle().telemetry().health.can_arm
        });
        // On sensors the estimate settles meanwhile.
        self.run(2.0);
        self
    }

    /// Sends a command; its answer, and how long that took, µs.
    pub fn command(&mut self, command: MavCmd, params: [f32; 7]) -> (MavResult, u64) {
        let [param1, param2, param3, param4, param5, param6, param7] = params;
        let sent = self.now;
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
        let (time, ack) = self.wait::<COMMAND_ACK_DATA>(5.0, |ack| ack.command == command);
        (ack.result, time - sent)
    }

    /// Sends a command that is to be accepted.
    pub fn order(&mut self, command: MavCmd, params: [f32; 7]) {
        let (result, _) = self.command(command, params);
        assert_eq!(
            result,
            MavResult::MAV_RESULT_ACCEPTED,
            "{command:?}: {:#?}",
            self.texts
        );
    }

    /// Asks for one of PX4's modes.
    pub fn set_mode(&mut self, main: f32, sub: f32) -> MavResult {
        let params = [1.0, main, sub, 0.0, 0.0, 0.0, 0.0];
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, params).0
    }

    /// Uploads a plan as clients do: gives what is asked for, begins anew when nothing comes.
    pub fn upload(&mut self, kind: MavMissionType, items: &[MissionItem]) -> MavMissionResult {
        for _ in 0..20 {
            self.send(&MISSION_COUNT_DATA {
                count: items.len() as u16,
                target_system: 1,
                target_component: 1,
                mission_type: kind,
                opaque_id: 0,
            });
            let mut quiet = 0;
            while quiet < 500 {
                quiet += 1;
                while let Some(seen) = self.seen.pop_front() {
                    if let Some(ask) = seen.read::<MISSION_REQUEST_INT_DATA>()
                        && let Some(item) = items.get(usize::from(ask.seq))
                    {
                        quiet = 0;
                        self.raw(MISSION_ITEM_INT_DATA::ID, &item_payload(kind, ask.seq, item));
                    }
                    if let Some(ack) = seen.read::<MISSION_ACK_DATA>().filter(|a| a.mission_type == kind) {
                        return ack.mavtype;
                    }
                }
                self.step();
            }
        }
        panic!("the upload came to nothing; texts: {:#?}", self.texts);
    }
}

/// An item as it is sent (`MISSION_ITEM_INT`): byte for byte, since it need not be one that is known.
pub fn item_payload(kind: MavMissionType, seq: u16, item: &MissionItem) -> Vec<u8> {
    let mut payload = Vec::new();
    for param in item.params {
        payload.extend(param.to_le_bytes());
    }
    payload.extend(item.x.to_le_bytes());
    payload.extend(item.y.to_le_bytes());
    payload.extend(item.z.to_le_bytes());
    payload.extend(seq.to_le_bytes());
    payload.extend(item.command.to_le_bytes());
    payload.extend([1, 1, item.frame, 0, u8::from(item.autocontinue), kind as u8]);
    payload
}
