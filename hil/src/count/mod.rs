//! What the code costs: instructions, counted on the emulated board between a function's first
//! instruction and the one behind its call.
//!
//! - [`ticks`]: the steps of the shipped firmware, in a flight.
//! - [`kernels`]: the functions of `windhover-math` over their arguments, the filter over a flight,
//!   the outer step in a mission.
//! - [`table`]: bounds, peers' figures, and how all of it is shown.
//!
//! A call is counted with its return and without the instruction that calls; what preempts it is
//! not counted. Cycles are estimates by the cost model of [`crate::machine`].

pub mod kernels;
pub mod table;
pub mod ticks;

use crate::machine::Calls;

/// Calls of one kind, and what they cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// How many.
    pub calls: u64,
    /// Fewest instructions of a call.
    pub min: u64,
    /// Most instructions of a call.
    pub max: u64,
    /// Instructions of all calls.
    pub instructions: u64,
    /// Cycles of all calls, an estimate.
    pub cycles: u64,
}

impl Count {
    /// Instructions of a call in the mean, 0 without any.
    pub fn mean(&self) -> f64 {
        self.instructions as f64 / self.calls.max(1) as f64
    }

    /// Cycles of a call in the mean, an estimate; 0 without any.
    pub fn mean_cycles(&self) -> f64 {
        self.cycles as f64 / self.calls.max(1) as f64
    }

    /// These calls and those together.
    pub fn and(&self, more: &Self) -> Self {
        let (low, high) = match (self.calls, more.calls) {
            (0, _) => (more.min, more.max),
            (_, 0) => (self.min, self.max),
            _ => (self.min.min(more.min), self.max.max(more.max)),
        };
        Self {
            calls: self.calls + more.calls,
            min: low,
            max: high,
            instructions: self.instructions + more.instructions,
            cycles: self.cycles + more.cycles,
        }
    }

    /// The same without a part that each call had once, in the mean; the extremes are bounds.
    pub fn without(&self, part: &Self) -> Self {
        let share = |sum: u64| sum * self.calls / part.calls.max(1);
        Self {
            calls: self.calls,
            min: self.min.saturating_sub(part.max),
            max: self.max.saturating_sub(part.min),
            instructions: self.instructions.saturating_sub(share(part.instructions)),
            cycles: self.cycles.saturating_sub(share(part.cycles)),
        }
    }

    /// The same for each of the so many equal parts of a call.
    pub fn per(&self, parts: u64) -> Self {
        Self {
            calls: self.calls * parts,
            min: self.min / parts,
            max: self.max.div_ceil(parts),
            ..*self
        }
    }

    /// Counts one more call.
    fn add(&mut self, call: Call) {
        *self = self.and(&Self {
            calls: 1,
            min: call.instructions,
            max: call.instructions,
            instructions: call.instructions,
            cycles: call.cycles,
        });
    }
}

impl From<Calls> for Count {
    fn from(calls: Calls) -> Self {
        Self {
            calls: calls.count,
            min: calls.instructions.min,
            max: calls.instructions.max,
            instructions: calls.instructions.sum,
            cycles: calls.cycles.sum,
        }
    }
}

/// The cost of one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Call {
    instructions: u64,
    cycles: u64,
}
