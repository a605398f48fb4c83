//! Sensors as the bus sees them: what their registers hold, and when.
//!
//! A model of a part takes the [`Truth`](crate::Truth) and gives raw integers; scale, board
//! rotation and calibration are the autopilot's. Each has a struct of errors, whose default is
//! design §5's reference conditions and whose `ideal()` has none. Errors that differ from part to
//! part (a bias, a scale) are standard deviations: a seed draws the part. Every sensor has its
//! own stream of random numbers, so that what happens to one never changes another.
//!
//! - [`icm42688p`]: the inertial measurement unit's registers, byte by byte; it knows nothing of
//!   the vehicle. [`inertial`]: what it measures.
//! - [`barometer`], [`spl06`]: the pressure of the air, and the formula of the part.
//! - [`compass`]: the magnetic field.
//! - [`gnss`]: position and velocity over ground, late, as messages [`nav_pvt`], on the wire as
//!   [`ubx`].
//! - [`battery`]: voltage under load and current; [`rc`]: the pilot's sticks,
//!   on the wire as [`crsf`] and [`sbus`].
//! - [`fault`]: faults by name; [`injection`]: how they act.
//! - [`suite`]: all sensors of a vehicle together, each at its [`rate`].
//! - [`mounting`]: how a part sits; [`noise`]: walks, correlated noise, filters.

pub mod barometer;
pub mod battery;
pub mod compass;
pub mod crsf;
pub mod fault;
pub mod gnss;
pub mod icm42688p;
pub mod inertial;
pub mod injection;
pub mod mounting;
pub mod nav_pvt;
pub mod noise;
pub mod rate;
pub mod rc;
pub mod sbus;
pub mod spl06;
pub mod suite;
pub mod ubx;

/// Streams of random numbers, one a sensor. 0 is the wind's.
mod stream {
    pub const ACCEL: u64 = 0x100;
    pub const GYRO: u64 = 0x101;
    pub const BAROMETER: u64 = 0x102;
    pub const COMPASS: u64 = 0x103;
    pub const GNSS: u64 = 0x104;
    pub const BATTERY: u64 = 0x105;
    pub const RC: u64 = 0x106;
    /// The first of the faults', which have one each.
    pub const FAULT: u64 = 0x1000;
}

/// The integer nearest to `value`, half to even, held at the ends of a range; 0 for NaN.
pub(crate) fn count(value: f64, low: i32, high: i32) -> i32 {
    libm::rint(value.clamp(f64::from(low), f64::from(high))) as i32
}

/// As [`count`], in the range of an `i16`.
pub(crate) fn count_i16(value: f64) -> i16 {
    count(value, i16::MIN.into(), i16::MAX.into()) as i16
}

#[cfg(test)]
mod tests {
    use super::stream::{ACCEL, BAROMETER, BATTERY, COMPASS, FAULT, GNSS, GYRO, RC};

    #[test]
    fn every_sensor_has_its_own_stream() {
        let mut streams = [ACCEL, GYRO, BAROMETER, COMPASS, GNSS, BATTERY, RC];
        streams.sort_unstable();
        assert!(streams[0] > 0, "0 is the wind's");
        assert!(streams.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(streams[6] < FAULT);
    }
}
