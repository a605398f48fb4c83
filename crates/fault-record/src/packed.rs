//! A record as words with a check: no other bits are likely in memory after power-on.

use crate::{Fault, Frame, MESSAGE, Progress, Reason, Record, Task, Text};

/// Says that a record is a record, and in which layout.
const MAGIC: u32 = u32::from_be_bytes(*b"WHN2");

/// Words of a reason: the longest is a panic's length and text.
const REASON: usize = 1 + MESSAGE / 4;

/// Codes of reasons.
const PANIC: u32 = 1;
const FAULT: u32 = 2;
const RESTART: u32 = 3;

/// Codes of tasks; interrupts lie above.
const THREAD: u32 = 0;
const INNER: u32 = 1;
const OUTER: u32 = 2;
const LOG: u32 = 3;
const INTERRUPT: u32 = 0x1_0000;

/// A packed record. Any bits are one of this type; [`Packed::unpack`] says whether they are a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Packed {
    magic: u32,
    code: u32,
    task: u32,
    progress: [u32; 3],
    reason: [u32; REASON],
    check: u32,
}

impl Packed {
    /// No record.
    pub const NONE: Self = Self {
        magic: 0,
        code: 0,
        task: 0,
        progress: [0; 3],
        reason: [0; REASON],
        check: 0,
    };

    /// Packs a record.
    #[inline(never)]
    pub fn new(record: &Record) -> Self {
        let Progress { tick, outer, log } = record.progress;
        let mut packed = Self {
            magic: MAGIC,
            task: match record.task {
                Task::Thread => THREAD,
                Task::Inner => INNER,
                Task::Outer => OUTER,
                Task::Log => LOG,
                Task::Interrupt(number) => INTERRUPT | u32::from(number),
            },
            progress: [tick, outer, log],
            ..Self::NONE
        };
        packed.code = match &record.reason {
            Reason::Panic(text) => {
                let text = text.as_str().as_bytes();
                let words = text.chunks(4).map(|bytes| {
                    let bytes = bytes.iter().rev();
                    bytes.fold(0, |word, byte| word << 8 | u32::from(*byte))
                });
                packed.put([text.len() as u32].into_iter().chain(words));
                PANIC
            }
            Reason::Fault(fault) => {
                let frame = fault.frame.iter().flat_map(|frame| {
                    let [r0, r1, r2, r3] = frame.r;
                    [r0, r1, r2, r3, frame.r12, frame.lr, frame.pc, frame.xpsr]
                });
                let stacked = u32::from(fault.frame.is_some());
                let words = [fault.cfsr, fault.hfsr, fault.address, stacked];
                packed.put(words.into_iter().chain(frame));
                FAULT
            }
            Reason::Restart => RESTART,
        };
        packed.check = packed.sum();
        packed
    }

    fn put(&mut self, words: impl Iterator<Item = u32>) {
        for (to, word) in self.reason.iter_mut().zip(words) {
            *to = word;
        }
    }

    /// Each word turned and added: whatever single bit is another, the sum is.
    fn sum(&self) -> u32 {
        let words = [self.code, self.task].into_iter();
        words
            .chain(self.progress)
            .chain(self.reason)
            .fold(self.magic, |sum, word| sum.rotate_left(5) ^ word)
    }

    /// The record, if this is one.
    #[inline(never)]
    pub fn unpack(&self) -> Option<Record> {
        if self.magic != MAGIC || self.check != self.sum() {
            return None;
        }
        let [tick, outer, log] = self.progress;
        Some(Record {
            reason: self.reason()?,
            task: match self.task {
                THREAD => Task::Thread,
                INNER => Task::Inner,
                OUTER => Task::Outer,
                LOG => Task::Log,
                number => Task::Interrupt(number as u16),
            },
            progress: Progress { tick, outer, log },
        })
    }

    fn reason(&self) -> Option<Reason> {
        match self.code {
            PANIC => {
                let (length, words) = self.reason.split_first()?;
                let mut text = [0; MESSAGE];
                for (to, word) in text.chunks_mut(4).zip(words) {
                    for (to, byte) in to.iter_mut().zip(word.to_le_bytes()) {
                        *to = byte;
                    }
                }
                let text = core::str::from_utf8(text.get(..*length as usize)?).ok()?;
                Some(Reason::Panic(Text::message(format_args!("{text}"))))
            }
            FAULT => {
                let [cfsr, hfsr, address, stacked, r0, r1, r2, r3, r12, lr, pc, xpsr] =
                    *self.reason.first_chunk()?;
                let frame = Frame {
                    r: [r0, r1, r2, r3],
                    r12,
                    lr,
                    pc,
                    xpsr,
                };
                Some(Reason::Fault(Fault {
                    frame: (stacked != 0).then_some(frame),
                    cfsr,
                    hfsr,
                    address,
                }))
            }
            RESTART => Some(Reason::Restart),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn reasons() -> impl Strategy<Value = Reason> {
        let frame = any::<[u32; 8]>().prop_map(|[a, b, c, d, r12, lr, pc, xpsr]| Frame {
            r: [a, b, c, d],
            r12,
            lr,
            pc,
            xpsr,
        });
        let fault = (prop::option::of(frame), any::<[u32; 3]>());
        let fault = fault.prop_map(|(frame, [cfsr, hfsr, address])| {
            Reason::Fault(Fault {
                frame,
                cfsr,
                hfsr,
                address,
            })
        });
        prop_oneof![
            ".{0,150}".prop_map(|text| Reason::Panic(Text::message(format_args!("{text}")))),
            fault,
            Just(Reason::Restart),
        ]
    }

    fn records() -> impl Strategy<Value = Record> {
        let task = prop_oneof![
            Just(Task::Thread),
            Just(Task::Inner),
            Just(Task::Outer),
            Just(Task::Log),
            any::<u16>().prop_map(Task::Interrupt)
        ];
        (reasons(), task, any::<[u32; 3]>()).prop_map(|(reason, task, [tick, outer, log])| Record {
            reason,
            task,
            progress: Progress { tick, outer, log },
        })
    }

    /// The words of a packed record, as memory holds them.
    fn words(packed: &Packed) -> Vec<u32> {
        let Packed {
            magic,
            code,
            task,
            progress,
            reason,
            check,
        } = packed;
        let first = [*magic, *code, *task];
        [&first[..], progress, reason, &[*check]].concat()
    }

    fn from_words(words: &[u32]) -> Packed {
        Packed {
            magic: words[0],
            code: words[1],
            task: words[2],
            progress: words[3..6].try_into().unwrap(),
            reason: words[6..6 + REASON].try_into().unwrap(),
            check: words[6 + REASON],
        }
    }

    proptest! {
        #[test]
        fn a_record_survives_and_one_with_a_bit_flipped_is_none(record in records()) {
            let packed = Packed::new(&record);
            prop_assert_eq!(packed.unpack(), Some(record));
            let words = words(&packed);
            for bit in 0..32 * words.len() {
                let mut flipped = words.clone();
                flipped[bit / 32] ^= 1 << (bit % 32);
                prop_assert_eq!(from_words(&flipped).unpack(), None);
            }
        }

        /// Even with a check that fits, bits that say nothing are no record: no panic, no nonsense text.
        #[test]
        fn any_words_are_safe(mut packed in prop::collection::vec(any::<u32>(), 7 + REASON), code in 0u32..6) {
            prop_assert_eq!(from_words(&packed).unpack(), None);
            packed[0] = MAGIC;
            packed[1] = code;
            let mut packed = from_words(&packed);
            packed.check = packed.sum();
            if let Some(record) = packed.unpack() {
                prop_assert!(!record.to_string().is_empty());
            }
        }
    }

    #[test]
    fn memory_that_was_cleared_is_no_record() {
        assert_eq!(Packed::NONE.unpack(), None);
    }
}
