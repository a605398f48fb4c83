//! Reset and clock control (RM0090 chapter 7).

pub(super) mod clocks;
mod gates;
mod oscillator;

use super::ResetCause;
use super::map::Bus;
use super::refusal::{Answer, misuse};
use clocks::{Clocks, HSE_CYCLE, HSI_CYCLE, Pll};
use gates::Gates;
use oscillator::{HSE, HSI, LSE, LSI, Oscillators, PLL, PLLI2S};

const CR: u32 = 0x00;
const PLLCFGR: u32 = 0x04;
const CFGR: u32 = 0x08;
const CIR: u32 = 0x0C;
const BDCR: u32 = 0x70;
const CSR: u32 = 0x74;
const SSCGR: u32 = 0x80;
const PLLI2SCFGR: u32 = 0x84;
/// The F405 has no such register, but embassy-stm32 0.6 writes zero to it. Reserved, it reads as zero.
const DCKCFGR: u32 = 0x8C;

const CR_HSEBYP: u32 = 1 << 18;
/// Bits of CR that only keep what is written: HSITRIM, CSSON.
const CR_PLAIN: u32 = 0x1F << 3 | 1 << 19;
/// The oscillators of CR with the bit that switches each on; the next one says that it is ready.
const CR_SWITCHES: [(usize, u32); 4] = [(HSI, 1 << 0), (HSE, 1 << 16), (PLL, 1 << 24), (PLLI2S, 1 << 26)];

const BDCR_LSEON: u32 = 1 << 0;
const BDCR_LSERDY: u32 = 1 << 1;
const BDCR_PLAIN: u32 = 1 << 2 | 3 << 8 | 1 << 15;
const BDCR_RTCSEL: u32 = 3 << 8;
const BDCR_BDRST: u32 = 1 << 16;

const CSR_LSION: u32 = 1 << 0;
const CSR_LSIRDY: u32 = 1 << 1;
const CSR_RMVF: u32 = 1 << 24;
const CSR_BORRSTF: u32 = 1 << 25;
const CSR_PINRSTF: u32 = 1 << 26;
const CSR_PORRSTF: u32 = 1 << 27;
const CSR_SFTRSTF: u32 = 1 << 28;
const CSR_IWDGRSTF: u32 = 1 << 29;

const PLLCFGR_RESET: u32 = 0x2400_3010;
const PLLCFGR_WRITABLE: u32 = 0x0F43_7FFF;
/// A reserved bit that reads as one.
const PLLCFGR_RESERVED: u32 = 0x2000_0000;
const PLLI2SCFGR_RESET: u32 = 0x2000_3000;
const HSITRIM_RESET: u32 = 0x80;

/// SW and SWS.
const FROM_HSI: u32 = 0;
const FROM_HSE: u32 = 1;
const FROM_PLL: u32 = 2;

pub(super) const INTERRUPT: u32 = 5;

pub(super) struct Rcc {
    oscillators: Oscillators,
    control: u32,
    pll: u32,
    configuration: u32,
    /// What the system clock really comes from: SWS.
    source: u32,
    interrupts: u32,
    /// Resets and clock gates of the peripherals.
    pub gates: Gates,
    backup_domain: u32,
    reset_flags: u32,
    spread_spectrum: u32,
    pll_i2s: u32,
    clocks: Clocks,
}

impl Rcc {
    pub(super) fn new() -> Self {
        Self {
            oscillators: Oscillators::new(),
            control: HSITRIM_RESET,
            pll: PLLCFGR_RESET,
            configuration: 0,
            source: FROM_HSI,
            interrupts: 0,
            gates: Gates::new(),
            backup_domain: 0,
            reset_flags: CSR_BORRSTF | CSR_PINRSTF | CSR_PORRSTF,
            spread_spectrum: 0,
            pll_i2s: PLLI2SCFGR_RESET,
            clocks: Clocks::new(HSI_CYCLE, 0),
        }
    }

    /// A reset that leaves the power on: flags stay until the firmware removes them, and the backup
    /// domain is not touched. Every reset pulls NRST low, and so sets its flag too.
    pub(super) fn reset(&mut self, cause: ResetCause) {
        let flags = CSR_PINRSTF
            | match cause {
                ResetCause::PowerOn => CSR_PORRSTF | CSR_BORRSTF,
                ResetCause::Pin => 0,
                ResetCause::Software => CSR_SFTRSTF,
                ResetCause::IndependentWatchdog => CSR_IWDGRSTF,
            };
        let mut next = Self::new();
        if cause != ResetCause::PowerOn {
            next.reset_flags = self.reset_flags | flags;
            next.backup_domain = self.backup_domain;
            next.oscillators.keep(LSE, &self.oscillators);
        }
        *self = next;
    }

    pub(super) fn clocks(&self) -> Clocks {
        self.clocks
    }

    pub(super) fn enabled(&self, (bus, bit): (Bus, u32)) -> bool {
        self.gates.enables[bus as usize] & (1 << bit) != 0
    }

    pub(super) fn held_in_reset(&self, (bus, bit): (Bus, u32)) -> bool {
        self.gates.resets[bus as usize] & (1 << bit) != 0
    }

    /// The independent watchdog switches its oscillator on and keeps it on (RM0090 7.2.5).
    pub(super) fn start_lsi(&mut self, now: u64) {
        self.oscillators.switch(LSI, true, now);
    }

    pub(super) fn next_event(&self) -> u64 {
        self.oscillators.next_event()
    }

    /// The request line of RCC's interrupt.
    pub(super) fn interrupt(&self) -> bool {
        self.interrupts & (self.interrupts >> 8) & 0x3F != 0
    }

    /// Oscillators become ready; a switch that waited for one happens.
    pub(super) fn advance(&mut self, now: u64) -> Answer<()> {
        let became_ready = self.oscillators.advance(now);
        self.interrupts |= became_ready & (self.interrupts >> 8);
        self.switch_if_ready()
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            CR => {
                let mut value = self.control;
                for (oscillator, switch) in CR_SWITCHES {
                    value |= if self.oscillators.on(oscillator) {
                        switch
                    } else {
                        0
                    };
                    value |= if self.oscillators.ready(oscillator) {
                        switch << 1
                    } else {
                        0
                    };
                }
                value
            }
            PLLCFGR => self.pll,
            CFGR => self.configuration | self.source << 2,
            CIR => self.interrupts,
            BDCR => {
                let flag = |set: bool, bit: u32| if set { bit } else { 0 };
                self.backup_domain
                    | flag(self.oscillators.on(LSE), BDCR_LSEON)
                    | flag(self.oscillators.ready(LSE), BDCR_LSERDY)
            }
            CSR => {
                let flag = |set: bool, bit: u32| if set { bit } else { 0 };
                self.reset_flags
                    | flag(self.oscillators.on(LSI), CSR_LSION)
                    | flag(self.oscillators.ready(LSI), CSR_LSIRDY)
            }
            SSCGR => self.spread_spectrum,
            PLLI2SCFGR => self.pll_i2s,
            DCKCFGR => 0,
            _ => return self.gates.read(offset),
        })
    }

    /// `backup_writable` is `PWR_CR.DBP`.
    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32, backup_writable: bool) -> Answer<()> {
        match offset {
            CR => self.write_control(now, value)?,
            PLLCFGR if self.oscillators.on(PLL) => {
                return misuse("PLLCFGR is written while the PLL is on");
            }
            PLLCFGR => self.pll = value & PLLCFGR_WRITABLE | PLLCFGR_RESERVED,
            CFGR => {
                self.configuration = value & !(3 << 2);
                return self.switch_if_ready();
            }
            CIR => {
                let cleared = (value >> 16) & 0xBF;
                self.interrupts = (self.interrupts & 0xBF & !cleared) | (value & 0x3F00);
            }
            BDCR if !backup_writable => {
                return misuse("BDCR is written while PWR_CR.DBP protects the backup domain");
            }
            BDCR => self.write_backup_domain(now, value),
            CSR => {
                self.oscillators.switch(LSI, value & CSR_LSION != 0, now);
                if value & CSR_RMVF != 0 {
                    self.reset_flags = 0;
                }
            }
            SSCGR => self.spread_spectrum = value,
            PLLI2SCFGR => self.pll_i2s = value,
            DCKCFGR if value == 0 => {}
            _ => return self.gates.write(offset, value),
        }
        Ok(())
    }

    fn write_control(&mut self, now: u64, value: u32) -> Answer<()> {
        if value & CR_HSEBYP != 0 {
            return misuse("HSEBYP wants an external clock, but the boards have a crystal");
        }
        for (oscillator, switch) in CR_SWITCHES {
            let on = value & switch != 0;
            if !on && self.in_use(oscillator) {
                return misuse(format!(
                    "CR switches {} off while the system clock needs it",
                    oscillator::NAMES[oscillator]
                ));
            }
            if oscillator == PLL && on && !self.oscillators.on(PLL) {
                self.check_pll()?;
            }
            self.oscillators.switch(oscillator, on, now);
        }
        self.control = value & CR_PLAIN;
        Ok(())
    }

    fn check_pll(&self) -> Answer<()> {
        let pll = Pll::new(self.pll);
        let source = if pll.runs_from_crystal() { HSE } else { HSI };
        if !self.oscillators.ready(source) {
            return misuse("the PLL is switched on before its source is ready");
        }
        pll.output_cycle().map(|_| ())
    }

    fn in_use(&self, oscillator: usize) -> bool {
        let through_pll = self.source == FROM_PLL;
        match oscillator {
            HSI => self.source == FROM_HSI || through_pll && !Pll::new(self.pll).runs_from_crystal(),
            HSE => self.source == FROM_HSE || through_pll && Pll::new(self.pll).runs_from_crystal(),
            PLL => through_pll,
            _ => false,
        }
    }

    fn write_backup_domain(&mut self, now: u64, value: u32) {
        if value & BDCR_BDRST != 0 {
            self.oscillators.switch(LSE, false, now);
            self.backup_domain = BDCR_BDRST;
            return;
        }
        self.oscillators.switch(LSE, value & BDCR_LSEON != 0, now);
        // embassy-stm32 0.6 writes its default of zero over the source that it chose: no effect.
        let chosen = self.backup_domain & BDCR_RTCSEL;
        let source = if chosen == 0 { value & BDCR_RTCSEL } else { chosen };
        self.backup_domain = value & BDCR_PLAIN & !BDCR_RTCSEL | source;
    }

    /// Takes the clock source that SW asks for, once it is ready, and the prescalers.
    fn switch_if_ready(&mut self) -> Answer<()> {
        let wanted = self.configuration & 3;
        let oscillator = match wanted {
            FROM_HSI => HSI,
            FROM_HSE => HSE,
            FROM_PLL => PLL,
            _ => return misuse("CFGR.SW = 3 is not allowed"),
        };
        if self.oscillators.ready(oscillator) {
            self.source = wanted;
        }
        let system = match self.source {
            FROM_HSI => HSI_CYCLE,
            FROM_HSE => HSE_CYCLE,
            _ => Pll::new(self.pll).output_cycle()?,
        };
        self.clocks = Clocks::new(system, self.configuration);
        Ok(())
    }
}
