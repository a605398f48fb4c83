//! Mathematics of the core: the only door to transcendental functions.
//!
//! Everything here gives the same bits on x86-64 and on a Cortex-M4F, in debug and in release
//! builds. That is what lets a flight on a board be replayed on a desktop, command for command.
//!
//! - [`trig`]: sine, cosine and their inverses in single precision, by polynomial.
//! - [`scalar`]: minimum, maximum, square root, saturation, wrapping.
//! - [`real`]: the number type that rotations are written for: `f32` in the core, `f64` in models.
//! - [`rotation`]: quaternions, Euler angles, rotation matrices; NED world, FRD body.
//! - [`geodesy`]: positions as integers, differences as metres.
#![no_std]

pub mod geodesy;
pub mod real;
pub mod rotation;
pub mod scalar;
pub mod trig;

pub use real::Real;
pub use rotation::{Euler, Quaternion};
pub use scalar::{max, min, saturate, sqrt, wrap_pi};
pub use trig::{acos, asin, atan2, cos, sin, sin_cos};

/// A column of three numbers; which frame and unit is said where it is used.
pub type Vector3<T = f32> = nalgebra::Vector3<T>;

/// A 3×3 matrix.
pub type Matrix3<T = f32> = nalgebra::Matrix3<T>;

/// Standard gravity in m/s² (ISO 80000-3).
pub const GRAVITY: f32 = 9.806_65;
