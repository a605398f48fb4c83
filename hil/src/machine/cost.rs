//! What an instruction costs, in cycles: an estimate.
//!
//! After the instruction table of the Cortex-M4 Technical Reference Manual (DDI 0439, 3.3), with
//! every fetch a hit of the flash accelerator, every branch taken, and no pipelining of loads and
//! stores. Times and loads from it are estimates too, and are called so.

/// Cycles of the instruction with these two halfwords; the second counts in wide ones only.
pub(super) fn cycles(first: u16, second: u16) -> u64 {
    if is_wide(first) {
        wide(first, second)
    } else {
        narrow(first)
    }
}

/// Whether an instruction that begins with this halfword has two of them.
pub(super) fn is_wide(first: u16) -> bool {
    first >> 11 >= 0b11101
}

const LOAD_STORE: u64 = 2;
const BRANCH: u64 = 2;
const BRANCH_REGISTER: u64 = 3;
const CALL: u64 = 3;
const DIVIDE: u64 = 6;
const FLOAT_ACCUMULATE: u64 = 3;
const FLOAT_DIVIDE: u64 = 14;

fn narrow(first: u16) -> u64 {
    match first >> 12 {
        0x4 if first & 0x0F00 == 0x0700 => BRANCH_REGISTER,
        0x4 if first & 0x0800 != 0 => LOAD_STORE,
        0x5..=0x9 => LOAD_STORE,
        // PUSH and POP
        0xB if first & 0x0600 == 0x0400 => 1 + u64::from((first & 0x01FF).count_ones()),
        // LDM and STM
        0xC => 1 + u64::from((first & 0x00FF).count_ones()),
        0xD | 0xE => BRANCH,
        _ => 1,
    }
}

fn wide(first: u16, second: u16) -> u64 {
    match first {
        // VDIV and VSQRT
        f if f & 0xEFB0 == 0xEE80 => FLOAT_DIVIDE,
        f if f & 0xEFBF == 0xEEB1 && second & 0x0FC0 == 0x0AC0 => FLOAT_DIVIDE,
        // VMLA, VNMLA, VFMA, VFNMA
        f if f & 0xFFA0 == 0xEE00 && second & 0x0010 == 0 => FLOAT_ACCUMULATE,
        f if f & 0xFFA0 == 0xEEA0 && f & 0xFFB0 != 0xEEB0 => FLOAT_ACCUMULATE,
        f if f & 0xFFB0 == 0xEE90 => FLOAT_ACCUMULATE,
        f if f & 0xEF00 == 0xEE00 => 1,
        // A move of two registers, VLDR and VSTR, then VLDM and VSTM
        f if f & 0xFFE0 == 0xEC40 => LOAD_STORE,
        f if f & 0xEF20 == 0xED00 => LOAD_STORE,
        f if f & 0xEE00 == 0xEC00 => 1 + u64::from((second & 0x00FF).clamp(1, 32)),
        // LDM and STM, then LDRD, STRD, exclusives and table branches
        f if f & 0xFE40 == 0xE800 => 1 + u64::from(second.count_ones()),
        f if f & 0xFE40 == 0xE840 => 3,
        f if f & 0xFE00 == 0xF800 => LOAD_STORE,
        f if f & 0xFFD0 == 0xFB90 => DIVIDE,
        // UMULL and its relatives, on this core a cycle like any multiplication
        f if f & 0xFF80 == 0xFB80 => 1,
        f if f & 0xF800 == 0xF000 && second & 0x8000 != 0 => CALL,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_instructions_cost_what_the_table_says() {
        assert_eq!(cycles(0x1840, 0), 1, "adds r0, r0, r1");
        assert_eq!(cycles(0x6808, 0), 2, "ldr r0, [r1]");
        assert_eq!(cycles(0x4800, 0), 2, "ldr r0, [pc]");
        assert_eq!(cycles(0xB5F0, 0), 6, "push {{r4-r7, lr}}");
        assert_eq!(cycles(0x4770, 0), 3, "bx lr");
        assert_eq!(cycles(0xBF00, 0), 1, "nop");
    }

    #[test]
    fn wide_instructions_cost_what_the_table_says() {
        assert_eq!(cycles(0xEE80, 0x0A20), 14, "vdiv.f32 s0, s0, s1");
        assert_eq!(cycles(0xEEB1, 0x0AC0), 14, "vsqrt.f32 s0, s0");
        assert_eq!(cycles(0xEE30, 0x0A20), 1, "vadd.f32 s0, s0, s1");
        assert_eq!(cycles(0xEEA0, 0x0A20), 3, "vfma.f32 s0, s0, s1");
        assert_eq!(cycles(0xEE00, 0x0A20), 3, "vmla.f32 s0, s0, s1");
        assert_eq!(cycles(0xEE00, 0x0A10), 1, "vmov s0, r0");
        assert_eq!(cycles(0xEEB0, 0x0A60), 1, "vmov.f32 s0, s1");
        assert_eq!(cycles(0xED90, 0x0A00), 2, "vldr s0, [r0]");
        assert_eq!(cycles(0xED2D, 0x8A10), 17, "vpush {{s16-s31}}");
        assert_eq!(cycles(0xE92D, 0x4FF0), 10, "push.w {{r4-r11, lr}}");
        assert_eq!(cycles(0xFB90, 0xF0F1), 6, "sdiv r0, r0, r1");
        assert_eq!(cycles(0xF000, 0xF800), 3, "bl");
    }
}
