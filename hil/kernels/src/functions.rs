//! The functions of `windhover-math`, over their arguments.

use core::hint::black_box;

pub fn call() {
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
