//! Whether the inertial sensors can have measured what their registers hold.

use crate::io::ImuCounts;

/// How the ICM-42688-P marks a result that is not valid (datasheet, section 4.14: the registers'
/// value after a reset and while a sensor is off).
const INVALID: [i16; 3] = [i16::MIN; 3];

/// So many samples a second without a change in any axis are none: the part's own noise alone is
/// three counts. In thousandths of the sample rate, so 25 ms.
const FROZEN: u32 = 25;

/// Watches the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccelWatch {
    last: [i16; 3],
    same: u16,
    most: u16,
}

impl AccelWatch {
    /// For this many samples per second.
    pub fn new(imu_rate: u32) -> Self {
        Self {
            last: [0; 3],
            same: 0,
            most: (imu_rate * FROZEN / 1000).min(1000) as u16,
        }
    }

    /// Takes in a sample; whether it can be true of a vehicle that flies. One that stands still on
    /// a quiet desk may show the same for long.
    #[inline]
    pub fn look(&mut self, counts: &ImuCounts, flies: bool) -> bool {
        if counts.accel != self.last {
            self.last = counts.accel;
            self.same = 0;
        } else if self.same < self.most {
            self.same += 1;
        }
        counts.accel != INVALID && !(flies && self.same >= self.most)
    }
}

/// Whether the gyro has measured anything.
#[inline]
pub fn has_rate(counts: &ImuCounts) -> bool {
    counts.gyro != INVALID
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(x: i16) -> ImuCounts {
        ImuCounts {
            accel: [x, 3, -2048],
            gyro: [0; 3],
        }
    }

    #[test]
    fn an_accelerometer_that_hangs_in_flight_is_noticed_after_25_ms() {
        for (rate, ticks) in [(1000, 25), (4000, 100)] {
            let mut watch = AccelWatch::new(rate);
            watch.look(&counts(1), true);
            let noticed = (1..1000).find(|_| !watch.look(&counts(1), true));
            assert_eq!(noticed, Some(ticks));
            assert!(watch.look(&counts(1), false), "on the ground it may");
            assert!(watch.look(&counts(2), true), "and it may wake up");
        }
    }

    #[test]
    fn registers_of_a_sensor_that_is_off_are_no_measurement() {
        let off = ImuCounts {
            accel: INVALID,
            gyro: INVALID,
        };
        assert!(!AccelWatch::new(1000).look(&off, false));
        assert!(!has_rate(&off) && has_rate(&counts(0)));
    }
}
