//! Whether the inertial sensors can have measured what their registers hold.

use crate::io::ImuCounts;

/// How the ICM-42688-P marks a result that is not valid (datasheet, section 4.14: the registers'
/// value after a reset and while a sensor is off): all three axes so.
const INVALID: i16 = i16::MIN;

/// So many samples without a change in any axis, while the gyro changes, are none: the part's own
/// noise alone is three counts. In thousandths of the sample rate, so 100 ms or somewhat more. Where
/// the gyro stands still as well, the vehicle may: in a world without noise it does.
const FROZEN: u32 = 100;

/// Watches the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccelWatch {
    last: [i16; 3],
    /// What the gyro's first axis showed then.
    gyro: i16,
    /// How often it may still show the same.
    left: u16,
    most: u16,
}

impl AccelWatch {
    /// For this many samples per second.
    pub fn new(imu_rate: u32) -> Self {
        let most = (imu_rate * FROZEN / 1000).min(1000) as u16;
        Self {
            last: [0; 3],
            gyro: 0,
            left: most,
            most,
        }
    }

    /// Takes in a sample; whether it can be true of a vehicle that flies. One that stands still on
    /// a quiet desk may show the same for long: there [`has_force`] is enough. Inlined, it would
    /// have to share the registers.
    #[inline(never)]
    pub fn look(&mut self, counts: &ImuCounts) -> bool {
        // The usual case is over at the first axis.
        if counts.accel.iter().zip(&self.last).any(|(now, last)| now != last) {
            self.last = counts.accel;
            self.gyro = counts.gyro[0];
            self.left = self.most;
            return has_force(counts);
        }
        let gyro_lives = counts.gyro[0] != self.gyro;
        self.left = self.left.saturating_sub(u16::from(gyro_lives));
        self.left > 0 && has_force(counts)
    }
}

/// Whether the accelerometer has measured anything.
#[inline]
pub fn has_force(counts: &ImuCounts) -> bool {
    is_valid(&counts.accel)
}

/// Whether the gyro has measured anything.
#[inline]
pub fn has_rate(counts: &ImuCounts) -> bool {
    is_valid(&counts.gyro)
}

#[inline]
fn is_valid(axes: &[i16; 3]) -> bool {
    axes.iter().any(|count| *count != INVALID)
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
    fn an_accelerometer_that_hangs_in_flight_is_noticed_after_100_ms() {
        for (rate, ticks) in [(1000, 100), (4000, 400)] {
            let mut watch = AccelWatch::new(rate);
            watch.look(&counts(1));
            // Neither moves: a vehicle at rest in a world without noise.
            assert!((1..1000).all(|_| watch.look(&counts(1))));
            let alive = ImuCounts {
                gyro: [1, 0, 0],
                ..counts(1)
            };
            let noticed = (1..1000).find(|_| !watch.look(&alive));
            assert_eq!(noticed, Some(ticks));
            assert!(has_force(&counts(1)), "on the ground it may");
            assert!(watch.look(&counts(2)), "and it may wake up");
        }
    }

    #[test]
    fn registers_of_a_sensor_that_is_off_are_no_measurement() {
        let off = ImuCounts {
            accel: [INVALID; 3],
            gyro: [INVALID; 3],
        };
        assert!(!AccelWatch::new(1000).look(&off) && !has_force(&off));
        assert!(!has_rate(&off) && has_rate(&counts(0)));
    }
}
