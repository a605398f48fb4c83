//! What stands before the first tick: who flew, on what, with which parameters and which mission.
//!
//! Written in chunks of at most [`CHUNK`] bytes, each some whole messages, so that no large buffer
//! is needed. The order: flags, infos, parameters, formats, subscriptions, stored items.

use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::sensing::BoardRotation;
use windhover_autopilot::{InnerConfig, OuterConfig, Parameters};

use crate::plan::{Plan, PlanItem, PlanKind};
use crate::record::{Description, Record, Topic, data};
use crate::topics;
use crate::value::Value;
use crate::wire::{Encoder, FILE_HEADER, MAGIC, VERSION, kind, message};

/// The most bytes of a chunk.
pub const CHUNK: usize = 512;

/// Version of what we write into ULog's frame; a reader knows one.
pub const LOG_VERSION: u32 = 3;

/// The most bytes of a text; what is longer is cut.
const TEXT: usize = 240;

/// The value of an info message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InfoValue<'a> {
    /// A text.
    Text(&'a str),
    /// A whole number.
    U32(u32),
    /// A whole number with a sign.
    I32(i32),
    /// A number.
    F32(f32),
    /// A number.
    F64(f64),
    /// A matrix of small numbers.
    I8x9([i8; 9]),
}

impl InfoValue<'_> {
    /// Writes the body of an info message; fails when the name is longer than some 80 bytes.
    pub fn put(&self, name: &str, out: &mut Encoder<'_>) {
        let kind = match self {
            Self::Text(_) => "char",
            Self::U32(_) => "uint32_t",
            Self::I32(_) => "int32_t",
            Self::F32(_) => "float",
            Self::F64(_) => "double",
            Self::I8x9(_) => "int8_t",
        };
        let length = match self {
            Self::Text(text) => Some(cut(text).len()),
            Self::I8x9(_) => Some(9),
            _ => None,
        };
        let mut key = [0; 96];
        let mut typed = Encoder::new(&mut key);
        typed.slice(kind.as_bytes());
        if let Some(length) = length {
            typed.bytes([b'[']);
            typed.decimal(length);
            typed.bytes([b']']);
        }
        typed.bytes([b' ']);
        typed.slice(name.as_bytes());
        let Some(length) = typed.finish() else {
            out.fail();
            return;
        };
        out.bytes([length as u8]);
        out.slice(key.get(..length).unwrap_or_default());
        match self {
            Self::Text(text) => out.slice(cut(text).as_bytes()),
            Self::U32(value) => value.put(out),
            Self::I32(value) => value.put(out),
            Self::F32(value) => value.put(out),
            Self::F64(value) => value.put(out),
            Self::I8x9(values) => values.put(out),
        }
    }
}

/// As much of a text as is written.
fn cut(text: &str) -> &str {
    text.get(..text.floor_char_boundary(TEXT)).unwrap_or(text)
}

/// What the header says.
#[derive(Clone, Copy, Debug)]
pub struct Header<'a> {
    /// Time of the start, µs.
    pub time: u64,
    /// The commit that the core was built from.
    pub commit: &'a str,
    /// Version of the core, 0xMMmmpptt as PX4 has it.
    pub release: u32,
    /// The board.
    pub board: &'a str,
    /// IMU rate and rotation.
    pub inner: InnerConfig,
    /// Parameters as loaded, calibration among them.
    pub parameters: &'a Parameters,
    /// Home and declination where they were given, and the compass.
    pub outer: OuterConfig,
    /// Why the core started.
    pub reset_cause: &'a str,
    /// CRC of the stored mission.
    pub mission_crc: u32,
    /// What is stored.
    pub plans: &'a [Plan],
    /// Whatever else is to be said; for simulations their conditions.
    pub more: &'a [(&'a str, InfoValue<'a>)],
}

impl Header<'_> {
    fn mission(&self) -> Plan {
        let mission = |plan: &&Plan| plan.kind == PlanKind::Mission;
        self.plans.iter().find(mission).copied().unwrap_or_default()
    }

    /// The info message with that index; `None` beyond the last.
    fn info(&self, index: usize) -> Option<(&str, InfoValue<'_>)> {
        let flat =
            |BoardRotation([[a, b, c], [d, e, f], [g, h, i]])| InfoValue::I8x9([a, b, c, d, e, f, g, h, i]);
        let outer = &self.outer;
        let home = outer.home.unwrap_or_default();
        let own = [
            ("sys_name", InfoValue::Text("Windhover")),
            ("ver_sw", InfoValue::Text(self.commit)),
            ("ver_sw_release", InfoValue::U32(self.release)),
            ("ver_hw", InfoValue::Text(self.board)),
            ("log_version", InfoValue::U32(LOG_VERSION)),
            ("imu_rate", InfoValue::U32(self.inner.imu_rate)),
            ("imu_k", InfoValue::U32(self.inner.k())),
            ("imu_rotation", flat(self.inner.rotation)),
            ("home_known", InfoValue::U32(u32::from(outer.home.is_some()))),
            ("home_lat", InfoValue::I32(home.latitude)),
            ("home_lon", InfoValue::I32(home.longitude)),
            ("home_alt", InfoValue::I32(home.altitude)),
            ("mag_ut_per_count", InfoValue::F32(outer.compass.per_count)),
            ("mag_rotation", flat(outer.compass.rotation)),
            ("reset_cause", InfoValue::Text(self.reset_cause)),
            ("mission_slot", InfoValue::U32(u32::from(self.mission().slot))),
            ("mission_count", InfoValue::U32(u32::from(self.mission().count))),
            ("mission_crc", InfoValue::U32(self.mission_crc)),
        ];
        // One that was not given is looked up again in a replay.
        let declination = outer
            .declination
            .map(|bearing| ("declination", InfoValue::F32(bearing)));
        let more = self.more.iter().copied();
        own.into_iter().chain(declination).chain(more).nth(index)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    File,
    Info,
    Parameter,
    Default,
    Format,
    Subscription,
    Item(usize),
    Done,
}

/// Writes a header, chunk by chunk.
#[derive(Debug)]
pub struct HeaderWriter<'a, F> {
    header: Header<'a>,
    /// The stored items, by kind, slot and index.
    items: F,
    stage: Stage,
    index: usize,
    buffer: [u8; CHUNK],
}

impl<'a, F: Fn(PlanKind, u8, u16) -> Option<MissionItem>> HeaderWriter<'a, F> {
    /// A writer at its first chunk.
    pub fn new(header: Header<'a>, items: F) -> Self {
        Self {
            header,
            items,
            stage: Stage::File,
            index: 0,
            buffer: [0; CHUNK],
        }
    }

    /// The next chunk; `None` when all is written.
    pub fn chunk(&mut self) -> Option<&[u8]> {
        let mut length = 0;
        let mut buffer = [0; CHUNK];
        while self.stage != Stage::Done {
            let place = buffer.get_mut(length..)?;
            match self.message(place) {
                Message::Written(written) => {
                    length += written;
                    self.index += 1;
                }
                Message::StageEnds(next) => (self.stage, self.index) = (next, 0),
                Message::NoRoom if length == 0 => self.index += 1,
                Message::NoRoom => break,
            }
        }
        self.buffer = buffer;
        self.buffer.get(..length).filter(|chunk| !chunk.is_empty())
    }

    fn message(&self, to: &mut [u8]) -> Message {
        match self.stage {
            Stage::File if self.index == 0 => file(to, self.header.time).into(),
            Stage::File => Message::StageEnds(Stage::Info),
            Stage::Info => match self.header.info(self.index) {
                Some((name, value)) => message(to, kind::INFO, |out| value.put(name, out)).into(),
                None => Message::StageEnds(Stage::Parameter),
            },
            Stage::Parameter => self.parameter(to, false),
            Stage::Default => self.parameter(to, true),
            Stage::Format | Stage::Subscription => match topics::all().nth(self.index) {
                Some(topic) => self.topic(to, &topic),
                None if self.stage == Stage::Format => Message::StageEnds(Stage::Subscription),
                None => Message::StageEnds(Stage::Item(0)),
            },
            Stage::Item(plan) => self.item(to, plan),
            Stage::Done => Message::StageEnds(Stage::Done),
        }
    }

    /// A parameter's value, or its default where that is another one.
    fn parameter(&self, to: &mut [u8], default: bool) -> Message {
        let (Some(declaration), Some(value)) = (
            Parameters::declaration(self.index),
            self.header.parameters.get(self.index),
        ) else {
            return Message::StageEnds(if default { Stage::Format } else { Stage::Default });
        };
        if !default {
            let value = InfoValue::F32(value);
            return message(to, kind::PARAMETER, |out| value.put(declaration.name, out)).into();
        }
        if value.to_bits() == declaration.default.to_bits() {
            return Message::Written(0);
        }
        let value = InfoValue::F32(declaration.default);
        message(to, kind::PARAMETER_DEFAULT, |out| {
            out.bytes([1]);
            value.put(declaration.name, out);
        })
        .into()
    }

    fn topic(&self, to: &mut [u8], topic: &Description) -> Message {
        let written = if self.stage == Stage::Format {
            let k = self.header.inner.k() as usize;
            message(to, kind::FORMAT, |out| topic.format(k, out))
        } else {
            message(to, kind::SUBSCRIPTION, |out| {
                out.bytes([0]);
                out.bytes(topic.id.to_le_bytes());
                out.slice(topic.name.as_bytes());
            })
        };
        written.into()
    }

    fn item(&self, to: &mut [u8], plan: usize) -> Message {
        let Some(&Plan { kind, slot, count }) = self.header.plans.get(plan) else {
            return Message::StageEnds(Stage::Done);
        };
        let index = u16::try_from(self.index).unwrap_or(u16::MAX);
        let item = if index < count {
            (self.items)(kind, slot, index)
        } else {
            None
        };
        let Some(item) = item else {
            return Message::StageEnds(Stage::Item(plan + 1));
        };
        let item = PlanItem {
            kind,
            slot,
            index,
            item,
        };
        data(to, PlanItem::TOPIC.id, self.header.time, |out| item.put(out)).into()
    }
}

enum Message {
    Written(usize),
    StageEnds(Stage),
    NoRoom,
}

impl From<Option<usize>> for Message {
    fn from(length: Option<usize>) -> Self {
        length.map_or(Self::NoRoom, Self::Written)
    }
}

/// The file's own header, and the flags: defaults of parameters are there, nothing is appended.
fn file(to: &mut [u8], time: u64) -> Option<usize> {
    let mut out = Encoder::new(to);
    out.bytes(MAGIC);
    out.bytes([VERSION]);
    out.bytes(time.to_le_bytes());
    out.finish()?;
    let flags = message(to.get_mut(FILE_HEADER..)?, kind::FLAGS, |out| {
        out.bytes([1, 0, 0, 0, 0, 0, 0, 0]);
        out.bytes([0; 32]);
    })?;
    Some(FILE_HEADER + flags)
}
