//! A vehicle around a link, a ground station, and a channel that loses, delays and repeats: all in
//! simulated time.
#![allow(dead_code, deprecated)]

use mavlink::dialects::common::*;
use mavlink::{MavlinkVersion, MessageData};
use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::{MissionCommit, Parameters};
use windhover_ground_link::frame::{MAX_FRAME, Parser, Writer};
use windhover_ground_link::{
    Address, CommandResult, Config, Context, Link, MissionResult, Order, PlanKind, PlanRefusal, PlanStore,
    Request, Telemetry,
};

/// One step of simulated time, µs.
pub const STEP: u64 = 5_000;

pub const VEHICLE: Address = Address {
    system: 1,
    component: 1,
};

/// A command in a mission item that the store refuses.
pub const REFUSED_COMMAND: u16 = 9_999;

/// xorshift64*: small, seeded, and good enough to lose frames with.
#[derive(Clone)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    /// True with this probability, in percent.
    pub fn percent(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }
}

/// One direction of a channel.
pub struct Channel {
    pub loss: u64,
    pub repeats: u64,
    pub delay: u64,
    pub jitter: u64,
    random: Random,
    under_way: Vec<(u64, Vec<u8>)>,
}

impl Channel {
    pub fn clean() -> Self {
        Self::new(0, 0, 0, 0, 1)
    }

    /// 20 % loss, 30 ms jitter, 2 % repeated.
    pub fn bad(seed: u64) -> Self {
        Self::new(20, 2, 10_000, 30_000, seed)
    }

    pub fn new(loss: u64, repeats: u64, delay: u64, jitter: u64, seed: u64) -> Self {
        Self {
            loss,
            repeats,
            delay,
            jitter,
            random: Random::new(seed),
            under_way: Vec::new(),
        }
    }

    pub fn send(&mut self, now: u64, frame: Vec<u8>) {
        if self.random.percent(self.loss) {
            return;
        }
        let copies = 1 + usize::from(self.random.percent(self.repeats));
        for _ in 0..copies {
            let jitter = if self.jitter > 0 {
                self.random.below(self.jitter)
            } else {
                0
            };
            self.under_way.push((now + self.delay + jitter, frame.clone()));
        }
    }

    pub fn arrived(&mut self, now: u64) -> Vec<Vec<u8>> {
        self.under_way.sort_by_key(|(at, _)| *at);
        let count = self.under_way.iter().take_while(|(at, _)| *at <= now).count();
        self.under_way.drain(..count).map(|(_, frame)| frame).collect()
    }
}

/// Plans in memory, with two slots each.
#[derive(Clone, Default)]
pub struct Store {
    slots: [[Vec<MissionItem>; 2]; 3],
    active: [MissionCommit; 3],
    staged: [bool; 3],
    pub commits: u32,
    pub refuse_commit: bool,
}

impl Store {
    pub fn items(&self, kind: PlanKind) -> &[MissionItem] {
        let at = usize::from(kind.code());
        &self.slots[at][usize::from(self.active[at].slot)]
    }

    /// Bits of all plans in use.
    pub fn bits(&self) -> Vec<Vec<String>> {
        PlanKind::EACH
            .map(|kind| self.items(kind).iter().map(bits).collect())
            .into()
    }
}

/// An item as text in which NaNs can be compared.
pub fn bits(item: &MissionItem) -> String {
    let params = item.params.map(f32::to_bits);
    let z = item.z.to_bits();
    let MissionItem {
        command,
        frame,
        autocontinue,
        x,
        y,
        ..
    } = item;
    format!("{command} {frame} {autocontinue} {params:x?} {x} {y} {z:x}")
}

impl PlanStore for Store {
    fn committed(&self, kind: PlanKind) -> MissionCommit {
        self.active[usize::from(kind.code())]
    }

    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        let slots = &self.slots[usize::from(kind.code())];
        slots[usize::from(slot)].get(usize::from(index)).copied()
    }

    fn capacity(&self, _kind: PlanKind) -> u16 {
        256
    }

    fn check(&self, _kind: PlanKind, index: u16, item: &MissionItem) -> Result<(), PlanRefusal> {
        if item.command == REFUSED_COMMAND {
            let reason = format_args!("item {index}: this is not flown");
            return Err(PlanRefusal::new(MissionResult::Unsupported, reason));
        }
        Ok(())
    }

    fn begin(&mut self, kind: PlanKind, _count: u16) -> Result<u8, PlanRefusal> {
        let at = usize::from(kind.code());
        assert!(!self.staged[at], "an upload begins before the last one ended");
        self.staged[at] = true;
        let slot = 1 - self.active[at].slot;
        self.slots[at][usize::from(slot)].clear();
        Ok(slot)
    }

    fn write(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> Result<(), PlanRefusal> {
        let at = usize::from(kind.code());
        assert!(self.staged[at] && slot != self.active[at].slot);
        let items = &mut self.slots[at][usize::from(slot)];
        assert_eq!(items.len(), usize::from(index), "items come in order");
        items.push(*item);
        Ok(())
    }

    fn commit(&mut self, kind: PlanKind, commit: MissionCommit) -> Result<(), PlanRefusal> {
        let at = usize::from(kind.code());
        if self.refuse_commit {
            return Err(PlanRefusal::new(MissionResult::Denied, format_args!("in flight")));
        }
        let items = &self.slots[at][usize::from(commit.slot)];
        assert_eq!(items.len(), usize::from(commit.count), "committed whole");
        assert_eq!(
            commit.crc,
            windhover_flight_log::crc::mission_crc(items.iter().copied())
        );
        self.staged[at] = false;
        self.active[at] = commit;
        self.commits += 1;
        Ok(())
    }

    fn abort(&mut self, kind: PlanKind) {
        self.staged[usize::from(kind.code())] = false;
    }
}

/// What a vehicle does with a request.
pub type Answer = fn(&Request) -> Option<CommandResult>;

/// A link with all that it needs.
pub struct Vehicle {
    pub link: Link,
    pub store: Store,
    pub parameters: Parameters,
    pub telemetry: Telemetry,
    pub orders: Vec<Order>,
    /// `None` answers nothing.
    pub answer: Answer,
    /// Whether requests are taken out of the queue.
    pub takes: bool,
}

impl Vehicle {
    /// With all the bandwidth that one could wish for.
    pub fn new() -> Self {
        Self::with(Config {
            bandwidth: 1_000_000,
            ..Config::default()
        })
    }

    pub fn with(config: Config) -> Self {
        Self {
            link: Link::new(config),
            store: Store::default(),
            parameters: Parameters::default(),
            telemetry: Telemetry::default(),
            orders: Vec::new(),
            answer: |_| Some(CommandResult::Accepted),
            takes: true,
        }
    }

    pub fn receive(&mut self, bytes: &[u8], now: u64) {
        let mut context = Context {
            telemetry: &self.telemetry,
            parameters: &self.parameters,
            plans: &mut self.store,
        };
        self.link.receive(bytes, now, &mut context);
        while self.takes
            && let Some(order) = self.link.next_request()
        {
            self.act(order, now);
        }
    }

    fn act(&mut self, order: Order, now: u64) {
        self.orders.push(order);
        if let Request::WriteParameter { index, value } = order.request {
            let outcome = self.parameters.set(usize::from(index), value);
            if let Err(refusal) = outcome {
                self.link.parameter_refused(index, refusal, &self.parameters, now);
            }
        }
        if let (Some(id), Some(result)) = (order.id, (self.answer)(&order.request)) {
            self.link.finish(id, result, now);
        }
    }

    pub fn poll(&mut self, now: u64) -> Vec<Vec<u8>> {
        let mut context = Context {
            telemetry: &self.telemetry,
            parameters: &self.parameters,
            plans: &mut self.store,
        };
        let mut frames = Vec::new();
        self.link
            .poll(now, &mut context, &mut |frame| frames.push(frame.to_vec()));
        frames
    }

    pub fn requests(&self) -> Vec<Request> {
        self.orders.iter().map(|order| order.request).collect()
    }
}

/// A message as it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    pub id: u32,
    pub payload: Vec<u8>,
}

impl Seen {
    pub fn read<M: MessageData>(&self) -> Option<M> {
        (self.id == M::ID).then(|| M::deser(MavlinkVersion::V2, &self.payload).expect("our own is valid"))
    }
}

/// All messages of one type.
pub fn all<M: MessageData>(seen: &[Seen]) -> Vec<M> {
    seen.iter().filter_map(Seen::read).collect()
}

/// Text of a status message.
pub fn texts(seen: &[Seen]) -> Vec<String> {
    let text = |data: STATUSTEXT_DATA| data.text.to_str().unwrap().to_string();
    all(seen).into_iter().map(text).collect()
}

/// A ground station: frames its messages and reads those of the vehicle.
pub struct Station {
    pub address: Address,
    writer: Writer,
    parser: Parser,
}

impl Station {
    pub fn new(system: u8) -> Self {
        let address = Address {
            system,
            component: 190,
        };
        Self {
            address,
            writer: Writer::new(address),
            parser: Parser::default(),
        }
    }

    pub fn frame<M: MessageData>(&mut self, message: &M) -> Vec<u8> {
        let mut payload = [0; 255];
        message.ser(MavlinkVersion::V2, &mut payload);
        self.raw(M::ID, &payload[..M::ENCODED_LEN])
    }

    pub fn raw(&mut self, id: u32, payload: &[u8]) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        let length = self.writer.write(&mut buffer, id, payload, None).unwrap();
        buffer[..length].to_vec()
    }

    pub fn read(&mut self, frames: &[Vec<u8>]) -> Vec<Seen> {
        let mut seen = Vec::new();
        for frame in frames {
            self.parser.feed(frame, |frame| {
                seen.push(Seen {
                    id: frame.id,
                    payload: frame.payload.to_vec(),
                });
            });
        }
        assert_eq!(
            self.parser.counts().skipped,
            0,
            "the vehicle sends nothing but frames"
        );
        seen
    }
}

/// A vehicle and one station on a clean channel, with a clock.
pub struct Bench {
    pub vehicle: Vehicle,
    pub station: Station,
    pub now: u64,
}

impl Bench {
    pub fn new() -> Self {
        Self::with(Vehicle::new())
    }

    pub fn with(vehicle: Vehicle) -> Self {
        let mut bench = Self {
            vehicle,
            station: Station::new(255),
            now: 1_000_000,
        };
        bench.run(STEP);
        bench
    }

    /// Sends, and what comes back in the same step.
    pub fn ask<M: MessageData>(&mut self, message: &M) -> Vec<Seen> {
        let frame = self.station.frame(message);
        self.bytes(&frame)
    }

    pub fn bytes(&mut self, bytes: &[u8]) -> Vec<Seen> {
        self.vehicle.receive(bytes, self.now);
        self.run(STEP)
    }

    /// Lets time pass: what the vehicle sends.
    pub fn run(&mut self, time: u64) -> Vec<Seen> {
        let mut seen = Vec::new();
        let end = self.now + time;
        while self.now < end {
            let frames = self.vehicle.poll(self.now);
            seen.extend(self.station.read(&frames));
            self.now += STEP;
        }
        seen
    }

    /// A command, and its acknowledgements.
    pub fn command(&mut self, command: MavCmd, params: [f32; 7]) -> Vec<COMMAND_ACK_DATA> {
        let seen = self.ask(&long(command, params));
        all(&seen)
    }

    pub fn result(&mut self, command: MavCmd, params: [f32; 7]) -> MavResult {
        let acks = self.command(command, params);
        assert_eq!(acks.len(), 1, "{command:?} is acknowledged once: {acks:?}");
        assert_eq!((acks[0].command, acks[0].target_system), (command, 255));
        acks[0].result
    }
}

pub fn long(command: MavCmd, params: [f32; 7]) -> COMMAND_LONG_DATA {
    let [param1, param2, param3, param4, param5, param6, param7] = params;
    COMMAND_LONG_DATA {
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
    }
}

pub const NAN: f32 = f32::NAN;

/// Any plan: numbers that tell items apart, and NaNs of different kinds.
pub fn plan(count: u16, salt: u32) -> Vec<MissionItem> {
    (0..count)
        .map(|index| {
            let n = u32::from(index) + salt;
            MissionItem {
                command: if index % 3 == 2 { 2000 } else { 16 },
                frame: [0, 3, 6, 2][usize::from(index % 4)],
                autocontinue: index % 7 != 0,
                params: [n as f32, f32::from_bits(0x7fc0_0000 | n), -0.0, NAN],
                x: 473_977_418 + n as i32,
                y: -85_455_938 - n as i32,
                z: if index % 5 == 0 {
                    f32::from_bits(0xffc0_0001 + n)
                } else {
                    n as f32 * 0.1
                },
            }
        })
        .collect()
}

pub fn item_data(item: &MissionItem, index: u16, kind: MavMissionType) -> MISSION_ITEM_INT_DATA {
    use num::{command, frame};
    let [param1, param2, param3, param4] = item.params;
    MISSION_ITEM_INT_DATA {
        param1,
        param2,
        param3,
        param4,
        x: item.x,
        y: item.y,
        z: item.z,
        seq: index,
        command: command(item.command),
        target_system: 1,
        target_component: 1,
        frame: frame(item.frame),
        current: 0,
        autocontinue: u8::from(item.autocontinue),
        mission_type: kind,
    }
}

pub fn item_of(data: &MISSION_ITEM_INT_DATA) -> MissionItem {
    MissionItem {
        command: data.command as u16,
        frame: data.frame as u8,
        autocontinue: data.autocontinue != 0,
        params: [data.param1, data.param2, data.param3, data.param4],
        x: data.x,
        y: data.y,
        z: data.z,
    }
}

/// Numbers to the crate's enumerations, by way of a message.
mod num {
    use super::*;

    fn data(command: u16, frame: u8) -> MISSION_ITEM_INT_DATA {
        let mut payload = [0; 38];
        payload[30..32].copy_from_slice(&command.to_le_bytes());
        payload[34] = frame;
        MISSION_ITEM_INT_DATA::deser(MavlinkVersion::V2, &payload).expect("known numbers")
    }

    pub fn command(number: u16) -> MavCmd {
        data(number, 0).command
    }

    pub fn frame(number: u8) -> MavFrame {
        data(16, number).frame
    }
}

pub fn count(count: u16, kind: MavMissionType) -> MISSION_COUNT_DATA {
    MISSION_COUNT_DATA {
        count,
        target_system: 1,
        target_component: 1,
        mission_type: kind,
        ..MISSION_COUNT_DATA::DEFAULT
    }
}
