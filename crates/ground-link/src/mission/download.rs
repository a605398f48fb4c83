//! Downloads: a client asks for the count, then for item after item, and repeats itself on loss.
//!
//! Nothing has to be remembered to answer, but one thing: a plan that was exchanged since the
//! count was told must not be mixed with the one before it.

use heapless::Vec;

use super::{DOWNLOADS, MissionResult, MissionService, PlanKind, Surroundings};
use crate::frame::Address;
use crate::outbox::Reply;
use crate::wire::Payload;

/// A client that was told a count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Download {
    client: Address,
    kind: PlanKind,
    crc: u32,
    count: u16,
}

impl MissionService {
    /// `MISSION_REQUEST_LIST`.
    pub fn list(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        let Some(kind) = around.kind(payload, 0, from) else {
            return;
        };
        let plan = around.plans.committed(kind);
        let (count, crc) = (plan.count, plan.crc);
        remember(
            &mut self.downloads,
            Download {
                client: from,
                kind,
                crc,
                count,
            },
        );
        around.outbox.reply(Reply::PlanCount {
            to: from,
            kind,
            count,
            crc,
        });
    }

    /// `MISSION_REQUEST_INT`, and `MISSION_REQUEST` of clients that do not know it: both get
    /// integers.
    pub fn item(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        let Some(kind) = around.kind(payload, 2, from) else {
            return;
        };
        let index = payload.word(0);
        let plan = around.plans.committed(kind);
        let known = |download: &&Download| download.client == from && download.kind == kind;
        let changed = |download: &Download| (download.crc, download.count) != (plan.crc, plan.count);
        if self.downloads.iter().find(known).is_some_and(changed) {
            self.downloads.retain(|download| !known(&download));
            return around.ack(from, kind.code(), MissionResult::Cancelled);
        }
        if index >= plan.count {
            return around.ack(from, kind.code(), MissionResult::InvalidSequence);
        }
        around.outbox.reply(Reply::PlanItem {
            to: from,
            kind,
            index,
        });
    }
}

/// Keeps a download; the oldest makes room.
fn remember(downloads: &mut Vec<Download, DOWNLOADS>, download: Download) {
    downloads.retain(|old| old.client != download.client || old.kind != download.kind);
    if downloads.is_full() {
        downloads.remove(0);
    }
    let _ = downloads.push(download);
}
