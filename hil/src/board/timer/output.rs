//! What a timer's outputs do in a period (RM0090 17.3.9 and 17.3.12, tables 101 and 102).

use super::super::refusal::{Answer, misuse};
use super::super::wiring::PwmPulse;
use super::Timer;

/// In CCER, for the first channel: enable and polarity of the output, and of its complement. Each
/// further channel's lie four bits above.
const CCE: u32 = 1 << 0;
const CCP: u32 = 1 << 1;
const CCNE: u32 = 1 << 2;
const CCNP: u32 = 1 << 3;
/// MOE in BDTR.
const MAIN_OUTPUT: u32 = 1 << 15;

/// OCxM.
const FORCE_INACTIVE: u32 = 4;
const FORCE_ACTIVE: u32 = 5;
const PWM_1: u32 = 6;
const PWM_2: u32 = 7;

impl Timer {
    /// Whether any output is switched on.
    pub(super) fn has_outputs(&self) -> bool {
        self.enables & 0x5555 != 0 && self.main_output()
    }

    fn main_output(&self) -> bool {
        !self.kind.advanced || self.break_register & MAIN_OUTPUT != 0
    }

    /// Whether a period begins now. It says so once.
    pub(in super::super) fn take_beginning(&mut self, now: u64) -> bool {
        self.began.take() == Some(now)
    }

    /// The outputs that give something: their channels, and whether it is the complement.
    pub(in super::super) fn active_outputs(&self) -> impl Iterator<Item = (u8, bool)> + '_ {
        let channels = if self.running() { self.kind.channels } else { 0 };
        (0..channels as u8)
            .flat_map(|channel| [(channel, false), (channel, true)])
            .filter(|(channel, complement)| self.gives(*channel, *complement))
    }

    fn gives(&self, channel: u8, complement: bool) -> bool {
        let enable = if complement { CCNE } else { CCE };
        let exists = !complement || self.kind.advanced && channel < 3;
        exists && self.main_output() && self.enables & enable << (4 * channel) != 0
    }

    /// Whether an output gives pulses.
    pub(in super::super) fn pulses(&self, channel: u8, complement: bool) -> bool {
        self.running() && self.counter.period().is_some() && self.gives(channel, complement)
    }

    /// The pulse of an output in the period that begins; none if the counter stands still.
    pub(in super::super) fn pulse(&self, channel: u8, complement: bool) -> Answer<Option<PwmPulse>> {
        let (Some(period), Some(compare)) = (
            self.counter.period(),
            self.counter.compare_time(usize::from(channel)),
        ) else {
            return Ok(None);
        };
        let channel_index = usize::from(channel);
        let mode = self.modes[channel_index / 2] >> (8 * (channel_index % 2) + 4) & 7;
        let active = match mode {
            PWM_1 => compare,
            PWM_2 => period - compare,
            FORCE_INACTIVE => 0,
            FORCE_ACTIVE => period,
            _ => {
                return misuse(format!(
                    "output mode {mode} of channel {} is not modelled",
                    channel + 1
                ));
            }
        };
        let inverted = self.inverted(channel, complement);
        Ok(Some(PwmPulse {
            high: if inverted { period - active } else { active },
            period,
        }))
    }

    /// A complement alone follows the reference; beside its output it is the reference inverted.
    fn inverted(&self, channel: u8, complement: bool) -> bool {
        let bits = self.enables >> (4 * channel);
        if complement {
            (bits & CCE != 0) ^ (bits & CCNP != 0)
        } else {
            bits & CCP != 0
        }
    }
}
