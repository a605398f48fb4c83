//! How the processor's time is spent.

use super::bus::Bus;
use super::nvic::EXCEPTIONS;
use super::{Machine, State};

/// Ticks of virtual time by what they were spent for. By the cost model, so an estimate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Load {
    by_exception: [u64; EXCEPTIONS],
    /// In sleep.
    pub asleep: u64,
    /// In lockup.
    pub locked_up: u64,
    accounted: u64,
}

impl Default for Load {
    fn default() -> Self {
        Self {
            by_exception: [0; EXCEPTIONS],
            asleep: 0,
            locked_up: 0,
            accounted: 0,
        }
    }
}

impl Load {
    /// In the handler of an exception without those that preempted it; of 0, in thread mode awake.
    pub fn exception(&self, number: usize) -> u64 {
        self.by_exception.get(number).copied().unwrap_or(0)
    }

    /// All of it.
    pub fn total(&self) -> u64 {
        self.by_exception.iter().sum::<u64>() + self.asleep + self.locked_up
    }

    /// What was spent since an earlier load of the same machine.
    pub fn since(&self, earlier: &Self) -> Self {
        let mut by_exception = self.by_exception;
        for (now, then) in by_exception.iter_mut().zip(earlier.by_exception) {
            *now -= then;
        }
        Self {
            by_exception,
            asleep: self.asleep - earlier.asleep,
            locked_up: self.locked_up - earlier.locked_up,
            accounted: self.accounted,
        }
    }
}

impl<B: Bus + 'static> Machine<B> {
    /// Time since the last call goes to what the processor did until now.
    pub(super) fn account(&mut self) {
        let now = self.now();
        let spent = now - std::mem::replace(&mut self.load.accounted, now);
        match self.state {
            State::Running => self.load.by_exception[self.current] += spent,
            State::AsleepForInterrupt | State::AsleepForEvent => self.load.asleep += spent,
            State::Lockup => self.load.locked_up += spent,
        }
    }
}
