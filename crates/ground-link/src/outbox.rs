//! What services want done: answers for ground stations, requests for the vehicle.

use core::fmt;

use heapless::Deque;

use crate::commands::{CommandId, CommandResult};
use crate::frame::Address;
use crate::mission::{MissionResult, PlanKind};
use crate::request::Request;
use crate::text::{Severity, Texts};

/// Answers that wait.
const REPLIES: usize = 32;

/// Acknowledgements of commands that wait: no flood of other questions may crowd them out.
const ACKNOWLEDGEMENTS: usize = 16;

/// Requests that wait.
const REQUESTS: usize = 8;

/// An answer: small, and made into bytes when it is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reply {
    Command {
        to: Address,
        command: u16,
        result: CommandResult,
        /// In percent, 255 when unknown.
        progress: u8,
    },
    PlanAck {
        to: Address,
        /// `MAV_MISSION_TYPE` as it was asked for.
        kind: u8,
        result: MissionResult,
    },
    PlanCount {
        to: Address,
        kind: PlanKind,
        count: u16,
        crc: u32,
    },
    PlanRequest {
        to: Address,
        kind: PlanKind,
        index: u16,
    },
    PlanItem {
        to: Address,
        kind: PlanKind,
        index: u16,
    },
    Reached(u16),
    Parameter(u16),
    ParameterHash,
    /// Why there is no value.
    ParameterError {
        to: Address,
        /// As it was asked for.
        index: i16,
        id: [u8; 16],
        /// `MAV_PARAM_ERROR`.
        error: u8,
    },
    /// A message of telemetry, by its number.
    Telemetry(u16),
    Version,
    Protocol,
    Interval(u16),
    Pong {
        to: Address,
        time: u64,
        sequence: u32,
    },
    Time {
        to: Address,
        theirs: u64,
        ours: u64,
    },
    NoFiles {
        to: Address,
        sequence: u16,
        session: u8,
        opcode: u8,
    },
}

/// Something asked of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// What is asked.
    pub request: Request,
    /// Who asks.
    pub from: Address,
    /// With this the result is given back; `None` where nobody waits for one.
    pub id: Option<CommandId>,
}

/// Answers, requests and texts that wait.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outbox {
    acknowledgements: Deque<Reply, ACKNOWLEDGEMENTS>,
    replies: Deque<Reply, REPLIES>,
    requests: Deque<Order, REQUESTS>,
    pub texts: Texts,
    pub dropped: Dropped,
}

/// What found no room since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Answers; whoever asked will ask again.
    pub replies: u32,
    /// Photos that were not told.
    pub photos: u32,
    /// Requests; commands among them were answered "temporarily rejected".
    pub requests: u32,
}

impl Outbox {
    /// Puts an answer at the end. One that waits already is not put twice, but each command is
    /// acknowledged for itself.
    #[inline(never)]
    pub fn reply(&mut self, reply: Reply) {
        let pushed = if matches!(reply, Reply::Command { .. }) {
            self.acknowledgements.push_back(reply)
        } else if self.replies.iter().any(|waiting| *waiting == reply) {
            return;
        } else {
            self.replies.push_back(reply)
        };
        if pushed.is_err() {
            self.dropped.replies = self.dropped.replies.saturating_add(1);
        }
    }

    /// Puts a request at the end; whether there was room.
    #[inline(never)]
    pub fn request(&mut self, order: Order) -> bool {
        let taken = self.requests.push_back(order).is_ok();
        if !taken {
            self.dropped.requests = self.dropped.requests.saturating_add(1);
        }
        taken
    }

    /// Puts a line of text at the end.
    #[inline(never)]
    pub fn say(&mut self, severity: Severity, text: fmt::Arguments<'_>) {
        self.texts.say(severity, text);
    }

    pub fn next_acknowledgement(&mut self) -> Option<Reply> {
        self.acknowledgements.pop_front()
    }

    pub fn next_reply(&mut self) -> Option<Reply> {
        self.replies.pop_front()
    }

    pub fn next_request(&mut self) -> Option<Order> {
        self.requests.pop_front()
    }

    pub fn has_replies(&self) -> bool {
        !self.replies.is_empty()
    }
}
