//! The independent watchdog (RM0090 chapter 21).

use super::rcc::clocks::LSI_CYCLE;
use super::refusal::{Answer, Refusal, misuse};
use crate::time::NEVER;

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0C;

const KEY_RELOAD: u32 = 0xAAAA;
const KEY_ENABLE_ACCESS: u32 = 0x5555;
const KEY_START: u32 = 0xCCCC;

const SR_PVU: u32 = 1 << 0;
const SR_RVU: u32 = 1 << 1;

const RELOAD_RESET: u32 = 0xFFF;
/// A new prescaler or reload value takes up to five cycles of the oscillator to arrive.
const UPDATE_TIME: u64 = 5 * LSI_CYCLE;

pub(super) struct Iwdg {
    prescaler: u32,
    reload: u32,
    writable: bool,
    running: bool,
    /// When it will reset the microcontroller.
    expiry: u64,
    /// When the prescaler and the reload value last written will have arrived.
    prescaler_arrives: u64,
    reload_arrives: u64,
}

impl Iwdg {
    pub(super) fn new() -> Self {
        Self {
            prescaler: 0,
            reload: RELOAD_RESET,
            writable: false,
            running: false,
            expiry: NEVER,
            prescaler_arrives: 0,
            reload_arrives: 0,
        }
    }

    pub(super) fn running(&self) -> bool {
        self.running
    }

    pub(super) fn next_event(&self) -> u64 {
        self.expiry
    }

    /// Whether it expires now. It does so once.
    pub(super) fn expires(&mut self, now: u64) -> bool {
        let expires = self.expiry <= now;
        if expires {
            self.expiry = NEVER;
        }
        expires
    }

    pub(super) fn read(&self, now: u64, offset: u32) -> Answer<u32> {
        let flag = |arrives: u64, bit: u32| if now < arrives { bit } else { 0 };
        Ok(match offset {
            KR => 0,
            PR => self.prescaler,
            RLR => self.reload,
            SR => flag(self.prescaler_arrives, SR_PVU) | flag(self.reload_arrives, SR_RVU),
            _ => return Err(Refusal::Unknown),
        })
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        match offset {
            KR => {
                self.write_key(now, value & 0xFFFF);
                Ok(())
            }
            PR | RLR if !self.writable => misuse("PR or RLR is written without the key 0x5555"),
            PR if now < self.prescaler_arrives => misuse("PR is written while PVU is set"),
            RLR if now < self.reload_arrives => misuse("RLR is written while RVU is set"),
            PR => {
                self.prescaler = value & 7;
                self.prescaler_arrives = now + UPDATE_TIME;
                Ok(())
            }
            RLR => {
                self.reload = value & 0xFFF;
                self.reload_arrives = now + UPDATE_TIME;
                Ok(())
            }
            _ => Err(Refusal::Unknown),
        }
    }

    fn write_key(&mut self, now: u64, key: u32) {
        self.writable = key == KEY_ENABLE_ACCESS;
        match key {
            KEY_START if !self.running => {
                self.running = true;
                self.count_down(now, RELOAD_RESET);
            }
            KEY_RELOAD if self.running => self.count_down(now, self.reload),
            _ => {}
        }
    }

    fn count_down(&mut self, now: u64, from: u32) {
        let division = 4 << self.prescaler.min(6);
        self.expiry = now + u64::from(from) * division * LSI_CYCLE;
    }
}
