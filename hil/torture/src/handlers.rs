//! Exception handlers: they count, they spoil every register, and they do what is asked of them.

use crate::tester::{self, LINES};
use core::arch::asm;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;

/// How often each line's handler ran.
pub static COUNTS: [AtomicU32; LINES] = [const { AtomicU32::new(0) }; LINES];
pub static PENDSV: AtomicU32 = AtomicU32::new(0);
pub static SVCALL: AtomicU32 = AtomicU32::new(0);
pub static SYSTICK: AtomicU32 = AtomicU32::new(0);
/// Deepest nesting seen.
pub static DEEPEST: AtomicU32 = AtomicU32::new(0);
static NESTING: AtomicU32 = AtomicU32::new(0);
/// Something that all add to, by LDREX and STREX.
pub static SUM: AtomicU32 = AtomicU32::new(0);
/// What each line's handler does besides.
pub static DUTY: [AtomicU32; LINES] = [const { AtomicU32::new(Duty::Count as u32) }; LINES];
/// What happened, in order.
pub static LOG: [AtomicU32; 32] = [const { AtomicU32::new(0) }; 32];
pub static LOGGED: AtomicU32 = AtomicU32::new(0);

/// What a line's handler does.
#[repr(u32)]
pub enum Duty {
    /// Counts and spoils registers.
    Count,
    /// Lowers its line at the third time only.
    Tardy,
    /// Anything: pends others, changes priorities, takes its time.
    Riot,
    /// Notes its beginning and its end.
    Log,
    /// As `Log`, and in between pends PendSV, line 1 and line 2.
    LogAndPend,
    /// As `Log`, and in between raises NMI.
    LogAndNmi,
    /// As `LogAndPend`, then swaps the priorities of lines 1 and 2.
    LogAndSwap,
    /// Calls the supervisor.
    Supervise,
    /// Sets FAULTMASK.
    Mask,
}

pub fn duty(line: usize, duty: Duty) {
    DUTY[line].store(duty as u32, Relaxed);
}

pub fn total() -> u32 {
    COUNTS.iter().map(|count| count.load(Relaxed)).sum()
}

pub fn log(event: u32) {
    let place = LOGGED.fetch_add(1, Relaxed) as usize;
    LOG[place % LOG.len()].store(event, Relaxed);
}

/// Priority of an interrupt.
pub fn prioritise(line: usize, priority: u8) {
    // SAFETY: a byte of the NVIC's priority registers.
    unsafe { ((0xE000_E400 + line) as *mut u8).write_volatile(priority) }
}

pub fn pend(line: usize) {
    // SAFETY: ISPR takes ones only.
    unsafe { (0xE000_E200 as *mut u32).write_volatile(1 << line) }
}

/// Writes something else into every register that a context may use.
#[inline(never)]
pub fn spoil(seed: u32) {
    // SAFETY: all that is written is declared.
    unsafe {
        asm!(
            "vmov s0, {seed}", "vmov s1, {seed}", "vmov s2, {seed}", "vmov s3, {seed}",
            "vmov s4, {seed}", "vmov s5, {seed}", "vmov s6, {seed}", "vmov s7, {seed}",
            "vmov s8, {seed}", "vmov s9, {seed}", "vmov s10, {seed}", "vmov s11, {seed}",
            "vmov s12, {seed}", "vmov s13, {seed}", "vmov s14, {seed}", "vmov s15, {seed}",
            "vmov s16, {seed}", "vmov s23, {seed}", "vmov s31, {seed}",
            "vdiv.f32 s1, s0, s2", "vcmp.f32 s0, s1", "vmrs apsr_nzcv, fpscr",
            "mov r0, {seed}", "mov r1, {seed}", "mov r2, {seed}", "mov r3, {seed}",
            "mov r4, {seed}", "mov r5, {seed}", "mov r8, {seed}", "mov r10, {seed}",
            "mov r12, {seed}", "qadd r0, r0, r0", "uadd8 r1, r0, r2", "adds r0, r0, r0",
            seed = in(reg) seed,
            out("r0") _, out("r1") _, out("r2") _, out("r3") _, out("r4") _, out("r5") _,
            out("r8") _, out("r10") _, out("r12") _,
            out("s0") _, out("s1") _, out("s2") _, out("s3") _, out("s4") _, out("s5") _,
            out("s6") _, out("s7") _, out("s8") _, out("s9") _, out("s10") _, out("s11") _,
            out("s12") _, out("s13") _, out("s14") _, out("s15") _, out("s16") _, out("s23") _,
            out("s31") _,
        );
    }
}

/// Passes some time, with calls, so that others can preempt.
pub fn dawdle(rounds: u32) {
    for round in 0..rounds {
        spoil(round);
    }
}

fn nested(work: impl FnOnce()) {
    let depth = NESTING.fetch_add(1, Relaxed) + 1;
    DEEPEST.fetch_max(depth, Relaxed);
    work();
    NESTING.fetch_sub(1, Relaxed);
}

#[exception]
unsafe fn DefaultHandler(irqn: i16) {
    let line = irqn as usize;
    nested(|| {
        let duty = DUTY[line].load(Relaxed);
        if duty == Duty::Tardy as u32 {
            if COUNTS[line].load(Relaxed) >= 2 {
                tester::acknowledge(line);
            }
        } else if duty == Duty::Riot as u32 {
            riot(line);
        } else {
            tester::acknowledge(line);
            orderly(line, duty);
        }
        spoil(0x7F00_0000 + line as u32);
        SUM.fetch_add(1, Relaxed);
        COUNTS[line].fetch_add(1, Relaxed);
    });
}

fn orderly(line: usize, duty: u32) {
    if duty == Duty::Count as u32 {
        return;
    }
    log(line as u32);
    if duty == Duty::LogAndPend as u32 || duty == Duty::LogAndSwap as u32 {
        SCB::set_pendsv();
        pend(2);
        pend(1);
    }
    if duty == Duty::LogAndSwap as u32 {
        prioritise(1, 0x90);
        prioritise(2, 0x80);
    }
    if duty == Duty::LogAndNmi as u32 {
        // SAFETY: sets NMI pending, nothing else.
        unsafe { (0xE000_ED04 as *mut u32).write_volatile(1 << 31) };
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
    }
    if duty == Duty::Supervise as u32 {
        // SAFETY: the handler of SVCall does nothing but count.
        unsafe { asm!("svc 0") };
    }
    if duty == Duty::Mask as u32 {
        // SAFETY: the return from this handler clears it.
        unsafe { asm!("cpsid f") };
    }
    log(0x80 + line as u32);
}

fn riot(line: usize) {
    let noise = tester::noise();
    let late = noise & 1 != 0;
    if !late {
        tester::acknowledge(line);
    }
    if noise & 2 != 0 {
        SCB::set_pendsv();
    }
    if noise & 0x1C == 0 {
        pend((noise >> 8) as usize % LINES);
    }
    if noise & 0xE0 == 0 {
        prioritise((noise >> 8) as usize % LINES, (noise >> 16) as u8);
    }
    dawdle(noise >> 12 & 0xF);
    if noise & 0x700 == 0 {
        cortex_m::interrupt::free(|_| dawdle(5));
    }
    if late {
        tester::acknowledge(line);
    }
}

#[exception]
fn PendSV() {
    nested(|| {
        log(0x40);
        spoil(0x4000_0040);
        SUM.fetch_add(1, Relaxed);
        PENDSV.fetch_add(1, Relaxed);
        log(0xC0);
    });
}

#[exception]
fn SVCall() {
    nested(|| {
        spoil(0x4000_0080);
        SVCALL.fetch_add(1, Relaxed);
    });
}

#[exception]
fn SysTick() {
    nested(|| {
        spoil(0x4000_0100);
        SYSTICK.fetch_add(1, Relaxed);
    });
}

#[exception]
unsafe fn NonMaskableInt() {
    log(0x20);
    spoil(0x4000_0020);
}
