//! Proof that no panic can be reached from the ground link, and the measure of what it takes.
//!
//! The same proof as for the steps (see `main.rs` beside this folder): the panic handler cannot be
//! linked. This program holds the link, a vehicle of a few lines around it, and nothing else, so
//! that its sections are also the measure of the link's flash and RAM (`cargo xtask size`). It is
//! never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod entries;
#[cfg(target_os = "none")]
mod probe;
#[cfg(target_os = "none")]
mod vehicle;

/// A desktop program always has a panic handler: nothing to prove here.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This probe is linked for the board and never run: cargo xtask test --only no-panic");
}
