//! The pin INT1: how an interrupt shows on it.

use std::collections::VecDeque;

use super::NEVER;
use super::clock::Clock;
use super::registers::{INT_CONFIG, INT_CONFIG1, INT_SOURCE0, Registers};

/// In INT_CONFIG.
const ACTIVE_HIGH: u8 = 1 << 0;
const PUSH_PULL: u8 = 1 << 1;
const LATCHED: u8 = 1 << 2;
/// In INT_CONFIG1.
const ASYNC_RESET: u8 = 1 << 4;
const REST_DISABLED: u8 = 1 << 5;
const SHORT_PULSE: u8 = 1 << 6;
/// In INT_SOURCE0.
const DATA_READY: u8 = 1 << 3;

/// Pulse and rest in µs (data sheet, INT_CONFIG1).
const LONG_US: u64 = 100;
const SHORT_US: u64 = 8;

/// INT1 and the wire at it. A pin that is released, and a wire that is broken, read low.
#[derive(Clone, Debug)]
pub(super) struct Int1 {
    config: u8,
    timing: u8,
    source: u8,
    asserted: bool,
    /// When the pulse ends.
    fall: u64,
    /// Until when the pin rests after a pulse.
    rest: u64,
    pub connected: bool,
    level: bool,
    changes: VecDeque<(u64, bool)>,
}

impl Int1 {
    pub fn new(registers: &Registers) -> Self {
        let mut int1 = Self {
            config: 0,
            timing: 0,
            source: 0,
            asserted: false,
            fall: NEVER,
            rest: 0,
            connected: true,
            level: false,
            changes: VecDeque::new(),
        };
        int1.configure(0, registers);
        int1
    }

    /// Takes over what the registers say.
    pub fn configure(&mut self, now: u64, registers: &Registers) {
        self.config = registers.get(INT_CONFIG);
        self.timing = registers.get(INT_CONFIG1);
        self.source = registers.get(INT_SOURCE0);
        self.update(now);
    }

    /// Back to rest: the part was reset or lost its power.
    pub fn reset(&mut self, now: u64, registers: &Registers) {
        self.asserted = false;
        self.fall = NEVER;
        self.rest = 0;
        self.configure(now, registers);
    }

    /// A sample is ready. While INT_ASYNC_RESET is set nothing reaches the pin: what silicon
    /// does then the data sheet does not say, only that it is not proper. A pulse that would
    /// begin before the last one and its rest are over is lost.
    pub fn data_ready(&mut self, now: u64, clock: &Clock) {
        if self.source & DATA_READY == 0 || self.timing & ASYNC_RESET != 0 {
            return;
        }
        if self.config & LATCHED == 0 {
            if self.asserted || now < self.rest {
                return;
            }
            let short = self.timing & SHORT_PULSE != 0;
            self.fall = now + clock.microseconds(if short { SHORT_US } else { LONG_US });
        }
        self.asserted = true;
        self.update(now);
    }

    /// The cause was read, so that a latched pin is released.
    pub fn cleared(&mut self, now: u64) {
        if self.config & LATCHED != 0 {
            self.asserted = false;
            self.update(now);
        }
    }

    /// When the pulse ends.
    pub fn fall(&self) -> u64 {
        self.fall
    }

    /// Ends the pulse, at the time it should.
    pub fn end_pulse(&mut self, clock: &Clock) {
        let now = self.fall;
        self.fall = NEVER;
        if self.timing & REST_DISABLED == 0 {
            self.rest = now + clock.microseconds(LONG_US);
        }
        self.asserted = false;
        self.update(now);
    }

    /// Sets the level that follows from everything.
    pub fn update(&mut self, now: u64) {
        let driven = self.config & PUSH_PULL != 0 && self.connected;
        let level = driven && self.asserted == (self.config & ACTIVE_HIGH != 0);
        if level != self.level {
            self.level = level;
            self.changes.push_back((now, level));
        }
    }

    /// The level of the pin.
    pub fn level(&self) -> bool {
        self.level
    }

    /// When the oldest change was that has not been told.
    pub fn untold(&self) -> Option<u64> {
        self.changes.front().map(|(time, _)| *time)
    }

    /// The oldest change that has not been told.
    pub fn tell(&mut self) -> Option<(u64, bool)> {
        self.changes.pop_front()
    }
}
