//! The desktop's world: a quadcopter, its rotors, the air and the ground.
//!
//! The other side of the core's borders: motor commands go in, the truth comes out. It knows
//! nothing of controllers. All in SI units, radians and double precision; world NED (north,
//! east, down from the start), body FRD (front, right, down); rotors in the core's order. Equal
//! arguments give equal bits on every machine: no functions of the operating system's
//! mathematical library, no clock, randomness from a seed.
//!
//! - [`vehicle`]: vehicle files; [`conditions`]: wind, pushes, payload, seed of a flight.
//! - [`world`]: the vehicle in its world, step by step; [`truth`]: what there is to know.
//! - [`simple`], [`paper`], [`rigid`]: the equations of motion, chosen in [`motion`] and stepped
//!   by [`integrate`]; [`kinematics`] is what they have in common, [`divergence`] where they end.
//! - [`esc`], [`rotor`]: from motor commands to forces and torques.
//! - [`wind`], [`push`], [`payload`], [`body`], [`ground`]: what else acts on the vehicle.
//! - [`imu`]: what an ideal IMU reads; [`sensor`]: parts as the bus sees them; [`random`]:
//!   random numbers.

pub mod body;
pub mod conditions;
pub mod divergence;
pub mod esc;
pub mod ground;
pub mod imu;
pub mod integrate;
pub mod kinematics;
mod length;
pub mod motion;
pub mod paper;
pub mod payload;
pub mod push;
pub mod random;
pub mod rigid;
pub mod rotor;
pub mod sensor;
pub mod simple;
pub mod truth;
pub mod vehicle;
pub mod wind;
pub mod world;

pub use conditions::{Conditions, ConditionsError};
pub use divergence::{Divergence, Quantity};
pub use esc::Command;
pub use ground::{Contact, Crash};
pub use imu::{ImuCounts, ideal_counts};
pub use integrate::Integrator;
pub use kinematics::Kinematics;
pub use motion::ModelKind;
pub use payload::Payload;
pub use push::Push;
pub use truth::Truth;
pub use vehicle::{Plant, Vehicle, VehicleError};
pub use wind::mean_wind_from;
pub use world::World;

/// Standard gravity in m/s² (ISO 80000-3).
pub const GRAVITY: f64 = 9.806_65;
