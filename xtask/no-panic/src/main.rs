//! Proof that no panic can be reached from the inner and the outer step.
//!
//! The panic handler of this program calls a function that exists nowhere. The optimiser removes
//! the handler when nothing can reach it, and the program links; one reachable `unwrap`, index
//! check or division by zero, and it does not. `cargo xtask test` links it both ways: as it is,
//! and with the feature `prove-it-fails`, where it must not link. It is never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod probe;
#[cfg(target_os = "none")]
mod steps;

/// A desktop program always has a panic handler: nothing to prove here.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This probe is linked for the board and never run: cargo xtask test --only no-panic");
}
