//! Memory accesses in blocks of conditional instructions (IT), each behind a branch to code that
//! runs for the first time. An emulator that finds its way to new memory in the middle of such a
//! block, or to new code behind it, must not take the block's condition along.

use core::arch::global_asm;

/// How the access lies in its block.
#[derive(Clone, Copy)]
pub enum Kind {
    /// A load, alone.
    Load,
    /// A load between two other instructions, the last of which is not executed.
    LoadBetween,
    /// A store at the end, in the other branch.
    StoreElse,
    /// A load of two words, followed by another instruction.
    LoadTwo,
}

impl Kind {
    pub const ALL: [Self; 4] = [Self::Load, Self::LoadBetween, Self::StoreElse, Self::LoadTwo];
}

/// What each piece of code returns: all four additions behind the branch were made.
pub const WHOLE: u32 = 15;

/// How many pieces of code there are of each kind.
pub const COPIES: usize = 12;

/// Bytes from one piece of code to the next.
const LENGTH: usize = 64;

// R0 is the address. Behind the access the flags are turned over, so that what would still be
// conditional there is skipped.
global_asm!(
    r#"
    .syntax unified
    .macro BEHIND
    movs    r1, #1
    b       88f
    .balign 4
88:
    adds    r3, r3, #1
    adds    r3, r3, #2
    adds    r3, r3, #4
    adds    r3, r3, #8
    mov     r0, r3
    bx      lr
    .endm

    .section .text.conditional, "ax", %progbits
    .balign 64
    .global conditional
    .thumb
conditional:
    .rept 12
    .balign 64
    movs    r3, #0
    it      eq
    ldreq   r2, [r0]
    BEHIND
    .balign 64
    movs    r3, #0
    itte    eq
    moveq   r2, #0
    ldreq   r2, [r0]
    movne   r3, #16
    BEHIND
    .balign 64
    movs    r3, #0
    ite     ne
    movne   r3, #16
    streq   r3, [r0]
    BEHIND
    .balign 64
    movs    r3, #0
    itt     eq
    ldrdeq  r2, r12, [r0]
    moveq   r2, #0
    BEHIND
    .endr
    .balign 64
    "#
);

unsafe extern "C" {
    static conditional: [u8; 0];
}

/// Runs one piece of code, which accesses this address.
pub fn run(kind: Kind, copy: usize, address: usize) -> u32 {
    let piece = Kind::ALL.len() * copy + kind as usize;
    let code = (&raw const conditional) as usize + LENGTH * piece;
    // SAFETY: such a piece begins here; it takes and gives one word by the procedure call standard,
    // and the caller's address is that of memory nobody else uses, or of a register.
    unsafe {
        let run: unsafe extern "C" fn(usize) -> u32 = core::mem::transmute(code | 1);
        run(address)
    }
}
