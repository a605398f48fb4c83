//! What is sent, in the order of importance: heartbeat, answers, text, photos, then streams and the
//! list of parameters in turn.

use mavlink::MessageData;
use mavlink::dialects::common::{
    FILE_TRANSFER_PROTOCOL_DATA, MESSAGE_INTERVAL_DATA, MISSION_ITEM_REACHED_DATA, PARAM_ERROR_DATA,
    PING_DATA, TIMESYNC_DATA,
};

use super::{Context, Core};
use crate::commands;
use crate::frame::{Address, MAX_FRAME, Sign};
use crate::mission::{self, PlanKind};
use crate::outbox::Reply;
use crate::parameters;
use crate::signing::Signing;
use crate::streams::{self, encode, version};
use crate::telemetry::{Landed, Telemetry};
use crate::wire::Message;

/// What is given the frames.
type Out<'a> = &'a mut dyn FnMut(&[u8]);

/// The code in a file transfer that refuses, and the reason "unknown command".
const REFUSED: u8 = 129;
const UNKNOWN_COMMAND: u8 = 7;

/// What was told last: a change is told at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shown {
    heartbeat: (u32, bool, bool),
    landed: Landed,
    mission: (crate::telemetry::Progress, u32),
    home: Option<windhover_math::geodesy::GlobalPosition>,
}

impl Shown {
    fn of(telemetry: &Telemetry, mission: u32) -> Self {
        Self {
            heartbeat: (telemetry.mode.custom(), telemetry.armed, telemetry.failsafe),
            landed: telemetry.landed,
            mission: (telemetry.mission, mission),
            home: telemetry.home,
        }
    }
}

impl Core {
    /// Sends what is due.
    pub fn poll(&mut self, now: u64, context: &mut Context<'_>, out: Out<'_>) {
        self.go_on(now, context);
        self.notice(now, context);
        self.budget.advance(now);
        let m = &mut Message::empty();
        if self.streams.heartbeat(context.time(now)) {
            self.send_telemetry(streams::HEARTBEAT, now, context, m, out);
        }
        // Whatever else waits: they are shorter than what they answer.
        while let Some(reply) = self.outbox.next_acknowledgement() {
            if self.answer(&reply, now, context, m).is_some() {
                self.send(m, now, context.signing, out);
            }
        }
        while self.budget.allows_answer()
            && let Some(reply) = self.outbox.next_reply()
        {
            if self.answer(&reply, now, context, m).is_some() {
                self.send(m, now, context.signing, out);
            }
        }
        self.send_rest(now, context, m, out);
    }

    /// Lets the services notice that time has passed.
    fn go_on(&mut self, now: u64, context: &mut Context<'_>) {
        self.commands.poll(&mut self.outbox, now);
        self.mission.poll(&mut mission::Surroundings {
            own: self.config.address,
            plans: &mut *context.plans,
            outbox: &mut self.outbox,
            now,
        });
        self.parameters.poll(&mut parameters::Surroundings {
            own: self.config.address,
            table: context.parameters,
            outbox: &mut self.outbox,
            now,
        });
    }

    /// What has changed is told at once.
    fn notice(&mut self, now: u64, context: &Context<'_>) {
        let mission = context.plans.committed(PlanKind::Mission).crc;
        let time = context.time(now);
        let shown = Shown::of(context.telemetry, mission);
        if shown.heartbeat != self.shown.heartbeat {
            self.streams.hasten(streams::HEARTBEAT, time);
        }
        if shown.landed != self.shown.landed {
            self.streams.hasten(streams::EXTENDED_SYS_STATE, time);
        }
        if shown.mission != self.shown.mission {
            self.streams.hasten(streams::MISSION_CURRENT, time);
        }
        if shown.home != self.shown.home {
            self.streams.hasten(streams::HOME_POSITION, time);
        }
        self.shown = shown;
    }

    /// What has to wait for the budget.
    #[inline(never)]
    fn send_rest(&mut self, now: u64, context: &mut Context<'_>, m: &mut Message, out: Out<'_>) {
        if self.outbox.has_replies() {
            return;
        }
        while self.budget.allows() && self.outbox.texts.next(m).is_some() {
            self.send(m, now, context.signing, out);
        }
        while self.budget.allows()
            && let Some(photo) = self.photos.pop_front()
        {
            encode::image_captured(&photo, &self.source(now, context), m);
            self.send(m, now, context.signing, out);
        }
        while self.budget.allows() {
            let stream = self.streams.next(context.time(now));
            if let Some(number) = stream {
                self.send_telemetry(number, now, context, m, out);
            }
            let listed = self.parameters.next_of_list(context.parameters);
            if let Some(index) = listed
                && parameters::value_message(context.parameters, index, m).is_some()
            {
                self.send(m, now, context.signing, out);
            }
            if stream.is_none() && listed.is_none() {
                break;
            }
        }
    }

    #[inline(never)]
    fn send_telemetry(
        &mut self,
        number: u16,
        now: u64,
        context: &mut Context<'_>,
        m: &mut Message,
        out: Out<'_>,
    ) {
        if encode::message(number, &self.source(now, context), m) {
            self.send(m, now, context.signing, out);
        }
    }

    /// Makes a frame around a message, signed if there is a key.
    #[inline(never)]
    fn send(&mut self, message: &Message, now: u64, signing: &mut Signing, out: Out<'_>) {
        let mut buffer = [0; MAX_FRAME];
        let (is_signed, channel) = (signing.is_on(), self.config.channel);
        let mut sign = |covered: &[u8]| signing.sign(covered, channel, now);
        let sign: Option<Sign<'_>> = if is_signed { Some(&mut sign) } else { None };
        let length = self
            .writer
            .write(&mut buffer, message.id, message.payload(), sign);
        if let Some(frame) = length.and_then(|length| buffer.get(..length)) {
            self.budget.spend(frame.len());
            out(frame);
        }
    }

    /// What messages of telemetry are made from.
    #[inline(never)]
    pub(super) fn source<'a>(&self, now: u64, context: &'a Context<'_>) -> encode::Source<'a> {
        let (lost, received) = (self.losses.lost() as f32, self.losses.received() as f32);
        encode::Source {
            telemetry: context.telemetry,
            identity: self.config.identity,
            plans: PlanKind::EACH.map(|kind| context.plans.committed(kind)),
            loss: if received > 0.0 {
                lost / (lost + received)
            } else {
                0.0
            },
            now: context.time(now),
        }
    }

    /// An answer as a message; `None` when what was asked for is gone.
    #[inline(never)]
    fn answer(&self, reply: &Reply, now: u64, context: &Context<'_>, m: &mut Message) -> Option<()> {
        match *reply {
            Reply::Command {
                to,
                command,
                result,
                progress,
            } => commands::ack_message(to, command, result, progress, m),
            Reply::PlanAck { to, kind, result } => {
                let plan = PlanKind::from_code(kind).map(|kind| context.plans.committed(kind).crc);
                mission::ack_message(to, kind, result, plan.unwrap_or_default(), m);
            }
            Reply::PlanCount { to, kind, count, crc } => mission::count_message(to, kind, count, crc, m),
            Reply::PlanRequest { to, kind, index } => mission::request_message(to, kind, index, m),
            Reply::PlanItem { to, kind, index } => item(to, kind, index, context, m)?,
            Reply::Reached(index) => {
                m.start(MISSION_ITEM_REACHED_DATA::ID).word(index);
            }
            Reply::Parameter(index) => parameters::value_message(context.parameters, index, m)?,
            Reply::ParameterHash => parameters::hash_message(context.parameters, m),
            Reply::ParameterError { to, index, id, error } => {
                m.start(PARAM_ERROR_DATA::ID).short(index).target(to);
                m.bytes(&id).byte(error);
            }
            Reply::Telemetry(number) => {
                return encode::message(number, &self.source(now, context), m).then_some(());
            }
            Reply::Version => version::autopilot(self.config.uid, self.config.version, m),
            Reply::Protocol => version::protocol(m),
            Reply::Interval(message) => interval(message, self.streams.interval(u32::from(message)), m),
            Reply::Pong { to, time, sequence } => {
                m.start(PING_DATA::ID).huge(time).long(sequence).target(to);
            }
            Reply::Time { to, theirs, ours } => {
                m.start(TIMESYNC_DATA::ID).huge(ours).huge(theirs).target(to);
            }
            Reply::NoFiles {
                to,
                sequence,
                session,
                opcode,
            } => no_files(to, sequence, session, opcode, m),
        }
        Some(())
    }
}

/// An item of the plan in use.
fn item(to: Address, kind: PlanKind, index: u16, context: &Context<'_>, m: &mut Message) -> Option<()> {
    let plan = context.plans.committed(kind);
    let item = context.plans.item(kind, plan.slot, index)?;
    let current = kind == PlanKind::Mission && context.telemetry.mission.current == index;
    mission::item_message(to, kind, index, current, &item, m);
    Some(())
}

/// `MESSAGE_INTERVAL`: -1 is never, 0 says that there is no such message.
fn interval(message: u16, interval: Option<u32>, m: &mut Message) {
    let interval = match interval {
        None => 0,
        Some(0) => -1,
        Some(interval) => i32::try_from(interval).unwrap_or(i32::MAX),
    };
    m.start(MESSAGE_INTERVAL_DATA::ID).integer(interval).word(message);
}

/// `FILE_TRANSFER_PROTOCOL` with a refusal: sequence, session, code, size, what was asked, offset,
/// reason.
fn no_files(to: Address, sequence: u16, session: u8, opcode: u8, m: &mut Message) {
    m.start(FILE_TRANSFER_PROTOCOL_DATA::ID)
        .byte(0) // network
        .target(to)
        .word(sequence)
        .bytes(&[session, REFUSED, 1, opcode])
        .zeros(6)
        .byte(UNKNOWN_COMMAND);
}
