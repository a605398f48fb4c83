//! A vehicle around a link, a ground station, and a channel that loses, delays and repeats: all in
//! simulated time.
#![allow(dead_code, deprecated, unused_imports)]

mod channel;
mod items;
mod station;
mod store;
mod vehicle;

use mavlink::MessageData;
use mavlink::dialects::common::*;
use windhover_ground_link::Address;

pub use channel::*;
pub use items::*;
pub use station::*;
pub use store::*;
pub use vehicle::*;

/// One step of simulated time, µs.
pub const STEP: u64 = 5_000;

pub const VEHICLE: Address = Address {
    system: 1,
    component: 1,
};

/// The messages that the link acts on. Seeds of the fuzzer name them by their place here: a new one
/// comes last.
pub const UNDERSTOOD: &[u32] = &[
    HEARTBEAT_DATA::ID,
    PING_DATA::ID,
    SET_MODE_DATA::ID,
    PARAM_REQUEST_READ_DATA::ID,
    PARAM_REQUEST_LIST_DATA::ID,
    PARAM_SET_DATA::ID,
    MISSION_REQUEST_PARTIAL_LIST_DATA::ID,
    MISSION_WRITE_PARTIAL_LIST_DATA::ID,
    MISSION_ITEM_DATA::ID,
    MISSION_REQUEST_DATA::ID,
    MISSION_SET_CURRENT_DATA::ID,
    MISSION_REQUEST_LIST_DATA::ID,
    MISSION_COUNT_DATA::ID,
    MISSION_CLEAR_ALL_DATA::ID,
    MISSION_ACK_DATA::ID,
    MISSION_REQUEST_INT_DATA::ID,
    REQUEST_DATA_STREAM_DATA::ID,
    MANUAL_CONTROL_DATA::ID,
    RC_CHANNELS_OVERRIDE_DATA::ID,
    MISSION_ITEM_INT_DATA::ID,
    COMMAND_INT_DATA::ID,
    COMMAND_LONG_DATA::ID,
    SET_ATTITUDE_TARGET_DATA::ID,
    SET_POSITION_TARGET_LOCAL_NED_DATA::ID,
    SET_POSITION_TARGET_GLOBAL_INT_DATA::ID,
    FILE_TRANSFER_PROTOCOL_DATA::ID,
    TIMESYNC_DATA::ID,
    SETUP_SIGNING_DATA::ID,
];

/// A command in a mission item that the store refuses.
pub const REFUSED_COMMAND: u16 = 9_999;

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
