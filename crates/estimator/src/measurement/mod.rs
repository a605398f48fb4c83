//! What corrects the filter, one file a sensor.
//!
//! Each method checks its input, compares it with the state at the measurement's time, lets the
//! gate decide, and reports innovation, variance and verdict. Standard deviations come with the
//! measurement: who knows the sensor sets them.

mod bearing;

pub mod barometer;
pub mod compass;
pub mod gnss_position;
pub mod gnss_velocity;
pub mod gravity;
pub mod heading;
pub mod pose;
pub mod rest;

pub use barometer::BarometricHeight;
pub use compass::MagneticField;
pub use gnss_position::GnssPosition;
pub use gnss_velocity::GnssVelocity;
pub use heading::Heading;
pub use pose::ExternalPose;
