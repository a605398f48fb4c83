//! What a flight leaves behind, besides the firmware's own log.

use windhover_model::{ImuCounts, Truth};

use super::motors::PulseChange;

/// A sample of the inertial sensors, and the truth at it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When it was taken, in ticks.
    pub time: u64,
    /// What there was to know.
    pub truth: Truth,
    /// What the sensors measured, along the body's axes.
    pub counts: ImuCounts,
}

/// Everything that was recorded, in the order of time.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Samples with their truth.
    pub samples: Vec<Sample>,
    /// Times at which data-ready rose at the processor's pin, in ticks.
    pub data_ready: Vec<u64>,
    /// Changes of the motors' pulses.
    pub pulses: Vec<PulseChange>,
}
