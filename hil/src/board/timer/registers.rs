//! A timer's registers. Which exist depends on the timer (RM0090 17.4, 18.4, 19.4, 20.4).

use super::super::refusal::{Answer, Refusal, misuse};
use super::{COMPARE_1, CR1_ARPE, CR1_CEN, CR1_UDIS, CR1_URS, Timer, UPDATE};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1C;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;
const RCR: u32 = 0x30;
const CCR1: u32 = 0x34;
const CCR4: u32 = 0x40;
const BDTR: u32 = 0x44;
const DCR: u32 = 0x48;
const DMAR: u32 = 0x4C;
const OR: u32 = 0x50;

/// DIR and CMS: counting down, or up and down.
const CR1_NOT_UP: u32 = 7 << 4;
const CR1_WRITABLE: u32 = 0x38F;
/// CCxS of both channels of a CCMR: a channel that is an input.
const CCMR_INPUTS: u32 = 0x0303;
/// OCxPE of the lower channel.
const CCMR_PRELOAD: u32 = 1 << 3;
/// SMS, and ECE.
const SMCR_SLAVE: u32 = 7 | 1 << 14;
/// Interrupts and DMA of trigger, break and commutation.
const DIER_UNMODELLED: u32 = 1 << 14 | 1 << 13 | 3 << 6 | 1 << 5;
/// BKE: the break input.
const BDTR_BREAK: u32 = 1 << 12;
const BDTR_DEAD_TIME: u32 = 0xFF;

impl Timer {
    fn exists(&self, offset: u32) -> bool {
        let (channels, advanced) = (self.kind.channels, self.kind.advanced);
        match offset {
            CR1 | DIER | SR | EGR | CNT | PSC | ARR => true,
            CR2 => channels != 1 && channels != 2,
            SMCR => channels >= 2,
            CCMR1 | CCER => channels > 0,
            CCMR2 | DCR | DMAR => channels == 4,
            CCR1..=CCR4 => ((offset - CCR1) / 4) < channels as u32,
            RCR | BDTR => advanced,
            OR => matches!(self.kind.name, "TIM2" | "TIM5" | "TIM11"),
            _ => false,
        }
    }

    pub(in super::super) fn read(&mut self, now: u64, offset: u32) -> Answer<u32> {
        if !self.exists(offset) {
            return Err(Refusal::Unknown);
        }
        self.catch_up(now);
        Ok(match offset {
            CR1 => self.control,
            CR2 => self.control_2,
            SMCR => self.slave_mode,
            DIER => self.requests,
            SR => self.status,
            CCMR1 | CCMR2 => self.modes[((offset - CCMR1) / 4) as usize],
            CCER => self.enables,
            CNT => self.counter.count(),
            PSC => self.prescaler,
            ARR => self.reload,
            CCR1..=CCR4 => self.compares[((offset - CCR1) / 4) as usize],
            BDTR => self.break_register,
            OR => self.options,
            _ => 0,
        })
    }

    pub(in super::super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        if !self.exists(offset) {
            return Err(Refusal::Unknown);
        }
        self.catch_up(now);
        match offset {
            CR1 => self.write_control(now, value)?,
            CR2 => self.control_2 = value,
            SMCR if value & SMCR_SLAVE != 0 => return misuse("slave modes are not modelled"),
            SMCR => self.slave_mode = value,
            DIER if value & DIER_UNMODELLED != 0 => {
                return misuse("requests of trigger, break and commutation are not modelled");
            }
            DIER => self.requests = value,
            SR => self.status &= value,
            EGR => self.generate(now, value)?,
            CCMR1 | CCMR2 => self.write_modes(offset, value)?,
            CCER => self.enables = value & 0xFFFF,
            CNT => self.counter.set_count(value),
            PSC => self.prescaler = value & 0xFFFF,
            ARR => self.write_reload(value),
            CCR1..=CCR4 => self.write_compare(((offset - CCR1) / 4) as usize, value),
            RCR if value & 0xFF != 0 => return misuse("the repetition counter is not modelled"),
            BDTR => self.write_break(value)?,
            DCR | DMAR if value != 0 => return misuse("DMA bursts are not modelled"),
            OR => self.options = value,
            _ => {}
        }
        Ok(())
    }

    fn write_control(&mut self, now: u64, value: u32) -> Answer<()> {
        if value & CR1_NOT_UP != 0 {
            return misuse("only counting up is modelled");
        }
        let starts = value & !self.control & CR1_CEN != 0;
        self.control = value & CR1_WRITABLE;
        if starts && self.counter.count() == 0 {
            self.began = Some(now);
        }
        Ok(())
    }

    /// EGR: events by software.
    fn generate(&mut self, now: u64, value: u32) -> Answer<()> {
        let compares = ((1 << self.kind.channels) - 1) * COMPARE_1;
        let known = UPDATE | compares;
        if value & 0xFF & !known != 0 {
            return misuse("EGR: trigger, break and commutation are not modelled");
        }
        self.flag(value & known & !UPDATE);
        if value & UPDATE == 0 {
            return Ok(());
        }
        self.counter.restart(now);
        self.began = Some(now);
        if self.control & CR1_UDIS == 0 {
            self.load();
            if self.control & CR1_URS == 0 {
                self.flag(UPDATE);
            }
        }
        Ok(())
    }

    fn write_modes(&mut self, offset: u32, value: u32) -> Answer<()> {
        if value & CCMR_INPUTS != 0 {
            return misuse("input capture is not modelled");
        }
        self.modes[((offset - CCMR1) / 4) as usize] = value & 0xFFFF;
        Ok(())
    }

    fn write_reload(&mut self, value: u32) {
        self.reload = value & self.kind.top;
        if self.control & CR1_ARPE == 0 {
            self.counter.set_reload(self.reload);
        }
    }

    fn write_compare(&mut self, channel: usize, value: u32) {
        let value = value & self.kind.top;
        self.compares[channel] = value;
        let preload = CCMR_PRELOAD << (8 * (channel % 2));
        if self.modes[channel / 2] & preload == 0 {
            self.counter.set_compare(channel, value);
        }
    }

    fn write_break(&mut self, value: u32) -> Answer<()> {
        if value & (BDTR_BREAK | BDTR_DEAD_TIME) != 0 {
            return misuse("break input and dead time are not modelled");
        }
        self.break_register = value & 0xFFFF;
        Ok(())
    }
}
