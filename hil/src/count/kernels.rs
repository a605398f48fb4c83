//! The functions of `windhover-math`, the filter and the outer step in a mission, counted in the
//! program `hil/kernels`.

use std::sync::Arc;

use super::Count;
use crate::board::{Board, Frame, Inputs, Pin, PwmPulse, Usart, Wiring};
use crate::elf::Elf;
use crate::flight::FlightError;
use crate::machine::{Machine, Options};
use crate::time::{NEVER, SECOND};

/// The functions of `windhover-math`, each of that name in the program.
pub const FUNCTIONS: [&str; 6] = ["sin", "cos", "sin_cos", "asin", "acos", "atan2"];

/// The filter's functions, each of that name in the program, and how many scalars it takes in.
const FILTER: [(&str, u64); 7] = [
    ("predict", 1),
    ("barometer", 1),
    ("compass", 1),
    ("gravity", 3),
    ("gnss_position", 2),
    ("gnss_height", 1),
    ("gnss_velocity", 3),
];

/// From here on in [`FILTER`] measurements come late.
const FIRST_LATE: usize = 4;

/// It takes a few seconds.
const LIMIT: u64 = 60 * SECOND;

/// What the program's functions cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kernels {
    /// In the order of [`FUNCTIONS`].
    pub functions: [Count; 6],
    /// Predict, and the measurements' updates, per scalar: barometer, compass, gravity, a
    /// receiver's late north and east, its late height, its late velocity. Border and gate are in
    /// it, the look back is not.
    pub filter: [Count; 7],
    /// The look back of a measurement that comes late.
    pub look_back: Count,
    /// The outer step of a vehicle on its mission that is told where it is.
    pub mission: Count,
}

/// Runs the program to its end.
///
/// # Errors
/// When this is another program, or it does what a program must not.
pub fn count(elf: Arc<Elf>) -> Result<Kernels, FlightError> {
    let mut machine = Machine::new(Board::new(Bare), elf, Options::default())?;
    let mut probe = |function: &str| machine.count(format!("windhover_kernels::{function}").as_str());
    let mut probes = Vec::new();
    for function in FUNCTIONS {
        probes.push(probe(&format!("functions::{function}"))?);
    }
    for (function, _) in FILTER {
        probes.push(probe(&format!("filter::{function}"))?);
    }
    let mission = probe("mission::outer_step")?;
    let look_back = machine.count("Filter::past_at")?;
    // It sleeps when it has done all calls.
    while machine.load().asleep == 0 && machine.now() < LIMIT {
        machine.run(machine.now() + SECOND / 10)?;
    }
    let count = |probe| Count::from(machine.calls(probe));
    let (functions, filter) = probes.split_at(FUNCTIONS.len());
    let look_back = count(look_back);
    let update = |i: usize| match count(filter[i]) {
        late if i >= FIRST_LATE => late.without(&look_back),
        present => present,
    };
    Ok(Kernels {
        functions: std::array::from_fn(|i| count(functions[i])),
        filter: std::array::from_fn(|i| update(i).per(FILTER[i].1)),
        look_back,
        mission: count(mission),
    })
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

    fn transmitted(&mut self, _: u64, _: Usart, _: Frame) {}

    fn next_event(&self) -> u64 {
        NEVER
    }

    fn advance(&mut self, _: u64, _: &mut Inputs) {}
}
