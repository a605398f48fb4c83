//! Proof that no panic can be reached from the vehicle's end of the ground link: what the firmware's
//! task for ground stations calls, and what the outer loop tells it.
//!
//! The same proof as for the steps (see `main.rs` beside this folder). It is never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod probe;

/// A desktop program always has a panic handler: nothing to prove here.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This probe is linked for the board and never run: cargo xtask test --only no-panic");
}
