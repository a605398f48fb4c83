//! Fault handlers that say what they find, and what provokes them.

use crate::tester;
use core::arch::{asm, global_asm};
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// A load or store at this address faults.
const NOWHERE: u32 = 0x3000_0000;

/// The HardFault handler must provoke another fault.
#[unsafe(no_mangle)]
static FAULT_AGAIN: AtomicU32 = AtomicU32::new(0);

// The stack may be where nothing can be pushed: a new one first. R0 gets EXC_RETURN, R1 the stack
// pointer as it was found. UsageFault and BusFault count, and step over an instruction of four bytes.
global_asm!(
    r#"
    .syntax unified
    .section .text.HardFault, "ax", %progbits
    .global HardFault
    .type HardFault, %function
    .thumb_func
HardFault:
    mov     r0, lr
    mov     r1, sp
    ldr     r2, =0x20010000
    mov     sp, r2
    b       hard_fault
    .pool

    .section .text.BusFault, "ax", %progbits
    .global BusFault
    .type BusFault, %function
    .thumb_func
BusFault:
    ldr     r0, [sp, #24]
    adds    r0, r0, #4
    str     r0, [sp, #24]
    mov     r0, #5
    b       configurable_fault

    .section .text.UsageFault, "ax", %progbits
    .global UsageFault
    .type UsageFault, %function
    .thumb_func
UsageFault:
    ldr     r0, [sp, #24]
    adds    r0, r0, #4
    str     r0, [sp, #24]
    mov     r0, #6
    b       configurable_fault
    "#
);

fn status(register: usize) -> u32 {
    // SAFETY: a register of the system control block.
    unsafe { (register as *const u32).read_volatile() }
}

/// Reports CFSR, HFSR, BFAR, EXC_RETURN and the stack pointer, and ends the run.
#[unsafe(no_mangle)]
unsafe extern "C" fn hard_fault(exc_return: u32, sp: u32) -> ! {
    if FAULT_AGAIN.load(Relaxed) != 0 {
        undefined();
    }
    for word in [
        status(0xE000_ED28),
        status(0xE000_ED2C),
        status(0xE000_ED38),
        exc_return,
        sp,
    ] {
        tester::report(word);
    }
    tester::finish()
}

/// Reports the exception's number and CFSR, clears that, and goes on.
#[unsafe(no_mangle)]
unsafe extern "C" fn configurable_fault(number: u32) {
    tester::report(number);
    tester::report(status(0xE000_ED28));
    // SAFETY: ones clear what was there.
    unsafe { (0xE000_ED28 as *mut u32).write_volatile(u32::MAX) };
}

/// Enables MemManage, BusFault and UsageFault.
pub fn enable_handlers() {
    // SAFETY: the handlers are above.
    unsafe { (0xE000_ED24 as *mut u32).write_volatile(0b111 << 16) };
}

#[inline(never)]
pub fn undefined() {
    // SAFETY: the fault is what is wanted.
    unsafe { asm!("udf.w #1") };
}

pub fn fault_again() {
    FAULT_AGAIN.store(1, Relaxed);
    undefined();
}

pub fn load() {
    // SAFETY: as above; written out because the handler steps over four bytes.
    unsafe { asm!("ldr.w {value}, [{address}]", value = out(reg) _, address = in(reg) NOWHERE) };
}

#[inline(never)]
pub fn store(address: u32) {
    // SAFETY: as above.
    unsafe { asm!("str.w {address}, [{address}]", address = in(reg) address) };
}

pub fn store_nowhere() {
    store(NOWHERE);
}

pub fn jump(address: u32) {
    // SAFETY: as above.
    unsafe { asm!("blx {0}", in(reg) address, out("lr") _) };
}

/// Recursion without end.
#[inline(never)]
#[allow(unconditional_recursion)]
pub fn overflow(depth: u32) -> u32 {
    let frame = core::hint::black_box([depth; 16]);
    overflow(depth + 1) + frame[depth as usize % 16]
}

/// Raises a line while the stack has room for no frame.
pub fn interrupt_on_full_stack(line: usize) {
    // SAFETY: the HardFault handler never comes back here.
    unsafe {
        asm!(
            "mov sp, {top}", "str {line}, [{raise}]", "2: b 2b",
            top = in(reg) 0x1000_0020_u32, line = in(reg) line, raise = in(reg) 0x4000_0014_u32,
            options(noreturn)
        );
    }
}

/// The handler of SysTick in a table of its own leaves in a way that does not fit: as if it had
/// preempted another handler.
pub fn return_to_nobody() {
    #[repr(align(512))]
    struct Table([AtomicU32; 98]);
    static TABLE: Table = Table([const { AtomicU32::new(0) }; 98]);
    unsafe extern "C" fn misfit() {
        // SAFETY: the fault is what is wanted.
        unsafe { asm!("bx {0}", in(reg) 0xFFFF_FFE1_u32, options(noreturn)) }
    }
    for (i, entry) in TABLE.0.iter().enumerate() {
        // SAFETY: the vector table in flash has that many entries.
        entry.store(unsafe { (0x0800_0000 as *const u32).add(i).read() }, Relaxed);
    }
    TABLE.0[15].store(misfit as *const () as u32 | 1, Relaxed);
    // SAFETY: the table lives for ever and is aligned as it must be; SysTick becomes pending.
    unsafe {
        (0xE000_ED08 as *mut u32).write_volatile(TABLE.0.as_ptr() as u32);
        (0xE000_ED04 as *mut u32).write_volatile(1 << 26);
    }
    cortex_m::asm::isb();
}
