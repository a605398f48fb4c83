//! The functions of `windhover-math`, counted in the program `hil/kernels`.

use std::sync::Arc;

use super::Count;
use crate::board::{Board, Inputs, Pin, PwmPulse, Usart, Wiring};
use crate::elf::Elf;
use crate::flight::FlightError;
use crate::machine::{Machine, Options};
use crate::time::{NEVER, SECOND};

/// The functions, each of that name in the program.
pub const FUNCTIONS: [&str; 6] = ["sin", "cos", "sin_cos", "asin", "acos", "atan2"];

/// It takes a fraction of a second.
const LIMIT: u64 = 10 * SECOND;

/// Runs the program to its end; a count for each of [`FUNCTIONS`].
///
/// # Errors
/// When this is another program, or it does what a program must not.
pub fn count(elf: Arc<Elf>) -> Result<[Count; 6], FlightError> {
    let mut machine = Machine::new(Board::new(Bare), elf, Options::default())?;
    let mut probes = Vec::new();
    for function in FUNCTIONS {
        probes.push(machine.count(format!("windhover_kernels::{function}").as_str())?);
    }
    // It sleeps when it has done all calls.
    while machine.load().asleep == 0 && machine.now() < LIMIT {
        machine.run(machine.now() + SECOND / 10)?;
    }
    Ok(std::array::from_fn(|i| machine.calls(probes[i]).into()))
}

/// Pins without anything on them.
struct Bare;

impl Wiring for Bare {
    fn spi(&mut self, _: u64, _: u8) -> u8 {
        0
    }

    fn output(&mut self, _: u64, _: Pin, _: bool) {}

    fn pwm(&mut self, _: u64, _: Pin, _: PwmPulse) {}

    fn pwm_stopped(&mut self, _: u64, _: Pin) {}

    fn transmitted(&mut self, _: u64, _: Usart, _: u8) {}

    fn next_event(&self) -> u64 {
        NEVER
    }

    fn advance(&mut self, _: u64, _: &mut Inputs) {}
}
