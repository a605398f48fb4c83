//! A log and what stands before its first tick.

use std::vec::Vec;

use super::end::{End, OpenError, Reason};
use super::entries::Entries;
use super::messages::{Message, Messages};
use super::periods::Periods;
use crate::batch::MAX_K;
use crate::plan::PlanItem;
use crate::record::{Record, Topic};
use crate::topics;
use crate::value::Value;
use crate::wire::{Decoder, Encoder, kind};

/// The most of each kind of definition that is kept.
const MOST: usize = 4096;

/// The longest format of ours.
const FORMAT: usize = 1024;

/// A named value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Info<'a> {
    /// Its type, as in `char[9]`.
    pub kind: &'a str,
    /// Its name.
    pub name: &'a str,
    /// Its bytes.
    pub value: &'a [u8],
}

impl<'a> Info<'a> {
    fn get(body: &'a [u8]) -> Option<Self> {
        let mut from = Decoder::new(body);
        let [length] = from.bytes()?;
        let key = core::str::from_utf8(from.slice(usize::from(length))?).ok()?;
        let (kind, name) = key.split_once(' ')?;
        Some(Self {
            kind,
            name,
            value: from.rest(),
        })
    }

    /// The value, when it is of that type and as long.
    pub fn value<T: Value>(&self) -> Option<T> {
        let (scalar, count) = match self.kind.split_once('[') {
            Some((scalar, rest)) => (scalar, rest.strip_suffix(']')?.parse().ok()?),
            None => (self.kind, 0),
        };
        if scalar != T::SCALAR.name() || count != T::COUNT {
            return None;
        }
        let mut from = Decoder::new(self.value);
        T::get(&mut from).filter(|_| from.rest().is_empty())
    }

    /// The value, when it is a text.
    pub fn text(&self) -> Option<&'a str> {
        let text = self.kind.starts_with("char[").then_some(self.value)?;
        core::str::from_utf8(text).ok()
    }
}

/// What a topic's number stands for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subscription<'a> {
    /// One of ours, by our own number.
    Ours(u16, &'static str),
    /// One with a name of ours and another format.
    Mismatched(&'a str),
    /// One that we do not know.
    Foreign(&'a str),
}

/// What the definitions have said so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Definitions<'a> {
    pub info: Vec<Info<'a>>,
    pub parameters: Vec<(&'a str, f32)>,
    formats: Vec<(&'a str, &'a [u8])>,
    /// By number.
    subscriptions: Vec<Option<Subscription<'a>>>,
    subscribed: usize,
    pub k: Option<usize>,
    pub imu_rate: u32,
}

/// A log, open.
#[derive(Clone, Debug)]
pub struct Log<'a> {
    start: u64,
    definitions: Definitions<'a>,
    items: Vec<PlanItem>,
    data: Messages<'a>,
    end: Option<End>,
}

impl<'a> Log<'a> {
    /// Reads what stands before the first tick. A log that ends there is a log too.
    pub fn open(bytes: &'a [u8]) -> Result<Self, OpenError> {
        let (messages, start) = Messages::new(bytes)?;
        let mut log = Self {
            start,
            definitions: Definitions::default(),
            items: Vec::new(),
            data: messages,
            end: None,
        };
        let mut first = true;
        while log.end.is_none() {
            match log.data.next_message() {
                Ok(message) if first && message.kind == kind::FLAGS => check_flags(&message)?,
                Ok(message) => match log.definition(&message) {
                    Ok(true) => {}
                    Ok(false) => {
                        log.data.go_back(&message);
                        break;
                    }
                    Err(end) => log.end = Some(end),
                },
                Err(end) => log.end = Some(end),
            }
            first = false;
        }
        Ok(log)
    }

    /// Takes in a message; `false` when it belongs to the flight.
    fn definition(&mut self, message: &Message<'a>) -> Result<bool, End> {
        match message.kind {
            kind::TEXT | kind::DROPOUT | kind::SYNC => Ok(false),
            kind::DATA => {
                let Some((Subscription::Ours(id, _), body)) = self.definitions.data(message.body) else {
                    return Ok(false);
                };
                if id != PlanItem::TOPIC.id {
                    return Ok(false);
                }
                let item = body.split_at_checked(8).and_then(|(_, fields)| {
                    let mut from = Decoder::new(fields);
                    PlanItem::get(&mut from).filter(|_| from.rest().is_empty())
                });
                keep(&mut self.items, item.ok_or(message.corrupt())?, message)?;
                Ok(true)
            }
            _ => self.definitions.take(message).map(|()| true),
        }
    }

    /// Time of the file's start, µs.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Ticks of a period, where the log says it.
    pub fn k(&self) -> Option<usize> {
        self.definitions.k
    }

    /// All named values.
    pub fn infos(&self) -> &[Info<'a>] {
        &self.definitions.info
    }

    /// A named value.
    pub fn info(&self, name: &str) -> Option<&Info<'a>> {
        self.definitions.info.iter().find(|info| info.name == name)
    }

    /// A named value of a type.
    pub fn value<T: Value>(&self, name: &str) -> Option<T> {
        self.info(name)?.value()
    }

    /// A named text.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        self.info(name)?.text()
    }

    /// Parameters as they were at the start.
    pub fn parameters(&self) -> &[(&'a str, f32)] {
        &self.definitions.parameters
    }

    /// What was stored at the start.
    pub fn items(&self) -> &[PlanItem] {
        &self.items
    }

    /// The end, when it comes before the first tick.
    pub fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// Every record of the flight.
    pub fn entries(&self) -> Entries<'a> {
        Entries::new(self.definitions.clone(), self.data.clone(), self.end.clone())
    }

    /// The flight as replay needs it.
    pub fn periods(&self) -> Periods<'a> {
        Periods::new(self.entries())
    }
}

fn check_flags(message: &Message<'_>) -> Result<(), OpenError> {
    let incompatible = message.body.get(8..16).ok_or(OpenError::NotUlog)?;
    if incompatible.iter().any(|byte| *byte != 0) {
        return Err(OpenError::Incompatible);
    }
    Ok(())
}

/// Keeps one more, if that is not too many.
fn keep<T>(list: &mut Vec<T>, one: T, message: &Message<'_>) -> Result<(), End> {
    if list.len() >= MOST {
        return Err(message.end(Reason::TooMany(char::from(message.kind))));
    }
    list.push(one);
    Ok(())
}

impl<'a> Definitions<'a> {
    /// Takes in a message that defines something; others are ignored.
    pub fn take(&mut self, message: &Message<'a>) -> Result<(), End> {
        let corrupt = || message.corrupt();
        match message.kind {
            kind::INFO => {
                let info = Info::get(message.body).ok_or_else(corrupt)?;
                match info.name {
                    "imu_k" => {
                        self.k = info
                            .value::<u32>()
                            .map(|k| k as usize)
                            .filter(|k| (1..=MAX_K).contains(k))
                    }
                    "imu_rate" => self.imu_rate = info.value().unwrap_or(0),
                    _ => {}
                }
                keep(&mut self.info, info, message)
            }
            kind::PARAMETER => {
                let info = Info::get(message.body).ok_or_else(corrupt)?;
                match info.value::<f32>() {
                    Some(value) => keep(&mut self.parameters, (info.name, value), message),
                    // Whole numbers are PX4's.
                    None => info.value::<i32>().map(|_| ()).ok_or_else(corrupt),
                }
            }
            kind::FORMAT => {
                let colon = message
                    .body
                    .iter()
                    .position(|byte| *byte == b':')
                    .ok_or_else(corrupt)?;
                let name = core::str::from_utf8(&message.body[..colon]).map_err(|_| corrupt())?;
                keep(&mut self.formats, (name, message.body), message)
            }
            kind::SUBSCRIPTION => self.subscribe(message),
            _ => Ok(()),
        }
    }

    fn subscribe(&mut self, message: &Message<'a>) -> Result<(), End> {
        let corrupt = || message.corrupt();
        let mut from = Decoder::new(message.body);
        let [_instance] = from.bytes().ok_or_else(corrupt)?;
        let id = usize::from(from.bytes().map(u16::from_le_bytes).ok_or_else(corrupt)?);
        let name = core::str::from_utf8(from.rest()).map_err(|_| corrupt())?;
        self.subscribed += 1;
        if self.subscribed > MOST {
            return Err(message.end(Reason::TooMany(char::from(message.kind))));
        }
        if self.subscriptions.len() <= id {
            self.subscriptions.resize(id + 1, None);
        }
        self.subscriptions[id] = Some(self.resolve(name));
        Ok(())
    }

    /// A topic is ours when its format is, letter by letter.
    fn resolve(&self, name: &'a str) -> Subscription<'a> {
        let Some(ours) = topics::find(name) else {
            return Subscription::Foreign(name);
        };
        let mut buffer = [0; FORMAT];
        let mut out = Encoder::new(&mut buffer);
        // Topics whose format does not depend on K are the same for each.
        ours.format(self.k.unwrap_or(1), &mut out);
        let length = out.finish().unwrap_or(0);
        let written = self.formats.iter().rev().find(|(format, _)| *format == name);
        if written.is_some_and(|(_, format)| *format == &buffer[..length]) {
            Subscription::Ours(ours.id, ours.name)
        } else {
            Subscription::Mismatched(name)
        }
    }

    /// A data message's topic and what follows its number.
    pub fn data(&self, body: &'a [u8]) -> Option<(Subscription<'a>, &'a [u8])> {
        let mut from = Decoder::new(body);
        let id = usize::from(u16::from_le_bytes(from.bytes()?));
        let subscription = (*self.subscriptions.get(id)?)?;
        Some((subscription, from.rest()))
    }
}
