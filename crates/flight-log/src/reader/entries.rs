//! The records of a flight, one by one, in the order in which they were written.

use std::string::String;

use windhover_autopilot::Urgent;

use super::end::{End, Reason};
use super::log::{Definitions, Subscription};
use super::messages::{Message, Messages};
use crate::batch::{ImuBatch, ImuTimes};
use crate::inputs::Input;
use crate::logger::nominal_step;
use crate::motors::MotorBatch;
use crate::plan::PlanItem;
use crate::record::{Record, Topic};
use crate::value::Value;
use crate::views::View;
use crate::wire::{Decoder, kind};

/// One record of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
// Made and taken apart at once, never stored in numbers.
#[allow(clippy::large_enum_variant)]
pub enum Entry<'a> {
    /// The inputs of the inner step in one period.
    Imu(ImuBatch),
    /// An urgent command.
    Urgent {
        /// The tick in which it acted.
        tick: u32,
        /// The command.
        urgent: Urgent,
    },
    /// An item that the outer step took from a queue.
    Input {
        /// The boundary at which it was frozen.
        tick: u32,
        /// The item.
        input: Input,
    },
    /// The outputs of a period.
    Motors {
        /// Time of its first tick, µs.
        time: u64,
        /// The outputs.
        batch: MotorBatch,
    },
    /// An item that was stored in flight.
    Item(PlanItem),
    /// A record for people.
    View {
        /// Its time, µs.
        time: u64,
        /// The record.
        view: View,
    },
    /// A line of text.
    Text {
        /// Its time, µs.
        time: u64,
        /// The line.
        text: &'a str,
    },
    /// Something was lost for so long, ms.
    Dropout(u16),
    /// A topic whose format is not ours though its name is.
    Mismatched(&'a str),
    /// A topic that we do not know, and its record, time included.
    Foreign(&'a str, &'a [u8]),
}

/// Iterates over the records of a flight.
#[derive(Clone, Debug)]
pub struct Entries<'a> {
    definitions: Definitions<'a>,
    messages: Messages<'a>,
    exact: Option<ImuTimes>,
    end: Option<End>,
}

impl<'a> Entries<'a> {
    pub(super) fn new(definitions: Definitions<'a>, messages: Messages<'a>, end: Option<End>) -> Self {
        Self {
            definitions,
            messages,
            exact: None,
            end,
        }
    }

    /// Where and why it ended; `None` before the last record was taken.
    pub fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// Ends here for another reason.
    pub(super) fn stop(&mut self, offset: usize, reason: Reason) {
        self.end = Some(End { offset, reason });
    }

    /// Named values that were written during the flight are here, and those before it.
    pub fn infos(&self) -> &[super::Info<'a>] {
        &self.definitions.info
    }

    fn read(&mut self) -> Result<(usize, Entry<'a>), End> {
        loop {
            let message = self.messages.next_message()?;
            if let Some(entry) = self.entry(&message)? {
                return Ok((message.offset, entry));
            }
        }
    }

    /// The next record and where it stands.
    pub(super) fn next_at(&mut self) -> Option<(usize, Entry<'a>)> {
        if self.end.is_some() {
            return None;
        }
        match self.read() {
            Ok(entry) => Some(entry),
            Err(end) => {
                self.end = Some(end);
                None
            }
        }
    }

    fn entry(&mut self, message: &Message<'a>) -> Result<Option<Entry<'a>>, End> {
        let corrupt = || message.corrupt();
        let mut from = Decoder::new(message.body);
        match message.kind {
            kind::DATA => {
                let Some((subscription, body)) = self.definitions.data(message.body) else {
                    return Err(corrupt());
                };
                match subscription {
                    Subscription::Ours(id, name) => {
                        let record = self.record(id, body);
                        record.ok_or_else(|| message.end(Reason::Record(String::from(name))))
                    }
                    Subscription::Mismatched(name) => Ok(Some(Entry::Mismatched(name))),
                    Subscription::Foreign(name) => Ok(Some(Entry::Foreign(name, body))),
                }
            }
            kind::TEXT => {
                let (Some([_level]), Some(time)) = (from.bytes(), u64::get(&mut from)) else {
                    return Err(corrupt());
                };
                let text = core::str::from_utf8(from.rest()).map_err(|_| corrupt())?;
                Ok(Some(Entry::Text { time, text }))
            }
            kind::DROPOUT => Ok(Some(Entry::Dropout(u16::get(&mut from).ok_or_else(corrupt)?))),
            // Parameters here are PX4's way to tell of a change; ours are inputs.
            kind::PARAMETER => Ok(None),
            _ => self.definitions.take(message).map(|()| None),
        }
    }

    /// A record of ours; outer `None` when it is corrupt, inner when there is nothing to tell.
    fn record(&mut self, id: u16, body: &'a [u8]) -> Option<Option<Entry<'a>>> {
        let k = self.definitions.k.unwrap_or(1);
        let nominal = nominal_step(self.definitions.imu_rate);
        let mut from = Decoder::new(body);
        let time = u64::get(&mut from)?;
        let entry = if id == ImuBatch::TOPIC.id {
            let exact = self.exact.take();
            let batch = ImuBatch::get(time, k, nominal, exact.as_ref(), &mut from)?;
            Some(Entry::Imu(batch))
        } else if id == MotorBatch::TOPIC.id {
            let batch = MotorBatch::get(k, &mut from)?;
            Some(Entry::Motors { time, batch })
        } else if id == ImuTimes::TOPIC.id {
            self.exact = Some(ImuTimes::get(k, &mut from)?);
            None
        } else if id == PlanItem::TOPIC.id {
            Some(Entry::Item(PlanItem::get(&mut from)?))
        } else if id == Urgent::TOPIC.id {
            let tick = u32::get(&mut from)?;
            let urgent = Urgent::get(&mut from)?;
            Some(Entry::Urgent { tick, urgent })
        } else if let Some(view) = View::get(id, &mut from) {
            Some(Entry::View { time, view })
        } else {
            let tick = u32::get(&mut from)?;
            let input = Input::get(id, &mut from)?;
            Some(Entry::Input { tick, input })
        };
        from.rest().is_empty().then_some(entry)
    }
}

impl<'a> Iterator for Entries<'a> {
    type Item = Entry<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_at().map(|(_, entry)| entry)
    }
}
