//! A computation that uses every register and every flag: whatever an exception fails to keep
//! shows in its result.

use core::arch::global_asm;

/// Words that the kernel starts from: S0 to S31, then R4 to R11.
pub const INPUT: usize = 40;
/// Words that it ends with: S0 to S31, R4 to R12, APSR, FPSCR.
pub const OUTPUT: usize = 43;
/// How many copies there are; a page boundary lies one halfword further in each.
pub const COPIES: usize = 110;

pub type Input = [u32; INPUT];
pub type Output = [u32; OUTPUT];

global_asm!(
    r#"
    .syntax unified
    .macro COMPUTE
    push    {{r4-r11, lr}}
    vpush   {{s16-s31}}
    push    {{r1}}
    mov     r3, r2
    vldm    r0!, {{s0-s31}}
    ldm     r0, {{r4-r11}}
    mov     r0, r3
    mov     r12, r4
77:
    adds    r4, r4, r7
    adcs    r5, r5, r4, lsl #3
    ittee   cs
    addcs   r6, r6, #29
    eorcs   r7, r7, r5, ror #5
    subcc   r6, r6, #11
    eorcc   r7, r7, r4, lsr #2
    sbcs    r8, r8, r6
    it      vs
    addvs   r8, r8, #1
    sadd8   r9, r9, r8
    sel     r10, r9, r7
    usat    r11, #19, r10
    qsub    r10, r10, r5
    umull   r2, r3, r10, r8
    eors    r12, r12, r3
    itete   pl
    addpl   r12, r12, r2
    mvnmi   r12, r12
    subpl   r9, r9, r2
    addmi   r9, r9, r3
    smlal   r6, r7, r2, r11
    vadd.f32 s0, s0, s1
    vmul.f32 s2, s2, s3
    vsub.f32 s4, s4, s5
    vcmp.f32 s0, s4
    vmrs    apsr_nzcv, fpscr
    itt     gt
    vsubgt.f32 s0, s0, s6
    vaddgt.f32 s4, s4, s7
    ite     le
    vaddle.f32 s8, s8, s9
    vneggt.f32 s8, s8
    vdiv.f32 s10, s11, s8
    vabs.f32 s12, s10
    vsqrt.f32 s13, s12
    vfma.f32 s14, s13, s15
    vmls.f32 s14, s14, s3
    vadd.f32 s16, s16, s17
    vsub.f32 s18, s16, s19
    vmul.f32 s20, s18, s3
    vmov    r2, r3, s14, s15
    vmov.f32 s21, s22
    vcvt.s32.f32 s23, s16
    vmov    r3, s23
    add     r5, r5, r3
    vneg.f32 s3, s3
    push    {{r0, r4-r7}}
    pop     {{r0, r4-r7}}
    subs    r0, r0, #1
    bne     77b
    mrs     r2, apsr
    vmrs    r3, fpscr
    pop     {{r1}}
    vstm    r1!, {{s0-s31}}
    stm     r1!, {{r4-r12}}
    stm     r1!, {{r2, r3}}
    vpop    {{s16-s31}}
    pop     {{r4-r11, pc}}
    .endm

    .section .text.kernels, "ax", %progbits
    .balign 2048
    .global kernels
    .set offset, 0
    .thumb
kernels:
    .rept 110
    .balign 2048
    .space 1024 - offset
    COMPUTE
    .set offset, offset + 2
    .endr
    "#
);

unsafe extern "C" {
    static kernels: [u8; 0];
}

/// Runs one of the copies for so many rounds.
pub fn run(copy: usize, input: &Input, rounds: u32) -> Output {
    let mut output = [0; OUTPUT];
    let address = (&raw const kernels) as usize + 2048 * copy + 1024 - 2 * copy;
    // SAFETY: a copy begins here, and takes these three arguments by the procedure call standard.
    unsafe {
        let kernel: unsafe extern "C" fn(*const u32, *mut u32, u32) = core::mem::transmute(address | 1);
        kernel(input.as_ptr(), output.as_mut_ptr(), rounds);
    }
    output
}

/// Something to start from.
pub fn input() -> Input {
    core::array::from_fn(|i| {
        if i < 32 {
            (0.75_f32 + i as f32 * 0.219).to_bits()
        } else {
            0x9E37_79B9_u32.wrapping_mul(i as u32)
        }
    })
}
