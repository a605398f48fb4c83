//! The parameter protocol: list, read by name and index, set, hash.
//!
//! Every parameter is `REAL32`: clients disagree on how integers are encoded. A value in range
//! becomes a [`Request::WriteParameter`]; what is sent back is what the table then holds, so that
//! a client never believes what is not so. A value out of range is answered with the old one, and
//! with a line of text that says the range.

mod constants;

use mavlink::MessageData;
use mavlink::dialects::common::{MavParamType, PARAM_VALUE_DATA};
use windhover_parameters::{Declaration, Refusal};

use crate::checksum::update;
use crate::frame::{Address, put};
use crate::outbox::{Order, Outbox, Reply};
use crate::request::Request;
use crate::text::{Plain, Severity};
use crate::wire::{Message, Payload};
use windhover_parameters::Decimal;

pub use constants::{Appended, QGROUNDCONTROL};

/// The name under which clients ask for a hash over all names and values.
const HASH: &str = "_HASH_CHECK";

/// The longest name.
const NAME: usize = 16;

/// Writes that wait for the table to show them: clients send several at once.
const WRITES: usize = 12;

/// A write that the table does not show after this time is answered with what it holds, µs.
const WRITE_TIMEOUT: u64 = 400_000;

/// Why there is no value, or not the one that was to be set (`MAV_PARAM_ERROR`).
const DOES_NOT_EXIST: u8 = 1;
const OUT_OF_RANGE: u8 = 2;

/// The index that says "by name".
const BY_NAME: i16 = -1;

/// The parameters of the vehicle as the caller keeps them.
pub trait ParameterTable {
    /// How many there are.
    fn count(&self) -> u16;
    /// The declaration of one.
    fn declaration(&self, index: u16) -> Option<&'static Declaration>;
    /// The value of one.
    fn value(&self, index: u16) -> Option<f32>;
    /// The index of one by its name.
    fn find(&self, name: &str) -> Option<u16> {
        let named = |index: &u16| self.declaration(*index).is_some_and(|found| found.name == name);
        (0..self.count()).find(named)
    }
}

impl ParameterTable for windhover_autopilot::Parameters {
    fn count(&self) -> u16 {
        u16::try_from(Self::COUNT).unwrap_or(u16::MAX)
    }

    fn declaration(&self, index: u16) -> Option<&'static Declaration> {
        Self::declaration(usize::from(index))
    }

    fn value(&self, index: u16) -> Option<f32> {
        self.get(usize::from(index))
    }
}

/// A write that was asked for.
#[derive(Clone, Copy, Debug)]
struct Write {
    index: u16,
    value: f32,
    deadline: u64,
}

/// The state of the protocol.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParameterService {
    /// The next parameter of the list that is being sent.
    listing: Option<u16>,
    writes: [Option<Write>; WRITES],
}

/// What the service works with.
pub(crate) struct Surroundings<'a> {
    pub own: Address,
    pub table: &'a dyn ParameterTable,
    pub outbox: &'a mut Outbox,
    /// µs.
    pub now: u64,
}

impl ParameterService {
    /// Sends the list from its start.
    pub fn list(&mut self, payload: Payload<'_>, own: Address) {
        if payload.is_for(own, 0) {
            self.listing = Some(0);
        }
    }

    /// Sends one parameter, or the hash, or says that there is no such one.
    pub fn read(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        if !payload.is_for(around.own, 2) {
            return;
        }
        let id = payload.bytes::<NAME>(4);
        let name = crate::wire::text(&id);
        let asked = payload.short(0);
        let index = match asked {
            BY_NAME if name == HASH => return around.outbox.reply(Reply::ParameterHash),
            BY_NAME => around.table.find(name),
            index => u16::try_from(index).ok(),
        };
        around
            .outbox
            .reply(match index.filter(|index| *index < around.table.count()) {
                Some(index) => Reply::Parameter(index),
                None => error(from, asked, id, DOES_NOT_EXIST),
            });
    }

    /// Asks for a write, or says why not.
    pub fn set(&mut self, payload: Payload<'_>, from: Address, around: &mut Surroundings<'_>) {
        if !payload.is_for(around.own, 4) {
            return;
        }
        // The type (byte 22) may be anything: the value is a float all the same.
        let value = payload.float(0);
        let id = payload.bytes::<NAME>(6);
        let name = crate::wire::text(&id);
        if name == HASH {
            return self.compare(value, around);
        }
        let found = around.table.find(name);
        let Some((index, declaration)) =
            found.and_then(|index| Some((index, around.table.declaration(index)?)))
        else {
            around.outbox.reply(error(from, BY_NAME, id, DOES_NOT_EXIST));
            let text = format_args!("{}: there is no such parameter", Plain(name));
            return around.outbox.say(Severity::Warning, text);
        };
        if value.is_subnormal() {
            around.outbox.reply(Reply::Parameter(index));
            let text = format_args!("{}: to be sent as REAL32", Plain(name));
            return around.outbox.say(Severity::Warning, text);
        }
        if let Err(refusal) = declaration.check(value) {
            around.outbox.reply(error(from, BY_NAME, id, OUT_OF_RANGE));
            return refuse(index, refusal, around);
        }
        self.write(
            Write {
                index,
                value,
                deadline: around.now.saturating_add(WRITE_TIMEOUT),
            },
            from,
            around,
        );
    }

    /// A client that already knows all values says so by setting the hash: no more of the list.
    fn compare(&mut self, theirs: f32, around: &mut Surroundings<'_>) {
        if theirs.to_bits() == hash(around.table) {
            self.listing = None;
        }
        around.outbox.reply(Reply::ParameterHash);
    }

    fn write(&mut self, write: Write, from: Address, around: &mut Surroundings<'_>) {
        let shown = around.table.value(write.index).map(f32::to_bits) == Some(write.value.to_bits());
        let is_same = |other: &Option<Write>| other.is_some_and(|other| other.index == write.index);
        let known = self.writes.iter().position(is_same);
        if shown && known.is_none() {
            return around.outbox.reply(Reply::Parameter(write.index));
        }
        let request = Request::WriteParameter {
            index: write.index,
            value: write.value,
        };
        let order = Order {
            request,
            from,
            id: None,
        };
        let free = known.or_else(|| self.writes.iter().position(Option::is_none));
        let place = free.and_then(|free| self.writes.get_mut(free));
        // Without room there is no answer either: the old value would look like a refusal, and who hears
        // none sends it again.
        if let Some(place) = place.filter(|_| around.outbox.request(order)) {
            *place = Some(write);
        }
    }

    /// A write was refused by the vehicle.
    pub fn refused(&mut self, index: u16, refusal: Refusal, around: &mut Surroundings<'_>) {
        let is_its = |write: &Option<Write>| write.is_some_and(|write| write.index == index);
        for write in &mut self.writes {
            if is_its(write) {
                *write = None;
                refuse(index, refusal, around);
            }
        }
    }

    /// Answers writes that the table shows, or has not shown in time.
    pub fn poll(&mut self, around: &mut Surroundings<'_>) {
        for place in &mut self.writes {
            let Some(write) = place else { continue };
            let value = around.table.value(write.index).map(f32::to_bits);
            if value == Some(write.value.to_bits()) || around.now >= write.deadline {
                around.outbox.reply(Reply::Parameter(write.index));
                *place = None;
            }
        }
    }

    /// The next parameter of the list that is being sent.
    pub fn next_of_list(&mut self, table: &dyn ParameterTable) -> Option<u16> {
        let index = self.listing?;
        self.listing = (index.saturating_add(1) < table.count()).then_some(index + 1);
        (index < table.count()).then_some(index)
    }
}

/// A refusal for clients that know `PARAM_ERROR`: they do not have to wait or to ask again.
fn error(to: Address, index: i16, id: [u8; NAME], error: u8) -> Reply {
    Reply::ParameterError { to, index, id, error }
}

#[inline(never)]
fn refuse(index: u16, refusal: Refusal, around: &mut Surroundings<'_>) {
    around.outbox.reply(Reply::Parameter(index));
    let name = around
        .table
        .declaration(index)
        .map_or("", |declaration| declaration.name);
    let name = Plain(name);
    match refusal {
        Refusal::OutOfRange { min, max } => {
            let (min, max) = (Decimal::new(min), Decimal::new(max));
            let text = format_args!("{name}: the range is {min} to {max}");
            around.outbox.say(Severity::Warning, text);
        }
        // Not by their `Display`, which brings the standard way of writing floats with it.
        Refusal::Unknown => around.outbox.say(
            Severity::Warning,
            format_args!("{name}: there is no such parameter"),
        ),
        Refusal::Inconsistent => {
            let text = format_args!("{name}: it does not go with the other parameters");
            around.outbox.say(Severity::Warning, text);
        }
    }
}

/// A hash over all names and values, in the order of the names, as PX4 and QGroundControl have it:
/// CRC-32 without its inversions.
pub(crate) fn hash(table: &dyn ParameterTable) -> u32 {
    let mut crc = 0;
    let mut last = "";
    while let Some((name, value)) = following(table, last) {
        crc = update(update(crc, name.as_bytes()), &value.to_le_bytes());
        last = name;
    }
    crc
}

/// The parameter whose name comes next after `last`.
fn following(table: &dyn ParameterTable, last: &str) -> Option<(&'static str, f32)> {
    let named = (0..table.count()).filter_map(|index| {
        let name = table.declaration(index)?.name;
        (name > last).then_some((name, table.value(index)?))
    });
    named.min_by_key(|(name, _)| *name)
}

/// `PARAM_VALUE` of one parameter; `None` when there is no such one.
pub(crate) fn value_message(table: &dyn ParameterTable, index: u16, m: &mut Message) -> Option<()> {
    let (name, value) = (table.declaration(index)?.name, table.value(index)?);
    let real = MavParamType::MAV_PARAM_TYPE_REAL32;
    message(table, index, name, value, real, m);
    Some(())
}

/// `PARAM_VALUE` of the hash: 32 bits that are no float, and belong to no index.
pub(crate) fn hash_message(table: &dyn ParameterTable, m: &mut Message) {
    let (hash, bits) = (f32::from_bits(hash(table)), MavParamType::MAV_PARAM_TYPE_UINT32);
    message(table, u16::MAX, HASH, hash, bits, m);
}

fn message(
    table: &dyn ParameterTable,
    index: u16,
    name: &str,
    value: f32,
    kind: MavParamType,
    m: &mut Message,
) {
    let mut id = [0; NAME];
    put(&mut id, name.as_bytes());
    m.start(PARAM_VALUE_DATA::ID)
        .floats(&[value])
        .word(table.count())
        .word(index)
        .bytes(&id)
        .byte(kind as u8);
}
