//! The emulated processor against the program in `hil/torture`, which these tests build.

mod determinism;
mod exceptions;
mod faults;
mod injections;
mod log;
#[path = "../../torture/src/scenario.rs"]
mod scenario;
mod sleep;
mod tester;
