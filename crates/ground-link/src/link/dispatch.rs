//! From a frame to the service that it is for.

use mavlink::MessageData;
use mavlink::dialects::common as wire;

use super::{Context, Core, SILENCE};
use crate::commands::{self, CommandResult, Ours};
use crate::frame::{Address, Frame};
use crate::mission;
use crate::mode::Mode;
use crate::outbox::{Order, Reply};
use crate::parameters;
use crate::request::Request;
use crate::setpoints;
use crate::streams::{self, encode};
use crate::text::{Plain, Severity};
use crate::wire::{Message, Payload};
use windhover_parameters::Whole;

/// `MAV_TYPE_GCS`.
const GROUND_STATION: u8 = wire::MavType::MAV_TYPE_GCS as u8;

/// `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`.
const CUSTOM_MODE: u8 = wire::MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED.bits();

/// Messages that must not act twice when the network repeats them.
const ONCE: [u32; 5] = [
    wire::COMMAND_LONG_DATA::ID,
    wire::COMMAND_INT_DATA::ID,
    wire::MISSION_COUNT_DATA::ID,
    wire::MISSION_CLEAR_ALL_DATA::ID,
    wire::MISSION_SET_CURRENT_DATA::ID,
];

impl Core {
    /// Acts on a frame.
    #[inline(never)]
    pub fn take(&mut self, frame: &Frame<'_>, now: u64, context: &mut Context<'_>) {
        if frame.source == self.config.address {
            return;
        }
        self.losses.note(frame.source, frame.sequence);
        if !context.signing.accepts(frame, now) {
            return;
        }
        if ONCE.contains(&frame.id) && self.recent.has(frame, now) {
            self.repeated = self.repeated.saturating_add(1);
            return;
        }
        let understood = self.take_plan(frame, now, context)
            || self.take_parameter(frame, now, context)
            || self.take_command(frame, now, context)
            || self.take_setpoint(frame)
            || self.take_other(frame, now, context);
        if !understood {
            self.unknown = self.unknown.saturating_add(1);
        }
    }

    #[inline(never)]
    fn take_plan(&mut self, frame: &Frame<'_>, now: u64, context: &mut Context<'_>) -> bool {
        let (from, payload) = (frame.source, Payload(frame.payload));
        let around = &mut mission::Surroundings {
            own: self.config.address,
            plans: &mut *context.plans,
            outbox: &mut self.outbox,
            now,
        };
        let service = &mut self.mission;
        match frame.id {
            wire::MISSION_COUNT_DATA::ID => service.count(payload, from, around),
            wire::MISSION_ITEM_INT_DATA::ID => service.take(payload, false, from, around),
            wire::MISSION_ITEM_DATA::ID => service.take(payload, true, from, around),
            wire::MISSION_REQUEST_LIST_DATA::ID => service.list(payload, from, around),
            wire::MISSION_REQUEST_INT_DATA::ID | wire::MISSION_REQUEST_DATA::ID => {
                service.item(payload, from, around);
            }
            wire::MISSION_ACK_DATA::ID => service.acknowledged(payload, from, around),
            wire::MISSION_CLEAR_ALL_DATA::ID => service.clear(payload, from, around),
            wire::MISSION_WRITE_PARTIAL_LIST_DATA::ID | wire::MISSION_REQUEST_PARTIAL_LIST_DATA::ID => {
                service.partial(payload, from, around);
            }
            wire::MISSION_SET_CURRENT_DATA::ID => self.set_current(payload, from, now, context),
            _ => return false,
        }
        true
    }

    /// `MISSION_SET_CURRENT`: the answer is what is current, once it is so. Whoever hears another number
    /// right away believes it refused, or asks again without end.
    fn set_current(&mut self, payload: Payload<'_>, from: Address, now: u64, context: &Context<'_>) {
        if !payload.is_for(self.config.address, 2) {
            return;
        }
        let index = payload.word(0);
        if index < context.plans.committed(mission::PlanKind::Mission).count {
            let request = Request::SetCurrentItem { index };
            self.outbox.request(Order {
                request,
                from,
                id: None,
            });
            if context.telemetry.mission.current == index {
                self.streams.hasten(streams::MISSION_CURRENT, context.time(now));
            }
        } else {
            let text = format_args!("mission has no item {}", Whole(index.into()));
            self.outbox.say(Severity::Warning, text);
        }
    }

    #[inline(never)]
    fn take_parameter(&mut self, frame: &Frame<'_>, now: u64, context: &Context<'_>) -> bool {
        let (from, payload) = (frame.source, Payload(frame.payload));
        let around = &mut parameters::Surroundings {
            own: self.config.address,
            table: context.parameters,
            outbox: &mut self.outbox,
            now,
        };
        match frame.id {
            wire::PARAM_REQUEST_LIST_DATA::ID => self.parameters.list(payload, self.config.address),
            wire::PARAM_REQUEST_READ_DATA::ID => self.parameters.read(payload, from, around),
            wire::PARAM_SET_DATA::ID => self.parameters.set(payload, from, around),
            _ => return false,
        }
        true
    }

    #[inline(never)]
    fn take_command(&mut self, frame: &Frame<'_>, now: u64, context: &Context<'_>) -> bool {
        let (from, payload) = (frame.source, Payload(frame.payload));
        let around = &mut commands::Surroundings {
            own: self.config.address,
            identity: self.config.identity,
            outbox: &mut self.outbox,
            now,
        };
        let ours = match frame.id {
            wire::COMMAND_LONG_DATA::ID => self.commands.long(payload, from, around),
            wire::COMMAND_INT_DATA::ID => self.commands.int(payload, from, around),
            wire::SET_MODE_DATA::ID => {
                self.set_mode(payload, from);
                None
            }
            _ => return false,
        };
        if let Some(ours) = ours {
            let (result, reply) = self.do_ours(ours, now, context);
            commands::acknowledge(&mut self.outbox, from, ours.command(), result);
            if let Some(reply) = reply {
                self.outbox.reply(reply);
            }
        }
        true
    }

    /// Commands about messages: the result, and what is sent after it.
    fn do_ours(&mut self, ours: Ours, now: u64, context: &Context<'_>) -> (CommandResult, Option<Reply>) {
        let number = |message: u32| u16::try_from(message).unwrap_or(u16::MAX);
        match ours {
            Ours::Once {
                message: wire::AUTOPILOT_VERSION_DATA::ID,
                ..
            } => {
                self.say_version();
                (CommandResult::Accepted, Some(Reply::Version))
            }
            Ours::Once {
                message: wire::PROTOCOL_VERSION_DATA::ID,
                ..
            } => (CommandResult::Accepted, Some(Reply::Protocol)),
            Ours::Once { message, .. } if !streams::exists(message) => (CommandResult::Unsupported, None),
            Ours::Once { message, .. } => {
                // Written twice, so that what is not known now is refused.
                let number = number(message);
                match encode::message(number, &self.source(now, context), &mut Message::empty()) {
                    true => (CommandResult::Accepted, Some(Reply::Telemetry(number))),
                    false => (CommandResult::TemporarilyRejected, None),
                }
            }
            // Whoever hears none believes the vehicle lost.
            Ours::Every {
                message: wire::HEARTBEAT_DATA::ID,
                interval,
            } if !matches!(interval, Some(0..=1_000_000)) => (CommandResult::Denied, None),
            Ours::Every { message, interval } => match self.streams.set(message, interval, context.time(now))
            {
                true => (CommandResult::Accepted, None),
                false => (CommandResult::Unsupported, None),
            },
            Ours::Interval { message } => (CommandResult::Accepted, Some(Reply::Interval(number(message)))),
        }
    }

    /// Our own version as a line of text: the one that clients are shown is not ours.
    fn say_version(&mut self) {
        let version = crate::wire::text(&self.config.version);
        let text = format_args!("Windhover {}", Plain(version));
        self.outbox.texts.say(Severity::Info, text);
    }

    /// `SET_MODE`, of clients that know no commands.
    fn set_mode(&mut self, payload: Payload<'_>, from: Address) {
        let is_custom = payload.byte(5) & CUSTOM_MODE != 0;
        if payload.byte(4) != self.config.address.system || !is_custom {
            return;
        }
        if let Some(mode) = Mode::from_custom(payload.long(0)) {
            let request = Request::SetMode(mode);
            self.outbox.request(Order {
                request,
                from,
                id: None,
            });
        }
    }

    #[inline(never)]
    fn take_setpoint(&mut self, frame: &Frame<'_>) -> bool {
        let (payload, own) = (Payload(frame.payload), self.config.address);
        let (place, request) = match frame.id {
            wire::SET_POSITION_TARGET_LOCAL_NED_DATA::ID => (0, setpoints::local(payload, own)),
            wire::SET_POSITION_TARGET_GLOBAL_INT_DATA::ID => (0, setpoints::global(payload, own)),
            wire::SET_ATTITUDE_TARGET_DATA::ID => (0, setpoints::attitude(payload, own)),
            wire::MANUAL_CONTROL_DATA::ID => (1, setpoints::sticks(payload, own)),
            wire::RC_CHANNELS_OVERRIDE_DATA::ID => (2, setpoints::channels(payload, own)),
            _ => return false,
        };
        if let Some(request) = request
            && let Some(place) = self.newest.get_mut(place)
        {
            *place = Some(Order {
                request,
                from: frame.source,
                id: None,
            });
        }
        true
    }

    #[inline(never)]
    fn take_other(&mut self, frame: &Frame<'_>, now: u64, context: &Context<'_>) -> bool {
        let (from, payload) = (frame.source, Payload(frame.payload));
        match frame.id {
            wire::HEARTBEAT_DATA::ID => {
                // An unsigned one may be anybody's.
                let trusted = frame.signature.is_some() || !context.signing.is_on();
                if payload.byte(4) == GROUND_STATION && trusted {
                    let before = self.station.replace(now);
                    self.arrived |= before.is_none_or(|before| now.saturating_sub(before) > SILENCE);
                }
            }
            wire::RADIO_STATUS_DATA::ID => {}
            wire::REQUEST_DATA_STREAM_DATA::ID => {
                self.streams
                    .legacy(payload, self.config.address, context.time(now))
            }
            wire::PING_DATA::ID => self.ping(payload, from),
            wire::TIMESYNC_DATA::ID => self.time(payload, from, now),
            wire::FILE_TRANSFER_PROTOCOL_DATA::ID => self.files(payload, from),
            wire::SETUP_SIGNING_DATA::ID => self.setup_signing(payload, from),
            _ => return false,
        }
        true
    }

    fn ping(&mut self, payload: Payload<'_>, from: Address) {
        // With a target it is somebody's answer.
        if payload.word(12) == 0 {
            let (time, sequence) = (payload.huge(0), payload.long(8));
            self.outbox.reply(Reply::Pong {
                to: from,
                time,
                sequence,
            });
        }
    }

    fn time(&mut self, payload: Payload<'_>, from: Address, now: u64) {
        let is_asked = payload.huge(0) == 0;
        if is_asked && payload.is_for(self.config.address, 16) {
            let ours = now.saturating_mul(1000);
            self.outbox.reply(Reply::Time {
                to: from,
                theirs: payload.huge(8),
                ours,
            });
        }
    }

    /// There are no files: whatever is asked is refused at once. Answers are not answered.
    fn files(&mut self, payload: Payload<'_>, from: Address) {
        let answer = payload.byte(6) >= 128;
        if answer || !payload.is_for(self.config.address, 1) {
            return;
        }
        self.outbox.reply(Reply::NoFiles {
            to: from,
            sequence: payload.word(3).wrapping_add(1),
            session: payload.byte(5),
            opcode: payload.byte(6),
        });
    }

    fn setup_signing(&mut self, payload: Payload<'_>, from: Address) {
        if payload.byte(8) != self.config.address.system {
            return;
        }
        let request = Request::SetSigningKey {
            secret: payload.bytes(10),
            time: payload.huge(0),
        };
        self.outbox.request(Order {
            request,
            from,
            id: None,
        });
    }
}
