//! Threads and handlers against each other: masks, priorities, pending, and what must be kept.

use crate::conditional::{self, Kind};
use crate::handlers::{self, COUNTS, Duty, LOG, LOGGED, duty, prioritise, total};
use crate::kernel;
use crate::tester::{self, LINES};
use core::arch::{asm, global_asm};
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m::peripheral::{SCB, scb::SystemHandler};
use cortex_m::{Peripherals, interrupt};

fn peripherals() -> Peripherals {
    // SAFETY: this program is the only one here.
    unsafe { Peripherals::steal() }
}

fn open() {
    // SAFETY: nobody here relies on interrupts being masked.
    unsafe { interrupt::enable() };
    cortex_m::asm::isb();
}

/// Enables all lines, line 0 the most urgent, PendSV the least.
pub fn enable_lines() {
    for line in 0..LINES {
        prioritise(line, 0x10 * (line as u8 + 1));
    }
    let mut all = peripherals();
    // SAFETY: priorities only.
    unsafe {
        all.SCB.set_priority(SystemHandler::PendSV, 0xF0);
        all.SCB.set_priority(SystemHandler::SVCall, 0x80);
        all.SCB.set_priority(SystemHandler::SysTick, 0x50);
        (0xE000_E100 as *mut u32).write_volatile((1 << LINES) - 1);
    }
}

fn riot() {
    for line in 0..LINES {
        duty(line, Duty::Riot);
    }
    tester::storm(4_000);
}

fn peace() {
    tester::storm(0);
    open();
    tester::report(total());
}

pub fn storm() {
    let input = kernel::input();
    let want = interrupt::free(|_| kernel::run(0, &input, 3_000));
    riot();
    let wrong = (0..20).filter(|_| kernel::run(0, &input, 3_000) != want).count();
    tester::report(wrong as u32);
    peace();
    tester::report(handlers::DEEPEST.load(Relaxed));
    tester::report(want[0] ^ want[32] ^ want[40]);
}

pub fn pages() {
    let input = kernel::input();
    let want = kernel::run(0, &input, 150);
    riot();
    let wrong = (0..kernel::COPIES)
        .map(|copy| (0..3).filter(|_| kernel::run(copy, &input, 150) != want).count())
        .sum::<usize>();
    tester::report(wrong as u32);
    peace();
}

pub fn process_stack() {
    static STACK: [AtomicU32; 1024] = [const { AtomicU32::new(0) }; 1024];
    let input = kernel::input();
    let want = interrupt::free(|_| kernel::run(0, &input, 1_000));
    riot();
    // SAFETY: from here on the thread runs on another stack, until it is switched back; the frame
    // of this function is addressed by the old one, kept in R4.
    let wrong = unsafe {
        on_process_stack(STACK.as_ptr_range().end as u32, || {
            (0..10).filter(|_| kernel::run(0, &input, 1_000) != want).count()
        })
    };
    tester::report(wrong as u32);
    peace();
}

unsafe fn on_process_stack<F: FnMut() -> usize>(top: u32, mut work: F) -> usize {
    extern "C" fn call<F: FnMut() -> usize>(work: &mut F) -> usize {
        work()
    }
    let result;
    // SAFETY: the caller's stack is untouched, and taken again in the end.
    unsafe {
        asm!(
            "msr psp, {top}",
            "mrs r5, control", "orr r5, r5, #2", "msr control, r5", "isb",
            "blx {call}",
            "mrs r5, control", "bic r5, r5, #2", "msr control, r5", "isb",
            top = in(reg) top & !7,
            call = in(reg) call::<F> as extern "C" fn(&mut F) -> usize,
            inout("r0") &mut work => result,
            out("r1") _, out("r2") _, out("r3") _, out("r5") _, out("r12") _, out("lr") _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
        );
    }
    result
}

pub fn primask() {
    interrupt::disable();
    riot();
    kernel::run(0, &kernel::input(), 1_000);
    tester::report(total());
    open();
    peace();
}

pub fn basepri() {
    // SAFETY: masks lines 4 to 7, and opens them again.
    unsafe { cortex_m::register::basepri::write(0x50) };
    tester::storm(2_000);
    kernel::run(0, &kernel::input(), 2_000);
    for count in &COUNTS {
        tester::report(count.load(Relaxed));
    }
    // SAFETY: as above.
    unsafe { cortex_m::register::basepri::write(0) };
    cortex_m::asm::isb();
    tester::report(COUNTS[4..].iter().map(|count| count.load(Relaxed)).sum());
    tester::storm(0);
}

pub fn faultmask() {
    duty(0, Duty::Mask);
    // SAFETY: sets and clears FAULTMASK.
    unsafe { asm!("cpsid f", "isb") };
    tester::raise(0);
    tester::report(total());
    // SAFETY: as above.
    unsafe { asm!("cpsie f", "isb") };
    tester::report(total());
    let mask: u32;
    // SAFETY: reads a register.
    unsafe { asm!("mrs {0}, faultmask", out(reg) mask) };
    tester::report(mask);
}

pub fn supervisor() {
    let mut late = 0;
    for round in 1..=100 {
        // SAFETY: the handler counts.
        unsafe { asm!("svc 7") };
        late += u32::from(handlers::SVCALL.load(Relaxed) != round);
    }
    tester::report(late);
    tester::report(handlers::SVCALL.load(Relaxed));
}

fn report_log() {
    for event in LOG.iter().take(LOGGED.load(Relaxed) as usize) {
        tester::report(event.load(Relaxed));
    }
}

/// Line 3 pends PendSV, line 2 and line 1; 1 is more urgent than 3, 2 is less.
#[inline(never)]
pub fn order(first: Duty) {
    prioritise(1, 0x20);
    prioritise(3, 0x30);
    prioritise(2, 0x40);
    duty(1, Duty::Log);
    duty(2, Duty::Log);
    duty(3, first);
    tester::raise(3);
    report_log();
}

/// The same while 1 and 3 differ in the subpriority only.
pub fn subpriority() {
    // SAFETY: PRIGROUP 5: two bits of group priority.
    unsafe { peripherals().SCB.aircr.write(0x05FA_0000 | 5 << 8) };
    order(Duty::LogAndPend);
}

pub fn pend() {
    interrupt::disable();
    handlers::pend(0);
    // SAFETY: ICPR takes ones only.
    unsafe { (0xE000_E280 as *mut u32).write_volatile(1) };
    open();
    tester::report(total());
    handlers::pend(0);
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    tester::report(total());
    // SAFETY: STIR takes the number of an interrupt.
    unsafe { peripherals().NVIC.stir.write(5) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    tester::report(COUNTS[5].load(Relaxed));
}

pub fn level() {
    duty(0, Duty::Tardy);
    tester::raise(0);
    tester::report(total());
}

pub fn nmi() {
    prioritise(0, 0);
    duty(0, Duty::LogAndNmi);
    tester::raise(0);
    report_log();
}

pub fn skipped_float() {
    let pattern: [u32; 16] = core::array::from_fn(|i| 0x3F80_0000 + i as u32);
    let mut kept = [0_u32; 16];
    tester::storm(3_000);
    // SAFETY: CONTROL.FPCA is cleared, as in a context that never used floating point.
    unsafe {
        asm!(
            "mrs {t}, control", "bic {t}, {t}, #4", "msr control, {t}", "isb",
            "cmp {t}, {t}", "it ne", "vmovne.f32 s0, s1",
            "vldm {p}, {{s0-s15}}", "2: subs {n}, {n}, #1", "bne 2b", "vstm {k}, {{s0-s15}}",
            t = out(reg) _, p = in(reg) pattern.as_ptr(), k = in(reg) kept.as_mut_ptr(),
            n = inout(reg) 200_000 => _,
            out("s0") _, out("s1") _, out("s2") _, out("s3") _, out("s4") _, out("s5") _,
            out("s6") _, out("s7") _, out("s8") _, out("s9") _, out("s10") _, out("s11") _,
            out("s12") _, out("s13") _, out("s14") _, out("s15") _,
        );
    }
    tester::storm(0);
    tester::report(kept.iter().zip(pattern).filter(|(a, b)| **a != *b).count() as u32);
    tester::report(total());
}

pub fn vector_table() {
    #[repr(align(512))]
    struct Table([AtomicU32; 98]);
    static TABLE: Table = Table([const { AtomicU32::new(0) }; 98]);
    extern "C" fn other() {
        tester::acknowledge(0);
        handlers::log(0x77);
    }
    for (i, entry) in TABLE.0.iter().enumerate() {
        // SAFETY: the vector table in flash has that many entries.
        entry.store(unsafe { (0x0800_0000 as *const u32).add(i).read() }, Relaxed);
    }
    TABLE.0[16].store(other as *const () as u32 | 1, Relaxed);
    // SAFETY: the table lives for ever and is aligned as it must be.
    unsafe { peripherals().SCB.vtor.write(TABLE.0.as_ptr() as u32) };
    tester::raise(0);
    tester::raise(1);
    report_log();
    tester::report(total());
}

pub fn exclusive() {
    riot();
    for _ in 0..20_000 {
        handlers::SUM.fetch_add(1, Relaxed);
    }
    tester::storm(0);
    open();
    let others = total() + handlers::PENDSV.load(Relaxed);
    tester::report(handlers::SUM.load(Relaxed));
    tester::report(20_000 + others);
}

/// At the first boot RAM is filled and a reset demanded; at the second it is looked at.
pub fn reset() {
    const MAGIC: u32 = 0x5AFE_C0DE;
    let kept = [0x2001_FFF0_u32, 0x1000_F000];
    // SAFETY: two words of RAM that nobody else uses.
    unsafe {
        if (kept[0] as *const u32).read_volatile() == MAGIC {
            for address in kept {
                tester::report((address as *const u32).read_volatile());
            }
            tester::finish();
        }
        for address in kept {
            (address as *mut u32).write_volatile(MAGIC);
        }
    }
    SCB::sys_reset();
}

pub fn log_and_reset() {
    const BEEN_HERE: *mut u32 = 0x2001_FFE0 as *mut u32;
    // SAFETY: a word of RAM that nobody else uses.
    unsafe {
        if BEEN_HERE.read_volatile() == 0x5AFE_C0DE {
            tester::finish();
        }
        BEEN_HERE.write_volatile(0x5AFE_C0DE);
    }
    defmt::error!("last words");
    SCB::sys_reset();
}

pub fn flash_program() {
    let place = 0x080F_0000 as *mut u32;
    tester::unlock_flash();
    // SAFETY: nothing else is there.
    unsafe {
        tester::report(place.read_volatile());
        place.write_volatile(0xF0F0_1234);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        tester::report(place.read_volatile());
    }
}

pub fn no_vectors() {
    // SAFETY: the fault is what is wanted.
    unsafe { peripherals().SCB.vtor.write(0x3000_0000) };
    tester::raise(0);
}

// Eleven instructions with its return.
global_asm!(
    r#"
    .section .text.known_function, "ax", %progbits
    .global known_function
    .type known_function, %function
    .thumb_func
known_function:
    .rept 10
    nop
    .endr
    bx      lr
    .size known_function, . - known_function
    "#
);

unsafe extern "C" {
    safe fn known_function();
}

pub fn known(stormy: bool) {
    if stormy {
        tester::storm(3_000);
    }
    for _ in 0..5_000 {
        known_function();
    }
    tester::storm(0);
    tester::report(total());
}

pub fn conditional() {
    /// Above the stack, which is all that the program has there; a page of its own for each access.
    const RAM: usize = 0x1000_4000;
    const PAGE: usize = 1024;
    const COPIES: usize = conditional::COPIES - 2;
    let wrong = |kind, copy, address| u32::from(conditional::run(kind, copy, address) != conditional::WHOLE);
    let ram = |copy| {
        let pages = RAM + PAGE * Kind::ALL.len() * copy;
        let each = Kind::ALL.iter().enumerate();
        each.map(|(page, kind)| wrong(*kind, copy, pages + PAGE * page))
            .sum::<u32>()
    };
    tester::report((0..COPIES).map(ram).sum());
    let registers = [
        wrong(Kind::Load, COPIES, tester::NOISE),
        wrong(Kind::LoadBetween, COPIES, tester::NOISE),
        wrong(Kind::StoreElse, COPIES, tester::STORM),
    ];
    tester::report(registers.iter().sum());
    tester::unlock_flash();
    tester::report(wrong(Kind::StoreElse, COPIES + 1, 0x080F_F000));
}
