//! All services on one channel.
//!
//! What a caller calls is `inline(never)`, unless it is a line or two: callers are compiled for
//! speed.

mod dispatch;
mod recent;
mod send;

use core::fmt;

use heapless::Deque;
use windhover_math::Quaternion;
use windhover_math::geodesy::GlobalPosition;
use windhover_parameters::Refusal;

use crate::commands::{CommandId, CommandResult, CommandService, Identity};
use crate::frame::{Address, Counts, Losses, Parser, Writer};
use crate::mission::{MissionService, PlanStore};
use crate::outbox::{Dropped, Order, Outbox, Reply};
use crate::parameters::{self, ParameterService, ParameterTable};
use crate::signing::Signing;
use crate::streams::Streams;
use crate::streams::budget::Budget;
use crate::telemetry::Telemetry;
use crate::text::Severity;

use recent::Recent;
use send::Shown;

/// The start of a frame that waits for its end for so long is given up, µs: noise that looks like
/// one must not hold up the command behind it for longer than a command may wait.
const STALE: u64 = 80_000;

/// A ground station that was silent for so long and is heard again has come anew, µs.
const SILENCE: u64 = 10_000_000;

/// Photos that wait to be told.
const PHOTOS: usize = 8;

/// What is settled when a link begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Who the vehicle is: system 1, component 1 unless there are several.
    pub address: Address,
    /// As which autopilot it introduces itself.
    pub identity: Identity,
    /// Bytes a second that the channel carries.
    pub bandwidth: u32,
    /// Number of the channel among those of the vehicle; signatures name it.
    pub channel: u8,
    /// Unique number of the board.
    pub uid: u64,
    /// Our own version: up to eight bytes of text.
    pub version: [u8; 8],
}

impl Default for Config {
    /// System 1, component 1, on a serial port of 57,600 baud.
    fn default() -> Self {
        Self {
            address: Address {
                system: 1,
                component: 1,
            },
            identity: Identity::Px4,
            bandwidth: 5_760,
            channel: 0,
            uid: 0,
            version: [0; 8],
        }
    }
}

/// What the link sees of the vehicle, whenever it is called.
pub struct Context<'a> {
    /// The state to be told.
    pub telemetry: &'a Telemetry,
    /// The parameters.
    pub parameters: &'a dyn ParameterTable,
    /// Mission, fence and rally points.
    pub plans: &'a mut dyn PlanStore,
    /// Who may speak: one for all channels.
    pub signing: &'a mut Signing,
}

impl Context<'_> {
    /// The vehicle's time, µs, at `now` of the link's.
    pub(crate) fn time(&self, now: u64) -> u64 {
        self.telemetry.time.unwrap_or(now)
    }
}

/// A photo that was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photo {
    /// Counted from 0.
    pub index: u32,
    /// When, µs since start.
    pub time: u64,
    /// Where.
    pub position: GlobalPosition,
    /// Attitude, body to world.
    pub attitude: Quaternion,
}

/// What was counted since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Frames and bytes in between.
    pub parser: Counts,
    /// Frames that did not arrive, by the gaps in their numbers.
    pub lost: u32,
    /// Frames with a message that is not understood, skipped whole.
    pub unknown: u32,
    /// Frames that the network repeated.
    pub repeated: u32,
    /// What found no room.
    pub dropped: Dropped,
    /// Lines of text that found no room.
    pub texts: u32,
    /// Streamed messages that the budget left out.
    pub left_out: u32,
}

/// One channel to ground stations.
#[derive(Clone, Debug)]
pub struct Link {
    parser: Parser,
    /// When bytes came last, µs.
    heard: u64,
    core: Core,
}

/// All but the parser, so that frames can be acted on while they lie in its buffer.
#[derive(Clone, Debug)]
struct Core {
    config: Config,
    writer: Writer,
    losses: Losses,
    recent: Recent,
    outbox: Outbox,
    parameters: ParameterService,
    mission: MissionService,
    commands: CommandService,
    streams: Streams,
    budget: Budget,
    photos: Deque<Photo, PHOTOS>,
    /// The newest setpoint, sticks and channels.
    newest: [Option<Order>; 3],
    shown: Shown,
    /// When a ground station's heartbeat came last, µs.
    station: Option<u64>,
    /// A ground station has come, and nobody has asked yet.
    arrived: bool,
    unknown: u32,
    repeated: u32,
}

impl Link {
    /// A link that has heard nothing yet.
    #[inline(never)]
    pub fn new(config: Config) -> Self {
        Self {
            parser: Parser::default(),
            heard: 0,
            core: Core {
                config,
                writer: Writer::new(config.address),
                losses: Losses::default(),
                recent: Recent::default(),
                outbox: Outbox::default(),
                parameters: ParameterService::default(),
                mission: MissionService::default(),
                commands: CommandService::default(),
                streams: Streams::default(),
                budget: Budget::new(config.bandwidth),
                photos: Deque::new(),
                newest: [None; 3],
                shown: Shown::default(),
                station: None,
                arrived: false,
                unknown: 0,
                repeated: 0,
            },
        }
    }

    /// Nobody is at the other end any more: what was being uploaded has come to nothing.
    pub fn close(&mut self, context: &mut Context<'_>) {
        self.core.mission.close(&mut crate::mission::Surroundings {
            own: self.core.config.address,
            plans: &mut *context.plans,
            outbox: &mut self.core.outbox,
            now: 0,
        });
    }

    /// Takes bytes that have come, at `now` µs.
    #[inline(never)]
    pub fn receive(&mut self, bytes: &[u8], now: u64, context: &mut Context<'_>) {
        let Self { parser, heard, core } = self;
        *heard = now;
        parser.feed(bytes, |frame| core.take(frame, now, context));
    }

    /// Takes a packet that has come whole, such as a datagram of UDP, at `now` µs: what it leaves
    /// unfinished is given up at once, so that no packet can hold up the next one.
    pub fn receive_packet(&mut self, packet: &[u8], now: u64, context: &mut Context<'_>) {
        self.receive(packet, now, context);
        self.give_up(now, context);
    }

    /// No more bytes will come for what waits.
    #[inline(never)]
    fn give_up(&mut self, now: u64, context: &mut Context<'_>) {
        let Self { parser, core, .. } = self;
        parser.give_up(|frame| core.take(frame, now, context));
    }

    /// Gives the frames that are to be sent at `now` µs, each to one call of `out`. To be called
    /// every few milliseconds.
    #[inline(never)]
    pub fn poll(&mut self, now: u64, context: &mut Context<'_>, out: &mut dyn FnMut(&[u8])) {
        if self.parser.waits() && now.saturating_sub(self.heard) >= STALE {
            self.give_up(now, context);
        }
        self.core.poll(now, context, out);
    }

    /// What a ground station wants of the vehicle: commands in the order in which they came, then
    /// the newest setpoint and sticks.
    #[inline(never)]
    pub fn next_request(&mut self) -> Option<Order> {
        let Core { outbox, newest, .. } = &mut self.core;
        let next = outbox.next_request();
        next.or_else(|| newest.iter_mut().find_map(Option::take))
    }

    /// Answers a command. The first final answer counts; [`CommandResult::InProgress`] is not one.
    #[inline(never)]
    pub fn finish(&mut self, id: CommandId, result: CommandResult, now: u64) {
        self.core.commands.finish(id, result, &mut self.core.outbox, now);
    }

    /// Tells how far a command has come, in percent.
    #[inline(never)]
    pub fn progress(&mut self, id: CommandId, percent: u8, now: u64) {
        self.core
            .commands
            .progress(id, percent, &mut self.core.outbox, now);
    }

    /// Tells that a write to the parameter table was refused.
    #[inline(never)]
    pub fn parameter_refused(&mut self, index: u16, refusal: Refusal, table: &dyn ParameterTable, now: u64) {
        let core = &mut self.core;
        let mut around = parameters::Surroundings {
            own: core.config.address,
            table,
            outbox: &mut core.outbox,
            now,
        };
        core.parameters.refused(index, refusal, &mut around);
    }

    /// Tells that a parameter has changed without a ground station having asked for it.
    #[inline(never)]
    pub fn parameter_changed(&mut self, index: u16) {
        self.core.outbox.reply(Reply::Parameter(index));
    }

    /// Sends a line of text.
    #[inline(never)]
    pub fn say(&mut self, severity: Severity, text: fmt::Arguments<'_>) {
        self.core.outbox.say(severity, text);
    }

    /// Tells that an item of the mission was reached.
    #[inline(never)]
    pub fn item_reached(&mut self, index: u16) {
        self.core.outbox.reply(Reply::Reached(index));
    }

    /// Tells that a photo was taken. The oldest one that was not told yet makes room, and counts.
    #[inline(never)]
    pub fn photo_taken(&mut self, photo: Photo) {
        let Core { photos, outbox, .. } = &mut self.core;
        if photos.is_full() {
            photos.pop_front();
            outbox.dropped.photos = outbox.dropped.photos.saturating_add(1);
        }
        let _ = photos.push_back(photo);
    }

    /// Introduces the vehicle as another autopilot from now on.
    pub fn set_identity(&mut self, identity: Identity) {
        self.core.config.identity = identity;
    }

    /// When a ground station's heartbeat came last, µs.
    pub fn station_heard(&self) -> Option<u64> {
        self.core.station
    }

    /// Whether a ground station has come since this was asked last: its heartbeat, after none for ten
    /// seconds.
    pub fn take_arrival(&mut self) -> bool {
        core::mem::take(&mut self.core.arrived)
    }

    /// What was counted since start.
    #[inline(never)]
    pub fn counters(&self) -> Counters {
        let core = &self.core;
        Counters {
            parser: self.parser.counts(),
            lost: core.losses.lost(),
            unknown: core.unknown,
            repeated: core.repeated,
            dropped: core.outbox.dropped,
            texts: core.outbox.texts.dropped(),
            left_out: core.streams.left_out(),
        }
    }
}
