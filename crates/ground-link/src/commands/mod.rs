//! The command protocol: each command is asked for once, and acknowledged once.
//!
//! A client that hears no acknowledgement sends the command again, with a higher number in
//! `confirmation`: then the same answer is given again, and nothing is done twice. A command that
//! the vehicle has not answered for soon after it came is acknowledged as in progress.

mod arguments;
mod flight;
mod number;
mod translate;
mod upkeep;

use mavlink::MessageData;
use mavlink::dialects::common::{COMMAND_ACK_DATA, MavResult};

use crate::frame::{Address, crc};
use crate::outbox::{Order, Outbox, Reply};
use crate::request::Request;
use crate::wire::{Message, Payload};

pub(crate) use arguments::Parameters;
pub use translate::Identity;
pub(crate) use translate::{Meaning, Ours};

/// Commands that are remembered: those under way, and those answered last.
const COMMANDS: usize = 12;

/// A command that is not answered after this time is in progress, µs.
const IN_PROGRESS: u64 = 60_000;

/// A command that is not answered after this time has failed, µs.
const FAILED: u64 = 120_000_000;

/// For so long an answer can be asked for again, µs.
const MEMORY: u64 = 5_000_000;

/// Where `COMMAND_LONG` and `COMMAND_INT` have their command and target; then follow a confirmation
/// in the one, a frame in the other.
const COMMAND: usize = 28;
const TARGET: usize = 30;
const CONFIRMATION: usize = 32;
const FRAME: usize = 32;

/// The progress that says nothing.
const UNKNOWN: u8 = 255;

/// Names a command until it is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandId(u16);

macro_rules! results {
    ($($(#[$meta:meta])* $name:ident: $wire:ident;)*) => {
        /// How a command went (`MAV_RESULT`).
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum CommandResult {
            $($(#[$meta])* $name,)*
        }

        impl CommandResult {
            pub(crate) const fn wire(self) -> u8 {
                match self { $(Self::$name => MavResult::$wire as u8,)* }
            }
        }
    };
}

results! {
    /// Done, or being done by a mode of flight.
    Accepted: MAV_RESULT_ACCEPTED;
    /// Not now.
    TemporarilyRejected: MAV_RESULT_TEMPORARILY_REJECTED;
    /// Not with these parameters, or not in this state.
    Denied: MAV_RESULT_DENIED;
    /// Not by this vehicle.
    Unsupported: MAV_RESULT_UNSUPPORTED;
    /// Tried, without success.
    Failed: MAV_RESULT_FAILED;
    /// It takes time; another answer follows.
    InProgress: MAV_RESULT_IN_PROGRESS;
    /// Given up because the client wanted so.
    Cancelled: MAV_RESULT_CANCELLED;
    /// Only as `COMMAND_INT`.
    IntegersOnly: MAV_RESULT_COMMAND_INT_ONLY;
    /// Not in this frame.
    UnsupportedFrame: MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME;
}

/// A command that came.
#[derive(Clone, Copy, Debug)]
struct Entry {
    id: CommandId,
    from: Address,
    command: u16,
    /// Checksum of its parameters.
    digest: u16,
    /// When it came, µs.
    came: u64,
    /// Whether it was acknowledged as in progress.
    in_progress: bool,
    /// The answer, and when it was given.
    result: Option<(CommandResult, u64)>,
}

/// The state of the protocol.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommandService {
    entries: [Option<Entry>; COMMANDS],
    last: u16,
}

/// What the service works with.
pub(crate) struct Surroundings<'a> {
    pub own: Address,
    pub identity: Identity,
    pub outbox: &'a mut Outbox,
    /// µs.
    pub now: u64,
}

/// A command with its parameters, however it came.
struct Arrival {
    command: u16,
    parameters: Parameters,
    digest: u16,
    is_repeated: bool,
}

impl CommandService {
    /// `COMMAND_LONG`. What is to be done by the link itself comes back.
    pub fn long(
        &mut self,
        payload: Payload<'_>,
        from: Address,
        around: &mut Surroundings<'_>,
    ) -> Option<Ours> {
        if !payload.is_for(around.own, TARGET) {
            return None;
        }
        let arrival = Arrival {
            command: payload.word(COMMAND),
            parameters: Parameters::long(payload),
            digest: digest(payload, COMMAND + 2),
            is_repeated: payload.byte(CONFIRMATION) > 0 || is_numbered(payload),
        };
        self.arrived(&arrival, from, around)
    }

    /// `COMMAND_INT`.
    pub fn int(
        &mut self,
        payload: Payload<'_>,
        from: Address,
        around: &mut Surroundings<'_>,
    ) -> Option<Ours> {
        if !payload.is_for(around.own, TARGET) {
            return None;
        }
        let arrival = Arrival {
            command: payload.word(COMMAND),
            parameters: Parameters::int(payload),
            digest: digest(payload, FRAME + 1),
            is_repeated: is_numbered(payload),
        };
        self.arrived(&arrival, from, around)
    }

    fn arrived(&mut self, arrival: &Arrival, from: Address, around: &mut Surroundings<'_>) -> Option<Ours> {
        if self.is_known(arrival, from, around) {
            return None;
        }
        let command = arrival.command;
        match translate::meaning(command, &arrival.parameters, around.identity) {
            Meaning::Request(request) => {
                self.ask(arrival, from, request, around);
                None
            }
            Meaning::Ours(ours) => Some(ours),
            Meaning::Answer(result) => {
                acknowledge(around.outbox, from, command, result);
                None
            }
        }
    }

    /// Whether this command came before and needs no more than its answer.
    fn is_known(&self, arrival: &Arrival, from: Address, around: &mut Surroundings<'_>) -> bool {
        let same = |entry: &&Entry| {
            (entry.from, entry.command, entry.digest) == (from, arrival.command, arrival.digest)
        };
        let entries = self.entries.iter().flatten().filter(same);
        let Some(entry) = entries.max_by_key(|entry| entry.came) else {
            return false;
        };
        match entry.result {
            None => {
                if entry.in_progress {
                    acknowledge(around.outbox, from, arrival.command, CommandResult::InProgress);
                }
                true
            }
            Some((result, at)) => {
                let again = arrival.is_repeated && around.now.saturating_sub(at) < MEMORY;
                if again {
                    acknowledge(around.outbox, from, arrival.command, result);
                }
                again
            }
        }
    }

    /// Hands a request on, to be answered later.
    fn ask(&mut self, arrival: &Arrival, from: Address, request: Request, around: &mut Surroundings<'_>) {
        let id = CommandId(self.last);
        let order = Order {
            request,
            from,
            id: Some(id),
        };
        let place = self.place();
        let Some(place) = place.filter(|_| around.outbox.request(order)) else {
            let busy = CommandResult::TemporarilyRejected;
            return acknowledge(around.outbox, from, arrival.command, busy);
        };
        *place = Some(Entry {
            id,
            from,
            command: arrival.command,
            digest: arrival.digest,
            came: around.now,
            in_progress: false,
            result: None,
        });
        self.last = self.last.wrapping_add(1);
    }

    /// A place for a command: a free one, or that of the command that was answered first.
    fn place(&mut self) -> Option<&mut Option<Entry>> {
        let age = |place: &&mut Option<Entry>| match place {
            None => 0,
            Some(entry) => entry.result.map_or(u64::MAX, |(_, at)| at.saturating_add(1)),
        };
        let oldest = self.entries.iter_mut().min_by_key(age)?;
        let is_under_way = oldest.is_some_and(|entry| entry.result.is_none());
        (!is_under_way).then_some(oldest)
    }

    /// A command was done, or not. A second answer to the same command is ignored.
    pub fn finish(&mut self, id: CommandId, result: CommandResult, outbox: &mut Outbox, now: u64) {
        let Some(entry) = self.waiting(id) else { return };
        if result == CommandResult::InProgress {
            entry.in_progress = true;
        } else {
            entry.result = Some((result, now));
        }
        acknowledge(outbox, entry.from, entry.command, result);
    }

    /// How far a command has come, in percent.
    pub fn progress(&mut self, id: CommandId, percent: u8, outbox: &mut Outbox, now: u64) {
        let Some(entry) = self.waiting(id) else { return };
        entry.in_progress = true;
        entry.came = now;
        outbox.reply(Reply::Command {
            to: entry.from,
            command: entry.command,
            result: CommandResult::InProgress,
            progress: percent.min(100),
        });
    }

    fn waiting(&mut self, id: CommandId) -> Option<&mut Entry> {
        let mut entries = self.entries.iter_mut().flatten();
        entries.find(|entry| entry.id == id && entry.result.is_none())
    }

    /// Acknowledges what takes longer, and gives up what was never answered.
    pub fn poll(&mut self, outbox: &mut Outbox, now: u64) {
        let entries = self.entries.iter_mut().flatten();
        for entry in entries.filter(|entry| entry.result.is_none()) {
            let age = now.saturating_sub(entry.came);
            let result = match age {
                FAILED.. => CommandResult::Failed,
                IN_PROGRESS.. if !entry.in_progress => CommandResult::InProgress,
                _ => continue,
            };
            entry.in_progress = true;
            entry.result = (age >= FAILED).then_some((result, now));
            acknowledge(outbox, entry.from, entry.command, result);
        }
    }
}

/// Whether a command has a number of its own, so that the same again is no other one: photos have.
fn is_numbered(payload: Payload<'_>) -> bool {
    const SEQUENCE: usize = 12;
    payload.word(COMMAND) == number::IMAGE_START_CAPTURE && payload.float(SEQUENCE) > 0.0
}

/// A checksum over all that makes two commands the same, but for the confirmation.
fn digest(payload: Payload<'_>, length: usize) -> u16 {
    (0..length).fold(crc::START, |crc, at| crc::update(crc, &[payload.byte(at)]))
}

/// Puts an acknowledgement at the end of the answers.
#[inline(never)]
pub(crate) fn acknowledge(outbox: &mut Outbox, to: Address, command: u16, result: CommandResult) {
    outbox.reply(Reply::Command {
        to,
        command,
        result,
        progress: UNKNOWN,
    });
}

/// `COMMAND_ACK`.
pub(crate) fn ack_message(to: Address, command: u16, result: CommandResult, progress: u8, m: &mut Message) {
    m.start(COMMAND_ACK_DATA::ID)
        .word(command)
        .byte(result.wire())
        .byte(progress)
        .zeros(4) // a second result
        .target(to);
}
