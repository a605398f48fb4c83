//! Calls each function of `windhover-math` that has a bound, over its arguments; the emulated
//! board counts the instructions of each call. Then it sleeps for ever.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;

/// What cannot happen stops the run as a fault.
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    cortex_m::asm::udf()
}

#[entry]
fn main() -> ! {
    for i in -1000..=1000_i16 {
        let x = f32::from(i) * 1e-3;
        black_box(sin(black_box(10.0 * x)));
        black_box(cos(black_box(10.0 * x)));
        black_box(sin_cos(black_box(10.0 * x)));
        black_box(asin(black_box(x)));
        black_box(acos(black_box(x)));
    }
    // Odd steps leave out the origin, which no bearing is asked of.
    for y in (-49..=49_i16).step_by(2) {
        for x in (-49..=49_i16).step_by(2) {
            black_box(atan2(black_box(f32::from(y)), black_box(f32::from(x))));
        }
    }
    loop {
        cortex_m::asm::wfi();
    }
}

#[inline(never)]
fn sin(angle: f32) -> f32 {
    windhover_math::sin(angle)
}

#[inline(never)]
fn cos(angle: f32) -> f32 {
    windhover_math::cos(angle)
}

#[inline(never)]
fn sin_cos(angle: f32) -> (f32, f32) {
    windhover_math::sin_cos(angle)
}

#[inline(never)]
fn asin(x: f32) -> f32 {
    windhover_math::asin(x)
}

#[inline(never)]
fn acos(x: f32) -> f32 {
    windhover_math::acos(x)
}

#[inline(never)]
fn atan2(y: f32, x: f32) -> f32 {
    windhover_math::atan2(y, x)
}
