//! Lines of text for a human, with a severity; long ones go out in parts.

use core::fmt::{self, Write};

use heapless::{Deque, String};
use mavlink::MessageData;
use mavlink::dialects::common::STATUSTEXT_DATA;

use crate::wire::Message;

/// The longest line: two parts and a bit. A reason in an error should not be larger than this.
const LINE: usize = 104;

/// Lines that wait.
const LINES: usize = 8;

/// Bytes of a line in one message.
const PART: usize = 50;

/// How bad it is (`MAV_SEVERITY`, with its numbers).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The vehicle is unusable.
    Emergency,
    /// To be acted on at once.
    Alert,
    /// A primary system failed.
    Critical,
    /// A secondary system failed, or something was refused.
    Error,
    /// It may become an error.
    Warning,
    /// Unusual, not an error.
    Notice,
    /// Normal.
    Info,
    /// For developers.
    Debug,
}

/// A line of text of at most so many bytes, that ends where it is full.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Line(String<LINE>);

impl Line {
    /// What `text` says, as far as it fits.
    pub fn new(text: fmt::Arguments<'_>) -> Self {
        let mut line = Self::default();
        let _ = line.write_fmt(text);
        line
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Write for Line {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let fits = text.floor_char_boundary(LINE - self.0.len());
        let (fitting, rest) = text.split_at_checked(fits).unwrap_or_default();
        let taken = self.0.push_str(fitting);
        if rest.is_empty() {
            taken.map_err(|_| fmt::Error)
        } else {
            Err(fmt::Error)
        }
    }
}

/// A text inside another one, as it is: the standard way pads it, and takes more flash.
#[derive(Clone, Copy, Debug)]
pub struct Plain<'a>(pub &'a str);

impl fmt::Display for Plain<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Waiting {
    severity: Severity,
    line: Line,
}

/// Lines that wait to be sent.
#[derive(Clone, Debug, Default)]
pub struct Texts {
    lines: Deque<Waiting, LINES>,
    /// Number of the line under way, and of its next part.
    line: u16,
    part: u8,
    dropped: u32,
}

impl Texts {
    /// Puts a line at the end, unless the same waits already: whoever asks the same again and again
    /// must not crowd out what others are told. When there is no room, it is counted.
    pub fn say(&mut self, severity: Severity, text: fmt::Arguments<'_>) {
        let line = Line::new(text);
        let waiting = Waiting { severity, line };
        if self.lines.iter().any(|other| *other == waiting) {
            return;
        }
        if self.lines.push_back(waiting).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Lines for which there was no room, since start.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// The next part to be sent.
    pub(crate) fn next(&mut self, m: &mut Message) -> Option<()> {
        let waiting = self.lines.front()?;
        let text = waiting.line.as_str().as_bytes();
        let from = usize::from(self.part) * PART;
        let rest = text.get(from..).unwrap_or_default();
        let mut part = [0; PART];
        crate::frame::put(&mut part, rest);
        let alone = text.len() <= PART;
        m.start(STATUSTEXT_DATA::ID)
            .byte(waiting.severity as u8)
            .bytes(&part)
            .word(if alone { 0 } else { self.line.saturating_add(1) })
            .byte(self.part);
        // A part that is not full is the last one: a line that fills its parts needs one more.
        if alone || rest.len() < PART {
            self.lines.pop_front();
            self.line = (self.line + 1) % 0x7fff;
            self.part = 0;
        } else {
            self.part += 1;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::String;
    use std::vec::Vec;

    use mavlink::{MavlinkVersion, MessageData};

    use super::*;

    fn parts(texts: &mut Texts) -> Vec<(u16, u8, String)> {
        let mut message = Message::empty();
        core::iter::from_fn(|| texts.next(&mut message).map(|()| message))
            .map(|message| {
                let data: STATUSTEXT_DATA =
                    STATUSTEXT_DATA::deser(MavlinkVersion::V2, message.payload()).unwrap();
                let text: Vec<u8> = data.text.iter().copied().take_while(|byte| *byte != 0).collect();
                (data.id, data.chunk_seq, String::from_utf8(text).unwrap())
            })
            .collect()
    }

    #[test]
    fn a_short_line_is_one_message_and_a_long_one_is_numbered_parts() {
        let mut texts = Texts::default();
        texts.say(Severity::Info, format_args!("ready"));
        texts.say(Severity::Error, format_args!("{:a<120}", ""));
        texts.say(Severity::Error, format_args!("{:b<100}", ""));
        let parts = parts(&mut texts);
        assert_eq!(parts[0], (0, 0, "ready".into()));
        let lengths: Vec<_> = parts
            .iter()
            .map(|(id, part, text)| (*id, *part, text.len()))
            .collect();
        let long = [
            (2, 0, 50),
            (2, 1, 50),
            (2, 2, 4),
            (3, 0, 50),
            (3, 1, 50),
            (3, 2, 0),
        ];
        assert_eq!(lengths[1..], long);
    }

    #[test]
    fn a_line_too_long_is_cut_and_too_many_are_counted() {
        let mut texts = Texts::default();
        for number in 0..LINES + 3 {
            texts.say(Severity::Info, format_args!("{number} {:ä<300}", ""));
            texts.say(Severity::Info, format_args!("0 {:ä<300}", ""));
        }
        assert_eq!(texts.dropped(), 3);
        assert_eq!(Line::new(format_args!("{:ä<300}", "")).as_str().len(), LINE);
    }
}
