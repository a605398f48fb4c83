//! The clock tree (RM0090 7.2): how long one cycle of each bus takes.

use super::super::refusal::{Answer, misuse};
use crate::time::SECOND;

/// Ticks of virtual time in one cycle of the internal oscillator, 16 MHz.
pub(in super::super) const HSI_CYCLE: u64 = SECOND / 16_000_000;
/// Ticks of virtual time in one cycle of the boards' crystal, 8 MHz.
pub(in super::super) const HSE_CYCLE: u64 = SECOND / 8_000_000;
/// Ticks of virtual time in one cycle of the low-speed internal oscillator, 32 kHz.
pub(in super::super) const LSI_CYCLE: u64 = SECOND / 32_000;

/// Ticks of virtual time in one cycle of each clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Clocks {
    /// HCLK: processor, AHB, DMA.
    pub core: u64,
    /// PCLK1.
    pub apb1: u64,
    /// PCLK2.
    pub apb2: u64,
    /// The timers of APB1.
    pub apb1_timers: u64,
    /// The timers of APB2.
    pub apb2_timers: u64,
}

/// Fastest allowed clocks, as ticks in a cycle (datasheet table 14, range 1).
const CORE_FASTEST: u64 = SECOND / 168_000_000;
const APB1_FASTEST: u64 = SECOND / 42_000_000;
const APB2_FASTEST: u64 = SECOND / 84_000_000;
/// Fastest core with the regulator in scale 2 (datasheet table 14).
const SCALE_2_FASTEST_HZ: u64 = 144_000_000;
/// One more wait state is needed for each step of this (RM0090 table 10, 2.7 to 3.6 V).
const WAIT_STATE_STEP_HZ: u64 = 30_000_000;

impl Clocks {
    /// The buses' clocks from the system clock and the prescalers in `RCC_CFGR`.
    pub(in super::super) fn new(system: u64, configuration: u32) -> Self {
        let core = system * ahb_division((configuration >> 4) & 0xF);
        let (first, second) = (
            apb_division((configuration >> 10) & 0x7),
            apb_division((configuration >> 13) & 0x7),
        );
        Self {
            core,
            apb1: core * first,
            apb2: core * second,
            apb1_timers: timer_cycle(core, first),
            apb2_timers: timer_cycle(core, second),
        }
    }

    /// Refuses what the silicon is not specified for.
    pub(in super::super) fn check(&self, wait_states: u32, scale_1: bool) -> Answer<()> {
        for (name, cycle, fastest) in [
            ("HCLK", self.core, CORE_FASTEST),
            ("PCLK1", self.apb1, APB1_FASTEST),
            ("PCLK2", self.apb2, APB2_FASTEST),
        ] {
            if cycle < fastest {
                return misuse(format!(
                    "{name} of {} Hz is above {} Hz",
                    SECOND / cycle,
                    SECOND / fastest
                ));
            }
        }
        let hertz = SECOND / self.core;
        if !scale_1 && hertz > SCALE_2_FASTEST_HZ {
            return misuse(format!("HCLK of {hertz} Hz needs voltage scale 1 (PWR_CR.VOS)"));
        }
        if hertz > WAIT_STATE_STEP_HZ * u64::from(wait_states + 1) {
            return misuse(format!(
                "HCLK of {hertz} Hz needs more than {wait_states} flash wait states"
            ));
        }
        Ok(())
    }
}

/// HPRE. There is no division by 32.
fn ahb_division(bits: u32) -> u64 {
    match bits {
        0..8 => 1,
        8..12 => 2 << (bits - 8),
        _ => 4 << (bits - 8),
    }
}

/// PPRE1 and PPRE2.
fn apb_division(bits: u32) -> u64 {
    if bits < 4 { 1 } else { 2 << (bits - 4) }
}

/// A timer's clock is its bus's where that is not divided, and twice it otherwise.
fn timer_cycle(core: u64, division: u64) -> u64 {
    if division == 1 { core } else { core * division / 2 }
}

/// The main PLL's factors (RM0090 7.3.2).
pub(in super::super) struct Pll {
    /// Ticks in a cycle of its source.
    source_cycle: u64,
    input_division: u64,
    multiplication: u64,
    output_division: u64,
}

impl Pll {
    /// From `RCC_PLLCFGR`.
    pub(in super::super) fn new(bits: u32) -> Self {
        Self {
            source_cycle: if bits & (1 << 22) != 0 {
                HSE_CYCLE
            } else {
                HSI_CYCLE
            },
            input_division: u64::from(bits & 0x3F),
            multiplication: u64::from((bits >> 6) & 0x1FF),
            output_division: 2 * (1 + u64::from((bits >> 16) & 3)),
        }
    }

    /// Whether it runs from the crystal.
    pub(in super::super) fn runs_from_crystal(&self) -> bool {
        self.source_cycle == HSE_CYCLE
    }

    /// Ticks in a cycle of its output, if the factors are within what the manual allows.
    pub(in super::super) fn output_cycle(&self) -> Answer<u64> {
        let (m, n, p) = (self.input_division, self.multiplication, self.output_division);
        if m < 2 || !(50..=432).contains(&n) {
            return misuse(format!("PLLM = {m}, PLLN = {n} are not allowed"));
        }
        let source = SECOND / self.source_cycle;
        if !(950_000 * m..=2_100_000 * m).contains(&source) {
            return misuse(format!("the PLL's input of {} Hz is not 1 to 2 MHz", source / m));
        }
        let oscillator = source * n / m;
        if !(100_000_000..=432_000_000).contains(&oscillator) {
            return misuse(format!("the PLL's VCO at {oscillator} Hz is not 100 to 432 MHz"));
        }
        let ticks = self.source_cycle * m * p;
        if !ticks.is_multiple_of(n) {
            return misuse(format!(
                "the PLL's output of {} Hz is no whole number of the emulator's ticks of {SECOND} Hz",
                oscillator / p
            ));
        }
        Ok(ticks / n)
    }
}
