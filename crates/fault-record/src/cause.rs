//! Why the microcontroller started.

use core::fmt::{self, Display};

use crate::{Progress, Reason, Record};

/// Ticks of the inner loop without an outer step, by which the outer loop is said to have stood still:
/// some 25 periods at 1 kHz. Where the inner loop stands still, there are hardly more than one period's.
const STOOD_STILL: u32 = 100;

/// The hardware's flags of the last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags {
    /// The independent watchdog.
    pub watchdog: bool,
    /// Power-on.
    pub power_on: bool,
    /// The supply was too low.
    pub brown_out: bool,
    /// Software.
    pub software: bool,
}

/// Why the microcontroller started.
#[allow(
    clippy::large_enum_variant,
    reason = "there is one, once, and no heap for a box"
)]
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The supply came.
    PowerOn,
    /// The reset pin: a button, or a debug probe.
    ResetPin,
    /// The supply was too low.
    BrownOut,
    /// Software, and no record says why: a debug probe does so.
    Software,
    /// The watchdog was not fed.
    Watchdog(Progress),
    /// The last run ended and said why.
    Ended(Record),
}

impl Cause {
    /// By the flags, by the record of the last run, and by how far it had come. Memory holds through a
    /// reset by software or by the watchdog; a record that is there after another one is not believed.
    pub fn new(flags: Flags, record: Option<Record>, progress: Progress) -> Self {
        match record {
            Some(record) if flags.software || flags.watchdog => Self::Ended(record),
            _ if flags.watchdog => Self::Watchdog(progress),
            _ if flags.power_on => Self::PowerOn,
            _ if flags.brown_out => Self::BrownOut,
            _ if flags.software => Self::Software,
            _ => Self::ResetPin,
        }
    }

    /// Whether the last run ended as nobody wanted it to: ground stations are told.
    pub fn is_trouble(&self) -> bool {
        match self {
            Self::PowerOn | Self::ResetPin => false,
            Self::BrownOut | Self::Software | Self::Watchdog(_) => true,
            Self::Ended(record) => matches!(record.reason, Reason::Panic(_) | Reason::Fault(_)),
        }
    }
}

impl Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PowerOn => f.write_str("power-on"),
            Self::ResetPin => f.write_str("reset pin"),
            Self::BrownOut => f.write_str("brown-out: the supply fell below 2.7 V"),
            Self::Software => f.write_str("restart by software"),
            Self::Watchdog(progress) => {
                let ahead = progress.tick.wrapping_sub(progress.outer);
                let which = if ahead > STOOD_STILL { "outer" } else { "inner" };
                write!(f, "watchdog: the {which} loop stood still for 250 ms; {progress}")
            }
            Self::Ended(record) => record.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fault, Frame, TEXT, Task, Text};

    const PROGRESS: Progress = Progress {
        tick: 12_345,
        outer: 12_344,
        log: 456_789,
    };

    fn record(reason: Reason) -> Record {
        Record {
            reason,
            task: Task::Outer,
            progress: PROGRESS,
        }
    }

    fn flags(bits: u8) -> Flags {
        Flags {
            watchdog: bits & 1 != 0,
            power_on: bits & 2 != 0,
            brown_out: bits & 4 != 0,
            software: bits & 8 != 0,
        }
    }

    fn panic(text: &str) -> Record {
        record(Reason::Panic(Text::message(format_args!("{text}"))))
    }

    /// All flags in all combinations: memory is believed after the resets that keep it, and no others.
    #[test]
    fn a_record_counts_after_a_reset_that_keeps_memory() {
        for bits in 0..16 {
            let flags = flags(bits);
            let cause = Cause::new(flags, Some(panic("at a.rs:1:2: x")), PROGRESS);
            let ended = matches!(cause, Cause::Ended(_));
            assert_eq!(ended, flags.software || flags.watchdog, "{flags:?}");
        }
    }

    #[test]
    fn without_a_record_the_flags_say_it() {
        let cause = |bits| Cause::new(flags(bits), None, PROGRESS).to_string();
        assert_eq!(cause(0), "reset pin");
        // Power-on sets the brown-out flag too.
        assert_eq!(cause(2 | 4), "power-on");
        assert_eq!(cause(4), "brown-out: the supply fell below 2.7 V");
        assert_eq!(cause(8), "restart by software");
        assert!(cause(1 | 2 | 4 | 8).starts_with("watchdog"));
    }

    #[test]
    fn the_watchdog_names_the_loop_that_stood_still() {
        let cause = |tick, outer| {
            let log = 456_789;
            Cause::Watchdog(Progress { tick, outer, log }).to_string()
        };
        let text = "watchdog: the outer loop stood still for 250 ms; tick 250, log at 456789 bytes";
        assert_eq!(cause(250, 0), text);
        assert!(cause(12_345, 12_341).contains("the inner loop stood still"));
        // Also where the count of ticks begins anew.
        assert!(cause(3, u32::MAX).contains("the inner loop"));
        assert!(cause(240, u32::MAX).contains("the outer loop"));
    }

    #[test]
    fn what_was_wanted_is_no_trouble_and_all_else_is() {
        let fault = Reason::Fault(Fault {
            frame: None,
            cfsr: 0,
            hfsr: 0,
            address: 0,
        });
        let wanted = [
            Cause::PowerOn,
            Cause::ResetPin,
            Cause::Ended(record(Reason::Restart)),
        ];
        for cause in wanted {
            assert!(!cause.is_trouble(), "{cause}");
        }
        let trouble = [panic("x"), record(fault)].map(Cause::Ended);
        let others = [Cause::BrownOut, Cause::Software, Cause::Watchdog(PROGRESS)];
        for cause in [&others[..], &trouble[..]].concat() {
            assert!(cause.is_trouble(), "{cause}");
        }
    }

    #[test]
    fn a_fault_says_where_in_what_how_far_and_with_which_registers() {
        let frame = Some(Frame {
            r: [1, 2, 3, 0x2000_0000],
            r12: 0xc,
            lr: 0x0801_2345,
            pc: 0x0801_2346,
            xpsr: 0x2100_0024,
        });
        let mut fault = Fault {
            frame,
            cfsr: 0x8200,
            hfsr: 0x4000_0000,
            address: 0xe000_0000,
        };
        assert_eq!(
            record(Reason::Fault(fault)).to_string(),
            "bus fault at 0x08012346; in the outer loop, tick 12345, log at 456789 bytes; cfsr 0x8200, \
             hfsr 0x40000000, address 0xe0000000, lr 0x8012345, r0 to r3 1 2 3 20000000, r12 c, xpsr 21000024"
        );
        (fault.frame, fault.cfsr) = (None, 0x1000);
        assert_eq!(
            record(Reason::Fault(fault)).to_string(),
            "stack overflow; in the outer loop, tick 12345, log at 456789 bytes; cfsr 0x1000, \
             hfsr 0x40000000"
        );
        for (cfsr, name) in [(1 << 25, "usage"), (1 << 1, "memory"), (0, "hard")] {
            (fault.frame, fault.cfsr) = (frame, cfsr);
            let text = record(Reason::Fault(fault)).to_string();
            assert!(text.starts_with(&format!("{name} fault at")), "{text}");
        }
    }

    /// A number that is cut is a wrong number.
    #[test]
    fn the_longest_texts_are_whole() {
        let most = u32::MAX;
        let fault = Reason::Fault(Fault {
            frame: Some(Frame {
                r: [most; 4],
                r12: most,
                lr: most,
                pc: most,
                xpsr: most,
            }),
            cfsr: 0xffff & !(1 << 4 | 1 << 12),
            hfsr: most,
            address: most,
        });
        let text = Text::message(format_args!("{:a<150}", ""));
        for reason in [fault, Reason::Panic(text)] {
            let record = Record {
                reason,
                task: Task::Interrupt(u16::MAX),
                progress: Progress {
                    tick: most,
                    outer: most,
                    log: most,
                },
            };
            let text = Cause::Ended(record).to_string();
            assert!(text.len() <= TEXT, "{} bytes: {text}", text.len());
        }
    }
}
