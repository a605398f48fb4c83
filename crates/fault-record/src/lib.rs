//! What a run of the firmware leaves behind for the next start, in memory that a reset does not clear.
//!
//! A fault handler makes a [`Record`] and packs it into words; the next start unpacks it and, with the
//! hardware's flags, knows the [`Cause`] of the start. A watchdog runs no handler: of it speaks the
//! [`Progress`] that the loops keep up to date.
//!
//! Everything here is data to data: where the words lie and who reads the registers is the firmware's.
#![cfg_attr(not(test), no_std)]

mod cause;
mod packed;

use core::fmt::{self, Display, Write};

use heapless::String;

pub use cause::{Cause, Flags};
pub use packed::Packed;

/// Bytes of a panic's text that are kept.
pub const MESSAGE: usize = 120;

/// Bytes of the longest text of a cause.
pub const TEXT: usize = 240;

/// Text that ends where it is full.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text(String<TEXT>);

impl Text {
    /// What `text` says, as far as it fits.
    pub fn new(text: fmt::Arguments<'_>) -> Self {
        Self::within(TEXT, text)
    }

    /// The same for a panic's message, of which less is kept.
    pub fn message(text: fmt::Arguments<'_>) -> Self {
        Self::within(MESSAGE, text)
    }

    #[inline(never)]
    fn within(most: usize, text: fmt::Arguments<'_>) -> Self {
        let mut within = Within(Self::default(), most);
        let _ = within.write_fmt(text);
        within.0
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// A text, and how long it may be.
struct Within(Text, usize);

impl Write for Within {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let Self(Text(kept), most) = self;
        let fits = text.floor_char_boundary(most.saturating_sub(kept.len()));
        let (fitting, rest) = text.split_at_checked(fits).unwrap_or_default();
        let taken = kept.push_str(fitting);
        if rest.is_empty() {
            taken.map_err(|_| fmt::Error)
        } else {
            Err(fmt::Error)
        }
    }
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Ticks of the inner loop: the tick of the log's last period is at most this.
    pub tick: u32,
    /// What `tick` was when the last outer step ended.
    pub outer: u32,
    /// Bytes of the log that were handed to its port. What was logged later is lost.
    pub log: u32,
}

impl Display for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tick {}, log at {} bytes", self.tick, self.log)
    }
}

/// What ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The thread: ground link, log, health.
    Thread,
    /// The inner loop.
    Inner,
    /// The outer loop.
    Outer,
    /// The log on its way out.
    Log,
    /// An interrupt, by its number in the vector table's device part.
    Interrupt(u16),
}

impl Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Thread => f.write_str("in the thread"),
            Self::Inner => f.write_str("in the inner loop"),
            Self::Outer => f.write_str("in the outer loop"),
            Self::Log => f.write_str("in the log"),
            Self::Interrupt(number) => write!(f, "in interrupt {number}"),
        }
    }
}

/// Of the active interrupts, a bit each, the one that runs: it has the smallest priority, or it could
/// not have interrupted the others.
#[inline(never)]
pub fn most_urgent(active: &[u32], priority: &dyn Fn(u16) -> u8) -> Option<u16> {
    let is_active = |number: &u16| {
        let word = active.get(usize::from(number / 32));
        word.is_some_and(|word| word >> (number % 32) & 1 != 0)
    };
    let numbers = 0..(32 * active.len()) as u16;
    numbers.filter(is_active).min_by_key(|number| priority(*number))
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reason {
    /// A panic: its place and message, by [`Text::message`].
    Panic(Text),
    /// A fault of the processor.
    Fault(Fault),
    /// A restart that was asked for.
    Restart,
}

/// A fault of the processor: the registers that tell about it (Armv7-M, B3.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What the processor put on the stack; `None` where it could not.
    pub frame: Option<Frame>,
    /// Configurable fault status.
    pub cfsr: u32,
    /// HardFault status.
    pub hfsr: u32,
    /// The address of a bus or memory fault, where `cfsr` says that it is valid.
    pub address: u32,
}

/// A basic exception frame, in its order on the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// R0 to R3.
    pub r: [u32; 4],
    /// R12.
    pub r12: u32,
    /// The link register: where the function returns to.
    pub lr: u32,
    /// The instruction.
    pub pc: u32,
    /// The program status.
    pub xpsr: u32,
}

/// CFSR: MSTKERR and STKERR, no frame could be stacked.
const STACKING: u32 = 1 << 4 | 1 << 12;

/// CFSR: MMARVALID and BFARVALID, the address is valid.
const ADDRESS: u32 = 1 << 7 | 1 << 15;

impl Fault {
    /// Whether the frame could be stacked, by this CFSR.
    pub fn is_stacked(cfsr: u32) -> bool {
        cfsr & STACKING == 0
    }

    fn name(&self) -> &'static str {
        match self.cfsr {
            _ if self.frame.is_none() => "stack overflow",
            cfsr if cfsr & 0xffff_0000 != 0 => "usage fault",
            cfsr if cfsr & 0x0000_ff00 != 0 => "bus fault",
            cfsr if cfsr & 0x0000_00ff != 0 => "memory fault",
            _ => "hard fault",
        }
    }

    /// The registers besides the instruction's address.
    fn registers(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cfsr {:#x}, hfsr {:#x}", self.cfsr, self.hfsr)?;
        if self.cfsr & ADDRESS != 0 {
            write!(f, ", address {:#x}", self.address)?;
        }
        if let Some(frame) = &self.frame {
            let [a, b, c, d] = frame.r;
            write!(f, ", lr {:#x}, r0 to r3 {a:x} {b:x} {c:x} {d:x}", frame.lr)?;
            write!(f, ", r12 {:x}, xpsr {:x}", frame.r12, frame.xpsr)?;
        }
        Ok(())
    }
}

/// What a run leaves behind when it ends on purpose or in a fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Record {
    /// Why it ended.
    pub reason: Reason,
    /// What ran then.
    pub task: Task,
    /// How far it had come.
    pub progress: Progress,
}

impl Display for Record {
    /// The worst first: what does not fit is cut.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { task, progress, .. } = self;
        match &self.reason {
            Reason::Panic(text) => write!(f, "panic {}; {task}, {progress}", text.as_str()),
            Reason::Fault(fault) => {
                f.write_str(fault.name())?;
                if let Some(frame) = &fault.frame {
                    write!(f, " at {:#010x}", frame.pc)?;
                }
                write!(f, "; {task}, {progress}; ")?;
                fault.registers(f)
            }
            Reason::Restart => f.write_str("restart by command"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever is active on one another, the last one to interrupt is named.
    #[test]
    fn the_interrupt_that_runs_is_the_most_urgent_one() {
        let priority = |number: u16| match number {
            19 => 0x40,
            20 => 0x80,
            37 => 0x60,
            _ => 0,
        };
        let running = |numbers: &[u16]| {
            let mut active = [0; 3];
            for number in numbers {
                active[usize::from(number / 32)] |= 1 << (number % 32);
            }
            most_urgent(&active, &priority)
        };
        assert_eq!(running(&[]), None);
        assert_eq!(running(&[20]), Some(20));
        assert_eq!(running(&[20, 19]), Some(19));
        assert_eq!(running(&[20, 37]), Some(37));
        assert_eq!(running(&[20, 37, 19, 81]), Some(81));
        assert_eq!(most_urgent(&[], &priority), None);
    }
}
