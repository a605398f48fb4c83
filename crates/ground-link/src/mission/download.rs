//! Downloads: a client asks for the count, then for item after item, and repeats itself on loss.
//!
//! Nothing has to be remembered to answer, but one thing: a plan that was exchanged since the
//! count was told must not be mixed with the one before it.

use heapless::Deque;

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
        let known = |download: &&Download| (download.client, download.kind) == (from, kind);
        let changed = |download: &Download| (download.crc, download.count) != (plan.crc, plan.count);
        // Until it asks for the count again: this answer may get lost.
        if self.downloads.iter().find(known).is_some_and(changed) {
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

    /// A client that has exchanged the plan itself knows the new one.
    pub(super) fn exchanged(&mut self, client: Address, kind: PlanKind, count: u16, crc: u32) {
        for download in &mut self.downloads {
            if (download.client, download.kind) == (client, kind) {
                (download.count, download.crc) = (count, crc);
            }
        }
    }
}

/// Keeps a download; the oldest makes room.
fn remember(downloads: &mut Deque<Download, DOWNLOADS>, download: Download) {
    let is_same = |old: &&mut Download| (old.client, old.kind) == (download.client, download.kind);
    if let Some(old) = downloads.iter_mut().find(is_same) {
        *old = download;
        return;
    }
    if downloads.is_full() {
        downloads.pop_front();
    }
    let _ = downloads.push_back(download);
}
