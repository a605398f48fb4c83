//! What a flight is made of, besides the world.

use windhover_model::sensor::suite::SensorSuite;

use super::fault::Fault;
use super::wires::Wires;
use crate::parts::rc::Protocol;
use crate::parts::ublox::Generation;

/// What a flight is made of, besides the world.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The board's wires.
    pub wires: Wires,
    /// How much faster the sensors' oscillator is than it should be, in millionths.
    pub imu_clock_ppm: i32,
    /// What goes wrong.
    pub faults: Vec<Fault>,
    /// What is random about the faults follows from it.
    pub seed: u64,
    /// Every how many samples one is recorded; 0 for none.
    pub record_every: u64,
    /// What all sensors measure. Without, the inertial ones are ideal, and nothing else is there.
    pub sensors: Option<SensorSuite>,
    /// Which satellite receiver is plugged in.
    pub gnss: Generation,
    /// How the RC receiver speaks, if there is one.
    pub remote: Option<Protocol>,
}

impl Default for Setup {
    /// The reference board, a perfect oscillator, no faults, every sample recorded.
    fn default() -> Self {
        Self {
            wires: Wires::SPEEDYBEE_F405_V4,
            imu_clock_ppm: 0,
            faults: Vec::new(),
            seed: 1,
            record_every: 1,
            sensors: None,
            gnss: Generation::default(),
            remote: None,
        }
    }
}
