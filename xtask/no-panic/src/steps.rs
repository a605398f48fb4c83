//! The two steps under proof, each a function of its own in the ELF.
//!
//! STAND-IN: the autopilot's inner and outer step do not exist yet; rotations and angles of
//! `windhover_math` take their place. This file is the only one to change when they do.

// The names are for the reader of the ELF and for xtask, which looks whether they are in it.
#![allow(unsafe_code)]

use windhover_math::{Euler, Quaternion, Vector3, wrap_pi};

/// Numbers that a step reads.
pub const INPUTS: usize = 6;
/// Numbers that a step gives.
pub const OUTPUTS: usize = 3;

/// Turns a body vector into the world.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn inner_step(input: &[f32; INPUTS]) -> [f32; OUTPUTS] {
    let [roll, pitch, yaw, x, y, z] = *input;
    let world = Quaternion::from_euler(Euler { roll, pitch, yaw }).rotate(Vector3::new(x, y, z));
    #[cfg(feature = "prove-it-fails")]
    let world = world * f32::from(u8::try_from(z as i32).unwrap());
    [world.x, world.y, world.z]
}

/// Wraps the difference of two attitudes.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn outer_step(input: &[f32; INPUTS]) -> [f32; OUTPUTS] {
    let [roll, pitch, yaw, ..] = *input;
    let heading = Quaternion::from_euler(Euler { roll, pitch, yaw }).heading();
    [
        wrap_pi(heading - input[3]),
        wrap_pi(roll - input[4]),
        wrap_pi(pitch - input[5]),
    ]
}
