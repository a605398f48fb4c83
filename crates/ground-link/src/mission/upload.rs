//! Uploads: the vehicle asks for item after item, and keeps the plan when it has them all.
//!
//! The network may lose, repeat and delay messages, so that three kinds of items are not what was
//! asked for: older ones are repeated by the network and ignored, because an answer would double
//! all that follows; newer ones, and those of another kind, are faults of the client, unless they
//! may be left over from a transfer of the same client that has just ended.

use windhover_autopilot::MissionCommit;

use super::item::{self, Received};
use super::turn::Wanted;
use super::{MissionResult, MissionService, PlanKind, PlanRefusal, Surroundings};
use crate::checksum::plan_crc;
use crate::frame::Address;
use crate::outbox::Reply;
use crate::wire::Payload;
use windhover_parameters::Whole;

/// An item that has not come after this time is asked for again, µs.
const RETRY: u64 = 200_000;

/// Without an item for so long the upload is given up, µs.
const GIVE_UP: u64 = 5_000_000;

/// For so long after a transfer something of it may still come, µs.
const LEFT_OVER: u64 = 1_000_000;

/// A message that comes again this soon was repeated by the network, not by the client, µs.
const REPEATED: u64 = 150_000;

/// An upload under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Upload {
    pub from: Address,
    pub kind: PlanKind,
    slot: u8,
    count: u16,
    /// Index of the item that is asked for.
    next: u16,
    crc: u32,
    asked: u64,
    progressed: u64,
    /// Until then items that were not asked for may be left over.
    tolerant_until: u64,
}

/// An upload that has ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finished {
    from: Address,
    kind: PlanKind,
    /// How many items it had; 0 when it was given up or refused.
    count: u16,
    at: u64,
    /// When its end was last told.
    told: u64,
}

impl MissionService {
    /// `MISSION_COUNT`: a client wants to upload.
    pub fn count(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        let Some(kind) = around.kind(payload, 2, from) else {
            return;
        };
        self.want(Wanted::Upload(kind, payload.word(0)), from, around);
    }

    /// An upload of so many items begins.
    pub(super) fn upload(
        &mut self,
        kind: PlanKind,
        count: u16,
        from: Address,
        around: &mut Surroundings<'_>,
    ) {
        if self.upload.is_some_and(|upload| upload.from != from) {
            return around.ack(from, kind.code(), MissionResult::Denied);
        }
        let restarted = self.upload.is_some();
        self.abandon(around);
        if let Err(refusal) = self.begin(from, kind, count, restarted, around) {
            around.refuse(from, kind, &refusal);
        }
    }

    fn begin(
        &mut self,
        from: Address,
        kind: PlanKind,
        count: u16,
        restarted: bool,
        around: &mut Surroundings<'_>,
    ) -> Result<(), PlanRefusal> {
        let (now, capacity) = (around.now, around.plans.capacity(kind));
        if count > capacity {
            let [count, capacity] = [count, capacity].map(|number| Whole(number.into()));
            let reason = format_args!("{count} items, there is room for {capacity}");
            return Err(PlanRefusal::new(MissionResult::NoSpace, reason));
        }
        let recent = |last: &Finished| last.from == from && now.saturating_sub(last.at) < LEFT_OVER;
        let tolerant = restarted || self.finished.as_ref().is_some_and(recent);
        let upload = Upload {
            from,
            kind,
            slot: around.plans.begin(kind, count)?,
            count,
            next: 0,
            crc: 0,
            asked: now,
            progressed: now,
            tolerant_until: if tolerant {
                now.saturating_add(LEFT_OVER)
            } else {
                0
            },
        };
        if count == 0 {
            self.finish(upload, around);
        } else {
            self.upload = Some(upload);
            around.outbox.reply(Reply::PlanRequest {
                to: from,
                kind,
                index: 0,
            });
        }
        Ok(())
    }

    /// `MISSION_ITEM_INT` or, with floats, `MISSION_ITEM`.
    pub fn take(
        &mut self,
        payload: Payload<'_>,
        is_float: bool,
        from: Address,
        around: &mut Surroundings<'_>,
    ) {
        if payload.is_for(around.own, item::TARGET) {
            self.received(&item::read(payload, is_float), from, around);
        }
    }

    fn received(&mut self, received: &Received, from: Address, around: &mut Surroundings<'_>) {
        let Some(upload) = self.upload.filter(|upload| upload.from == from) else {
            return self.without_upload(received, from, around);
        };
        let left_over = around.now < upload.tolerant_until;
        if received.kind != Ok(upload.kind) {
            if !left_over {
                self.give_up(upload, MissionResult::Invalid, around);
            }
        } else if received.index > upload.next {
            if !left_over {
                self.give_up(upload, MissionResult::InvalidSequence, around);
            }
        } else if received.index == upload.next {
            self.keep(upload, received, around);
        }
    }

    /// An item that nobody asked for: perhaps the last one again, because its answer was lost.
    fn without_upload(&mut self, received: &Received, from: Address, around: &mut Surroundings<'_>) {
        let Ok(kind) = received.kind else { return };
        if self.upload.is_some() {
            // Somebody else's is under way; this one was told so when it began.
            return;
        }
        let Some(last) = self.finished.as_mut().filter(|last| last.from == from) else {
            return around.ack(from, kind.code(), MissionResult::Error);
        };
        let is_last = last.kind == kind && last.count.checked_sub(1) == Some(received.index);
        if is_last && around.now.saturating_sub(last.told) >= REPEATED {
            last.told = around.now;
            around.ack(from, kind.code(), MissionResult::Accepted);
        } else if !is_last && around.now.saturating_sub(last.at) >= LEFT_OVER {
            around.ack(from, kind.code(), MissionResult::Error);
        }
    }

    /// Keeps the item that was asked for, and asks for the next one.
    fn keep(&mut self, mut upload: Upload, received: &Received, around: &mut Surroundings<'_>) {
        let (kind, index, item) = (upload.kind, received.index, &received.item);
        let outcome = around
            .plans
            .check(kind, index, item)
            .and_then(|()| around.plans.write(kind, upload.slot, index, item));
        if let Err(refusal) = outcome {
            self.ended(upload, 0, around.now);
            self.abandon(around);
            return around.refuse(upload.from, kind, &refusal);
        }
        upload.crc = plan_crc(upload.crc, item);
        upload.next += 1;
        upload.asked = around.now;
        upload.progressed = around.now;
        if upload.next == upload.count {
            return self.finish(upload, around);
        }
        self.upload = Some(upload);
        let index = upload.next;
        around.outbox.reply(Reply::PlanRequest {
            to: upload.from,
            kind,
            index,
        });
    }

    /// All items are there: commits the plan.
    fn finish(&mut self, upload: Upload, around: &mut Surroundings<'_>) {
        let Upload {
            from,
            kind,
            slot,
            count,
            crc,
            ..
        } = upload;
        self.upload = None;
        match around.plans.commit(kind, MissionCommit { slot, count, crc }) {
            Ok(()) => {
                self.ended(upload, count, around.now);
                self.exchanged(from, kind, count, crc);
                around.ack(from, kind.code(), MissionResult::Accepted);
            }
            Err(refusal) => {
                around.plans.abort(kind);
                self.ended(upload, 0, around.now);
                around.refuse(from, kind, &refusal);
            }
        }
    }

    fn ended(&mut self, upload: Upload, count: u16, now: u64) {
        let Upload { from, kind, .. } = upload;
        self.finished = Some(Finished {
            from,
            kind,
            count,
            at: now,
            told: now,
        });
    }

    fn give_up(&mut self, upload: Upload, result: MissionResult, around: &mut Surroundings<'_>) {
        self.ended(upload, 0, around.now);
        self.abandon(around);
        around.ack(upload.from, upload.kind.code(), result);
    }

    /// `MISSION_ACK` from the client: anything but "accepted" ends its upload.
    pub fn acknowledged(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        let (result, kind) = (payload.byte(2), payload.byte(3));
        if result == MissionResult::Accepted.wire() || !payload.is_for(around.own, 0) {
            return;
        }
        let its_own = |upload: &Upload| upload.from == from && upload.kind.code() == kind;
        if let Some(upload) = self.upload.filter(its_own) {
            self.ended(upload, 0, around.now);
            self.abandon(around);
        }
    }

    /// Asks again for what has not come; gives up in the end.
    pub fn poll(&mut self, around: &mut Surroundings<'_>) {
        self.take_turns(around);
        let Some(upload) = &mut self.upload else { return };
        if around.now.saturating_sub(upload.progressed) >= GIVE_UP {
            let upload = *upload;
            return self.give_up(upload, MissionResult::Cancelled, around);
        }
        if around.now.saturating_sub(upload.asked) >= RETRY {
            upload.asked = around.now;
            let (to, kind, index) = (upload.from, upload.kind, upload.next);
            around.outbox.reply(Reply::PlanRequest { to, kind, index });
        }
    }
}
