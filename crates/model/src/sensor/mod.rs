//! Sensors as the bus sees them: what their registers hold, byte by byte, and when.
//!
//! These models know time and raw counts, nothing of the vehicle and nothing of the driver.
//!
//! - [`icm42688p`]: the inertial measurement unit.

pub mod icm42688p;
