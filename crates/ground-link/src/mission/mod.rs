//! The mission protocol, for mission, fence and rally points.
//!
//! In an upload the vehicle drives: it asks for item after item, and asks again when none comes.
//! Items are staged in a slot that is not in use, and the plan is committed whole after the last
//! one, or not at all. Downloads are driven by clients; any number of them may read at once.

mod download;
mod item;
mod plan;
mod turn;
mod upload;

use heapless::Deque;
use mavlink::MessageData;
use mavlink::dialects::common::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_REQUEST_INT_DATA, MavMissionType,
};

use crate::frame::Address;
use crate::outbox::{Outbox, Reply};
use crate::text::{Plain, Severity};
use crate::wire::{Message, Payload};

use download::Download;
use turn::{TURNS, Turn, Wanted};
use upload::{Finished, Upload};

pub(crate) use item::item_message;
pub use plan::{MissionResult, PlanRefusal, PlanStore};
pub use windhover_autopilot::mission::PlanKind;

/// Downloads whose plan is watched for changes.
const DOWNLOADS: usize = 4;

/// `MAV_MISSION_TYPE_ALL`: for clearing only.
const ALL: u8 = MavMissionType::MAV_MISSION_TYPE_ALL as u8;

/// What the service works with.
pub(crate) struct Surroundings<'a> {
    pub own: Address,
    pub plans: &'a mut dyn PlanStore,
    pub outbox: &'a mut Outbox,
    /// µs.
    pub now: u64,
}

impl Surroundings<'_> {
    /// The kind of plan of a message whose target is in a place, with the kind right behind it;
    /// `None` when it is for another. A number that is no kind is refused.
    #[inline(never)]
    fn kind(&mut self, payload: Payload<'_>, target: usize, from: Address) -> Option<PlanKind> {
        if !payload.is_for(self.own, target) {
            return None;
        }
        let code = payload.byte(target + 2);
        let kind = PlanKind::from_code(code);
        if kind.is_none() {
            self.ack(from, code, MissionResult::Unsupported);
        }
        kind
    }

    #[inline(never)]
    fn ack(&mut self, to: Address, kind: u8, result: MissionResult) {
        self.outbox.reply(Reply::PlanAck { to, kind, result });
    }

    /// Refuses with a reason that a human can read.
    #[inline(never)]
    fn refuse(&mut self, to: Address, kind: PlanKind, refusal: &PlanRefusal) {
        self.ack(to, kind.code(), refusal.result);
        let (kind, reason) = (Plain(kind.name()), Plain(refusal.reason.as_str()));
        let text = format_args!("{kind} refused: {reason}");
        self.outbox.say(Severity::Error, text);
    }
}

/// The state of the protocol.
#[derive(Clone, Debug, Default)]
pub(crate) struct MissionService {
    upload: Option<Upload>,
    finished: Option<Finished>,
    downloads: Deque<Download, DOWNLOADS>,
    turns: Deque<Turn, TURNS>,
}

impl MissionService {
    /// `MISSION_CLEAR_ALL`.
    pub fn clear(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        if !payload.is_for(around.own, 0) {
            return;
        }
        let code = payload.byte(2);
        if kinds(code).is_empty() {
            return around.ack(from, code, MissionResult::Unsupported);
        }
        self.want(Wanted::Empty(code), from, around);
    }

    /// Empties plans, by the code of their kind.
    fn empty(&mut self, code: u8, from: Address, around: &mut Surroundings<'_>) {
        if self.upload.as_ref().is_some_and(|upload| upload.from != from) {
            return around.ack(from, code, MissionResult::Denied);
        }
        self.abandon(around);
        for kind in kinds(code) {
            if let Err(refusal) = commit_empty(*kind, around.plans) {
                around.ack(from, code, refusal.result);
                let (kind, reason) = (Plain(kind.name()), Plain(refusal.reason.as_str()));
                let text = format_args!("{kind} not cleared: {reason}");
                return around.outbox.say(Severity::Error, text);
            }
        }
        around.ack(from, code, MissionResult::Accepted);
    }

    /// Partial lists are not understood.
    pub fn partial(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        if payload.is_for(around.own, 4) {
            around.ack(from, payload.byte(6), MissionResult::Unsupported);
        }
    }

    /// Whoever was at the other end is not there any more.
    pub fn close(&mut self, around: &mut Surroundings<'_>) {
        self.abandon(around);
        self.turns.clear();
    }

    /// Ends an upload without a trace.
    fn abandon(&mut self, around: &mut Surroundings<'_>) {
        if let Some(upload) = self.upload.take() {
            around.plans.abort(upload.kind);
        }
    }
}

/// The kinds of plans that a code means; none where it means nothing.
fn kinds(code: u8) -> &'static [PlanKind] {
    match (code, PlanKind::from_code(code)) {
        (ALL, _) => &PlanKind::EACH,
        (_, Some(PlanKind::Mission)) => &[PlanKind::Mission],
        (_, Some(PlanKind::Fence)) => &[PlanKind::Fence],
        (_, Some(PlanKind::Rally)) => &[PlanKind::Rally],
        (_, None) => &[],
    }
}

/// Puts an empty plan in the place of the present one.
fn commit_empty(kind: PlanKind, plans: &mut dyn PlanStore) -> Result<(), PlanRefusal> {
    let slot = plans.begin(kind, 0)?;
    let commit = windhover_autopilot::MissionCommit {
        slot,
        count: 0,
        crc: 0,
    };
    let outcome = plans.commit(kind, commit);
    if outcome.is_err() {
        plans.abort(kind);
    }
    outcome
}

/// `MISSION_ACK`; `plan` names the plan that is in use then.
pub(crate) fn ack_message(to: Address, kind: u8, result: MissionResult, plan: u32, m: &mut Message) {
    m.start(MISSION_ACK_DATA::ID)
        .target(to)
        .byte(result.wire())
        .byte(kind)
        .long(plan);
}

/// `MISSION_COUNT`.
pub(crate) fn count_message(to: Address, kind: PlanKind, count: u16, crc: u32, m: &mut Message) {
    m.start(MISSION_COUNT_DATA::ID)
        .word(count)
        .target(to)
        .byte(kind.code())
        .long(crc);
}

/// `MISSION_REQUEST_INT`.
pub(crate) fn request_message(to: Address, kind: PlanKind, index: u16, m: &mut Message) {
    m.start(MISSION_REQUEST_INT_DATA::ID)
        .word(index)
        .target(to)
        .byte(kind.code());
}
