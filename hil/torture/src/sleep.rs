//! Sleep and what ends it, and the counters of time.

use crate::handlers::{self, total};
use crate::tester;
use core::arch::asm;
use core::sync::atomic::Ordering::Relaxed;
use cortex_m::Peripherals;
use cortex_m::peripheral::{DWT, SYST, syst::SystClkSource};

fn peripherals() -> Peripherals {
    // SAFETY: this program is the only one here.
    unsafe { Peripherals::steal() }
}

pub fn wfi() {
    tester::storm(10_000);
    let mut woke = 0;
    for _ in 0..1000 {
        cortex_m::asm::wfi();
        woke += 1;
    }
    tester::storm(0);
    tester::report(woke);
    tester::report(total());
}

/// Counts SysTick down from a large value: cycles that pass, asleep or not.
fn start_stopwatch(systick: &mut SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(0x00FF_FFFF);
    systick.clear_current();
    systick.enable_counter();
}

fn lap() -> u32 {
    0x00FF_FFFF - SYST::get_current()
}

pub fn wfe() {
    let mut systick = peripherals().SYST;
    start_stopwatch(&mut systick);
    cortex_m::asm::sev();
    cortex_m::asm::wfe();
    tester::report(lap());
    tester::raise_later(0);
    cortex_m::asm::wfe();
    tester::report(lap());
    tester::report(total());
}

pub fn wfi_primask() {
    cortex_m::interrupt::disable();
    tester::raise_later(0);
    cortex_m::asm::wfi();
    tester::report(total());
    open();
    tester::report(total());
}

pub fn sev_on_pend() {
    // SAFETY: the bit SEVONPEND.
    unsafe { peripherals().SCB.scr.write(1 << 4) };
    cortex_m::interrupt::disable();
    tester::raise_later(0);
    cortex_m::asm::wfe();
    tester::report(total());
    open();
    tester::report(total());
}

fn open() {
    // SAFETY: nobody here relies on interrupts being masked.
    unsafe { cortex_m::interrupt::enable() };
    cortex_m::asm::isb();
}

pub fn sleep_on_exit() {
    peripherals().SCB.set_sleeponexit();
    tester::storm(3_000);
    while total() < 100 {}
    // Reached only when the thread runs after the first interrupt.
    tester::report(total());
}

pub fn spin() {
    for _ in 0..1000 {
        // SAFETY: does nothing.
        unsafe { asm!("yield") };
    }
    tester::report(1000);
}

pub fn systick() {
    let mut systick = peripherals().SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(1_000 - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
    while handlers::SYSTICK.load(Relaxed) < 100 {}
    systick.disable_interrupt();
    while !systick.has_wrapped() {}
    tester::report(handlers::SYSTICK.load(Relaxed));
    tester::report(u32::from(systick.has_wrapped()));
}

pub fn cycle_counter() {
    let mut all = peripherals();
    all.DCB.enable_trace();
    all.DWT.enable_cycle_counter();
    let start = DWT::cycle_count();
    handlers::dawdle(10);
    let awake = DWT::cycle_count() - start;
    tester::raise_later(0);
    let start = DWT::cycle_count();
    cortex_m::asm::wfi();
    let asleep = DWT::cycle_count() - start;
    tester::report(awake);
    tester::report(asleep);
}

pub fn flash_busy() {
    start_stopwatch(&mut peripherals().SYST);
    tester::raise_later(0);
    tester::make_flash_busy(336_000);
    cortex_m::asm::isb();
    tester::report(lap() / 168);
    tester::report(total());
}
