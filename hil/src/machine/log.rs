//! Takes the program's log out of its memory as a probe would: at intervals, without its notice.

use super::Machine;
use super::bus::Bus;
use super::system::CoreMemory;
use crate::elf::Elf;
use crate::rtt::Rtt;
use crate::time::{MICROSECOND, NEVER};

const INTERVAL: u64 = 1_000 * MICROSECOND;

/// Bytes of the log, and when they were taken.
pub type LogChunk = (u64, Vec<u8>);

/// What has been taken, and when to take more.
#[derive(Debug)]
pub(super) struct LogTap {
    rtt: Option<Rtt>,
    due: u64,
    chunks: Vec<LogChunk>,
}

impl LogTap {
    pub fn new(elf: &Elf) -> Self {
        let rtt = Rtt::find(elf);
        Self {
            rtt,
            due: if rtt.is_some() { 0 } else { NEVER },
            chunks: Vec::new(),
        }
    }

    pub fn due(&self) -> u64 {
        self.due
    }
}

impl<B: Bus + 'static> Machine<B> {
    /// The log since the last time. Those of several boots are separated by a zero.
    pub fn take_log(&mut self) -> Vec<LogChunk> {
        self.drain_log();
        std::mem::take(&mut self.log.chunks)
    }

    /// Takes what waits if it is time to.
    pub(super) fn tap_log(&mut self) {
        if self.now() >= self.log.due {
            self.drain_log();
            self.log.due = (self.now() / INTERVAL + 1) * INTERVAL;
        }
    }

    /// A reset cuts the log: what was written before it is taken, and ends.
    pub(super) fn cut_log(&mut self) {
        if self.log.rtt.is_some() {
            self.drain_log();
            self.log.chunks.push((self.now(), vec![0]));
        }
    }

    fn drain_log(&mut self) {
        let Some(rtt) = self.log.rtt else { return };
        let mut flash_writes = Vec::new();
        let bytes = rtt.drain(&mut CoreMemory {
            core: &mut self.core,
            flash_writes: &mut flash_writes,
        });
        if !bytes.is_empty() {
            self.log.chunks.push((self.now(), bytes));
        }
    }
}
