//! The paper's controllers, as pure functions of setpoint, estimate and time step.
//!
//! From the outside in: [`position`] turns a position error into a demanded acceleration and
//! thrust (equation 13), with [`observer`] taking out what wind and payload do to it;
//! [`inversion`] turns the demanded force into roll and pitch (equation 12); [`attitude`] turns an
//! attitude error into a torque; [`mixer`] turns thrust and torque into four rotor speeds
//! (equation 5). [`pid`] is equation 10, used by the first and the third.
//!
//! SI units, radians, NED world, FRD body. No clock, no static, no heap: time comes in as `dt`.
#![no_std]

pub mod attitude;
pub mod inversion;
pub mod mixer;
pub mod observer;
pub mod pid;
pub mod position;
pub mod setpoint;
pub mod vehicle;

pub use setpoint::TrajectorySetpoint;
pub use vehicle::VehicleParameters;
